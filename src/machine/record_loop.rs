//! The record loop (image-order paper, 3.1 to 3.6): see the machine's page.

use hwmodel::{Memory, Probe, Stage};

use super::blocks::Port;
use super::cage::CageCoordinate;
use super::decide::RemainingWork;
use super::record::Record;
use super::state::State;
use super::watch::Watch;
use crate::frame::QuadNode;
use crate::project::EngineError;

impl<P: Probe, L: CageCoordinate, W: Watch> State<'_, P, L, W> {
    /// Draws the object in a tile, with children on the stack, in at most `most_records`
    /// turns. Returns whether that was enough.
    ///
    /// # Errors
    /// When a word overflows under the trap policy.
    pub(super) fn draw_object(
        &mut self,
        tile: QuadNode,
        most_records: u64,
    ) -> Result<bool, EngineError> {
        self.push_object(tile);
        while !self.stack.is_empty() {
            if self.counts.records >= most_records {
                return Ok(false);
            }
            self.turn();
            self.check_trap()?;
        }
        self.check_trap()?;
        Ok(true)
    }

    pub(super) fn check_trap(&self) -> Result<(), EngineError> {
        match self.dp.trap() {
            Some(trap) => Err(trap.into()),
            None => Ok(()),
        }
    }

    /// Takes the top record off the stack and does all that is to be done with
    /// it; its children are on the stack afterwards.
    pub(super) fn turn(&mut self) {
        // The stack is moved out of `self`, so that a record is worked on where
        // it lies: most have no children to push, and only the others are copied.
        let mut stack = std::mem::take(&mut self.stack);
        let Some(address) = stack.len().checked_sub(1) else {
            unreachable!("a turn is a record's, and the stack is empty");
        };
        let left = self.draw_or_drop(&mut stack[address], address as u64);
        let record = match left {
            RemainingWork::Nothing => None,
            RemainingWork::Children => Some(stack[address]),
        };
        stack.truncate(address);
        self.stack = stack;
        if let Some(parent) = record {
            self.subdivide(&parent);
        }
    }

    /// Draws a record or drops it, unless its children are needed to decide what
    /// is seen of it. `address`: the record's, on the stack.
    #[inline(always)]
    fn draw_or_drop(&mut self, record: &mut Record<L>, address: u64) -> RemainingWork {
        self.dp.begin_record(self.counts.records, record.cube.level);
        self.canvas.fill.begin_turn();
        self.counts.records += 1;
        self.watch.turn(record.place.quad);
        self.dp.stage(Stage::Pop);
        self.dp.read(Memory::Stack, address);
        Port::Pop.tap(&mut self.dp, address, record);

        if self.is_full(record.place.quad) {
            self.counts.already_full += 1;
            return RemainingWork::Nothing;
        }
        self.decide(record)
    }
}
