//! Figures of the hardware model, computed again without the model. The tables are read as plain
//! TOML, a probe of this file counts the machine's events, and the rest is arithmetic.

use std::collections::BTreeMap;

use hwmodel::cycles::{Hardware, NoObserver};
use hwmodel::{Memory, OpClass, Overflow, Probe, StageLevel};
use shiftvox::frame::Frame;
use shiftvox::machine::Machine;
use shiftvox::project::{FrameSetup, SetupOptions};
use shiftvox_lab::model::cost::{self, Prices};
use shiftvox_lab::model::{area, frame};

use crate::scenes::*;

#[derive(Default)]
struct Log {
    /// Times of operations by class and bits.
    operations: BTreeMap<(OpClass, u32), u64>,
    /// Addresses that are read, in order.
    reads: BTreeMap<Memory, Vec<u64>>,
    pixels: u64,
}

impl Probe for Log {
    fn op(&mut self, class: OpClass, bits: u32, _: StageLevel, times: u32) {
        *self.operations.entry((class, bits)).or_default() += u64::from(times);
    }

    fn read(&mut self, memory: Memory, address: u64, _: StageLevel) {
        self.reads.entry(memory).or_default().push(address);
    }

    fn write(&mut self, memory: Memory, _: u64, _: StageLevel) {
        self.pixels += u64::from(memory == Memory::Pixel);
    }
}

/// A cache as in a textbook: sets of lines, the one that was used last at the end.
fn naive_misses(addresses: &[u64], entry: u64, (bytes, ways, line): (u64, usize, u64)) -> u64 {
    let mut sets = vec![Vec::<u64>::new(); (bytes / (ways as u64 * line)) as usize];
    let mut misses = 0;
    for address in addresses {
        let number = address * entry / line;
        let at = number as usize % sets.len();
        let set = &mut sets[at];
        let before = set.len();
        set.retain(|held| *held != number);
        if set.len() == before {
            misses += 1;
            set.drain(..(before + 1).saturating_sub(ways));
        }
        set.push(number);
    }
    misses
}

/// A figure of a table for an operation and a width: its low and high ends, as the file has them.
fn row(table: &str, operation: &str, width: i64, figure: &str) -> [f64; 2] {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../hwmodel/tables");
    let text = std::fs::read_to_string(format!("{path}/{table}.toml")).unwrap();
    let table: toml::Table = text.parse().unwrap();
    let mut rows = table["row"].as_array().unwrap().iter();
    let found = rows.find(|row| {
        let is = |key: &str, value: toml::Value| row.get(key).is_none_or(|of| *of == value);
        is("operation", operation.into()) && is("width", width.into()) && is("goal", "area".into())
    });
    match &found.unwrap()[figure] {
        toml::Value::Array(ends) => [0, 1].map(|end| ends[end].as_float().unwrap()),
        value => [value.as_float().unwrap(); 2],
    }
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-9 * a.abs().max(b.abs()), "{a} {b}");
}

/// Of a design with one context. Its units and memories have sizes of the tables.
#[test]
fn figures_of_a_terrain() {
    let graph = graph_of("gen:terrain,depth=6");
    let camera = camera_at(CameraPlace::Outside, &graph, (64, 64), &mut Dice::new(11));
    let options = SetupOptions {
        bits: 32,
        ..SetupOptions::default()
    };
    let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options).unwrap();
    let mut hardware = Hardware::preset("tiny").unwrap();
    let adders = hardware.units.get_mut(&OpClass::Add).unwrap();
    (adders.count, adders.latency, adders.interval, adders.width) = (3, 0, 1, 32);
    (hardware.node_cache.bytes, hardware.node_cache.ways) = (1024, 2);
    hardware.stack.entries = 8;
    let prices = Prices::shipped().unwrap();
    let view = graph.view();
    let counted = frame::count(&graph, &setup, hardware.organisation, Overflow::Trap).unwrap();
    let simulated =
        frame::simulate(&view, &setup, &hardware, Overflow::Trap, &mut NoObserver).unwrap();
    let cycles = &simulated.1.cycles;
    let widths = frame::widths(&setup, &graph, &hardware);
    let cost = cost::frame_cost(&counted, cycles, &widths, &setup, &hardware, &prices).unwrap();
    let area = area::light(&counted, cycles, &setup, &hardware, &prices).unwrap();
    let mut frame = Frame::new(setup.width, setup.height, false);
    let drawn = Machine::default().render_probed(&view, &setup, &mut frame, Log::default());
    let log = drawn.unwrap().1;

    // 1. Energy of the additions of 32 bits.
    let mut lines = cost.operations.lines.iter();
    let line = lines.find(|line| (line.name.as_str(), line.width) == ("add", 32));
    let [low, high] = row("energy", "add", 32, "energy_pj");
    assert_eq!(low, high);
    let additions = log.operations[&(OpClass::Add, 32)] as f64;
    close(line.unwrap().total, additions * low);

    // 2. Area of the three adders that find a child's span.
    let mut lines = area.units.lines.iter();
    let line = lines.find(|line| line.name == "child box" && line.operation == "add");
    close(
        line.unwrap().total,
        3.0 * row("area", "add", 32, "nand2")[0],
    );

    // 3. Misses of both caches.
    let node_misses = naive_misses(&log.reads[&Memory::Node], 8, (1024, 2, 32));
    let of = hardware.attribute_cache;
    let line_bytes = u64::from(of.line_bytes);
    let shape = (u64::from(of.bytes), of.ways as usize, line_bytes);
    let read = &log.reads[&Memory::Attribute];
    let attribute_misses = naive_misses(read, u64::from(of.entry_bytes), shape);
    assert_eq!(cycles.node_cache.misses, node_misses);
    assert_eq!(cycles.attribute_cache.misses, attribute_misses);

    // 4. Bits of a record: node, level, two flags, two corners, then the quadtree's level and place. Four numbers of three
    // coordinates, the least W and twelve plane coefficients follow.
    let bits_of = |greatest: u64| 64 - greatest.leading_zeros();
    let always = bits_of(graph.len() as u64 - 1) + bits_of(6) + 2 + 2 * 3 * bits_of(64);
    let bits = always + bits_of(6) + 2 * 6 + 3 * 4 * 32 + 32 + 12 * 64;
    assert_eq!(counted.record_bits(), bits);

    // 5. Bits to and from outer memory: lines, pixels of three bytes, spilled records both ways.
    assert!(cycles.stack.spilled > 0);
    let moved = 8 * (32 * node_misses + line_bytes * attribute_misses)
        + 24 * log.pixels
        + 2 * cycles.stack.spilled_bits;
    assert_eq!(cost.traffic.bits(), moved);

    // 6. Their energy, in words of 64 bits.
    let words = 4 * node_misses
        + line_bytes / 8 * attribute_misses
        + (24 * log.pixels).div_ceil(64)
        + 2 * cycles.stack.spilled_bits.div_ceil(64);
    let [low, high] = row("energy", "dram_read", 64, "energy_pj");
    close(cost.outer.total, words as f64 * f64::midpoint(low, high));
}
