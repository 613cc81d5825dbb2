//! The traces can be read, and say what the simulation said.
use std::collections::BTreeMap;

use crate::cycles_common::{Does, Listed, Node};
use hwmodel::cycles::{Hardware, ImageNode, Recorder, START, TraceLimit, VisitSpan, simulate};
use hwmodel::{Memory, OpClass, Stage};

/// Three generations of eight children.
fn records() -> Vec<Node> {
    let does = vec![
        Does::Read(Stage::Pop, Memory::Stack, 0),
        Does::Read(Stage::OnePixel, Memory::Node, 0),
        Does::Ops(Stage::VertexPool, OpClass::Add, 32, 40),
        Does::Write(Stage::Push, Memory::Stack, 0),
    ];
    let mut nodes = vec![Node::default()];
    nodes[0].children.push((1, 0, ImageNode::default()));
    for at in 1..=73u32 {
        let children = if at <= 9 {
            (at - 1) * 8 + 2..at * 8 + 2
        } else {
            0..0
        };
        nodes.push(Node {
            does: does.clone(),
            children: children
                .zip(0u8..)
                .map(|(item, place)| (item, place, ImageNode::default()))
                .collect(),
        });
    }
    nodes
}

fn recorded(limit: TraceLimit) -> (Hardware, Recorder) {
    let mut hardware = Hardware::preset("wide").unwrap();
    (hardware.lanes, hardware.contexts) = (2, 3);
    let nodes = records();
    let mut workload = Listed::new(&nodes, &hardware);
    let mut recorder = Recorder::new(limit);
    simulate(&hardware, &mut workload, &mut recorder).unwrap();
    (hardware, recorder)
}

/// A dump, read as IEEE 1364 has it: width and values by time of every wire, by path.
#[derive(Default)]
struct Dump(BTreeMap<String, (u32, Vec<(u64, u64)>)>);

impl Dump {
    fn read(text: &str) -> Self {
        let (declared, values) = text.split_once("$enddefinitions $end").unwrap();
        assert!(declared.contains("$timescale 1 ns $end"));
        let (mut scopes, mut by_id) = (Vec::new(), BTreeMap::new());
        let mut dump = Self::default();
        for declaration in declared.split("$end").map(str::trim) {
            let words: Vec<&str> = declaration.split_whitespace().collect();
            match words[..] {
                ["$scope", "module", name] => scopes.push(name),
                ["$upscope"] => drop(scopes.pop().unwrap()),
                ["$var", "wire", bits, id, name] => {
                    assert!(id.bytes().all(|byte| (33..=126).contains(&byte)));
                    let path = format!("{}.{name}", scopes.join("."));
                    assert!(by_id.insert(id, path.clone()).is_none(), "{id} twice");
                    dump.0.insert(path, (bits.parse().unwrap(), Vec::new()));
                }
                _ => assert!(matches!(
                    words.first(),
                    None | Some(&"$comment" | &"$timescale")
                )),
            }
        }
        assert!(scopes.is_empty());
        let mut now = 0;
        let mut tokens = values.split_whitespace();
        while let Some(token) = tokens.next() {
            let (first, rest) = token.split_at(1);
            let (value, id) = match first {
                "$" => continue,
                "#" => {
                    let time = rest.parse().unwrap();
                    assert!(time > now || now == 0, "time goes on");
                    now = time;
                    continue;
                }
                "b" => (
                    u64::from_str_radix(rest, 2).unwrap(),
                    tokens.next().unwrap(),
                ),
                _ => (first.parse().unwrap(), rest),
            };
            let (bits, values) = dump.0.get_mut(&by_id[id]).unwrap();
            assert!(
                *bits == 64 || value >> *bits == 0,
                "{id}: {value} in {bits} bits"
            );
            values.push((now, value));
        }
        dump
    }

    /// A wire's value at a time.
    fn at(&self, path: &str, time: u64) -> u64 {
        let values = self.0[path].1.iter();
        values.take_while(|(t, _)| *t <= time).last().unwrap().1
    }
}

