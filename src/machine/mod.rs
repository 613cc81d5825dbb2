//! The machine: the paper's loop, in words (paper, sections 3.1 to 3.6).
//!
//! ```text
//! push the object's record
//! while there is a record:
//!     pop it; if its quadtree node is full by now, it is done
//!     change it to screen space, if its rule has that and its deviation allows
//!     if it maps to a sample, or is a solid that can be drawn: draw it
//!     else: find its centre, the order of its children, their vertices;
//!           for each child, farthest first: find its box and the smallest
//!           unfilled quadtree node that holds it; push it if there is one
//! ```
//!
//! The scalar machine defines the bits: what it draws is what every faster
//! path must draw. Every arithmetic step is a call on a
//! [`Datapath`](hwmodel::Datapath), so that a probe sees all of it.

mod alpha;
mod children;
mod constants;
mod draw;
mod fit;
mod lattice;
#[cfg(test)]
mod mutants;
mod open;
mod planes;
mod positions;
mod record;
mod size;
mod steps;
mod taps;
mod to_screen;
mod verdict;
pub(crate) mod vertices;
mod walk;

use hwmodel::cycles::{Hardware, Observer, TurnLog};
use hwmodel::{NoProbe, Overflow, Probe};

use crate::frame::{FillVectors, Frame};
use crate::graph::GraphView;
use walk::Walk;

use crate::project::{CageKind, Coverage, Engine, EngineError, FrameSetup, Stats};

pub use crate::project::OCCLUSION_ORDER;
pub use constants::count_load;
pub use positions::{Positions, Space, visit_positions};
use steps::Steps;
pub use steps::{SimulateError, Simulated};
pub use taps::Block;

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
        match setup.options.cage {
            CageKind::Corners => {
                self.run::<P, lattice::Corners>(graph, setup, frame, probe, u64::MAX)
            }
            CageKind::Frame => self.run::<P, lattice::Frame>(graph, setup, frame, probe, u64::MAX),
        }
        // Nobody waits for so many records.
        .map(|drawn| drawn.unwrap_or_else(|| unreachable!("more than 2^64 records")))
    }

    /// Draws a frame with at most so many records: `None`, and a frame of no
    /// use, where that is not enough. Every frame ends (`SPEC.md`,
    /// "Termination"); this is for who checks that.
    ///
    /// # Errors
    /// When a word overflows under the trap policy.
    pub fn render_within(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        most_records: u64,
    ) -> Result<Option<Stats>, EngineError> {
        let drawn = match setup.options.cage {
            CageKind::Corners => {
                self.run::<_, lattice::Corners>(graph, setup, frame, NoProbe, most_records)
            }
            CageKind::Frame => {
                self.run::<_, lattice::Frame>(graph, setup, frame, NoProbe, most_records)
            }
        };
        drawn.map(|drawn| drawn.map(|(stats, _)| stats))
    }

    fn run<P: Probe, L: lattice::Lattice>(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        probe: P,
        most_records: u64,
    ) -> Result<Option<(Stats, P)>, EngineError> {
        frame.clear();
        frame.set_blending(setup.options.coverage == Coverage::Alpha);
        let fill = Self::emptied(&mut self.fill, setup);
        walk::run::<P, L>(
            &self.options,
            graph,
            setup,
            fill,
            frame,
            probe,
            most_records,
        )
    }

    /// Draws a frame on a simulated hardware: each record has its turn in the
    /// cycle in which `hardware` gets to it, and finds the fill vectors as
    /// they are by then.
    ///
    /// Under [`Independence::None`] and [`Image`] the machine does exactly
    /// what it does serially, whatever the hardware. Under [`Classes`] and
    /// [`Both`] the picture is the same where no sample is claimed by two
    /// children of one class: under the exact rule.
    ///
    /// [`Independence::None`]: hwmodel::cycles::Independence::None
    /// [`Image`]: hwmodel::cycles::Independence::Image
    /// [`Classes`]: hwmodel::cycles::Independence::Classes
    /// [`Both`]: hwmodel::cycles::Independence::Both
    ///
    /// # Errors
    /// When the hardware's description is not sound, a word overflows under
    /// the trap policy, or a stack that does not spill.
    pub fn simulate<O: Observer>(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
        hardware: &Hardware,
        observer: &mut O,
    ) -> Result<Simulated, SimulateError> {
        hardware.check()?;
        frame.clear();
        frame.set_blending(setup.options.coverage == Coverage::Alpha);
        let fill = Self::emptied(&mut self.fill, setup);
        let log = TurnLog::new(hardware);
        let options = &self.options;
        match setup.options.cage {
            CageKind::Corners => {
                let walk =
                    Walk::<_, lattice::Corners>::new(options, graph, setup, fill, frame, log);
                Steps::new(walk).run(hardware, observer)
            }
            CageKind::Frame => {
                let walk = Walk::<_, lattice::Frame>::new(options, graph, setup, fill, frame, log);
                Steps::new(walk).run(hardware, observer)
            }
        }
    }

    /// Fill vectors of the frame's size, with nothing drawn.
    fn emptied<'f>(
        fill: &'f mut Option<(FillVectors, u32, u32)>,
        setup: &FrameSetup,
    ) -> &'f mut FillVectors {
        let (levels, width, height) = (setup.levels, setup.width, setup.height);
        let fits = |(fill, w, h): &(FillVectors, u32, u32)| {
            fill.levels() == levels && (*w, *h) == (width, height)
        };
        if !fill.as_ref().is_some_and(fits) {
            *fill = None;
        }
        let (fill, ..) =
            fill.get_or_insert_with(|| (FillVectors::new(levels, width, height), width, height));
        fill.clear();
        fill
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
