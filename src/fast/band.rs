//! The state of a band: the rows of the picture that one task draws.

use super::Switches;
use super::canvas::{Fill, Pixels};
use super::constants::Constants;
use super::counters::Counters;
use super::exact::Exact;
use super::parts::Parts;
use super::strips::Candidates;
use super::waiting::Waiting;
use crate::graph::GraphView;

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
    pub(super) blends: bool,
    pub(super) sample_offsets: [u32; 64],
    pub(super) candidates: Candidates,
    pub(super) waiting: Waiting,
    /// By sample.
    pub(super) hits: [Hit; 64],
    pub(super) brick_blocks: &'b mut BrickBlocks,
}

#[derive(Debug)]
pub(super) struct BrickBlocks {
    /// Masks of the parts of each block, and of no block. Blocks and parts are both in order of occlusion.
    pub(super) exist: [u64; 65],
    pub(super) parts: [Parts; 64],
    /// Those that were read, for lines of an octant.
    pub(super) ready: u64,
    /// By sample, those that its line may meet and that were not looked at.
    pub(super) others: [u64; 64],
    pub(super) octant: u8,
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Record {
    pub(super) node: u32,
    pub(super) level: u32,
    pub(super) min: [i32; 3],
    pub(super) centre: [f64; 3],
}

#[inline(always)]
pub(super) fn voxel_at(min: [i32; 3], level: u32) -> [i32; 4] {
    [min[0], min[1], min[2], level as i32]
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Brick<'b> {
    pub(super) record: &'b Record,
    pub(super) parts: &'b Parts,
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Hit {
    /// The block, in order of occlusion; no meaning in bricks of two levels.
    pub(super) block: u8,
    pub(super) part: u8,
}
