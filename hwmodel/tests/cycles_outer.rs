//! The port to outer memory, worked out by hand: spilled records and lines of
//! caches take turns at it.
#![allow(clippy::unwrap_used, reason = "tests")]

mod cycles_common;

use cycles_common::{Does, Listed, Node};
use hwmodel::cycles::{CycleReport, Hardware, ImageNode, NoObserver, simulate};
use hwmodel::memory::RecordBits;
use hwmodel::{Memory, Stage};

/// One lane, one context, one entry of the stack; 4 bytes a cycle.
fn hardware() -> Hardware {
    let mut hardware = Hardware::preset("tiny").unwrap();
    (hardware.lanes, hardware.contexts) = (1, 1);
    hardware.stack.entries = 1;
    hardware.stack.ports = 1;
    hardware.stack.latency = 1;
    hardware.stack.spill_cycles = 5;
    hardware.stack.record = RecordBits::uniform(128);
    hardware.outer_memory.bytes_per_cycle = 4;
    hardware.node_cache.hit_latency = 1;
    hardware.node_cache.miss_latency = 10;
    hardware.node_cache.line_bytes = 16;
    hardware
}

fn node(does: Vec<Does>, children: &[u32]) -> Node {
    let child = |(place, &item): (u8, &u32)| (item, place, ImageNode::default());
    Node {
        does,
        children: (0u8..).zip(children).map(child).collect(),
    }
}

fn run(nodes: &[Node], hardware: &Hardware) -> CycleReport {
    let mut workload = Listed::new(nodes, hardware);
    simulate(hardware, &mut workload, &mut NoObserver).unwrap()
}

const POP: Does = Does::Read(Stage::Pop, Memory::Stack, 0);
const PUSH: Does = Does::Write(Stage::Push, Memory::Stack, 0);

/// The start pushes A until cycle 1. A pops until 2, pushes B and C until 4: B
/// finds no entry.
fn family() -> Vec<Node> {
    vec![
        node(vec![PUSH], &[1]),
        node(vec![POP, PUSH, PUSH], &[2, 3]),
        node(vec![POP], &[]),
        node(vec![POP], &[]),
    ]
}

#[test]
fn a_spilled_record_takes_the_port_twice() {
    let report = run(&family(), &hardware());
    // B is written from 4 to 8, and its reading back, asked for at 4, takes
    // the port from 8 to 12. So its pop, from 4 to 5, ends 4 + 4 + 5 cycles later.
    // C pops from 18 to 19.
    assert_eq!(report.cycles, 19);
    assert_eq!(report.stages[Stage::Pop as usize].stalls.stack_spill, 13);
    assert_eq!((report.stack.spilled, report.stack.spilled_bits), (1, 128));
    assert_eq!(report.outer_busy, 8);
    let port = report
        .bounds
        .iter()
        .find(|b| b.resource == "outer memory port");
    assert_eq!(port.unwrap().cycles, 8);
}

#[test]
fn records_of_no_bits_or_a_port_of_any_width_cost_their_latency_alone() {
    let mut free = hardware();
    free.outer_memory.bytes_per_cycle = 0;
    let report = run(&family(), &free);
    // B pops from 4 to 5 and 5 cycles more, C from 10 to 11.
    assert_eq!((report.cycles, report.outer_busy), (11, 0));
    assert_eq!(report.stack.spilled_bits, 128);
    let mut empty = hardware();
    empty.stack.record = RecordBits::default();
    assert_eq!(run(&family(), &empty).cycles, 11);
}

#[test]
fn a_line_waits_for_a_spilled_record() {
    let mut nodes = family();
    // C misses: nothing is before it at the port by then. B misses too, when
    // its own bits have come.
    nodes[2]
        .does
        .push(Does::Read(Stage::OnePixel, Memory::Node, 0));
    let report = run(&nodes, &hardware());
    // B pops until 18; its line is asked for at 18, there at 18 + 1 + 10. C pops from 29.
    assert_eq!(report.cycles, 30);
    assert_eq!(report.outer_busy, 8 + 4);
    // A line that takes longer than the memory's latency: 16 bytes, one a cycle, 16 cycles.
    let mut narrow = hardware();
    narrow.outer_memory.bytes_per_cycle = 1;
    let report = run(&nodes, &narrow);
    // B: from 4 to 5, and 16 of waiting, 16 of its own, 5; then 1 + 16 of its line.
    assert_eq!(report.cycles, 5 + 16 + 16 + 5 + 17 + 1);
}

#[test]
fn pixels_share_words_of_the_port() {
    let pixel = Does::Write(Stage::Draw, Memory::Pixel, 0);
    let mut nodes = family();
    // C draws four pixels of 24 bits: three words of 32.
    nodes[3].does.extend(vec![pixel; 4]);
    nodes[3]
        .does
        .push(Does::Read(Stage::Blend, Memory::Node, 0));
    let mut hardware = hardware();
    (hardware.pixels.buffer, hardware.pixels.drain_interval) = (16, 1);
    hardware.pixels.write_ports = 4;
    let report = run(&nodes, &hardware);
    // C pops from 18 to 19 and draws in cycle 19: the second, third and fourth pixel complete a
    // word each, so they take the port from 19 to 22. Its line is asked for at 20, waits until 22,
    // and is there at 22 + 1 + 10.
    assert_eq!(report.outer_busy, 8 + 3 + 4);
    assert_eq!(report.cycles, 33);
    // By a port that takes a byte a cycle, the last of twelve bytes leaves in cycle 31.
    nodes[3].does.pop();
    hardware.outer_memory.bytes_per_cycle = 1;
    hardware.stack.record = RecordBits::default();
    let report = run(&nodes, &hardware);
    // C pops from 10 to 11, draws in 11.
    assert_eq!((report.outer_busy, report.cycles), (12, 23));
}
