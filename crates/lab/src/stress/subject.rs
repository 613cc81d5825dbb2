//! The machine under test, or in tests a machine with an error.

use hwmodel::Trap;

use shiftvox::frame::Frame;
use shiftvox::graph::GraphView;
use shiftvox::machine::{self, Cage, Machine};
use shiftvox::project::{EngineError, FrameSetup, Stats};

pub(super) trait Subject: Sync {
    /// Draws a frame with at most so many records: `None` where that is not enough.
    fn draw(
        &self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        most_records: u64,
    ) -> Result<Option<Stats>, EngineError> {
        Machine::default().render_within(graph, setup, frame, most_records)
    }

    fn cages_along(&self, setup: &FrameSetup, path: &[u8]) -> Result<Vec<Cage>, Trap> {
        machine::cages_along(setup, path)
    }
}

pub(super) struct Product;

impl Subject for Product {}
