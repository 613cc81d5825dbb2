//! Division of a picture into bands, and their threads.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use super::Switches;
use super::band::{Band, BrickBlocks, Hit};
use super::canvas::{Fill, Pixels};
use super::constants::Constants;
use super::counters::Counters;
use super::exact::Exact;
use super::lanes::Isa;
use super::parts::Parts;
use super::strips::Candidates;
use super::traversal;
use super::waiting::Waiting;
use super::window::{TILE_LOG2, Window};
use crate::graph::GraphView;
use crate::project::Stop;

pub(super) struct Job<'j> {
    pub(super) constants: &'j Constants,
    pub(super) exact: &'j Exact,
    pub(super) graph: &'j GraphView<'j>,
    pub(super) switches: &'j Switches,
    pub(super) stop: &'j Stop,
    /// Whether a band was not drawn.
    pub(super) is_stopped: AtomicBool,
}

pub(super) struct BandBuffers<'p> {
    pub(super) tiles_across: usize,
    pub(super) bounds: Window,
    pub(super) tiles: &'p mut [u64],
    pub(super) pixels: Pixels<'p>,
}

/// Rows of tiles of the first band. A node across two bands is visited in both, so bands are few, large ones first, so that
/// threads end together. Only rows that the object covers count.
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
    fn split(self, rows: usize) -> (Self, Self) {
        let top = self.bounds.top + ((rows << TILE_LOG2) as i32);
        let samples = (top - self.bounds.top) as usize * self.pixels.width;
        let voxels = samples.min(self.pixels.voxel.len());
        let blends = samples.min(self.pixels.blend.len());
        let (tiles, tiles_rest) = self.tiles.split_at_mut(rows * self.tiles_across);
        let (shown, shown_rest) = self.pixels.shown.split_at_mut(samples);
        let (voxel, voxel_rest) = self.pixels.voxel.split_at_mut(voxels);
        let (blend, blend_rest) = self.pixels.blend.split_at_mut(blends);
        let (width, color) = (self.pixels.width, self.pixels.color);
        let part = |bounds: Window, tiles, shown, voxel, blend| Self {
            tiles_across: self.tiles_across,
            bounds,
            tiles,
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
            part(upper, tiles, shown, voxel, blend),
            part(lower, tiles_rest, shown_rest, voxel_rest, blend_rest),
        )
    }
}

pub(super) fn run_bands<I: Isa>(
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

/// A band of a frame that is stopped stays undrawn.
fn run<I: Isa>(job: &Job<'_>, mut buffers: BandBuffers<'_>, isa: I) -> Counters {
    if job.stop.is_requested() {
        job.is_stopped.store(true, Ordering::Relaxed);
        return Counters::default();
    }
    let mut brick_blocks = BrickBlocks {
        exist: [0; 65],
        parts: [Parts::default(); 64],
        ready: 0,
        others: [0; 64],
        octant: 0,
    };
    buffers.pixels.clear();
    let fill = Fill::clear(buffers.tiles_across, buffers.bounds, buffers.tiles);
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
        candidates: Candidates([0; 64], [[[0; 8]; 8]; 3]),
        waiting: Waiting::none(),
        hits: [Hit::default(); 64],
        brick_blocks: &mut brick_blocks,
    };
    isa.vectorize(
        &mut band,
        (),
        #[inline(always)]
        |band, ()| {
            traversal::draw_object(band);
            band.waiting.show(&mut band.pixels);
        },
    );
    band.pixels.clear_open(&band.fill);
    band.counters
}
