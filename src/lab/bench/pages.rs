//! Pages of a mapped file: what a first frame costs that reads those that it
//! needs, and what it would cost to read all of them before.

use std::hint::black_box;
use std::path::Path;

use super::clock::{Clock, Elapsed};
use super::harness::{BenchError, Measured, Schedule};
use super::statistics::Summary;
use crate::frame::{Colors, Frame};
use crate::graph::{Graph, vxg};
use crate::project::{Engine, FrameSetup, Stats};

/// Name of the counter of pages that the process holds after a frame.
pub(super) const RESIDENT: &str = "pages_resident";

/// Whether all pages are read first; what tables call it, and what it means.
pub(super) const VARIANTS: [(bool, &str, &str); 2] = [
    (
        false,
        "first frame of the file",
        "the file is mapped anew before each frame, so that the frame finds none of its pages; what the next row is compared with",
    ),
    (
        true,
        "first frame, all pages read",
        "the same, and a byte of every page of the file is read before; the picture must be the same",
    ),
];

/// The smallest page there is: of larger ones several bytes are read.
const PAGE_BYTES: usize = 4096;

/// What first frames of a file took, and what they show.
pub(super) struct FirstFrames {
    /// Times, and pages after the last.
    pub(super) measured: Measured,
    /// The voxels seen.
    pub(super) voxels: Vec<[i32; 4]>,
}

/// Draws the first frame of a file, so many times, and then a frame with its
/// voxels, which is not timed. `None`: the file cannot be mapped any more.
///
/// # Errors
/// When the engine does not finish.
pub(super) fn measure(
    file: &Path,
    setup: &FrameSetup,
    engine: &mut dyn Engine,
    reads_all: bool,
    schedule: Schedule,
) -> Result<Option<FirstFrames>, BenchError> {
    let failed = |source| BenchError::Engine {
        who: file.display().to_string(),
        source,
    };
    let mut colors = Colors::new(setup.width, setup.height);
    colors.words.fill(1);
    let mut times: Vec<Elapsed> = Vec::new();
    let mut counters = Stats::new();
    for round in 0..schedule.warmup + schedule.runs.max(1) {
        let Ok(graph) = vxg::open(file) else {
            return Ok(None);
        };
        let clock = Clock::start();
        if reads_all {
            black_box(sum_of_pages(&graph));
        }
        let drawn = engine.draw_colors(&graph.view(), &graph.color, setup, &mut colors);
        black_box(colors.words.as_slice());
        let elapsed = clock.elapsed();
        drawn.map_err(failed)?;
        if round >= schedule.warmup {
            times.push(elapsed);
        }
        counters = graph.mapped_pages().map_or_else(Stats::new, |pages| {
            vec![("pages_mapped", pages.mapped), (RESIDENT, pages.resident)]
        });
    }
    let wall: Vec<f64> = times.iter().map(|t| t.wall_ms).collect();
    let thread: Option<Vec<f64>> = times.iter().map(|t| t.thread_ms).collect();
    let measured = Measured {
        wall: Summary::of(&wall),
        thread: thread.map(|thread| Summary::of(&thread)),
        counters,
    };
    let Ok(graph) = vxg::open(file) else {
        return Ok(None);
    };
    let mut frame = Frame::new(setup.width, setup.height, false);
    let drawn = engine.draw(&graph.view(), setup, &mut frame);
    drawn.map_err(failed)?;
    Ok(Some(FirstFrames {
        measured,
        voxels: frame.voxel,
    }))
}

/// Reads a byte of every page of a graph's arrays.
fn sum_of_pages(graph: &Graph) -> u64 {
    let arrays: [&[u8]; 5] = [
        &graph.mask,
        bytemuck::cast_slice(&graph.first),
        bytemuck::cast_slice(&graph.links),
        bytemuck::cast_slice(&graph.color),
        bytemuck::cast_slice(&graph.normal),
    ];
    let of = |array: &[u8]| {
        let bytes = array.iter().step_by(PAGE_BYTES).chain(array.last());
        bytes.map(|&byte| u64::from(byte)).sum::<u64>()
    };
    arrays.into_iter().map(of).sum()
}
