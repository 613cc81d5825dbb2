//! Whole frames in Verilog against the machine: every event with all its bits in order, the picture, and the cycles.

use std::collections::{BTreeMap, VecDeque};

use shiftvox::graph::{Graph, LinkedGraph, NodeLayout, vxg};

use super::machines::{LANES, Machine, STAGE_A, STAGE_B, STAGE_C, STAGE_C_BRICKS, agree};
use super::tools::{modules, rtl, run, text};
use super::views::{Dice, INSIDE, SCENES, TREE, any_view, view_from_within, with_tiles};

#[test]
fn views_from_outside_and_inside_have_the_machines_events_picture_and_cycles() {
    for (machine, events) in [
        (&STAGE_A, 1_000_000),
        (&STAGE_B, 250_000),
        (&STAGE_C, 100_000),
    ] {
        let agreement = agree(machine, TREE, None);
        assert!(agreement.events > events && agreement.samples > 1000);
        agree(machine, INSIDE, None);
    }
}

/// Synthesis accepts all machines, and lanes: no latch, no loop, no signal with two drivers.
#[test]
fn yosys_takes_the_machines() {
    let lanes = [
        Machine::new("stage_b", Some([2, 1, 1]), false),
        Machine::new("stage_c", Some([2, 2, 1]), true),
    ];
    let machines = [&STAGE_A, &STAGE_B, &STAGE_C, &STAGE_C_BRICKS];
    let machines = machines.map(|machine| (machine, "machine")).into_iter();
    for (machine, top) in machines.chain(lanes.iter().map(|machine| (machine, "lanes"))) {
        // Of modules in several folders the first counts.
        let mut files = BTreeMap::new();
        for folder in machine.folders() {
            for name in modules(folder) {
                let path = format!("{folder}/{name}.v");
                files.entry(name).or_insert(path);
            }
        }
        let files: Vec<String> = files.into_values().collect();
        let (files, folders) = (files.join(" "), machine.folders().join(" -I"));
        let parameters = machine.parameters();
        let parameters = parameters
            .iter()
            .map(|(name, value)| format!(" -chparam {name} {value}"));
        let parameters: String = parameters.collect();
        let script = format!(
            "read_verilog -sv -I. -I{folders} {files}; hierarchy -check -top {top}{parameters}; proc; check -assert; \
             select -assert-none t:$dlatch"
        );
        run(&rtl(), "yosys", &["-q", "-p", &script]);
    }
}

/// Chosen views, then random ones, from all sides and from between the voxels: planes are degenerate there, and cubes reach
/// behind the eye.
#[test]
#[ignore = "takes minutes"]
fn many_views() {
    for machine in [&STAGE_A, &STAGE_B, &STAGE_C] {
        for view in SCENES {
            agree(machine, view, None);
        }
        random_views(machine, 200, &any_view);
    }
    for machine in [&STAGE_B, &STAGE_C] {
        random_views(machine, 200, &view_from_within);
    }
    random_views(&STAGE_C_BRICKS, 100, &any_view);
    random_views(&STAGE_C_BRICKS, 100, &view_from_within);
    for machine in &LANES {
        for view in SCENES.into_iter().chain([TREE, INSIDE]) {
            agree(machine, view, None);
        }
        random_views(machine, 25, &|dice| with_tiles(any_view, dice));
        random_views(machine, 25, &|dice| with_tiles(view_from_within, dice));
    }
}

/// Draws views by seed.
fn random_views(machine: &Machine, number: u32, make: &dyn Fn(&mut Dice) -> String) {
    let mut dice = Dice(1);
    for _ in 0..number {
        agree(machine, &make(&mut dice), None);
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
        let (name, graph) = (nodes, linked_graph(depth, nodes));
        assert!(bricks_of(&graph).is_empty(), "{name}");
        vxg::write(&graph, &file, true).unwrap();
        for view in [
            "--size 64 --view iso",
            "--size 40x60 --azimuth 130 --lod 0",
            "--size 33 --view right --zoom 5",
        ] {
            let view = format!("{} {view}", text(&file));
            let machines = [&STAGE_A, &STAGE_B, &STAGE_C, &STAGE_C_BRICKS];
            let drawn = machines.map(|machine| agree(machine, &view, Some(&graph.links)));
            assert!(drawn.iter().all(|of| of.samples > 0), "{name}");
            assert_eq!(drawn[2].cycles, drawn[3].cycles, "{name}");
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
            _ if level == depth || dice.next(3) == 0 => 0,
            _ => 1 + dice.next(255),
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

/// Cycles with bricks beside those without.
#[test]
#[ignore = "takes minutes"]
fn bricks_in_many_scenes() {
    let shelter = tempfile::tempdir().unwrap();
    let file = shelter.path().join("solids.vxg");
    vxg::write(&tree_with_larger_solids(5), &file, true).unwrap();
    let solids = format!("{} --size 64 --view iso", text(&file));
    // The first has less than two levels, the second the root alone.
    let without_bricks = [
        "gen:random,depth=1,seed=2 --size 20",
        "gen:random,depth=2,seed=3 --size 20",
    ];
    let views = [TREE, INSIDE, &solids]
        .into_iter()
        .chain(SCENES)
        .chain(without_bricks);
    for view in views {
        let [with, without] = [&STAGE_C_BRICKS, &STAGE_C].map(|machine| agree(machine, view, None));
        assert_eq!(with.samples, without.samples);
        let is_fewer = with.cycles[0] < without.cycles[0];
        assert!(is_fewer || without_bricks.contains(&view), "{view}");
    }
}
