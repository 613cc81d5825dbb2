//! A band of the picture while it is drawn: what the steps of the traversal share and pass on to
//! each other.

use super::canvas::{Fill, Pixels};
use super::constants::Constants;
use super::counters::Counters;
use super::exact::Exact;
use super::lanes::{Candidates, Isa};
use super::parts::Parts;
use super::switches::Switches;
use super::window::Window;
use crate::graph::GraphView;

/// A band of the picture while it is drawn.
#[derive(Debug)]
pub(super) struct Band<'b, I> {
    pub(super) isa: I,
    pub(super) constants: &'b Constants,
    pub(super) exact: &'b Exact,
    pub(super) graph: &'b GraphView<'b>,
    pub(super) switches: &'b Switches,
    pub(super) fill: Fill<'b>,
    pub(super) pixels: Pixels<'b>,
    pub(super) counters: Counters,
    /// Whether voxels are blended.
    pub(super) blends: bool,
    /// By sample of a square: how many entries of the picture it lies behind the square's first
    /// sample.
    pub(super) sample_offsets: [u32; 64],
    /// By sample of the current square: the parts that its line may meet.
    pub(super) candidates: Candidates,
    /// What the samples of the current square show.
    pub(super) hits: [Hit; 64],
    /// The node that each of them shows; used only for bricks of four levels without blending.
    pub(super) nodes: [u32; 64],
    /// The blocks of the current brick of four levels.
    pub(super) brick_blocks: &'b mut BrickBlocks,
}

/// The blocks of a brick of four levels: its parts, with theirs.
#[derive(Debug)]
pub(super) struct BrickBlocks {
    /// Which parts of each block exist. Blocks and parts are both in order of occlusion.
    pub(super) exist: [u64; 64],
    pub(super) parts: [Parts; 64],
}

impl Default for BrickBlocks {
    fn default() -> Self {
        Self {
            exist: [0; 64],
            parts: [Parts::default(); 64],
        }
    }
}

/// A node at its place in the object: the unit of work above bricks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Record {
    pub(super) node: u32,
    pub(super) level: u32,
    /// Lowest corner, finest voxels.
    pub(super) min: [i32; 3],
    /// Clip vector (X, Y, W) of the centre.
    pub(super) centre: [f64; 3],
}

/// What a picture shows of a voxel: its lowest corner, and its level.
#[inline(always)]
pub(super) fn voxel_at(min: [i32; 3], level: u32) -> [i32; 4] {
    [min[0], min[1], min[2], level as i32]
}

/// A node that is drawn in one step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Brick<'b> {
    pub(super) record: &'b Record,
    pub(super) parts: &'b Parts,
}

/// What a sample of a square shows of a brick.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Hit {
    /// The sample.
    pub(super) bit: u8,
    /// The block, in order of occlusion; of bricks of two levels nothing.
    pub(super) block: u8,
    /// The part.
    pub(super) part: u8,
}

/// Steps of the traversal, each compiled as a whole for an instruction set: what is inlined into a
/// step uses that set.
/// Declared here, below the steps that call each other through it; `compiled.rs` defines them.
pub(super) trait Compiled: Isa {
    /// Visits the children of a record, nearest first.
    fn visit_children(self, band: &mut Band<'_, Self>, record: &Record);
    /// Draws a brick of two levels, sample by sample.
    fn brick(self, band: &mut Band<'_, Self>, brick: Brick<'_>, window: &Window);
    /// Draws a brick of four levels, sample by sample.
    fn deep_brick(self, band: &mut Band<'_, Self>, brick: Brick<'_>, window: &Window);
    /// Draws a brick, or a solid, voxel by voxel.
    fn voxels(self, band: &mut Band<'_, Self>, brick: Brick<'_>, window: &Window);
}
