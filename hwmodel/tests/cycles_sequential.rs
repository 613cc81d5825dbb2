//! Records, tiles and contexts on sequential hardware (rules 12 to 14 of `hwmodel::cycles`), their cycles worked out by hand.
#![allow(clippy::unwrap_used, reason = "tests")]

mod cycles_common;

use cycles_common::{Does, Listed, Node};
use hwmodel::cycles::{
    CycleReport, Hardware, ImageNode, Recorder, TraceLimit, VisitSpan, simulate,
};
use hwmodel::{Memory, OpClass, Stage};

const HARDWARE: &str = r#"
name = "by hand"
clock_mhz = 1.0
lanes = 1
contexts = 1
independence = "none"
steal_cycles = 0
sequential = true
wires = ["sub", "compare", "min_max", "select", "shift", "logic", "divide_step"]
[units]
add = { count = 2, latency = 1, interval = 1, width = 16 }
[stack]
entries = 4
ports = 1
latency = 1
overflow = "error"
spill_cycles = 0
[node_cache]
bytes = 64
ways = 1
line_bytes = 16
entry_bytes = 8
ports = 1
hit_latency = 1
miss_latency = 10
misses = 1
[attribute_cache]
bytes = 64
ways = 1
line_bytes = 16
entry_bytes = 8
ports = 1
hit_latency = 1
miss_latency = 10
misses = 1
[fill_vectors]
banks = 1
read_ports = 1
write_ports = 1
latency = 1
[pixels]
write_ports = 1
buffer = 1
drain_interval = 4
"#;

const ORIGIN: ImageNode = ImageNode {
    level: 0,
    x: 0,
    y: 0,
};

fn visits(does: Vec<Does>, toml: &str) -> (Vec<(Stage, u64, u64)>, u64) {
    let start = Node {
        does: vec![Does::Write(Stage::Push, Memory::Stack, 0)],
        children: vec![(1, 0, ORIGIN)],
    };
    let record = Node {
        does,
        children: Vec::new(),
    };
    let hardware = Hardware::from_toml(toml).unwrap();
    let nodes = [start, record];
    let mut workload = Listed::new(&nodes, &hardware);
    let mut recorder = Recorder::new(TraceLimit::default());
    let report = simulate(&hardware, &mut workload, &mut recorder).unwrap();
    let row = |visit: &VisitSpan| (visit.stage, visit.begins, visit.ends);
    (recorder.visits().iter().map(row).collect(), report.cycles)
}

#[test]
fn a_step_after_the_other() {
    let adds = |times| Does::Ops(Stage::Centre, OpClass::Add, 16, times);
    let filled = |address| Does::Read(Stage::Filled, Memory::FillVector, address);
    let does = vec![
        Does::Read(Stage::Pop, Memory::Stack, 0),
        adds(3),
        Does::Step(Stage::Centre, 0),
        adds(1),
        Does::Step(Stage::Centre, 3),
        filled(0),
        filled(1),
        Does::Read(Stage::OnePixel, Memory::Node, 0),
        adds(2),
        Does::Write(Stage::Draw, Memory::Pixel, 0),
    ];
    let (found, cycles) = visits(does.clone(), HARDWARE);
    let by_hand = [
        (Stage::Push, 0, 1),
        // A cycle to read, a cycle to look at it.
        (Stage::Pop, 1, 3),
        // Three adds on two adders: 2 cycles, and their latency.
        (Stage::Centre, 3, 6),
        // The next step of the same stage: a cycle, and a latency.
        (Stage::Centre, 6, 8),
        // Cycles in which nothing is counted.
        (Stage::Centre, 8, 11),
        // The second read waits until the first was looked at.
        (Stage::Filled, 11, 15),
        // A miss: 1 to ask, 10 to wait, 1 to look at it.
        (Stage::OnePixel, 15, 27),
        // Back in a stage: another visit of it.
        (Stage::Centre, 27, 29),
        (Stage::Draw, 29, 30),
    ];
    assert_eq!(found, by_hand);
    // The pixel leaves four cycles after it was written.
    assert_eq!(cycles, 33);
    // Pipelines take all of a stage for one visit, and know no steps.
    let pipelined = HARDWARE.replace("sequential = true", "");
    let (found, _) = visits(does, &pipelined);
    let stages: Vec<Stage> = found.iter().map(|&(stage, ..)| stage).collect();
    let count = |of| stages.iter().filter(|&&stage| stage == of).count();
    assert_eq!((count(Stage::Centre), count(Stage::Filled)), (1, 1));
    assert_eq!(stages.len(), 6);
}

