//! The machine: the paper's loop, in words (paper, sections 3.1 to 3.6).
//!
//! ```text
//! push the object's record
//! while there is a record:
//!     pop it; if its quadtree node is full by now, it is done
//!     change it to screen space, if its deviation allows
//!     if it maps to a sample, or is a solid that can be drawn: draw it
//!     else: find its centre, the order of its children, their vertices;
//!           for each child, farthest first: find its box and the smallest
//!           unfilled quadtree node that holds it; push it if there is one
//! ```
//!
//! The scalar machine defines the bits: what it draws is what every faster
//! path must draw. Every arithmetic step is a call on a
//! [`Datapath`](hwmodel::Datapath), so that a probe sees all of it.

mod constants;
mod draw;
mod fit;
mod lattice;
mod planes;
mod record;
mod record_bits;
mod silhouette;
mod size;
mod strips;
mod to_screen;
mod verdict;
#[cfg(test)]
pub(crate) mod vertices;
mod walk;

use hwmodel::{NoProbe, Overflow, Probe};

use crate::frame::{FillVectors, Frame};
use crate::graph::GraphView;
use crate::project::{CageKind, Engine, EngineError, FrameSetup, Stats};

pub use crate::project::OCCLUSION_ORDER;
pub use record_bits::{Held, RecordField, record_bits, record_fields};

/// How the machine works, beyond what the picture asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MachineOptions {
    /// What a result that does not fit its word becomes.
    pub overflow: Overflow,
    /// Whether full quadrants reject records. The picture is the same without.
    pub reject_filled: bool,
    /// The order array; only tests use another than [`OCCLUSION_ORDER`].
    pub order: [u8; 8],
}

impl Default for MachineOptions {
    fn default() -> Self {
        Self {
            overflow: Overflow::Trap,
            reject_filled: true,
            order: OCCLUSION_ORDER,
        }
    }
}

/// The scalar engine.
#[derive(Debug, Default)]
pub struct Machine {
    options: MachineOptions,
    fill: Option<(FillVectors, u32, u32)>,
}

impl Machine {
    /// A machine that works as `options` say.
    #[must_use]
    pub fn new(options: MachineOptions) -> Self {
        Self {
            options,
            fill: None,
        }
    }

    /// Draws a frame while `probe` watches; see [`Engine::render`].
    ///
    /// # Errors
    /// When a word overflows under the trap policy.
    pub fn render_probed<P: Probe>(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        probe: P,
    ) -> Result<(Stats, P), EngineError> {
        frame.clear();
        let (levels, width, height) = (setup.levels, setup.width, setup.height);
        let fill = match &mut self.fill {
            Some((fill, w, h)) if fill.levels() == levels && (*w, *h) == (width, height) => {
                fill.clear();
                fill
            }
            other => {
                &mut other
                    .insert((FillVectors::new(levels, width, height), width, height))
                    .0
            }
        };
        match setup.options.cage {
            CageKind::Corners => {
                walk::run::<P, lattice::Corners>(&self.options, graph, setup, fill, frame, probe)
            }
            CageKind::Frame => {
                walk::run::<P, lattice::Frame>(&self.options, graph, setup, fill, frame, probe)
            }
        }
    }
}

impl Engine for Machine {
    fn render(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
    ) -> Result<Stats, EngineError> {
        self.render_probed(graph, setup, frame, NoProbe)
            .map(|(stats, _)| stats)
    }
}
