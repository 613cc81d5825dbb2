//! Observers of a simulation.

use super::outer::OuterRequest;
use super::report::Cause;
use crate::Stage;

/// The record number of the workload's start.
pub const START: u64 = u64::MAX;

/// One record's visit of one stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct VisitSpan {
    /// In the order of turns, from 0; or [`START`].
    pub record: u64,
    pub lane: u32,
    /// Within the lane.
    pub context: u32,
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
    /// Whether [`visit`](Self::visit) is called; constant during a simulation.
    fn watches_visits(&self) -> bool {
        false
    }

    /// A visit of known course, in the order in which they begin.
    fn visit(&mut self, _: &VisitSpan) {}

    /// Whether [`requests`](Self::requests) is called; constant during a simulation.
    fn watches_requests(&self) -> bool {
        false
    }

    /// At the end, all requests to outer memory.
    fn requests(&mut self, _: Vec<OuterRequest>) {}

    /// Cycle and number of records, every few thousand records.
    fn progress(&mut self, _cycle: u64, _records: u64) {}
}

/// Observes nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoObserver;

impl Observer for NoObserver {}

/// Keeps all visits.
impl Observer for Vec<VisitSpan> {
    fn watches_visits(&self) -> bool {
        true
    }

    fn visit(&mut self, span: &VisitSpan) {
        self.push(*span);
    }
}
