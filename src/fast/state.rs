//! What the steps of the walk share: the band that is drawn, and what they hand to each other.

use super::canvas::{Fill, Pixels};
use super::counters::Counters;
use super::exact::Exact;
use super::lanes::{Found, Isa};
use super::parts::Parts;
use super::switches::Switches;
use super::view::View;
use super::window::Window;
use crate::graph::GraphView;

/// The walk over one band of the picture.
#[derive(Debug)]
pub(super) struct Walk<'w, I> {
    pub(super) isa: I,
    pub(super) view: &'w View,
    pub(super) exact: &'w Exact,
    pub(super) graph: &'w GraphView<'w>,
    pub(super) switches: &'w Switches,
    pub(super) fill: Fill<'w>,
    pub(super) pixels: Pixels<'w>,
    pub(super) counters: Counters,
    /// Whether voxels are blended.
    pub(super) blends: bool,
    /// How far a square's samples are from its first one in the picture.
    pub(super) places: [u32; 64],
    /// Parts by sample of the square that is worked on.
    pub(super) found: Found,
    /// What its samples show.
    pub(super) hits: [Hit; 64],
    /// The node that each of them shows; used only for bricks of four levels without blending.
    pub(super) nodes: [u32; 64],
    /// The blocks of the brick of four levels that is worked on.
    pub(super) blocks: &'w mut Blocks,
}

/// The blocks of a brick of four levels: its parts, with theirs.
#[derive(Debug)]
pub(super) struct Blocks {
    /// Which parts of each block exist. Blocks and parts are both in order of occlusion.
    pub(super) exist: [u64; 64],
    pub(super) parts: [Parts; 64],
}

impl Default for Blocks {
    fn default() -> Self {
        Self {
            exist: [0; 64],
            parts: [Parts::default(); 64],
        }
    }
}

/// A node whose turn has come.
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

/// Steps of the walk, each compiled as a whole for an instruction set: what is inlined into a step uses that set.
/// Declared here, below the steps that call each other through it; `compiled.rs` defines them.
pub(super) trait Compiled: Isa {
    /// A record's turn.
    fn turn(self, walk: &mut Walk<'_, Self>, record: &Record);
    /// Draws a brick of two levels, sample by sample.
    fn brick(self, walk: &mut Walk<'_, Self>, brick: Brick<'_>, window: &Window);
    /// Draws a brick of four levels, sample by sample.
    fn deep_brick(self, walk: &mut Walk<'_, Self>, brick: Brick<'_>, window: &Window);
    /// Draws a brick, or a solid, voxel by voxel.
    fn voxels(self, walk: &mut Walk<'_, Self>, brick: Brick<'_>, window: &Window);
}
