//! Whole turns, replayed: the stack and fill vectors return what was written, nodes are the graph's, and the pixels are
//! the picture.

use std::collections::BTreeMap;

use serde_json::Value;
use shiftvox::frame::NO_NODE;
use shiftvox::graph::Graph;
use shiftvox::project::{CageKind, Coverage, FrameSetup};

use super::rows::{Ports, lines, manifest_of};
use super::{options, scenes, written};
use crate::common::{draw, setup, times};

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
        let place = event["address"].as_u64().unwrap();
        let text = event["data"].as_str().unwrap();
        let (address, place) = (i128::from(place), place as usize);
        // Records are longer than a number.
        let data = i128::from_str_radix(text, 16).unwrap_or(-1);
        let empty = || empty_vector(setup, address);
        match event["port"].as_str().unwrap() {
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

const FRAMES: [(Coverage, CageKind); 4] = [
    (Coverage::Exact, CageKind::Frame),
    (Coverage::Exact, CageKind::Corners),
    (Coverage::Center, CageKind::Frame),
    (Coverage::Any, CageKind::Corners),
];

#[test]
fn turns_follow_from_one_another_and_make_the_picture() {
    for (number, (graph, camera)) in scenes().into_iter().enumerate() {
        // Each scene under another rule. In long runs all scenes under all rules.
        let rules = FRAMES.iter().cycle().skip(number);
        for &(coverage, cage) in rules.take(FRAMES.len().min(times() as usize)) {
            let setup = setup(&graph, &camera, &options(coverage, cage, 0.125, 32));
            let (_shelter, folder, _) = written(&graph.view(), &setup, u64::MAX);
            let turns = &manifest_of(&folder)["turns"];
            let events = lines(&folder, &turns["file"]);
            let at = format!("scene {number}, {coverage:?}, {cage:?}");
            let mut memories = Memories::default();
            for event in &events {
                assert!(memories.cross(event, &graph, &setup), "{at}: {event}");
            }
            assert_eq!(turns["events"], events.len(), "{at}");
            assert_eq!(turns["turns"], memories.turns, "{at}");
            assert!(memories.stack.is_empty(), "{at}");
            let (frame, _) = draw(&graph, &setup);
            let drawn = (0i128..)
                .zip(&frame.node)
                .filter(|(_, node)| **node != NO_NODE);
            let drawn: BTreeMap<_, _> = drawn.map(|(at, &node)| (at, node.into())).collect();
            assert!(memories.pixels == drawn && !drawn.is_empty(), "{at}");
            // The first record is the whole object.
            let first = events.iter().find(|event| event["port"] == "push").unwrap();
            let first = Ports::new(&turns["record"]).row(first["data"].as_str().unwrap());
            let of_root = (first.get("level"), first.get("node"));
            assert_eq!(of_root, (0, graph.root.into()));
        }
    }
}
