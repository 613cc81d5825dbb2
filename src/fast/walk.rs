//! What the turns of a walk share: the frame's constants, the graph, the
//! picture in the making.

use super::alpha::Aim;
use super::canvas::{Fill, Pixels};
use super::counters::Counters;
use super::planes::Exact;
use super::switches::Switches;
use super::tables::Tables;
use super::view::View;
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
    /// The band's samples as lanes.
    pub(super) bounds: Bounds,
    pub(super) counters: Counters,
    /// Tables of the subtree that is worked on.
    pub(super) tables: Tables,
    /// The shares of the sides of what is drawn, under the rule that blends.
    pub(super) aim: Aim,
    /// Samples of a square, and the lanes that were found there.
    pub(super) found: [(u32, u64); 64],
    /// Set where a subtree has numbers that do not fit the lanes; the frame is
    /// then of no use.
    pub(super) is_lost: bool,
}

/// What windows are cut to: first column and row, last column and row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    pub(super) least: [i32; 4],
    pub(super) greatest: [i32; 4],
    /// Tiles from one row of tiles to the next.
    pub(super) tiles_across: i32,
    /// Place of the band's first tile in the whole picture.
    pub(super) first_tile: i32,
}

impl Bounds {
    pub(super) fn new(fill: &Fill<'_>) -> Self {
        let window = &fill.bounds;
        let (tiles_across, first_tile) = fill.place_of_tiles();
        Self {
            least: [window.left, window.top, i32::MIN, i32::MIN],
            greatest: [i32::MAX, i32::MAX, window.right, window.bottom],
            tiles_across,
            first_tile,
        }
    }
}

/// What a picture shows of a voxel: the lowest corner of the cell of this
/// octree level that holds `min`, and the level.
#[inline(always)]
pub(super) fn voxel_at(min: [i32; 3], level: u32) -> [i32; 4] {
    [min[0], min[1], min[2], level as i32]
}
