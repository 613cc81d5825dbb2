//! Runs worked out by hand: `cycles_by_hand.txt` says how to read it.
use std::collections::BTreeMap;

use crate::cycles_common::{Does, Listed, Node};
use hwmodel::cycles::{Hardware, ImageNode, Recorder, START, VisitSpan, simulate};
use hwmodel::{Memory, OpClass, Stage};
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

fn hardware() -> Table {
    let caches = format!("node_cache = {CACHE}\nattribute_cache = {CACHE}");
    format!("{HARDWARE}{caches}").parse().unwrap()
}

fn overlay(onto: &mut Table, table: Table) {
    for (key, value) in table {
        match (onto.get_mut(&key), value) {
            (Some(toml::Value::Table(onto)), toml::Value::Table(table)) => overlay(onto, table),
            (_, value) => drop(onto.insert(key, value)),
        }
    }
}

fn does(word: &str) -> Does {
    let end = word
        .find(|c: char| c.is_ascii_digit())
        .unwrap_or(word.len());
    let (kind, number) = word.split_at(end);
    let address = number.parse().unwrap_or(0);
    let adds = |stage| Does::Ops(stage, OpClass::Add, 16, 1);
    match kind {
        "pop" => Does::Read(Stage::Pop, Memory::Stack, 0),
        "push" => Does::Write(Stage::Push, Memory::Stack, 0),
        "node" => Does::Read(Stage::OnePixel, Memory::Node, address),
        "blend" => Does::Read(Stage::Blend, Memory::Node, address),
        "attribute" => Does::Read(Stage::Draw, Memory::Attribute, address),
        "filled" => Does::Read(Stage::Filled, Memory::FillVector, address),
        "fill" => Does::Write(Stage::FillUpdate, Memory::FillVector, address),
        "pixel" => Does::Write(Stage::Draw, Memory::Pixel, 0),
        "step" => Does::Step(Stage::Centre, address as u32),
        "order" => adds(Stage::Order),
        "beside" => Does::Beside(Stage::Order, OpClass::Add, 16, 1),
        "add" => {
            let (bits, times) = number.split_once('x').unwrap();
            let [bits, times] = [bits, times].map(|number| number.parse().unwrap());
            Does::Ops(Stage::Centre, OpClass::Add, bits, times)
        }
        _ => panic!("{word}"),
    }
}

/// Records with their names, from lines `name: what it does -> child and place ...`.
fn records<'t>(lines: &[&'t str]) -> (Vec<&'t str>, Vec<Node>) {
    let parts = lines.iter().map(|line| line.split_once(": ").unwrap());
    let parts: Vec<_> = parts.collect();
    let names: Vec<&str> = parts.iter().map(|(name, _)| *name).collect();
    let node = |(_, rest): &(&str, &str)| {
        let (work, children) = rest.split_once(" -> ").unwrap_or((rest, ""));
        let child = |word: &str| {
            let (name, place) = word.split_at(1);
            let item = names.iter().position(|other| *other == name).unwrap();
            (item as u32, place.parse().unwrap(), ImageNode::default())
        };
        Node {
            does: work.split_whitespace().map(does).collect(),
            children: children.split_whitespace().map(child).collect(),
        }
    };
    let nodes = parts.iter().map(node).collect();
    (names, nodes)
}

/// A figure of a report: a pointer that names elements of lists by their stage or resource, or a sum over all stages.
fn figure(report: &Value, path: &str) -> Value {
    if let Some(cause) = path.strip_prefix("stalls/") {
        let stages = report["stages"].as_array().unwrap().iter();
        let of_stage = |stage: &Value| stage["stalls"][cause].as_u64().unwrap();
        return stages.map(of_stage).sum::<u64>().into();
    }
    let mut value = report;
    for key in path.split('/').skip(1) {
        let stage = Stage::ALL
            .iter()
            .position(|stage| format!("{stage:?}") == key);
        value = match (value, stage) {
            (Value::Array(list), Some(at)) => &list[at],
            (Value::Array(list), None) => list.iter().find(|of| of["resource"] == key).unwrap(),
            (value, _) => &value[key],
        };
    }
    value.clone()
}

