//! Observers of a simulation.

use super::report::Cause;
use crate::Stage;

/// The record number of the workload's start.
pub const START: u64 = u64::MAX;

/// One record's visit of one stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VisitSpan {
    /// The record, in the order of turns, from 0; or [`START`].
    pub record: u64,
    /// The lane.
    pub lane: u32,
    /// The context within the lane.
    pub context: u32,
    /// The stage.
    pub stage: Stage,
    /// Cycle in which the record arrived at the stage's block.
    pub arrives: u64,
    /// Cycle in which it entered the block.
    pub begins: u64,
    /// First cycle in which the block can take the next record.
    pub frees: u64,
    /// First cycle in which the record can continue.
    pub ends: u64,
    /// Cycles for which it waited for a memory, and the cause.
    pub stall: Option<(Cause, u64)>,
}

/// Observes a simulation. Its methods do nothing by default.
pub trait Observer {
    /// Whether [`visit`](Self::visit) and [`queue`](Self::queue) are called; constant during a simulation.
    fn watches_visits(&self) -> bool {
        false
    }

    /// A visit of known course, in the order in which they begin.
    fn visit(&mut self, _: &VisitSpan) {}

    /// The numbers of records on a lane's stack, and of those that are ready, from `cycle` on.
    fn queue(&mut self, cycle: u64, lane: u32, stored: u32, ready: u32) {
        let _ = (cycle, lane, stored, ready);
    }

    /// Progress, every few thousand records.
    fn progress(&mut self, cycle: u64, records: u64) {
        let _ = (cycle, records);
    }
}

/// Observes nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoObserver;

impl Observer for NoObserver {}

/// Calls a function with cycles and records every few thousand records.
#[derive(Debug, Clone, Copy)]
pub struct Progress<F>(pub F);

impl<F: FnMut(u64, u64)> Observer for Progress<F> {
    fn progress(&mut self, cycle: u64, records: u64) {
        (self.0)(cycle, records);
    }
}

/// Both observe.
impl<A: Observer, B: Observer> Observer for (A, B) {
    fn watches_visits(&self) -> bool {
        self.0.watches_visits() || self.1.watches_visits()
    }

    fn visit(&mut self, span: &VisitSpan) {
        self.0.visit(span);
        self.1.visit(span);
    }

    fn queue(&mut self, cycle: u64, lane: u32, stored: u32, ready: u32) {
        self.0.queue(cycle, lane, stored, ready);
        self.1.queue(cycle, lane, stored, ready);
    }

    fn progress(&mut self, cycle: u64, records: u64) {
        self.0.progress(cycle, records);
        self.1.progress(cycle, records);
    }
}
