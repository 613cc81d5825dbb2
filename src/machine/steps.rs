//! The machine one turn at a time, in an order that a scheduler chooses.
//!
//! The records that a turn leaves go to the scheduler and not onto a stack,
//! each with its place in the occlusion order and its image node. Fill vectors
//! are shared: a turn finds them as the turns before it left them. What the
//! serial machine keeps once because it works depth first, the lattice of the
//! record that changed to screen space last, is kept here for every such
//! record that has descendants left.

use hwmodel::cycles::{
    self, Child, CycleReport, Hardware, HardwareError, Observer, Region, TurnLog,
};
use hwmodel::{Datapath, NoProbe, Overflow, Trap, Word};
use serde::Serialize;

use super::lattice::Lattice;
use super::record::{Pose, Record};
use super::strips::Subtree;
use super::walk::Walk;
use crate::project::{EngineError, Stats};

/// What a simulated frame came to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Simulated {
    /// Cycles and what they were spent on.
    pub cycles: CycleReport,
    /// Most lattices of screen space at once: under the exact rule each
    /// record that changes has one, which its descendants share. The serial
    /// machine has one register for it.
    pub most_lattices: u64,
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

/// Number of no lattice.
const NONE: u32 = u32::MAX;

/// A record that waits for its turn.
#[derive(Debug, Clone, Copy)]
struct Waiting<L> {
    record: Record<L>,
    lattice: u32,
}

/// Lattices by number. One of them is at work: it lies in the walk.
#[derive(Debug, Default)]
struct Lattices {
    /// Its place, unless it is at work, and how many records share it.
    kept: Vec<(Option<Subtree>, u32)>,
    free: Vec<u32>,
    at_work: Option<u32>,
    live: u64,
    most_live: u64,
}

impl Lattices {
    /// Has lattice `number` at work, or none.
    fn take_up(&mut self, number: u32, register: &mut Option<Subtree>) {
        let wanted = (number != NONE).then_some(number);
        if self.at_work == wanted {
            return;
        }
        if let Some(before) = self.at_work {
            self.kept[before as usize].0 = register.take();
        }
        self.at_work = wanted;
        *register = wanted.and_then(|number| self.kept[number as usize].0.take());
    }

    /// The lattice that has just been made at work: its number.
    fn made(&mut self) -> u32 {
        let number = self.free.pop().unwrap_or(self.kept.len() as u32);
        if number as usize == self.kept.len() {
            self.kept.push((None, 0));
        }
        self.kept[number as usize] = (None, 1);
        self.at_work = Some(number);
        self.live += 1;
        self.most_live = self.most_live.max(self.live);
        number
    }

    /// `more` further records share a lattice, and one does no longer.
    fn pass_on(&mut self, number: u32, more: u32, register: &mut Option<Subtree>) {
        if number == NONE {
            return;
        }
        let shares = &mut self.kept[number as usize].1;
        *shares = *shares + more - 1;
        if *shares == 0 {
            self.live -= 1;
            self.free.push(number);
            if self.at_work == Some(number) {
                self.at_work = None;
                *register = None;
            }
        }
    }
}

/// The machine as a workload of the cycle model.
pub(super) struct Steps<'a, L> {
    walk: Walk<'a, TurnLog, L>,
    waiting: Vec<Waiting<L>>,
    free: Vec<u32>,
    lattices: Lattices,
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
            lattices: Lattices::default(),
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
        let most_lattices = self.lattices.most_live;
        let (mut counts, _) = self.walk.finish();
        counts.retain(|(name, _)| *name != "deepest_stack");
        Ok(Simulated {
            cycles,
            most_lattices,
            counts,
        })
    }

    /// Hands the records over that a turn left: the nearest was pushed last.
    fn hand_over(&mut self, parent_min: [Word; 3], lattice: u32, children: &mut Vec<Child>) {
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
            let waiting = Waiting { record, lattice };
            let item = if let Some(at) = self.free.pop() {
                self.waiting[at as usize] = waiting;
                at
            } else {
                self.waiting.push(waiting);
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
        self.hand_over([Word::ZERO; 3], NONE, children);
        Ok(())
    }

    fn turn(&mut self, item: u32, children: &mut Vec<Child>) -> Result<(), Trap> {
        let Waiting {
            record,
            mut lattice,
        } = self.waiting[item as usize];
        self.free.push(item);
        self.lattices.take_up(lattice, &mut self.walk.subtree);
        let in_clip_space = matches!(record.pose, Pose::Clip(..));
        let min = record.min;
        self.walk.stack.push(record);
        self.walk.turn();
        self.trap()?;
        if in_clip_space && self.walk.subtree.is_some() {
            lattice = self.lattices.made();
        }
        self.hand_over(min, lattice, children);
        let register = &mut self.walk.subtree;
        self.lattices
            .pass_on(lattice, children.len() as u32, register);
        Ok(())
    }

    fn log(&mut self) -> &mut TurnLog {
        self.walk.dp.probe_mut()
    }
}
