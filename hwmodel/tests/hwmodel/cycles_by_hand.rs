//! Runs worked out by hand: `cycles_by_hand.txt` says how to read it.
use std::collections::BTreeMap;

use crate::common::*;
use hwmodel::cycles::{Child, Hardware, ImageNode, START, VisitSpan, simulate};
use hwmodel::{Memory, OpClass, Probe};
use serde_json::Value;
use toml::Table;

/// One adder width, memories of one port, two nodes per line, four sets of one line, one miss at a time.
const HARDWARE: &str = r#"
name = "by hand"
clock_mhz = 1.0
lanes = 1
contexts = 1
independence = "none"
steal_cycles = 0
wires = ["sub", "compare", "min_max", "select", "shift", "logic", "divide_step"]
units = { add = { count = 2, latency = 1, interval = 1, width = 16 } }
stack = { entries = 4, ports = 1, latency = 1, overflow = "error", spill_cycles = 0 }
fill_vectors = { banks = 1, read_ports = 1, write_ports = 1, latency = 1 }
pixels = { write_ports = 1, buffer = 1, drain_interval = 4 }
"#;
const CACHE: &str = "{ bytes = 64, ways = 1, line_bytes = 16, entry_bytes = 8, ports = 1, hit_latency = 1, \
                     miss_latency = 10, misses = 1 }";

fn overlay(onto: &mut Table, table: Table) {
    for (key, value) in table {
        match (onto.get_mut(&key), value) {
            (Some(toml::Value::Table(onto)), toml::Value::Table(table)) => overlay(onto, table),
            (_, value) => drop(onto.insert(key, value)),
        }
    }
}

fn act_of(word: &str) -> Act {
    let digits = word.find(|c: char| c.is_ascii_digit());
    let (kind, number) = word.split_at(digits.unwrap_or(word.len()));
    let numbers: Vec<u32> = number.split('x').flat_map(str::parse).collect();
    let address = numbers.first().copied().unwrap_or(0);
    let read = |memory, stage| act(move |log| log.read(memory, address.into(), at(stage, 0)));
    let write = |memory, stage| act(move |log| log.write(memory, address.into(), at(stage, 0)));
    let add = |stage, bits, times| act(move |log| log.op(OpClass::Add, bits, at(stage, 0), times));
    match kind {
        "pop" => read(Memory::Stack, RecordStage::Pop),
        "push" => write(Memory::Stack, RecordStage::Push),
        "node" => read(Memory::Node, RecordStage::OnePixel),
        "blend" => read(Memory::Node, RecordStage::Blend),
        "attribute" => read(Memory::Attribute, RecordStage::Draw),
        "filled" => read(Memory::FillVector, RecordStage::Filled),
        "fill" => write(Memory::FillVector, RecordStage::FillUpdate),
        "pixel" => write(Memory::Pixel, RecordStage::Draw),
        "step" => act(move |log| log.next_step(address, at(RecordStage::Centre, 0))),
        "order" => add(RecordStage::Order, 16, 1),
        "add" => add(RecordStage::Centre, numbers[0], numbers[1]),
        "beside" => act(|log| {
            log.beside(true);
            log.op(OpClass::Add, 16, at(RecordStage::Order, 0), 1);
            log.beside(false);
        }),
        _ => panic!("{word}"),
    }
}

/// Records with their names, from lines `name: what it does -> child and place ...`.
fn records<'t>(lines: &[&'t str]) -> (Vec<&'t str>, Vec<Node>) {
    let parts = lines.iter().map(|line| line.split_once(": ").unwrap());
    let (names, works): (Vec<_>, Vec<_>) = parts.unzip();
    let child = |word: &str| {
        let item = names.iter().position(|name| *name == &word[..1]);
        Child {
            item: item.unwrap() as u32,
            place: word[1..].parse().unwrap(),
            image_node: ImageNode::default(),
        }
    };
    let node = |work: &str| {
        let (acts, children) = work.split_once(" -> ").unwrap_or((work, ""));
        Node {
            acts: acts.split_whitespace().map(act_of).collect(),
            children: children.split_whitespace().map(child).collect(),
        }
    };
    let nodes = works.into_iter().map(node).collect();
    (names, nodes)
}

