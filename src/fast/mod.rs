//! The fast engine: the exact picture, as fast as the processor goes.
//!
//! Approximate arithmetic with a bounded error decides nearly all samples, the exact rule those in doubt
//! (`spec/fast.md`).
//!
//! ```text
//! for each band of the picture, from the whole object down (traversal):
//!     skip what is behind the eye, outside the frustum, or occluded
//!     small voxels (bricks):  64 or 4096 to a step; for each open sample, which of them its
//!                             line may meet (strips), and the first that it does (lines)
//!     voxels (voxels):        one by one, against 64 samples at once
//!     large or near ones:     by exact planes (planes, exact)
//! ```
//!
//! Frames that it declines go to another engine.

mod alpha;
mod band;
mod bands;
mod bricks;
mod canvas;
mod child_windows;
mod constants;
mod counters;
mod directions;
mod exact;
mod lanes;
mod lines;
mod orders;
mod parts;
mod planes;
mod projection;
#[cfg(test)]
mod proof;
mod strips;
mod traversal;
mod voxels;
mod waiting;
mod window;

use std::sync::atomic::AtomicBool;

use crate::frame::{Colors, Frame};
use crate::graph::GraphView;
use crate::project::{Engine, EngineError, FrameSetup, Rendered, Stop};
use bands::{BandBuffers, Job, run_bands};
use canvas::Pixels;
use constants::Constants;
use counters::Counters;
use exact::Exact;
use lanes::{Isa, Scalar, Vector};
use window::{TILE_LOG2, Window};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Instructions {
    /// The best that the processor has.
    #[default]
    Auto,
    /// Plain Rust.
    Scalar,
}

/// Settings, none of which changes a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct FastOptions {
    /// 0: as many as the current pool.
    pub threads: usize,
    pub instructions: Instructions,
    pub switches: Switches,
}

pub struct Fast {
    options: FastOptions,
    stop: Stop,
    fallback: Box<dyn Engine + Send>,
    /// Masks of open samples.
    tiles: Vec<u64>,
    prepared: Option<Prepared>,
}

/// Counts of a drawn frame, or the reason for which the fallback has to draw it.
type Drawn = Result<Counters, &'static str>;

struct Prepared {
    setup: FrameSetup,
    constants: Result<Constants, &'static str>,
    exact: Exact,
}

impl Fast {
    /// `fallback` draws the frames that this engine declines, and must draw the machine's bits.
    pub fn new(options: FastOptions, fallback: Box<dyn Engine + Send>) -> Self {
        Self {
            options,
            stop: Stop::default(),
            fallback,
            tiles: Vec::new(),
            prepared: None,
        }
    }

    /// Lets `stop` end drawings, before each band of the picture. The fallback has one of its own.
    #[must_use]
    pub fn stopped_by(mut self, stop: &Stop) -> Self {
        self.stop = stop.clone();
        self
    }

    /// Allocates nothing when the set-up is that of the last frame.
    fn draw_fast(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        pixels: Pixels<'_>,
    ) -> Result<Drawn, EngineError> {
        let prepared = match &mut self.prepared {
            Some(prepared) if prepared.setup == *setup => prepared,
            other => other.insert(Prepared {
                setup: setup.clone(),
                constants: Constants::new(setup),
                exact: Exact::new(setup),
            }),
        };
        let constants = match &prepared.constants {
            Ok(constants) => constants,
            Err(why) => return Ok(Err(why)),
        };
        let job = Job {
            constants,
            exact: &prepared.exact,
            graph,
            switches: &self.options.switches,
            stop: &self.stop,
            is_stopped: AtomicBool::new(false),
        };
        canvas::resize(&mut self.tiles, setup.width, setup.height)?;
        let threads = match self.options.threads {
            0 => rayon::current_num_threads(),
            threads => threads,
        };
        let buffers = BandBuffers {
            tiles_across: canvas::tiles_across(setup.width),
            bounds: Window::of([0, 0, setup.width as i32 - 1, setup.height as i32 - 1]),
            tiles: &mut self.tiles,
            pixels,
        };
        let object = constants.rows(setup.height);
        let object = object.start >> TILE_LOG2..object.end.div_ceil(1 << TILE_LOG2);
        let vector = match self.options.instructions {
            Instructions::Auto => Vector::detect(),
            Instructions::Scalar => None,
        };
        let counters = match vector {
            Some(isa) => run_bands(&job, buffers, isa, &object, threads),
            None => run_bands(&job, buffers, Scalar, &object, threads),
        };
        match job.is_stopped.into_inner() {
            true => Err(EngineError::Stopped),
            false => Ok(Ok(counters)),
        }
    }
}

impl Engine for Fast {
    fn draw_colors(
        &mut self,
        graph: &GraphView<'_>,
        of_node: &[[u8; 3]],
        setup: &FrameSetup,
        colors: &mut Colors,
    ) -> Result<(), EngineError> {
        colors.fit(setup.width, setup.height)?;
        if setup.options.coverage.blends() {
            self.render(graph, setup, colors.nodes())?;
            colors.take_nodes(of_node);
            return Ok(());
        }
        let pixels = Pixels {
            width: colors.width as usize,
            top: 0,
            shown: &mut colors.words,
            color: of_node,
            voxel: &mut [],
            blend: &mut [],
        };
        if !of_node.is_empty() && self.draw_fast(graph, setup, pixels)?.is_ok() {
            return Ok(());
        }
        self.fallback.draw_colors(graph, of_node, setup, colors)
    }

    fn render(&mut self, graph: &GraphView<'_>, setup: &FrameSetup, frame: &mut Frame) -> Rendered {
        frame.fit(setup.width, setup.height, setup.options.coverage.blends())?;
        let why = if frame.records.is_some() {
            "handed_for_records"
        } else {
            let pixels = Pixels {
                width: frame.width as usize,
                top: 0,
                shown: &mut frame.node,
                color: &[],
                voxel: &mut frame.voxel,
                blend: frame.blend.as_deref_mut().unwrap_or_default(),
            };
            match self.draw_fast(graph, setup, pixels)? {
                Ok(counters) => return Ok(counters.stats()),
                Err(why) => why,
            }
        };
        let mut stats = self.fallback.render(graph, setup, frame)?;
        stats.extend([("handed_to_machine", 1), (why, 1)]);
        Ok(stats)
    }
}

/// Techniques on or off, for measurements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Switches {
    /// Skip occluded nodes.
    pub hidden: bool,
    /// Draw two levels, or one, in one step of 64 lanes.
    pub bricks: bool,
}

impl Default for Switches {
    fn default() -> Self {
        Self {
            hidden: true,
            bricks: true,
        }
    }
}
