//! The record loop (image-order paper, 3.1 to 3.6).

use crate::machine::stages::RecordStage;
use hwmodel::{Datapath, Memory, Probe};

use super::blocks::Port;
use super::cage::CageCoordinate;
use super::decide::decide;
use super::limit::Limit;
use super::state::{State, Traversal};
use super::watch::{Event, Watch};
use crate::frame::QuadNode;
use crate::project::EngineError;

impl<P: Probe, L: CageCoordinate, W: Watch> State<'_, P, L, W> {
    /// Draws the object in a tile, with children on the stack. Returns whether the limit was not reached. Fails when a
    /// word overflows under the trap policy, or when the drawing is stopped.
    pub(super) fn draw_object(
        &mut self,
        tile: QuadNode,
        limit: &mut Limit,
    ) -> Result<bool, EngineError> {
        self.push_object(tile);
        while !self.traversal.stack.is_empty() {
            if limit.is_reached(self.canvas.counts.records)? {
                return Ok(false);
            }
            self.turn();
            check_trap(&self.dp)?;
        }
        check_trap(&self.dp)?;
        Ok(true)
    }

    /// Pops the top record and draws or drops it, or pushes its children.
    pub(super) fn turn(&mut self) {
        let (dp, job, canvas) = (&mut self.dp, &self.job, &mut self.canvas);
        let Traversal { stack, watch } = &mut self.traversal;
        // The record is processed in place: most have no children to push, and only the others are copied.
        let address = stack.len().wrapping_sub(1) as u64;
        let Some(record) = stack.last_mut() else {
            unreachable!("a turn is a record's, and the stack is empty");
        };
        let quad = record.place.quad;
        dp.begin_record(canvas.counts.records, record.cube.level);
        canvas.fill.begin_turn();
        canvas.counts.records += 1;
        watch.see(Event::<L>::Turn(quad));
        dp.stage(RecordStage::Pop);
        dp.read(Memory::Stack, address);
        Port::Pop.tap(dp, address, record);

        let needs_children = if canvas.fill.is_full(dp, quad) {
            canvas.counts.already_full += 1;
            false
        } else {
            decide(dp, job, canvas, record)
        };
        let parent = needs_children.then_some(*record);
        stack.truncate(address as usize);
        if let Some(parent) = parent {
            self.traversal.subdivide(dp, job, canvas, &parent);
        }
    }
}

pub(super) fn check_trap<P: Probe>(dp: &Datapath<P>) -> Result<(), EngineError> {
    dp.trap().map_or(Ok(()), |trap| Err(trap.into()))
}