/// A list as an object whose keys are a field of its elements.
fn keyed(list: &Value, field: &str) -> Value {
    let entry = |of: &Value| (of[field].as_str().unwrap().to_owned(), of.clone());
    list.as_array().unwrap().iter().map(entry).collect()
}

fn check(name: &str, hardware: &Table, sections: &BTreeMap<&str, Vec<&str>>) {
    let hardware = Hardware::from_toml(&hardware.to_string()).unwrap();
    let tiles = sections.get("tiles");
    let (names, nodes) = records(tiles.unwrap_or_else(|| &sections["records"]));
    let mut workload = Listed::new(&nodes, &hardware);
    workload.tiles = tiles.map_or(0, |records| records.len() as u32 - 1);
    let mut visits: Vec<VisitSpan> = Vec::new();
    let report = simulate(&hardware, &mut workload, &mut visits).unwrap();
    assert!(report.cycles <= report.serial);
    let row = |visit: &VisitSpan| {
        let record = match workload.turns.get(visit.record as usize) {
            _ if visit.record == START && tiles.is_none() => "start",
            Some(&item) => names[item as usize],
            None => "tile",
        };
        let VisitSpan {
            lane,
            context,
            stage,
            arrives,
            begins,
            frees,
            ends,
            stall,
            ..
        } = visit;
        let stall = stall.map_or_else(String::new, |(cause, cycles)| {
            format!(" {cause:?} {cycles}")
        });
        format!("{record} {lane}.{context} {stage:?} {arrives} {begins} {frees} {ends}{stall}")
    };
    let found: Vec<String> = visits.iter().map(row).collect();
    let mut left: Vec<&str> = found.iter().map(String::as_str).collect();
    let exact = sections.get("visits");
    for expected in exact.or(sections.get("some visits")).into_iter().flatten() {
        // With `_`, a stall may be left out.
        let is_like = |found: &&str| {
            let mut pairs = expected.split(' ').zip(found.split(' '));
            pairs.all(|(e, f)| e == "_" || e == f)
                && (expected.contains('_') || expected.len() == found.len())
        };
        let at = left.iter().position(is_like);
        left.remove(at.unwrap_or_else(|| panic!("{name}: no visit {expected}: {found:#?}")));
    }
    assert!(exact.is_none() || left.is_empty(), "{name}: more: {left:?}");
    let mut json = serde_json::to_value(&report).unwrap();
    json["stages"] = keyed(&json["stages"], "stage");
    json["bounds"] = keyed(&json["bounds"], "resource");
    for line in sections.get("report").into_iter().flatten() {
        let (path, expected) = line.rsplit_once(' ').unwrap();
        let found = json.pointer(path).map(Value::to_string);
        assert_eq!(found.as_deref(), Some(expected), "{name}: {path}");
    }
}

#[test]
fn runs_worked_by_hand() {
    let mut known: BTreeMap<&str, (Table, BTreeMap<&str, Vec<&str>>)> = BTreeMap::new();
    for case in include_str!("cycles_by_hand.txt").split("\n=== ").skip(1) {
        let is_kept = |line: &&str| !line.starts_with('#') && !line.is_empty();
        let lines: Vec<&str> = case.lines().filter(is_kept).collect();
        let mut parts = lines[1..].split(|line| line.starts_with("--- "));
        let titles = lines.iter().filter_map(|line| line.strip_prefix("--- "));
        let mut settings = parts.next().unwrap();
        let hardware = format!("{HARDWARE}node_cache = {CACHE}\nattribute_cache = {CACHE}");
        let (mut table, mut sections) = (hardware.parse().unwrap(), BTreeMap::new());
        if let Some(name) = settings.first().and_then(|line| line.strip_prefix("like ")) {
            (table, sections) = known[name].clone();
            settings = &settings[1..];
        }
        // The records of the other case, unless there are others.
        sections.retain(|title, _| ["records", "tiles"].contains(title));
        overlay(&mut table, settings.join("\n").parse().unwrap());
        sections.extend(titles.zip(parts.map(<[&str]>::to_vec)));
        check(lines[0], &table, &sections);
        known.insert(lines[0], (table, sections));
    }
    assert!(known.len() > 20);
}
