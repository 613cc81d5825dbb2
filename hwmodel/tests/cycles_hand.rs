//! A run of ten records worked out by hand from the rules in
//! `hwmodel::cycles`: every visit's cycles, every sum.
//!
//! ```text
//! start - A (cycle 1)      places in the order: B 0, C 1, D 2, E 4;
//!         |- B                                  F 0, G 3;  H 1, I 2, J 3
//!         |- C - F, G      classes: B | C D | E;  F | G;  H I J at once
//!         |- D - H, I, J
//!         `- E
//! ```
#![allow(clippy::unwrap_used, reason = "tests")]

mod cycles_common;

use cycles_common::{Does, Listed, Node};
use hwmodel::cycles::{
    Cause, ContextReport, Hardware, ImageNode, Recorder, START, TraceLimit, VisitSpan, simulate,
};
use hwmodel::{Memory, OpClass, Stage};

const HARDWARE: &str = r#"
name = "by hand"
clock_mhz = 1.0
lanes = 2
contexts = 2
independence = "classes"
steal_cycles = 3
wires = ["sub", "compare", "min_max", "select", "shift", "logic", "divide_step"]
[units]
add = { count = 2, latency = 1, interval = 1, width = 16 }
[stack]
entries = 2
ports = 1
latency = 1
overflow = "spill"
spill_cycles = 5
[node_cache] # two nodes a line, four sets of one line, one miss at a time
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
banks = 2
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

fn node(does: Vec<Does>, children: &[(u32, u8)]) -> Node {
    Node {
        does,
        children: children
            .iter()
            .map(|&(item, place)| (item, place, ORIGIN))
            .collect(),
    }
}

fn pop() -> Does {
    Does::Read(Stage::Pop, Memory::Stack, 0)
}

fn push() -> Does {
    Does::Write(Stage::Push, Memory::Stack, 0)
}

fn look_up(node: u64) -> Does {
    Does::Read(Stage::OnePixel, Memory::Node, node)
}

fn pixel() -> Does {
    Does::Write(Stage::Draw, Memory::Pixel, 0)
}

/// In the list: start 0, A 1, B 2, C 3, D 4, E 5, F 6, G 7, H 8, I 9, J 10.
fn records() -> Vec<Node> {
    let filled = |address| Does::Read(Stage::Filled, Memory::FillVector, address);
    let fill = |address| Does::Write(Stage::FillUpdate, Memory::FillVector, address);
    // Six adds of 17 bits on 16-bit adders: 12 passes on two adders.
    let adds = Does::Ops(Stage::Centre, OpClass::Add, 17, 6);
    vec![
        node(vec![push()], &[(1, 0)]),
        node(
            vec![pop(), adds, push(), push(), push(), push()],
            &[(2, 0), (3, 1), (4, 2), (5, 4)],
        ),
        node(vec![pop(), look_up(0), pixel()], &[]),
        node(
            vec![pop(), filled(0), filled(2), push(), push()],
            &[(6, 0), (7, 3)],
        ),
        node(
            vec![pop(), filled(2), push(), push(), push()],
            &[(8, 1), (9, 2), (10, 3)],
        ),
        node(vec![pop(), look_up(0), pixel()], &[]),
        node(vec![pop(), fill(1), fill(3)], &[]),
        node(vec![pop(), look_up(2)], &[]),
        node(vec![pop(), look_up(1)], &[]),
        node(vec![pop(), look_up(8)], &[]),
        node(vec![pop(), pixel(), pixel()], &[]),
    ]
}

/// Record (in the order of turns), lane, context, stage, arrives, begins,
/// frees, ends, stall.
type Row = (u64, u32, u32, Stage, [u64; 4], Option<(Cause, u64)>);