#[test]
fn what_is_done_beside_takes_no_step_of_its_own() {
    let ops = |stage, times| Does::Ops(stage, OpClass::Add, 16, times);
    let (read, centre) = (
        Does::Read(Stage::Pop, Memory::Stack, 0),
        ops(Stage::Centre, 1),
    );
    let beside = Does::Beside(Stage::Order, OpClass::Add, 16, 1);
    let does = vec![read.clone(), centre.clone(), beside, centre.clone()];
    let (found, _) = visits(does.clone(), HARDWARE);
    // Three adds on the two adders of one stage: 2 cycles, and their latency.
    assert_eq!(found[2..], [(Stage::Centre, 3, 6)]);
    // Were it a step of its own, each of three would take a cycle and a latency.
    let (apart, _) = visits(
        vec![read, centre.clone(), ops(Stage::Order, 1), centre],
        HARDWARE,
    );
    let by_hand = [
        (Stage::Centre, 3, 5),
        (Stage::Order, 5, 7),
        (Stage::Centre, 7, 9),
    ];
    assert_eq!(apart[2..], by_hand);
    // Pipelines do it in its own block.
    let pipelined = HARDWARE.replace("sequential = true", "");
    let (found, _) = visits(does, &pipelined);
    let stages: Vec<Stage> = found[2..].iter().map(|&(stage, ..)| stage).collect();
    assert_eq!(stages, [Stage::Centre, Stage::Order]);
}

/// Tiles that do what is listed, and the last one's record, on lanes that are given them: context (counted on from
/// lane to lane), stage, first cycle, end.
fn tiles(
    (lanes, contexts): (u32, u32),
    does: Vec<Vec<Does>>,
) -> (Vec<(u32, Stage, u64, u64)>, CycleReport) {
    let toml = HARDWARE
        .replace("lanes = 1", &format!("lanes = {lanes}"))
        .replace("contexts = 1", &format!("contexts = {contexts}"))
        .replace("misses = 1", "misses = 3")
        .replace("drain_interval = 4", "drain_interval = 4\nown_port = true")
        + "[organisation]\ntile_levels = 1\n[outer_memory]\nbytes_per_cycle = 8\n";
    let hardware = Hardware::from_toml(&toml).unwrap();
    let mut nodes: Vec<Node> = does
        .into_iter()
        .map(|does| Node {
            does,
            children: Vec::new(),
        })
        .collect();
    let all = nodes.len() as u32;
    nodes[all as usize - 1].children = vec![(all, 0, ORIGIN)];
    nodes.push(Node {
        does: vec![Does::Read(Stage::Pop, Memory::Stack, 0)],
        children: Vec::new(),
    });
    let mut workload = Listed::new(&nodes, &hardware);
    workload.tiles = (0..all).collect();
    let mut recorder = Recorder::new(TraceLimit::default());
    let report = simulate(&hardware, &mut workload, &mut recorder).unwrap();
    assert!(report.cycles <= report.serial);
    let row = |visit: &VisitSpan| {
        let context = visit.lane * contexts + visit.context;
        (context, visit.stage, visit.begins, visit.ends)
    };
    let mut rows: Vec<_> = recorder.visits().iter().map(row).collect();
    rows.sort_by_key(|&(lane, _, begins, _)| (begins, lane));
    (rows, report)
}

fn node(address: u64) -> Does {
    Does::Read(Stage::OnePixel, Memory::Node, address)
}

#[test]
fn tiles_are_handed_out_and_a_cache_serves_who_came_first() {
    let pixel = Does::Write(Stage::Draw, Memory::Pixel, 0);
    let (found, report) = tiles(
        (3, 1),
        vec![vec![node(0)], vec![node(0)], vec![node(1)], vec![pixel]],
    );
    let by_hand = [
        // A tile a cycle, begun in the next. A miss: 1 to ask, 10 to wait, 1 to look at it.
        (0, Stage::OnePixel, 1, 13),
        // Asks in cycle 2, in which the cache looks at what it found, and in 3 it finds a line on its way.
        (1, Stage::OnePixel, 2, 13),
        // Asks in cycle 3, after the other, and is served in 5.
        (2, Stage::OnePixel, 3, 13),
        // All ask for a tile in cycle 13, and one is left.
        (0, Stage::Draw, 14, 15),
        // Its record lies on its own lane's stack; the others have nothing to do.
        (0, Stage::Pop, 15, 17),
    ];
    assert_eq!(found, by_hand);
    // The pixel was written in cycle 14 and leaves four later.
    assert_eq!(report.cycles, 18);
}

