//! What is put under stress: the machine, or in tests one with an injury.

use hwmodel::Trap;

use crate::frame::Frame;
use crate::graph::GraphView;
use crate::machine::vertices::{self, Held};
use crate::machine::{Machine, MachineOptions};
use crate::project::{EngineError, FrameSetup, Stats};

/// A renderer whose pictures and vertices can be looked at.
pub(crate) trait Subject: Sync {
    /// Draws a frame with at most so many records: `None` where that is not enough.
    fn draw(
        &self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        most_records: u64,
    ) -> Result<Option<Stats>, EngineError>;

    /// The voxels on a way down from the root, with it, as
    /// [`vertices::follow`] has them.
    fn follow(&self, setup: &FrameSetup, path: &[u8]) -> Result<Vec<Held>, Trap>;
}

/// The machine as it is.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Product;

impl Subject for Product {
    fn draw(
        &self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        most_records: u64,
    ) -> Result<Option<Stats>, EngineError> {
        Machine::new(MachineOptions::default()).render_within(graph, setup, frame, most_records)
    }

    fn follow(&self, setup: &FrameSetup, path: &[u8]) -> Result<Vec<Held>, Trap> {
        vertices::follow(setup, path)
    }
}