fn check(name: &str, hardware: Table, sections: &BTreeMap<&str, Vec<&str>>) {
    let hardware: Hardware = Hardware::from_toml(&hardware.to_string()).unwrap();
    let tiles = sections.get("tiles");
    let (names, nodes) = records(tiles.unwrap_or_else(|| &sections["records"]));
    let mut workload = Listed::new(&nodes, &hardware);
    if tiles.is_some() {
        workload.tiles = (0..nodes.len() as u32 - 1).collect();
    }
    let mut recorder = Recorder::new(u64::MAX);
    let report = simulate(&hardware, &mut workload, &mut recorder).unwrap();
    assert!(report.cycles <= report.serial);
    let row = |visit: &VisitSpan| {
        let of_turn = workload.turns.get(visit.record as usize);
        let record = match of_turn {
            _ if visit.record == START && tiles.is_none() => "start",
            Some(&item) => names[item as usize],
            None => "tile",
        };
        let times = [visit.arrives, visit.begins, visit.frees, visit.ends];
        let mut words = vec![
            record.to_owned(),
            format!("{}.{}", visit.lane, visit.context),
        ];
        words.push(format!("{:?}", visit.stage));
        words.extend(times.map(|time| time.to_string()));
        let stall = visit
            .stall
            .map(|(cause, cycles)| format!("{cause:?} {cycles}"));
        words.extend(stall);
        words.join(" ")
    };
    let found: Vec<String> = recorder.visits().iter().map(row).collect();
    let mut left: Vec<&str> = found.iter().map(String::as_str).collect();
    let exact = sections.get("visits");
    for expected in exact.or(sections.get("some visits")).into_iter().flatten() {
        // With `_`, a stall may be left out.
        let is_like = |found: &str| {
            let mut pairs = expected.split(' ').zip(found.split(' '));
            pairs.all(|(e, f)| e == "_" || e == f)
                && (expected.contains('_') || expected.len() == found.len())
        };
        let at = left.iter().position(|found| is_like(found));
        left.remove(at.unwrap_or_else(|| panic!("{name}: no visit {expected}: {found:#?}")));
    }
    assert!(
        exact.is_none() || left.is_empty(),
        "{name}: more visits: {left:?}"
    );
    let json = serde_json::to_value(&report).unwrap();
    for line in sections.get("report").into_iter().flatten() {
        let (path, expected) = line.rsplit_once(' ').unwrap();
        assert_eq!(figure(&json, path).to_string(), expected, "{name}: {path}");
    }
}

#[test]
fn runs_worked_by_hand() {
    let text = include_str!("cycles_by_hand.txt");
    let mut known: BTreeMap<&str, (Table, BTreeMap<&str, Vec<&str>>)> = BTreeMap::new();
    for case in text.split("\n=== ").skip(1) {
        let is_kept = |line: &&str| !line.starts_with('#') && !line.is_empty();
        let lines: Vec<&str> = case.lines().filter(is_kept).collect();
        let mut parts = lines[1..].split(|line| line.starts_with("--- "));
        let titles = lines.iter().filter_map(|line| line.strip_prefix("--- "));
        let settings = parts.next().unwrap();
        let like = settings.first().and_then(|line| line.strip_prefix("like "));
        let (mut table, mut sections) = match like {
            Some(name) => known[name].clone(),
            None => (hardware(), BTreeMap::new()),
        };
        // The records of the other case, unless there are others.
        sections.retain(|title, _| ["records", "tiles"].contains(title));
        let own = usize::from(like.is_some());
        overlay(&mut table, settings[own..].join("\n").parse().unwrap());
        sections.extend(titles.zip(parts.map(<[&str]>::to_vec)));
        check(lines[0], table.clone(), &sections);
        known.insert(lines[0], (table, sections));
    }
    assert!(known.len() > 20);
}
