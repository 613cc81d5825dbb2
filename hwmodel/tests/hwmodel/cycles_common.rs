//! A workload that does what a list says, for tests of the cycle model.

use std::convert::Infallible;

use hwmodel::cycles::{Child, Hardware, ImageNode, TurnLog, Workload};
use hwmodel::{Memory, OpClass, Probe, Stage, StageLevel};

#[derive(Debug, Clone)]
pub(crate) enum Does {
    /// So many operations of a class and width.
    Ops(Stage, OpClass, u32, u32),
    /// The same, done beside the stage in which the turn is.
    Beside(Stage, OpClass, u32, u32),
    Read(Stage, Memory, u64),
    Write(Stage, Memory, u64),
    /// The next step needs this one, after so many cycles.
    Step(Stage, u32),
}

/// A record: its acts, and record, place and region of each child.
#[derive(Debug, Clone, Default)]
pub(crate) struct Node {
    pub does: Vec<Does>,
    pub children: Vec<(u32, u8, ImageNode)>,
}

/// Record 0 of the list is the workload's start.
pub(crate) struct Listed<'a> {
    nodes: &'a [Node],
    log: TurnLog,
    /// Items in the order of their turns.
    pub turns: Vec<u32>,
    /// The record that is each tile's start.
    pub tiles: Vec<u32>,
}

impl<'a> Listed<'a> {
    pub(crate) fn new(nodes: &'a [Node], hardware: &Hardware) -> Self {
        Self {
            nodes,
            log: TurnLog::new(hardware),
            turns: Vec::new(),
            tiles: Vec::new(),
        }
    }

    fn does(&mut self, item: u32, children: &mut Vec<Child>) {
        let node = &self.nodes[item as usize];
        for does in &node.does {
            let at = |stage| StageLevel { stage, level: 0 };
            match *does {
                Does::Ops(stage, class, bits, times) => self.log.op(class, bits, at(stage), times),
                Does::Beside(stage, class, bits, times) => {
                    self.log.beside(true);
                    self.log.op(class, bits, at(stage), times);
                    self.log.beside(false);
                }
                Does::Read(stage, memory, address) => self.log.read(memory, address, at(stage)),
                Does::Write(stage, memory, address) => self.log.write(memory, address, at(stage)),
                Does::Step(stage, idle) => self.log.next_step(idle, at(stage)),
            }
        }
        let child = |&(item, place, image_node): &(u32, u8, ImageNode)| Child {
            item,
            place,
            image_node,
        };
        children.extend(node.children.iter().map(child));
    }
}

impl Workload for Listed<'_> {
    type Error = Infallible;

    fn start(&mut self, children: &mut Vec<Child>) -> Result<(), Infallible> {
        self.does(0, children);
        Ok(())
    }

    fn tiles(&self) -> u32 {
        self.tiles.len() as u32
    }

    fn begin_tile(&mut self, tile: u32, children: &mut Vec<Child>) -> Result<(), Infallible> {
        self.does(self.tiles[tile as usize], children);
        Ok(())
    }

    fn turn(&mut self, item: u32, children: &mut Vec<Child>) -> Result<(), Infallible> {
        assert!(children.is_empty());
        self.turns.push(item);
        self.does(item, children);
        Ok(())
    }

    fn log(&mut self) -> &mut TurnLog {
        &mut self.log
    }
}
