//! The interface of the engines.

use hwmodel::Trap;

use super::FrameSetup;
use crate::budget::Shortage;
use crate::frame::{Colors, Frame};
use crate::graph::GraphView;

/// Children by occlusion order, nearest first, for octant 000: exclusive-or with the octant bits gives the order for any
/// eye (image-order paper, 3.2). Normative: the first record to reach a sample draws it.
pub const OCCLUSION_ORDER: [u8; 8] = [7, 6, 5, 3, 4, 2, 1, 0];

/// Why a frame was not finished.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum EngineError {
    /// A word overflowed under the trap policy.
    #[error("{0}; use more bits, fewer fraction bits, or another overflow policy (wrap, saturate)")]
    Trap(#[from] Trap),
    /// The system refuses the memory of a frame.
    #[error(transparent)]
    Memory(#[from] Shortage),
    /// The machine stopped after this many records ([`most_records`]).
    #[error(
        "the picture takes more than {0} records: much of the scene is near the plane of the eye, or detail is too fine"
    )]
    Records(u64),
    /// [`Stop`](super::Stop) ended the drawing.
    #[error("the drawing was stopped")]
    Stopped,
}

/// Records that a frame may take: 2^20, and 512 for each sample. Ordinary pictures take up to 80 for a sample.
#[must_use]
pub fn most_records(setup: &FrameSetup) -> u64 {
    (1 << 20) + 512 * u64::from(setup.width) * u64::from(setup.height)
}

/// An engine's counts of one frame: names and numbers, in a fixed order.
pub type Stats = Vec<(&'static str, u64)>;

/// The counts of a frame that was drawn, or why it was not.
pub type Rendered = Result<Stats, EngineError>;

/// A count by its name; 0 if there is none of that name.
#[must_use]
pub fn stat(stats: &[(&'static str, u64)], name: &str) -> u64 {
    let found = stats.iter().find(|(of, _)| *of == name);
    found.map_or(0, |(_, count)| *count)
}

/// Draws a frame. The picture depends only on the frame set-up and the graph.
pub trait Engine {
    /// Draws the unlit colours of the samples' nodes. `of_node` has the colours by graph node. `colors` gets the size of
    /// `setup`, and each of its entries is written. Experiments time this. Errors: as [`Engine::render`].
    fn draw_colors(
        &mut self,
        graph: &GraphView<'_>,
        of_node: &[[u8; 3]],
        setup: &FrameSetup,
        colors: &mut Colors,
    ) -> Result<(), EngineError> {
        colors.fit(setup.width, setup.height)?;
        self.render(graph, setup, colors.nodes())?;
        colors.take_nodes(of_node);
        Ok(())
    }

    /// Draws into `frame`, which gets the size of `setup`. Each of its entries is written. Fails when the frame cannot be
    /// finished; its contents then have no meaning.
    fn render(&mut self, graph: &GraphView<'_>, setup: &FrameSetup, frame: &mut Frame) -> Rendered;
}
