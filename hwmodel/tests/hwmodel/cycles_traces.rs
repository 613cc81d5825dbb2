//! Trace events of a simulation: valid JSON, one event per visit and wait.
use std::collections::BTreeMap;

use crate::cycles_common::{Does, Listed, Node};
use hwmodel::cycles::{Hardware, ImageNode, Recorder, START, simulate};
use hwmodel::{Memory, OpClass, Stage};

/// Three generations of eight children on two lanes of three contexts.
fn recorded(records: u64) -> (Hardware, Recorder) {
    let mut hardware = Hardware::preset("wide").unwrap();
    (hardware.lanes, hardware.contexts) = (2, 3);
    let does = vec![
        Does::Read(Stage::Pop, Memory::Stack, 0),
        Does::Read(Stage::OnePixel, Memory::Node, 0),
        Does::Ops(Stage::VertexPool, OpClass::Add, 32, 40),
        Does::Write(Stage::Push, Memory::Stack, 0),
    ];
    let child = |(item, place)| (item, place, ImageNode::default());
    let mut nodes = vec![Node::default()];
    nodes[0].children.push(child((1, 0)));
    for at in 1..=73u32 {
        let first = (at - 1) * 8 + 2;
        let children = (first..first + 8).zip(0u8..).filter(|_| at <= 9);
        nodes.push(Node {
            does: does.clone(),
            children: children.map(child).collect(),
        });
    }
    let mut workload = Listed::new(&nodes, &hardware);
    let mut recorder = Recorder::new(records);
    simulate(&hardware, &mut workload, &mut recorder).unwrap();
    (hardware, recorder)
}

#[test]
fn trace_events_are_json_and_complete() {
    let (hardware, recorder) = recorded(u64::MAX);
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
    let visits = recorder.visits();
    assert_eq!((visits.len(), of("stage")), (4 * 73, 4 * 73));
    let waits = visits
        .iter()
        .filter(|visit| visit.begins > visit.arrives)
        .count();
    assert_eq!(of("wait"), waits);
    assert!(waits > 0 && events.iter().any(|event| event["ph"] == "C"));
    // Each visit follows its wait, and on one thread nothing overlaps.
    let mut last: BTreeMap<(u64, u64), u64> = BTreeMap::new();
    let spans = events.iter().filter(|event| event["ph"] == "X");
    let mut spans: Vec<_> = spans
        .map(|event| ["ts", "dur", "pid", "tid"].map(|key| event[key].as_u64().unwrap()))
        .collect();
    let times: u64 = visits.iter().map(|visit| visit.ends - visit.arrives).sum();
    assert_eq!(spans.iter().map(|span| span[1]).sum::<u64>(), times);
    spans.sort_unstable();
    for [ts, dur, pid, tid] in spans {
        let end = last.entry((pid, tid)).or_default();
        assert!(ts >= *end);
        *end = ts + dur;
    }
}

#[test]
fn a_recorder_keeps_the_first_records() {
    let (_, recorder) = recorded(5);
    let last = recorder.visits().iter().map(|visit| visit.record);
    assert_eq!(last.filter(|&record| record != START).max(), Some(4));
}
