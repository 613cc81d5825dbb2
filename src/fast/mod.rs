//! The fast engine: the exact picture, as fast as the processor goes.
//!
//! Under `exact` the picture is defined without reference to an algorithm (`SPEC.md`): each sample
//! shows the first voxel on its ray. So this engine may work sample by sample, where the machine
//! works record by record, and in approximate numbers: arithmetic with a bounded error decides
//! nearly all samples, the exact rule those in doubt (`spec/fast.md`).
//!
//! ```text
//! for each band of the picture, from the whole object down (traversal):
//!     skip what is behind the eye, beside the picture, or hidden
//!     small voxels (bricks):  64 or 4096 to a step; for each open sample, which of them its
//!                             line may meet (strips), and the first that it does (lines)
//!     voxels (voxels):        one by one, against 64 samples at once
//!     large or near ones:     by exact planes (planes, exact)
//! ```
//!
//! Frames that it does not draw ([`Declined`]: other rules, positions too large, records asked for)
//! go to the engine that it is made with.

mod alpha;
mod band;
mod bricks;
mod canvas;
mod compiled;
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
mod squares;
mod strips;
mod switches;
mod traversal;
mod voxels;
mod window;

use std::ops::Range;

use crate::frame::{Colors, Frame};
use crate::graph::GraphView;
use crate::project::{Coverage, Engine, EngineError, FrameSetup, Stats};
use band::{Band, BrickBlocks, Compiled, Hit};
use canvas::{Fill, FillMemory, FillPart, Pixels, TileGrid};
use constants::Constants;
pub use constants::Declined;
use counters::Counters;
use exact::Exact;
use lanes::Scalar;
pub use switches::Switches;
use window::{TILE_LOG2, Window};

/// Which instructions the engine uses. Never changes a bit of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Instructions {
    /// The best that the processor has.
    #[default]
    Auto,
    /// Plain Rust.
    Scalar,
    /// AVX2; plain Rust where the processor has none.
    Avx2,
}

/// How the engine works. None of it changes a bit of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct FastOptions {
    /// Threads; 0: as many as the current pool has.
    pub threads: usize,
    /// Instructions.
    pub instructions: Instructions,
    /// What is skipped.
    pub switches: Switches,
}

/// The fast engine.
pub struct Fast {
    options: FastOptions,
    /// Draws the frames that this engine does not.
    fallback: Box<dyn Engine + Send>,
    fill: FillMemory,
    /// The constants of the last frame, good for the next of the same set-up.
    prepared: Option<Prepared>,
    /// Counts of the last frame.
    counters: Counters,
    /// Why the last frame went to the fallback.
    declined: Option<Declined>,
}

/// A frame's constants.
struct Prepared {
    setup: FrameSetup,
    constants: Result<Constants, Declined>,
    exact: Exact,
}

impl std::fmt::Debug for Fast {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Fast")
            .field("options", &self.options)
            .finish_non_exhaustive()
    }
}

impl Fast {
    /// An engine that hands to `fallback`, which must draw the machine's bits,
    /// the frames that it does not draw itself.
    #[must_use]
    pub fn new(options: FastOptions, fallback: Box<dyn Engine + Send>) -> Self {
        Self {
            options,
            fallback,
            fill: FillMemory::default(),
            prepared: None,
            counters: Counters::default(),
            declined: None,
        }
    }

    /// Why the last frame was handed to the fallback, which is many times slower; `None`: it was
    /// not.
    #[must_use]
    pub fn declined(&self) -> Option<Declined> {
        self.declined
    }