#[test]
fn a_line_that_comes_in_takes_the_cache() {
    let later = |cycles, address| vec![Does::Step(Stage::Centre, cycles), node(address)];
    // 16 bytes by a port of 8 a cycle: two cycles, the last before the access of cycle 1 is done, 10 and 11.
    for (waits, begins, ends) in [
        (7, 9, 11 + 2),
        (8, 10, 12 + 2),
        (9, 11, 12 + 2),
        (10, 12, 12 + 2),
    ] {
        let (found, _) = tiles((2, 1), vec![vec![node(0)], later(waits, 1)]);
        // What is looked up before finds the line on its way, and waits for it.
        assert_eq!(found[0], (0, Stage::OnePixel, 1, 13));
        assert!(
            found.contains(&(1, Stage::OnePixel, begins, ends)),
            "{waits}: {found:?}"
        );
    }
}

#[test]
fn of_two_misses_in_a_cycle_nodes_come_first_and_the_other_waits_for_the_port() {
    let attribute = vec![
        Does::Step(Stage::Centre, 1),
        Does::Read(Stage::Draw, Memory::Attribute, 0),
        Does::Read(Stage::Draw, Memory::Attribute, 0),
    ];
    let (found, _) = tiles((2, 1), vec![attribute, vec![node(0)]]);
    assert!(found.contains(&(1, Stage::OnePixel, 2, 14)), "{found:?}");
    // Its line sets out two cycles later, in 4, and is looked at in 15; then a hit.
    assert!(found.contains(&(0, Stage::Draw, 2, 18)), "{found:?}");
}

/// So many cycles of work, then a node.
fn works_and_reads(cycles: u32) -> Vec<Does> {
    vec![Does::Step(Stage::Centre, cycles), node(0)]
}

#[test]
fn a_context_that_waits_lets_another_have_the_lane() {
    let (found, report) = tiles((1, 2), vec![vec![node(0)], works_and_reads(3)]);
    let by_hand = [
        // Asks in cycle 1; what it reads is there in 12, but the lane is not free until 15: looked at in 16.
        (0, Stage::OnePixel, 1, 17),
        // Given its tile in cycle 1, in which the other asks; begins it in 2.
        (1, Stage::Centre, 2, 5),
        // The line is on its way, and nobody else wants the lane: looked at in 12.
        (1, Stage::OnePixel, 5, 13),
        (1, Stage::Pop, 13, 15),
    ];
    assert_eq!(found, by_hand);
    assert_eq!(report.cycles, 17);
    // The first waits 10 cycles for its line and then 4 for the lane; the second looks at it in 12, not in 6.
    let of = &report.stages[Stage::OnePixel as usize].stalls;
    assert_eq!((of.block_busy, of.cache_miss), (4, 10 + 6));
}

#[test]
fn who_wanted_a_lane_first_is_given_it_and_the_lowest_of_one_cycle() {
    let works = vec![Does::Step(Stage::Centre, 9)];
    let (found, report) = tiles((1, 3), vec![vec![node(0)], works_and_reads(2), works]);
    let by_hand = [
        // Both have what they asked for in cycle 12, and the third has the lane.
        (0, Stage::OnePixel, 1, 18),
        (1, Stage::Centre, 2, 4),
        (1, Stage::OnePixel, 4, 20),
        // Wanted the lane from cycle 2 on, and is given it in 4.
        (2, Stage::Centre, 5, 14),
        (2, Stage::Pop, 14, 16),
    ];
    assert_eq!(found, by_hand);
    assert_eq!(report.cycles, 20);
}

#[test]
fn contexts_of_a_sequential_lane_need_tiles() {
    let toml = HARDWARE.replace("contexts = 1", "contexts = 2");
    let error = Hardware::from_toml(&toml).unwrap_err().to_string();
    assert!(error.contains("contexts"), "{error}");
}