const BY_HAND: [Row; 26] = [
    (START, 0, 0, Stage::Push, [0, 0, 1, 1], None),
    // A. 12 passes on two units: 6 cycles, and a latency of 1.
    (0, 0, 0, Stage::Pop, [1, 1, 2, 2], None),
    (0, 0, 0, Stage::Centre, [2, 2, 8, 9], None),
    // Four writes through one port.
    (
        0,
        0,
        0,
        Stage::Push,
        [9, 9, 13, 13],
        Some((Cause::MemoryPort, 3)),
    ),
    // Four records for two entries: B and C are spilled. B is read back: 5 cycles.
    (1, 0, 0, Stage::Pop, [13, 13, 14, 19], None),
    (
        1,
        0,
        0,
        Stage::OnePixel,
        [19, 19, 20, 30],
        Some((Cause::CacheMiss, 10)),
    ),
    (1, 0, 0, Stage::Draw, [30, 30, 31, 31], None),
    // B is finished: C (spilled) goes on in its context, D in the other one.
    (2, 0, 0, Stage::Pop, [31, 31, 32, 37], None),
    (3, 0, 1, Stage::Pop, [31, 32, 33, 33], None),
    (3, 0, 1, Stage::Filled, [33, 33, 34, 34], None),
    (
        3,
        0,
        1,
        Stage::Push,
        [34, 34, 37, 37],
        Some((Cause::MemoryPort, 2)),
    ),
    // Two reads of bank 0.
    (
        2,
        0,
        0,
        Stage::Filled,
        [37, 37, 39, 39],
        Some((Cause::BankConflict, 1)),
    ),
    // D's children: H and I are spilled beside E and J. H stays; J, the
    // oldest, and I are stolen by lane 1, through the port of lane 0's stack.
    (4, 0, 1, Stage::Pop, [37, 37, 38, 43], None),
    (
        5,
        1,
        0,
        Stage::Pop,
        [37, 37, 39, 42],
        Some((Cause::MemoryPort, 1)),
    ),
    (
        2,
        0,
        0,
        Stage::Push,
        [39, 39, 41, 41],
        Some((Cause::MemoryPort, 1)),
    ),
    (
        6,
        1,
        1,
        Stage::Pop,
        [37, 39, 42, 50],
        Some((Cause::MemoryPort, 2)),
    ),
    // C's children: F is spilled; its pop comes after I's on the port.
    (
        7,
        0,
        0,
        Stage::Pop,
        [41, 41, 43, 48],
        Some((Cause::MemoryPort, 1)),
    ),
    // J's second pixel waits in 43 for the first, which leaves in 46.
    (
        5,
        1,
        0,
        Stage::Draw,
        [42, 42, 47, 47],
        Some((Cause::PixelPort, 4)),
    ),
    // H finds its line: B brought it. No record is ready: idle.
    (4, 0, 1, Stage::OnePixel, [43, 43, 44, 44], None),
    (
        7,
        0,
        0,
        Stage::FillUpdate,
        [48, 48, 50, 50],
        Some((Cause::BankConflict, 1)),
    ),
    // Line 4 takes the place of line 0.
    (
        6,
        1,
        1,
        Stage::OnePixel,
        [50, 50, 51, 61],
        Some((Cause::CacheMiss, 10)),
    ),
    // F is finished: G. Its miss waits until I's is over, in 61.
    (8, 0, 0, Stage::Pop, [50, 50, 51, 51], None),
    (
        8,
        0,
        0,
        Stage::OnePixel,
        [51, 51, 62, 72],
        Some((Cause::CacheMiss, 20)),
    ),
    // G, so C is finished; D was in 61: E. Its line is gone.
    (9, 0, 0, Stage::Pop, [72, 72, 73, 73], None),
    (
        9,
        0,
        0,
        Stage::OnePixel,
        [73, 73, 74, 84],
        Some((Cause::CacheMiss, 10)),
    ),
    (9, 0, 0, Stage::Draw, [84, 84, 85, 85], None),
];

#[test]
fn a_run_worked_by_hand() {
    let hardware = Hardware::from_toml(HARDWARE).unwrap();
    let nodes = records();
    let mut workload = Listed::new(&nodes, &hardware);
    let mut recorder = Recorder::new(TraceLimit::default());
    let report = simulate(&hardware, &mut workload, &mut recorder).unwrap();
    // A, B, C, D, H, J, I, F, G, E.
    assert_eq!(workload.turns, [1, 2, 3, 4, 8, 10, 9, 6, 7, 5]);

    let row = |visit: &VisitSpan| {
        let times = [visit.arrives, visit.begins, visit.frees, visit.ends];
        let VisitSpan {
            record,
            lane,
            context,
            stage,
            stall,
            ..
        } = *visit;
        (record, lane, context, stage, times, stall)
    };
    let found: Vec<Row> = recorder.visits().iter().map(row).collect();
    for (found, expected) in found.iter().zip(&BY_HAND) {
        assert_eq!(found, expected);
    }
    assert_eq!(found.len(), BY_HAND.len());

    // E's pixel leaves in 88.
    assert_eq!(report.cycles, 88);
    assert_eq!((report.records, report.pixels), (10, 4));
    // Start 1, A 9; three each: B, C, D, E; two each: F to J.
    assert_eq!(report.work, 32);
    // Start 1, A 10, B 13, C 16, F 18, G 20, E 23.
    assert_eq!(report.span, 23);
    assert_eq!(
        report.context_cycles,
        ContextReport {
            working: 32,
            stalled: 100,
            // From 13 to 72: 3 idle for 18 cycles, 2 for 6, 1 for 3, 2 for 14, 3 for 11.
            order_wait: 130,
            // 3 idle for 13 cycles, 3 for 13, all four for the last 3.
            no_record: 90,
        }
    );
    let all = |cause| -> u64 {
        report
            .stages
            .iter()
            .map(|stage| stage.stalls.of(cause))
            .sum()
    };
    let causes: Vec<u64> = Cause::ALL.into_iter().map(all).collect();
    // Block: D 1, I 2. Port: A 3, C 1, D 2, F 1, I 2, J 1. Banks: C 1, F 1.
    // Misses: B, E, I 10, G 20. Pixels: J 4. Spilled: B, C, F, H, I. Stolen: I, J.
    assert_eq!(causes, [3, 10, 2, 50, 4, 25, 6]);
    assert_eq!((report.stack.spilled, report.stack.stolen), (5, 2));
    assert_eq!(report.stack.deepest, 4);
    // In 41: F, H, I, J at work, E and G on the stack; A, C, D open.
    assert_eq!((report.stack.most_live, report.stack.most_open), (6, 3));
    let node = report.node_cache;
    assert_eq!((node.accesses, node.misses, node.bytes_in), (5, 4, 64));
    let centre = &report.stages[Stage::Centre as usize];
    assert_eq!((centre.operations, centre.passes, centre.busy), (6, 12, 6));
}