#[test]
fn the_dump_says_what_the_visits_say() {
    let (hardware, recorder) = recorded(TraceLimit::default());
    let mut text = Vec::new();
    recorder.write_vcd(&hardware, &mut text).unwrap();
    let dump = Dump::read(&String::from_utf8(text).unwrap());
    assert_eq!(dump.0.len(), 2 * (2 + Stage::ALL.len() + 3 * 3));
    assert!(recorder.visits().len() == 4 * 73);
    let mut waits = 0;
    for visit in recorder.visits() {
        let VisitSpan {
            lane,
            context,
            arrives,
            begins,
            frees,
            ends,
            ..
        } = *visit;
        let wire = |name: &str| format!("hardware.lane{lane}.{name}");
        for time in [arrives, begins, ends - 1] {
            let stage = dump.at(&wire(&format!("context{context}_stage")), time);
            assert_eq!(stage, visit.stage as u64);
            let record = dump.at(&wire(&format!("context{context}_record")), time);
            assert_eq!(record, visit.record);
            let waiting = dump.at(&wire(&format!("context{context}_waits")), time);
            assert_eq!(waiting == 1, time < begins);
            waits += waiting;
        }
        let issues = wire(&format!(
            "issues_{}",
            visit.stage.name().replace(' ', "_").replace('?', "")
        ));
        assert_eq!(dump.at(&issues, begins), 1);
        assert_eq!(dump.at(&issues, frees - 1), 1);
    }
    assert!(waits > 0, "nothing waited");
    // At the end all is idle and the stacks are empty.
    let end = recorder
        .visits()
        .iter()
        .map(|visit| visit.ends)
        .max()
        .unwrap();
    for (path, (bits, _)) in &dump.0 {
        let rest = if *bits == 4 { 15 } else { 0 };
        assert!(*bits == 64 || dump.at(path, end) == rest, "{path}");
    }
}

#[test]
fn trace_events_are_json_and_complete() {
    let (hardware, recorder) = recorded(TraceLimit::default());
    let mut text = Vec::new();
    recorder.write_chrome(&hardware, &mut text).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&text).unwrap();
    let events = json["traceEvents"].as_array().unwrap();
    let of = |category: &str| {
        events
            .iter()
            .filter(|event| event["cat"] == category)
            .count()
    };
    assert_eq!(of("stage"), recorder.visits().len());
    let waited = recorder
        .visits()
        .iter()
        .filter(|visit| visit.begins > visit.arrives);
    assert_eq!(of("wait"), waited.count());
    // On one thread nothing overlaps.
    let mut last: BTreeMap<(u64, u64), u64> = BTreeMap::new();
    let mut spans: Vec<_> = events
        .iter()
        .filter(|event| event["ph"] == "X")
        .map(|event| ["ts", "dur", "pid", "tid"].map(|key| event[key].as_u64().unwrap()))
        .collect();
    spans.sort_unstable();
    for [ts, dur, pid, tid] in spans {
        let end = last.entry((pid, tid)).or_default();
        assert!(ts >= *end);
        *end = ts + dur;
    }
    assert!(events.iter().any(|event| event["ph"] == "C"));
}

#[test]
fn a_limit_keeps_the_first_records_or_a_window() {
    let visits = |records: u64, cycles: std::ops::Range<u64>| {
        let (_, recorder) = recorded(TraceLimit { records, cycles });
        recorder.visits().to_vec()
    };
    let first = visits(5, TraceLimit::default().cycles);
    assert!(
        first
            .iter()
            .all(|visit| visit.record < 5 || visit.record == START)
    );
    assert!(first.iter().any(|visit| visit.record == 4));
    let window = visits(u64::MAX, 100..150);
    assert!(!window.is_empty());
    assert!(
        window
            .iter()
            .all(|visit| (100..150).contains(&visit.begins))
    );
}
