//! Ends frames that take too many records, and drawings that are stopped.

use crate::project::{EngineError, Stop};

/// Records between two questions whether to stop: about a millisecond.
const STEP: u64 = 2048;

pub(super) struct Limit {
    most: u64,
    next: u64,
    stop: Stop,
}

impl Limit {
    pub(super) fn new(most: u64, stop: &Stop) -> Self {
        Self {
            most,
            next: 0,
            stop: stop.clone(),
        }
    }

    /// Whether a frame with so many records may not have more. Fails if it is to be stopped.
    #[inline(always)]
    pub(super) fn is_reached(&mut self, records: u64) -> Result<bool, EngineError> {
        if records < self.next {
            return Ok(false);
        }
        if self.stop.is_requested() {
            return Err(EngineError::Stopped);
        }
        self.next = self.most.min(records + STEP);
        Ok(records >= self.most)
    }
}
