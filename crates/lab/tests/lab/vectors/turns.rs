//! Whole turns, replayed: stack and fill vectors are what was written to them, nodes are the graph's, and what
//! is drawn is the picture.

use std::collections::BTreeMap;
use std::fs;

use serde_json::Value;
use shiftvox::frame::{Frame, NO_NODE};
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::project::{CageKind, Coverage, Engine, FrameSetup};

use super::rows::{Row, read};
use super::{options, scenes, written};
use crate::common::{setup, times};

/// The memories, as the ports show them.
#[derive(Default)]
struct Memories {
    /// Rows of records.
    stack: Vec<usize>,
    pushed: usize,
    turns: u64,
    fill: BTreeMap<i128, i128>,
    pixels: BTreeMap<i128, i128>,
}

/// A quadtree node's vector before anything is drawn: quadrants beside the picture are full.
fn empty_vector(setup: &FrameSetup, address: i128) -> i128 {
    let (mut level, mut first) = (0, 0i128);
    while address >= first + (1 << (2 * level)) {
        first += 1 << (2 * level);
        level += 1;
    }
    let at = address - first;
    let (x, y) = (at % (1 << level), at >> level);
    let size = [setup.width, setup.height].map(i128::from);
    let is_beside = |x: i128, y: i128, below: u32| x << below >= size[0] || y << below >= size[1];
    let Some(below) = (setup.levels - level).checked_sub(1) else {
        return if is_beside(x, y, 0) { 15 } else { 0 };
    };
    let is_full = |q: i128| is_beside(2 * x + (q & 1), 2 * y + (q >> 1), below);
    (0..4).map(|q| i128::from(is_full(q)) << q).sum()
}

impl Memories {
    /// Something crosses a port; whether it fits what crossed before.
    fn cross(&mut self, port: &str, event: &Row, graph: &Graph, setup: &FrameSetup) -> bool {
        let (address, data) = (event.get("address"), event.get("data"));
        let place = address as usize;
        let empty = || empty_vector(setup, address);
        match port {
            "push" => {
                self.stack.push(data as usize);
                self.pushed += 1;
                (self.stack.len(), self.pushed) == (place + 1, data as usize + 1)
            }
            "pop" => {
                self.turns += 1;
                let top = self.stack.pop();
                self.stack.len() == place && top == Some(data as usize)
            }
            "fill_read" => data == *self.fill.entry(address).or_insert_with(empty),
            "fill_write" => {
                let before = self.fill.insert(address, data).unwrap_or_else(empty);
                before & data == before
            }
            "node_read" => {
                let (view, node) = (graph.view(), place as u32);
                data == i128::from(view.mask(node)) << 32 | i128::from(view.first(node))
            }
            "attribute_read" => data == 0,
            "pixel_write" => self.pixels.insert(address, data).is_none(),
            _ => false,
        }
    }
}

/// The first event that does not fit those before it, and what they make of the memories.
fn replay<'e>(
    names: &[&str],
    events: impl IntoIterator<Item = &'e Row>,
    (graph, setup): (&Graph, &FrameSetup),
) -> (Option<String>, Memories) {
    let mut memories = Memories::default();
    for event in events {
        let port = names[event.get("port") as usize];
        if !memories.cross(port, event, graph, setup) {
            return (Some(format!("{port}, {:?}", event.values)), memories);
        }
    }
    (None, memories)
}

const FRAMES: [(Coverage, CageKind); 4] = [
    (Coverage::Exact, CageKind::Frame),
    (Coverage::Exact, CageKind::Corners),
    (Coverage::Center, CageKind::Frame),
    (Coverage::Any, CageKind::Corners),
];

#[test]
fn turns_follow_from_one_another_and_make_the_picture() {
    for (number, (name, graph, camera)) in scenes().into_iter().enumerate() {
        // Each scene under one rule after another; at length under all.
        let rules = FRAMES.iter().cycle().skip(number);
        for &(coverage, cage) in rules.take(FRAMES.len().min(times() as usize)) {
            let setup = setup(&graph, &camera, &options(coverage, cage, 0.125, 32));
            let (_shelter, folder, _) = written(&graph.view(), &setup, u64::MAX);
            let text = fs::read_to_string(folder.join("manifest.json")).unwrap();
            let manifest: Value = serde_json::from_str(&text).unwrap();
            let turns = &manifest["turns"];
            let names = turns["ports"].as_array().unwrap().iter();
            let names: Vec<&str> = names.map(|port| port["name"].as_str().unwrap()).collect();
            let events = read(&folder, &turns["events"]);
            let records = read(&folder, &turns["records"]);
            let of = (&graph, &setup);
            let (wrong, memories) = replay(&names, &events, of);
            let at = format!("{name}, {coverage:?}, {cage:?}");
            assert_eq!(wrong, None, "{at}");
            assert_eq!(memories.pushed, records.len(), "{at}");
            assert_eq!(Some(memories.turns), turns["turns"].as_u64(), "{at}");
            assert!(memories.stack.is_empty(), "{at}");
            let mut frame = Frame::new(setup.width, setup.height, false);
            let mut machine = Machine::default();
            machine.render(&graph.view(), &setup, &mut frame).unwrap();
            let drawn = (0i128..).zip(&frame.node);
            let drawn = drawn.filter(|(_, node)| **node != NO_NODE);
            let drawn: BTreeMap<_, _> = drawn.map(|(at, &node)| (at, node.into())).collect();
            assert!(memories.pixels == drawn && !drawn.is_empty(), "{at}");
            // A record's own numbers: the first is the whole object.
            let first = &records[0];
            assert_eq!(
                (first.get("level"), first.get("node")),
                (0, graph.root.into())
            );
            // Without any one pop, push, write or pixel it is all found to be wrong.
            for lost in (0..events.len()).step_by(events.len().div_ceil(8 * times() as usize)) {
                if ["fill_read", "node_read", "attribute_read"]
                    .contains(&names[events[lost].get("port") as usize])
                {
                    continue;
                }
                let rest = events[..lost].iter().chain(&events[lost + 1..]);
                let (wrong, memories) = replay(&names, rest, of);
                let is_found = wrong.is_some()
                    || memories.pixels != drawn
                    || Some(memories.turns) != turns["turns"].as_u64();
                // A vector written last is read by nobody.
                let is_last = names[events[lost].get("port") as usize] == "fill_write";
                assert!(is_found || is_last, "{at}: {lost}");
            }
        }
    }
}
