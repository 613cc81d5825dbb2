//! The image-order paper's claim that cost follows the picture's pixels and not the
//! object: the same object in growing pictures, growing objects in one picture.

use hwmodel::{OpClass, Overflow};
use rayon::prelude::*;
use serde::Serialize;

use super::{ModelError, frame};
use shiftvox::graph::{Graph, Progress};
use shiftvox::project::{Camera, FrameSetup, SetupOptions};

/// One picture of one object.
#[derive(Debug, Clone, Serialize)]
pub struct GrowthRow {
    /// The object.
    pub object: String,
    /// Its finest voxels.
    pub voxels: u64,
    /// Pixels of the picture.
    pub pixels: u64,
    /// Samples that show something.
    pub drawn: u64,
    /// Records that had their turn.
    pub records: u64,
    /// Operations, but for shifts.
    pub operations: u64,
    /// Node reads.
    pub node_reads: u64,
    /// Operations in stage *octant and order* for each subdivided record: the
    /// same number everywhere, if ordering takes constant time.
    pub order_operations: f64,
}

/// Counts one picture.
///
/// # Errors
/// When the frame cannot be set up or drawn.
pub fn row(
    object: &str,
    graph: &Graph,
    camera: &Camera,
    side: u32,
    options: &SetupOptions,
) -> Result<GrowthRow, ModelError> {
    let camera = Camera {
        width: side,
        height: side,
        ..*camera
    };
    let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, options)?;
    let (frame, counter, stats) = frame::count_operations(&graph.view(), &setup, Overflow::Trap)?;
    let subdivided = stats.iter().find(|(name, _)| *name == "subdivided");
    let subdivided = subdivided.map_or(0, |&(_, count)| count);
    let ordering = counter.sum(|cell| cell.stage == hwmodel::Stage::Order);
    Ok(GrowthRow {
        object: object.to_owned(),
        voxels: graph.voxels,
        pixels: u64::from(side) * u64::from(side),
        drawn: frame.drawn() as u64,
        records: counter.records(),
        operations: counter.ops() - counter.ops_of(OpClass::Shift),
        node_reads: counter.reads(hwmodel::Memory::Node),
        order_operations: ordering as f64 / subdivided.max(1) as f64,
    })
}

/// One object in pictures of growing size.
///
/// # Errors
/// When a frame cannot be set up or drawn.
pub fn pictures(
    object: &str,
    graph: &Graph,
    camera: &Camera,
    sides: &[u32],
    options: &SetupOptions,
    progress: &dyn Progress,
) -> Result<Vec<GrowthRow>, ModelError> {
    progress.begin("growing pictures", sides.len() as u64);
    let rows = sides
        .par_iter()
        .map(|&side| {
            let row = row(object, graph, camera, side, options);
            progress.advance(1);
            row
        })
        .collect();
    progress.end();
    rows
}
