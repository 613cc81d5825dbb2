//! Whole turns, replayed: the stack and fill vectors return what was written, nodes are the graph's, and the pixels are
//! the picture.

use std::collections::BTreeMap;

use serde_json::Value;
use shiftvox::frame::{Frame, NO_NODE};
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::project::{CageKind, Coverage, Engine, FrameSetup};

use super::rows::{Ports, lines, manifest_of};
use super::{options, scenes, written};
use crate::common::{setup, times};

#[derive(Default)]
struct Memories {
    stack: Vec<String>,
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
    /// Whether an event of a port fits the events before it.
    fn cross(&mut self, event: &Value, graph: &Graph, setup: &FrameSetup) -> bool {
        let (place, text) = (
            event["address"].as_u64().unwrap(),
            event["data"].as_str().unwrap(),
        );
        let (address, place) = (i128::from(place), place as usize);
        // Records are longer than a number.
        let data = i128::from_str_radix(text, 16).unwrap_or(-1);
        let empty = || empty_vector(setup, address);
        match port_of(event) {
            "push" => {
                self.stack.push(text.to_owned());
                self.stack.len() == place + 1
            }
            "pop" => {
                self.turns += 1;
                let top = self.stack.pop();
                self.stack.len() == place && top.as_deref() == Some(text)
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

fn port_of(event: &Value) -> &str {
    event["port"].as_str().unwrap()
}

/// The first event that does not fit the events before it, and the state of the memories then.
fn replay<'e>(
    events: impl IntoIterator<Item = &'e Value>,
    (graph, setup): (&Graph, &FrameSetup),
) -> (Option<String>, Memories) {
    let mut memories = Memories::default();
    for event in events {
        if !memories.cross(event, graph, setup) {
            return (Some(event.to_string()), memories);
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
            let turns = &manifest_of(&folder)["turns"];
            let events = lines(&folder, &turns["file"]);
            let of = (&graph, &setup);
            let (wrong, memories) = replay(&events, of);
            let at = format!("{name}, {coverage:?}, {cage:?}");
            assert_eq!(wrong, None, "{at}");
            assert_eq!(Some(events.len() as u64), turns["events"].as_u64(), "{at}");
            assert_eq!(Some(memories.turns), turns["turns"].as_u64(), "{at}");
            assert!(memories.stack.is_empty(), "{at}");
            let mut frame = Frame::new(setup.width, setup.height, false);
            let mut machine = Machine::default();
            machine.render(&graph.view(), &setup, &mut frame).unwrap();
            let drawn = (0i128..).zip(&frame.node);
            let drawn = drawn.filter(|(_, node)| **node != NO_NODE);
            let drawn: BTreeMap<_, _> = drawn.map(|(at, &node)| (at, node.into())).collect();
            assert!(memories.pixels == drawn && !drawn.is_empty(), "{at}");
            // The first record is the whole object.
            let first = events
                .iter()
                .find(|event| port_of(event) == "push")
                .unwrap();
            let first = Ports::new(&turns["record"]).row(first["data"].as_str().unwrap());
            let of_root = (first.get("level"), first.get("node"));
            assert_eq!(of_root, (0, graph.root.into()));
            // The loss of any single pop, push, write or pixel is detected.
            for lost in (0..events.len()).step_by(events.len().div_ceil(8 * times() as usize)) {
                let port = port_of(&events[lost]);
                if port.ends_with("_read") {
                    continue;
                }
                let rest = events[..lost].iter().chain(&events[lost + 1..]);
                let (wrong, memories) = replay(rest, of);
                let is_found = wrong.is_some()
                    || memories.pixels != drawn
                    || Some(memories.turns) != turns["turns"].as_u64();
                // Nobody reads the vector that is written last.
                assert!(is_found || port == "fill_write", "{at}: {lost}");
            }
        }
    }
}
