//! A record on sequential hardware (rule 12 of `hwmodel::cycles`), its cycles worked out by hand.
#![allow(clippy::unwrap_used, reason = "tests")]

mod cycles_common;

use cycles_common::{Does, Listed, Node};
use hwmodel::cycles::{Hardware, ImageNode, Recorder, TraceLimit, VisitSpan, simulate};
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
