//! Whole frames in Verilog against the machine: every event with all its bits in order, the picture, and the cycles.

use std::collections::VecDeque;
use std::fs;

use shiftvox::graph::{Graph, LinkedGraph, NodeLayout, vxg};

use super::machines::{LANES, Machine, STAGE_A, STAGE_B, STAGE_C, STAGE_C_BRICKS, agree};
use super::tools::{each, files, rtl, run};
use super::views::{Dice, INSIDE, SCENES, TREE, view_from_outside, view_from_within};

#[test]
fn views_from_outside_and_inside_have_the_machines_events_picture_and_cycles() {
    let small = TREE.replace("--size 64", "--size 32");
    for (machine, events) in [(&STAGE_A, 250_000), (&STAGE_B, 50_000), (&STAGE_C, 20_000)] {
        let agreement = agree(machine, &small, None);
        assert!(agreement.events > events && agreement.samples > 250);
        agree(machine, INSIDE, None);
    }
}

#[test]
fn yosys_takes_lanes() {
    synthesize(&[&Machine::new(
        "stage_c",
        "LANES=2 CONTEXTS=2 TILE_LEVELS=1 BRICKS=1",
    )]);
}

#[test]
#[ignore = "takes half a minute"]
fn yosys_takes_the_other_machines() {
    let lanes = Machine::new("stage_b", "LANES=2 CONTEXTS=1 TILE_LEVELS=1");
    synthesize(&[&STAGE_A, &STAGE_B, &STAGE_C, &STAGE_C_BRICKS, &lanes]);
}

/// Synthesis accepts machines: no latch, no loop, no signal with two drivers.
fn synthesize(machines: &[&Machine]) {
    let shelter = tempfile::tempdir().unwrap();
    let script = shelter.path().join("check.ys");
    for machine in machines {
        let top = if machine.has_lanes() {
            "lanes"
        } else {
            "machine"
        };
        let mut modules = files(machine.folders());
        modules.retain(|path| path.extension().is_some_and(|end| end == "v"));
        let modules: String = modules
            .iter()
            .map(|path| format!(" {}", path.display()))
            .collect();
        let folders = each(machine.folders(), |folder| format!(" -I{folder}"));
        let parameters = each(machine.parameters, |of| {
            format!(" -chparam {}", of.replace('=', " "))
        });
        let text = format!(
            "read_verilog -sv -I.{folders}{modules}; hierarchy -check -top {top}{parameters}; proc; check -assert; \
             select -assert-none t:$dlatch"
        );
        fs::write(&script, text).unwrap();
        run(&rtl(), &format!("yosys -q -s {}", script.display()));
    }
}

/// Chosen views, then random ones, from all sides and from between the voxels: planes are degenerate there, and cubes reach
/// behind the eye.
#[test]
#[ignore = "takes minutes"]
fn many_views() {
    let shelter = tempfile::tempdir().unwrap();
    let file = shelter.path().join("solids.vxg");
    vxg::write(&tree_with_larger_solids(5), &file, true).unwrap();
    let solids = format!("{} --size 64 --view iso", file.display());
    // Without bricks: the first has less than two levels, the second the root alone.
    let small = [
        "gen:random,depth=1,seed=2 --size 20",
        "gen:random,depth=2,seed=3 --size 20",
    ];
    let chosen = [&[TREE, INSIDE, &solids], &SCENES[..], &small].concat();
    // A lane draws more samples than a tile has.
    let lanes = LANES.iter().map(|machine| (machine, 25, 25, 9));
    let alone = [
        (&STAGE_A, 200, 0, 1),
        (&STAGE_B, 200, 200, 1),
        (&STAGE_C, 200, 200, 1),
        (&STAGE_C_BRICKS, 100, 100, 1),
    ];
    for (machine, outside, within, least) in alone.into_iter().chain(lanes) {
        let (mut dice, mut inner) = (Dice(1), Dice(1));
        let outside = (0..outside).map(|_| view_from_outside(&mut dice, least));
        let within = (0..within).map(|_| view_from_within(&mut inner, least));
        let chosen = chosen.iter().map(|view| (*view).to_owned());
        for view in chosen.chain(outside).chain(within) {
            agree(machine, &view, None);
        }
    }
}

/// A linked graph: its depth, and the children of its nodes by octant. Digits are nodes, a dot is no child.
fn linked_graph(depth: u32, nodes: &str) -> Graph {
    let mut graph = LinkedGraph::new(depth);
    for (at, children) in nodes.split(' ').enumerate() {
        let mut children = children.chars().map(|digit| digit.to_digit(10));
        let children = std::array::from_fn(|_| children.next().flatten());
        graph.add_node([40 * at as u8 + 30, 90, 160], children);
    }
    graph.build().unwrap()
}

/// The hardware draws linked graphs from a memory in which lists of children lie side by side, shared ones once. They have
/// no bricks, also on a machine that can have them.
#[test]
#[ignore = "takes minutes"]
fn linked_and_cyclic_graphs() {
    let shelter = tempfile::tempdir().unwrap();
    let file = shelter.path().join("linked.vxg");
    for (depth, nodes) in [
        (6, "0..0.00."),
        (7, "1..0.21. .01....0 ........"),
        (3, "12.11.21 3.3..3.3 .31.3... ........"),
    ] {
        let graph = linked_graph(depth, nodes);
        assert!(bricks_of(&graph).is_empty(), "{nodes}");
        vxg::write(&graph, &file, true).unwrap();
        for camera in [
            "--size 64 --view iso",
            "--size 40x60 --azimuth 130 --lod 0",
            "--size 33 --view right --zoom 5",
        ] {
            let view = format!("{} {camera}", file.display());
            let machines = [&STAGE_A, &STAGE_B, &STAGE_C, &STAGE_C_BRICKS];
            let drawn = machines.map(|machine| agree(machine, &view, Some(&graph.links)));
            assert!(drawn.iter().all(|of| of.samples > 0), "{nodes}");
            assert_eq!(drawn[2].cycles, drawn[3].cycles, "{nodes}");
        }
    }
}

/// A tree with solids on each level, also next to voxels in a brick. Trees of voxels do not have those.
pub(crate) fn tree_with_larger_solids(depth: u32) -> Graph {
    let mut dice = Dice(5);
    let mut graph = LinkedGraph::new(depth);
    let (mut levels, mut next) = (VecDeque::from([0]), 1);
    while let Some(level) = levels.pop_front() {
        let mask = match level {
            0 => 0xff,
            _ if level == depth || dice.below(3) == 0 => 0,
            _ => 1 + dice.below(255),
        };
        let children = std::array::from_fn(|octant| {
            (mask >> octant & 1 != 0).then(|| {
                levels.push_back(level + 1);
                next += 1;
                next - 1
            })
        });
        graph.add_node([40, 90, 160], children);
    }
    let graph = graph.build().unwrap();
    assert!(!bricks_of(&graph).is_empty());
    graph
}

/// The nodes that are bricks where lists of children lie side by side.
fn bricks_of(graph: &Graph) -> std::ops::Range<u32> {
    let graph = graph.side_by_side().unwrap();
    NodeLayout::new(&graph.view(), true, true).bricks()
}
