//! Places, formats, and a workload that does what a list says.

use std::convert::Infallible;
use std::rc::Rc;

use hwmodel::cycles::{Child, Hardware, TurnLog, Workload};
use hwmodel::{Format, Stage, StageLevel};

hwmodel::stages! {
    pub(crate) enum RecordStage {
        Pop = "pop",
        Filled = "filled?",
        ToScreen = "to screen",
        OnePixel = "one pixel?",
        Centre = "centre",
        Order = "order",
        VertexPool = "vertex pool",
        ChildBox = "child box",
        QuadtreeFit = "quadtree fit",
        Push = "push",
        Draw = "draw",
        Blend = "blend",
        FillUpdate = "fill update",
    }
}

pub(crate) fn at(stage: impl Into<Stage>, level: u32) -> StageLevel {
    let stage = stage.into();
    StageLevel { stage, level }
}

pub(crate) fn format(bits: u32) -> Format {
    Format::new(bits, bits / 4).expect("a width within 16..=64")
}

pub(crate) type Act = Rc<dyn Fn(&mut TurnLog)>;

pub(crate) fn act(does: impl Fn(&mut TurnLog) + 'static) -> Act {
    Rc::new(does)
}

/// A record: its operations and accesses, and its children.
#[derive(Clone, Default)]
pub(crate) struct Node {
    pub acts: Vec<Act>,
    pub children: Vec<Child>,
}

/// Record 0 of the list is the workload's start.
pub(crate) struct Listed<'a> {
    nodes: &'a [Node],
    log: TurnLog,
    /// Items in the order of their turns.
    pub turns: Vec<u32>,
    /// Number of tiles; record `n` is the start of tile `n`.
    pub tiles: u32,
}

impl<'a> Listed<'a> {
    pub(crate) fn new(nodes: &'a [Node], hardware: &Hardware) -> Self {
        Self {
            nodes,
            log: TurnLog::new(hardware),
            turns: Vec::new(),
            tiles: 0,
        }
    }
}

impl Workload for Listed<'_> {
    type Error = Infallible;

    fn start(&mut self, children: &mut Vec<Child>) -> Result<(), Infallible> {
        self.begin_tile(0, children)
    }

    fn tiles(&self) -> u32 {
        self.tiles
    }

    fn begin_tile(&mut self, tile: u32, children: &mut Vec<Child>) -> Result<(), Infallible> {
        let node = &self.nodes[tile as usize];
        node.acts.iter().for_each(|act| act(&mut self.log));
        children.extend(&node.children);
        Ok(())
    }

    fn turn(&mut self, item: u32, children: &mut Vec<Child>) -> Result<(), Infallible> {
        assert!(children.is_empty());
        self.turns.push(item);
        self.begin_tile(item, children)
    }

    fn log(&mut self) -> &mut TurnLog {
        &mut self.log
    }
}