    /// Draws a frame; returns `false` if it has to be drawn by the fallback. Allocates nothing
    /// when the set-up is that of the last frame.
    fn draw_fast(&mut self, graph: &GraphView<'_>, setup: &FrameSetup, pixels: Pixels<'_>) -> bool {
        let prepared = match &mut self.prepared {
            Some(prepared) if prepared.setup == *setup => prepared,
            other => other.insert(Prepared {
                setup: setup.clone(),
                constants: Constants::new(setup),
                exact: Exact::new(setup),
            }),
        };
        self.declined = prepared.constants.as_ref().err().copied();
        let Ok(constants) = &prepared.constants else {
            return false;
        };
        let job = Job {
            constants,
            exact: &prepared.exact,
            graph,
            switches: &self.options.switches,
        };
        let grid = TileGrid::new(setup.width, setup.height);
        self.fill.resize(&grid);
        let threads = match self.options.threads {
            0 => rayon::current_num_threads(),
            threads => threads,
        };
        let buffers = BandBuffers {
            grid,
            bounds: Window {
                left: 0,
                top: 0,
                right: setup.width as i32 - 1,
                bottom: setup.height as i32 - 1,
            },
            fill: self.fill.part(),
            pixels,
        };
        let object = constants.rows(setup.height);
        let object = object.start >> TILE_LOG2..object.end.div_ceil(1 << TILE_LOG2);
        let counters = match self.options.instructions.best() {
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2(isa) => run_bands(&job, buffers, isa, &object, threads),
            InstructionSet::Scalar(isa) => run_bands(&job, buffers, isa, &object, threads),
        };
        self.counters = counters;
        true
    }
}

impl Fast {
    /// [`Fast::draw_fast`] of a frame's nodes and voxels.
    fn draw_frame(&mut self, graph: &GraphView<'_>, setup: &FrameSetup, frame: &mut Frame) -> bool {
        if frame.records.is_some() {
            self.declined = Some(Declined::Records);
            return false;
        }
        self.draw_fast(graph, setup, pixels_of(frame))
    }
}

impl Engine for Fast {
    fn draw(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
    ) -> Result<(), EngineError> {
        frame.set_blending(setup.options.coverage == Coverage::Alpha);
        if self.draw_frame(graph, setup, frame) {
            return Ok(());
        }
        self.fallback.draw(graph, setup, frame)
    }

    fn draw_colors(
        &mut self,
        graph: &GraphView<'_>,
        of_node: &[[u8; 3]],
        setup: &FrameSetup,
        colors: &mut Colors,
    ) -> Result<(), EngineError> {
        if setup.options.coverage == Coverage::Alpha {
            // Nodes first: what is blended has no colour before the last voxel.
            self.draw(graph, setup, colors.nodes())?;
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
        // Without colours there is nothing to look up.
        if !of_node.is_empty() && self.draw_fast(graph, setup, pixels) {
            return Ok(());
        }
        self.fallback.draw_colors(graph, of_node, setup, colors)
    }

    fn render(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
    ) -> Result<Stats, EngineError> {
        frame.set_blending(setup.options.coverage == Coverage::Alpha);
        if self.draw_frame(graph, setup, frame) {
            return Ok(self.counters.stats());
        }
        let mut stats = self.fallback.render(graph, setup, frame)?;
        stats.push(("handed_to_machine", 1));
        stats.extend(self.declined.map(|why| (why.counter(), 1)));
        Ok(stats)
    }
}

/// A frame's nodes and voxels.
fn pixels_of(frame: &mut Frame) -> Pixels<'_> {
    Pixels {
        width: frame.width as usize,
        top: 0,
        shown: &mut frame.node,
        color: &[],
        voxel: &mut frame.voxel,
        blend: frame.blend.as_deref_mut().unwrap_or_default(),
    }
}

/// A set of instructions that the processor has.
enum InstructionSet {
    #[cfg(target_arch = "x86_64")]
    Avx2(lanes::Avx2),
    Scalar(Scalar),
}

impl Instructions {
    /// The best of these sets that the processor has.
    fn best(self) -> InstructionSet {
        #[cfg(target_arch = "x86_64")]
        if let Some(isa) = lanes::Avx2::detect().filter(|_| self != Self::Scalar) {
            return InstructionSet::Avx2(isa);
        }
        InstructionSet::Scalar(Scalar)
    }

    /// Whether the processor has these; without, the next lower set is used.
    #[must_use]
    pub fn are_available(self) -> bool {
        let best = self.best();
        match self {
            Self::Auto | Self::Scalar => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => matches!(best, InstructionSet::Avx2(_)),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 => false,
        }
    }
}

/// What all bands of a frame have in common.
struct Job<'j> {
    constants: &'j Constants,
    exact: &'j Exact,
    graph: &'j GraphView<'j>,
    switches: &'j Switches,
}

