//! The machine one turn at a time, in an order that a scheduler chooses.
//!
//! The records that a turn leaves go to the scheduler and not onto a stack,
//! each with its place in the occlusion order and its image node. Fill vectors
//! are shared: a turn finds them as the turns before it left them.

use hwmodel::cycles::{
    self, Child, CycleReport, Hardware, HardwareError, Observer, Region, TurnLog,
};
use hwmodel::{Datapath, NoProbe, Overflow, Trap, Word};
use serde::Serialize;

use super::lattice::Lattice;
use super::record::Record;
use super::walk::Walk;
use crate::project::{EngineError, Stats};

/// What a simulated frame came to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Simulated {
    /// Cycles and what they were spent on.
    pub cycles: CycleReport,
    /// What the machine counts of any frame, but for the stack's depth.
    pub counts: Stats,
}

/// Why a simulation ended early.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulateError {
    /// The machine could not finish the frame.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The hardware is none.
    #[error(transparent)]
    Hardware(#[from] HardwareError),
    /// A stack without room, on hardware that does not spill.
    #[error(
        "record {record} leaves more records than the {entries} entries of lane {lane}'s \
         stack hold; give it more, or set overflow = \"spill\""
    )]
    StackOverflow {
        /// The record, in the order of turns, from 0.
        record: u64,
        /// The lane.
        lane: u32,
        /// Entries of its stack.
        entries: u32,
    },
}

impl From<cycles::SimulationError<Trap>> for SimulateError {
    fn from(error: cycles::SimulationError<Trap>) -> Self {
        match error {
            cycles::SimulationError::Workload(trap) => Self::Engine(trap.into()),
            cycles::SimulationError::Hardware(error) => Self::Hardware(error),
            cycles::SimulationError::StackOverflow {
                record,
                lane,
                entries,
            } => Self::StackOverflow {
                record,
                lane,
                entries,
            },
        }
    }
}

/// The machine as a workload of the cycle model.
pub(super) struct Steps<'a, L> {
    walk: Walk<'a, TurnLog, L>,
    /// Records that wait for their turn.
    waiting: Vec<Record<L>>,
    free: Vec<u32>,
    /// Which child is which, found again for the scheduler: no probe sees it.
    wires: Datapath<NoProbe>,
}

impl<'a, L: Lattice> Steps<'a, L> {
    pub(super) fn new(walk: Walk<'a, TurnLog, L>) -> Self {
        let wires = Datapath::new(walk.dp.format(), Overflow::Wrap, NoProbe);
        Self {
            walk,
            waiting: Vec::new(),
            free: Vec::new(),
            wires,
        }
    }

    /// The frame, simulated.
    pub(super) fn run<O: Observer>(
        mut self,
        hardware: &Hardware,
        observer: &mut O,
    ) -> Result<Simulated, SimulateError> {
        let cycles = cycles::simulate(hardware, &mut self, observer)?;
        let (mut counts, _) = self.walk.finish();
        counts.retain(|(name, _)| *name != "deepest_stack");
        Ok(Simulated { cycles, counts })
    }

    /// Hands the records over that a turn left: the nearest was pushed last.
    fn hand_over(&mut self, parent_min: [Word; 3], children: &mut Vec<Child>) {
        let mut octant = None;
        while let Some(record) = self.walk.stack.pop() {
            let upper: [bool; 3] = std::array::from_fn(|k| record.min[k] != parent_min[k]);
            let octant = *octant.get_or_insert_with(|| {
                // As the turn found it; any child has the centre at one end.
                (0..3).fold(0u8, |bits, k| {
                    let centre = if upper[k] {
                        record.min[k]
                    } else {
                        record.max[k]
                    };
                    let eye = self.walk.constants.eye_floor[k];
                    bits << 1 | u8::from(self.wires.lt(eye, centre))
                })
            });
            let child = upper
                .iter()
                .fold(0u8, |bits, &bit| bits << 1 | u8::from(bit));
            let order = &self.walk.options.order;
            let place = order.iter().position(|&nearest| octant ^ nearest == child);
            let region = Region {
                level: record.quad.level,
                x: record.quad.x,
                y: record.quad.y,
            };
            let item = if let Some(at) = self.free.pop() {
                self.waiting[at as usize] = record;
                at
            } else {
                self.waiting.push(record);
                (self.waiting.len() - 1) as u32
            };
            children.push(Child {
                item,
                // An order array has every octant.
                place: place.unwrap_or(0) as u8,
                region,
            });
        }
    }

    fn trap(&self) -> Result<(), Trap> {
        self.walk.dp.trap().map_or(Ok(()), Err)
    }
}

impl<L: Lattice> cycles::Workload for Steps<'_, L> {
    type Error = Trap;

    fn start(&mut self, children: &mut Vec<Child>) -> Result<(), Trap> {
        self.walk.push_object();
        self.trap()?;
        // The object's record is its own only child, wherever its centre is.
        self.hand_over([Word::ZERO; 3], children);
        Ok(())
    }

    fn turn(&mut self, item: u32, children: &mut Vec<Child>) -> Result<(), Trap> {
        let record = self.waiting[item as usize];
        self.free.push(item);
        let min = record.min;
        self.walk.stack.push(record);
        self.walk.turn();
        self.trap()?;
        self.hand_over(min, children);
        Ok(())
    }

    fn log(&mut self) -> &mut TurnLog {
        self.walk.dp.probe_mut()
    }
}
