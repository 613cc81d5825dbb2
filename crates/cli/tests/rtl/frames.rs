//! Whole frames in Verilog against the machine: every event with all its bits, in order; the picture; the cycles.

use std::collections::BTreeMap;
use std::fs;

use shiftvox::graph::{LinkedGraph, vxg};

use super::machines::{
    Expected, Machine, STAGE_A, STAGE_B, STAGE_C, STAGE_C_BRICKS, agree, agree_linked, lanes,
};
use super::tools::{is_there, rtl, run, text};
use super::views::{Dice, INSIDE, SCENES, TREE, any_view, view_from_within};

#[test]
fn the_bundled_tree_has_the_machines_events_picture_and_cycles() {
    if !is_there("verilator") {
        return;
    }
    for (machine, events) in [
        (&STAGE_A, 1_000_000),
        (&STAGE_B, 250_000),
        (&STAGE_C, 100_000),
    ] {
        let agreement = agree(machine, &[TREE, "--size", "64"]);
        assert!(agreement.events > events && agreement.samples > 1000);
    }
}

#[test]
fn an_eye_inside_too() {
    if !is_there("verilator") {
        return;
    }
    agree(&STAGE_A, &INSIDE);
    agree(&STAGE_B, &INSIDE);
    agree(&STAGE_C, &INSIDE);
}

/// Synthesis takes all machines, and lanes: no latch, no loop, no signal with two drivers.
#[test]
fn yosys_takes_the_machines() {
    if !is_there("yosys") {
        return;
    }
    let lanes_b = Machine::lanes_of_stage_b(lanes(2, 1, 1));
    let lanes_c = Machine::lanes_of_stage_c(lanes(2, 2, 1), true);
    for (machine, top) in [
        (&STAGE_A, "machine"),
        (&STAGE_B, "machine"),
        (&STAGE_C, "machine"),
        (&STAGE_C_BRICKS, "machine"),
        (&lanes_b, "lanes"),
        (&lanes_c, "lanes"),
    ] {
        // Of modules in several folders the first counts.
        let mut files = BTreeMap::new();
        for folder in machine.folders {
            for path in fs::read_dir(rtl().join(folder)).unwrap() {
                let name = path.unwrap().file_name().into_string().unwrap();
                if name.ends_with(".v") {
                    files
                        .entry(name.clone())
                        .or_insert(format!("{folder}/{name}"));
                }
            }
        }
        let files: Vec<String> = files.into_values().collect();
        let (files, folders) = (files.join(" "), machine.folders.join(" -I"));
        let parameters: String = machine
            .parameters()
            .iter()
            .map(|(name, value)| format!(" -chparam {name} {value}"))
            .collect();
        let script = format!(
            "read_verilog -sv -I. -I{folders} {files}; hierarchy -check -top {top}{parameters}; proc; check -assert; \
             select -assert-none t:$dlatch"
        );
        run(&rtl(), "yosys", &["-q", "-p", &script]);
    }
}

#[test]
#[ignore = "takes minutes"]
fn many_scenes() {
    if !is_there("verilator") {
        return;
    }
    for machine in [&STAGE_A, &STAGE_B, &STAGE_C] {
        for view in SCENES {
            agree(machine, view);
        }
    }
}

/// A graph as this file writes it: its name, its depth, and each node's children by octant.
pub(crate) type Drawn = (&'static str, u32, Vec<[Option<u32>; 8]>);

/// Graphs with shared nodes and with cycles.
pub(crate) fn linked_graphs() -> Vec<Drawn> {
    let no = None;
    let [a, b, c, d] = [Some(0), Some(1), Some(2), Some(3)];
    vec![
        (
            "one node, four times below itself",
            6,
            vec![[a, no, no, a, no, a, a, no]],
        ),
        (
            "two nodes in turns, and a solid",
            7,
            vec![
                [b, no, no, a, no, c, b, no],
                [no, a, b, no, no, no, no, a],
                [no; 8],
            ],
        ),
        (
            "one solid, shared by three, one of them shared by the root",
            3,
            vec![
                [b, c, no, b, b, no, c, b],
                [d, no, d, no, no, d, no, d],
                [no, d, b, no, d, no, no, no],
                [no; 8],
            ],
        ),
    ]
}

/// The hardware draws linked graphs from a memory in which lists of children lie side by side, shared ones once.
#[test]
#[ignore = "takes minutes"]
fn linked_and_cyclic_graphs() {
    if !is_there("verilator") {
        return;
    }
    let shelter = tempfile::tempdir().unwrap();
    for (name, depth, nodes) in linked_graphs() {
        let mut graph = LinkedGraph::new(depth);
        for (at, &children) in nodes.iter().enumerate() {
            graph.add_node([40 * at as u8 + 30, 90, 160], children);
        }
        let graph = graph.build().unwrap();
        let file = shelter.path().join("linked.vxg");
        vxg::write(&graph, &file, true).unwrap();
        for view in [
            &["--size", "64", "--view", "iso"][..],
            &["--size", "40x60", "--azimuth", "130", "--lod", "0"],
            &["--size", "33", "--view", "right", "--zoom", "5"],
        ] {
            let view = [&[text(&file)], view].concat();
            for machine in [&STAGE_A, &STAGE_B, &STAGE_C] {
                eprint!("{name}: ");
                let agreement = agree_linked(machine, &view, Some(&graph.links));
                assert!(agreement.samples > 0, "{name}");
            }
        }
    }
}

/// So many views by seed.
pub(crate) fn random_views(
    machine: &Machine,
    number: u32,
    make: &mut dyn FnMut(Dice<'_>) -> Vec<String>,
) {
    if !is_there("verilator") {
        return;
    }
    let mut state = 1u64;
    let mut next = |most: u64| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % most
    };
    let mut unlike = 0;
    for at in 0..number {
        let view = make(&mut next);
        let view: Vec<&str> = view.iter().map(String::as_str).collect();
        let agreement = Expected::new(machine, &view)
            .compare(&[machine.simulator()])
            .unwrap_or_else(|error| panic!("{} {at} {view:?}: {error}", machine.name));
        let [simulated, model] = agreement.cycles;
        if simulated != model {
            eprintln!("{at} {view:?}: {simulated} cycles, {model} in the model");
            unlike += 1;
        }
    }
    let name = machine.name;
    eprintln!(
        "{name} {:?}: {number} random views: all events and pictures equal; cycles unlike in {unlike}",
        machine.parameters()
    );
    assert_eq!(unlike, 0);
}

#[test]
#[ignore = "takes minutes"]
fn two_hundred_random_views() {
    random_views(&STAGE_A, 200, &mut any_view);
}

#[test]
#[ignore = "takes minutes"]
fn two_hundred_random_views_of_stage_b() {
    random_views(&STAGE_B, 200, &mut any_view);
}

#[test]
#[ignore = "takes minutes"]
fn two_hundred_random_views_of_stage_c() {
    random_views(&STAGE_C, 200, &mut any_view);
}

/// Where planes are degenerate, and cubes reach behind the eye.
#[test]
#[ignore = "takes minutes"]
fn two_hundred_wide_views_of_stage_b_from_between_the_voxels() {
    random_views(&STAGE_B, 200, &mut view_from_within);
}

#[test]
#[ignore = "takes minutes"]
fn two_hundred_wide_views_of_stage_c_from_between_the_voxels() {
    random_views(&STAGE_C, 200, &mut view_from_within);
}