/// The memory of a band of the picture: whole rows of tiles.
struct BandBuffers<'p> {
    grid: TileGrid,
    bounds: Window,
    fill: FillPart<'p>,
    pixels: Pixels<'p>,
}

/// Rows of tiles that the first of several bands has, of `rows` from `top` on; all: there is one
/// band.
///
/// Nodes that lie across two bands are visited in both, so there are few bands; several to a
/// thread, large ones first, so that threads end together. What counts is the rows that the object
/// covers: those above and below it cost nothing.
fn first_band(top: usize, rows: usize, object: &Range<usize>, threads: usize) -> usize {
    let begin = object.start.max(top);
    let covered = object.end.min(top + rows).saturating_sub(begin);
    let size = (covered / (2 * threads)).max(1);
    if threads <= 1 || covered <= size {
        return rows;
    }
    begin - top + size
}

impl BandBuffers<'_> {
    /// Splits off the first rows of tiles.
    fn split(self, rows: usize) -> (Self, Self) {
        let top = self.bounds.top + ((rows << TILE_LOG2) as i32);
        let samples = (top - self.bounds.top) as usize * self.pixels.width;
        let voxels = samples.min(self.pixels.voxel.len());
        let blends = samples.min(self.pixels.blend.len());
        let first = (self.bounds.top >> TILE_LOG2) as usize;
        let (fill, fill_rest) = self.fill.split(&self.grid, first, rows);
        let (shown, shown_rest) = self.pixels.shown.split_at_mut(samples);
        let (voxel, voxel_rest) = self.pixels.voxel.split_at_mut(voxels);
        let (blend, blend_rest) = self.pixels.blend.split_at_mut(blends);
        let (width, color) = (self.pixels.width, self.pixels.color);
        let part = |bounds: Window, fill, shown, voxel, blend| Self {
            grid: self.grid,
            bounds,
            fill,
            pixels: Pixels {
                width,
                top: bounds.top,
                shown,
                color,
                voxel,
                blend,
            },
        };
        let upper = Window {
            bottom: top - 1,
            ..self.bounds
        };
        let lower = Window { top, ..self.bounds };
        (
            part(upper, fill, shown, voxel, blend),
            part(lower, fill_rest, shown_rest, voxel_rest, blend_rest),
        )
    }
}

/// Draws the first band, while other threads draw the rest in the same way. `object`: rows of tiles
/// that the object covers.
fn run_bands<I: Compiled>(
    job: &Job<'_>,
    buffers: BandBuffers<'_>,
    isa: I,
    object: &Range<usize>,
    threads: usize,
) -> Counters {
    let tiles = buffers.bounds.coarser(TILE_LOG2);
    let rows = (tiles.bottom - tiles.top + 1) as usize;
    let first = first_band(tiles.top as usize, rows, object, threads);
    if first == rows {
        return run(job, buffers, isa);
    }
    let (upper, rest) = buffers.split(first);
    let (mut counters, others) = rayon::join(
        || run(job, upper, isa),
        || run_bands(job, rest, isa, object, threads),
    );
    counters.add(&others);
    counters
}

/// Draws one band.
fn run<I: Compiled>(job: &Job<'_>, mut buffers: BandBuffers<'_>, isa: I) -> Counters {
    let mut brick_blocks = BrickBlocks::default();
    buffers.pixels.clear();
    let fill = Fill::clear(&buffers.grid, buffers.bounds, buffers.fill);
    let mut band = Band {
        isa,
        constants: job.constants,
        exact: job.exact,
        graph: job.graph,
        switches: job.switches,
        fill,
        blends: job.constants.opacity_eye.is_some(),
        sample_offsets: std::array::from_fn(|i| ((i >> 3) * buffers.pixels.width + (i & 7)) as u32),
        pixels: buffers.pixels,
        counters: Counters::default(),
        candidates: lanes::Candidates([0; 64]),
        hits: [Hit::default(); 64],
        nodes: [0; 64],
        brick_blocks: &mut brick_blocks,
    };
    traversal::draw_object(&mut band);
    band.counters
}
