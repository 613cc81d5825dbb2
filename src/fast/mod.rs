//! The fast engine: the machine's bits, as fast as the processor goes.
//!
//! What the machine does for records this engine does for samples. Both go
//! down the graph nearest first and leave what cannot be seen; but the last
//! two levels are one step here (see [`brick`]): 64 parts, one lane each, and
//! for every open sample the first lane whose outline holds it. That gives
//! the machine's picture because the picture does not depend on when occluded
//! records are rejected (`SPEC.md`, section 5), and because all that decides it
//! (when a record changes to screen space, its lattice there, level of
//! detail, order, outlines) is computed from the same whole numbers.
//!
//! ```text
//! for each band of the picture, from the whole object down:
//!     clip space (clip):     leave what is behind the eye, beside the picture, or hidden;
//!                            change to screen space where the deviation allows
//!     screen space (screen): the same with integer boxes; two levels above the finest: a brick
//!     brick (brick):         columns, rows and strips of 64 parts against each open sample
//!     solids (planes):       by exact planes in clip space, by strips in screen space
//! ```
//!
//! Frames with settings that this engine has no exact numbers for (rules other
//! than `exact`, an infinite tolerance, records asked for, formats without
//! headroom) are handed to the engine it is made with.

mod brick;
mod canvas;
mod clip;
mod counters;
mod lanes;
mod planes;
mod screen;
mod subtree;
mod switches;
mod view;
mod walk;

use rayon::prelude::*;

use crate::frame::Frame;
use crate::graph::GraphView;
use crate::project::{Engine, EngineError, FrameSetup, Stats};
use canvas::{BLOCK_LOG2, Fill, FillMemory, FillPart, Grid, Pixels, Window};
use counters::Counters;
use lanes::{Isa, Scalar};
use planes::Exact;
pub use switches::Switches;
use view::View;
use walk::{Bounds, Walk};

/// Which instructions the engine uses. Never changes a bit of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Instructions {
    /// The best that the processor has.
    #[default]
    Auto,
    /// Plain Rust.
    Scalar,
    /// AVX2; plain Rust where the processor has none.
    Avx2,
    /// AVX-512; AVX2 or plain Rust where the processor has none.
    Avx512,
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
    /// Draws what this engine does not.
    fallback: Box<dyn Engine + Send>,
    fill: FillMemory,
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
        }
    }

    /// Draws a frame, or says that it does not: `None`.
    fn draw(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
    ) -> Option<Stats> {
        if frame.records.is_some() {
            return None;
        }
        let view = View::new(setup)?;
        let exact = Exact::new(setup);
        let job = Job {
            view: &view,
            exact: &exact,
            graph,
            switches: &self.options.switches,
        };
        let grid = Grid::new(frame.width, frame.height);
        self.fill.resize(&grid);
        let bands = bands(grid.blocks_down, self.threads());
        let pieces = pieces(&grid, &bands, frame, self.fill.part());
        let counters = match self.options.instructions {
            #[cfg(target_arch = "x86_64")]
            Instructions::Auto | Instructions::Avx512 if lanes::Avx512::detect().is_some() => {
                run_all(&job, pieces, lanes::Avx512::detect()?)
            }
            #[cfg(target_arch = "x86_64")]
            Instructions::Auto | Instructions::Avx512 | Instructions::Avx2
                if lanes::Avx2::detect().is_some() =>
            {
                run_all(&job, pieces, lanes::Avx2::detect()?)
            }
            _ => run_all(&job, pieces, Scalar),
        };
        counters.map(|counters| counters.stats())
    }

    fn threads(&self) -> usize {
        match self.options.threads {
            0 => rayon::current_num_threads(),
            threads => threads,
        }
    }
}

impl Engine for Fast {
    fn render(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        frame: &mut Frame,
    ) -> Result<Stats, EngineError> {
        match self.draw(graph, setup, frame) {
            Some(stats) => Ok(stats),
            None => self.fallback.render(graph, setup, frame),
        }
    }
}

/// What all bands of a frame have in common.
struct Job<'j> {
    view: &'j View,
    exact: &'j Exact,
    graph: &'j GraphView<'j>,
    switches: &'j Switches,
}

/// A band of the picture: whole rows of blocks.
struct Piece<'p> {
    grid: Grid,
    bounds: Window,
    fill: FillPart<'p>,
    pixels: Pixels<'p>,
}

/// How many rows of blocks each band has. Nodes that lie across two bands are
/// visited in both, so there are few bands; several to a thread, large ones
/// first, so that threads end together.
fn bands(block_rows: usize, threads: usize) -> Vec<usize> {
    if threads <= 1 {
        return vec![block_rows];
    }
    let mut left = block_rows;
    let mut bands = Vec::new();
    while left > 0 {
        let rows = (left / (2 * threads)).max(1);
        bands.push(rows);
        left -= rows;
    }
    bands
}

fn pieces<'p>(
    grid: &Grid,
    bands: &[usize],
    frame: &'p mut Frame,
    fill: FillPart<'p>,
) -> Vec<Piece<'p>> {
    let (width, height) = (frame.width as usize, frame.height as usize);
    let mut rest = (fill, &mut frame.node[..], &mut frame.voxel[..]);
    let mut first_row = 0;
    let mut pieces = Vec::with_capacity(bands.len());
    for &rows in bands {
        let top = first_row << BLOCK_LOG2;
        let bottom = ((first_row + rows) << BLOCK_LOG2).min(height);
        let samples = (bottom - top) * width;
        let voxels = samples.min(rest.2.len());
        let (fill, fill_rest) = rest.0.split(grid, rows);
        let (node, node_rest) = rest.1.split_at_mut(samples);
        let (voxel, voxel_rest) = rest.2.split_at_mut(voxels);
        rest = (fill_rest, node_rest, voxel_rest);
        pieces.push(Piece {
            grid: *grid,
            bounds: Window {
                left: 0,
                top: top as i32,
                right: width as i32 - 1,
                bottom: bottom as i32 - 1,
            },
            fill,
            pixels: Pixels {
                width,
                top: top as i32,
                node,
                voxel,
            },
        });
        first_row += rows;
    }
    pieces
}

/// Draws all bands. `None`: a subtree has numbers that do not fit.
fn run_all<I: Isa>(job: &Job<'_>, mut pieces: Vec<Piece<'_>>, isa: I) -> Option<Counters> {
    let mut total = Counters::default();
    if pieces.len() == 1 {
        let counters = run(job, pieces.pop()?, isa)?;
        total.add(&counters);
        return Some(total);
    }
    let counters: Vec<Option<Counters>> = pieces
        .into_par_iter()
        .with_max_len(1)
        .map(|piece| run(job, piece, isa))
        .collect();
    for counters in counters {
        total.add(&counters?);
    }
    Some(total)
}

/// Draws one band.
fn run<I: Isa>(job: &Job<'_>, mut piece: Piece<'_>, isa: I) -> Option<Counters> {
    piece.pixels.clear();
    let fill = Fill::clear(&piece.grid, piece.bounds, piece.fill);
    let mut walk = Walk {
        isa,
        view: job.view,
        exact: job.exact,
        graph: job.graph,
        switches: job.switches,
        fill,
        pixels: piece.pixels,
        bounds: Bounds::new(&piece.bounds),
        counters: Counters::default(),
        tables: brick::Tables::default(),
        bricks: brick::Bricks::default(),
        found: [(0, 0); 64],
        is_lost: false,
    };
    clip::start(&mut walk);
    (!walk.is_lost).then_some(walk.counters)
}
