//! The record: what the machine keeps of a voxel on its stack (paper, 2.4).

use hwmodel::{WideWord, Word};

use super::fit::Place;
use crate::frame::QuadNode;

/// A voxel's projected vertices.
#[derive(Debug, Clone, Copy)]
pub(super) enum Pose<L> {
    /// In clip space, exact; `x` and `y` are relative to the record's
    /// quadtree node: 0 is its left (upper) edge, `w` its right (lower) one.
    /// The planes are in use under the exact rule.
    Clip(Clip<L>, Planes),
    /// In screen space, an approximation, of the rules that draw single
    /// samples; whole-picture samples with the format's fraction bits.
    Screen(Screen<L>),
}

/// Vertices in clip space.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clip<L> {
    pub(super) x: L,
    pub(super) y: L,
    pub(super) w: L,
    /// The least depth of the eight vertices.
    pub(super) w_min: Word,
}

/// Vertices in screen space, and the box around them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Screen<L> {
    pub(super) x: L,
    pub(super) y: L,
    pub(super) spans: Spans,
}

/// Least and greatest x, least and greatest y, in screen space.
pub(super) type Spans = [(Word, Word); 2];

/// Silhouette planes of a clip-space voxel under the exact rule
/// (`SPEC.md`, "Exact coverage"); relative to the quadtree node: a function
/// `a x + b y + c` with `x`, `y` from 0 to 1 across the node.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Planes {
    /// By edge direction j: the plane through the eye and the edge that
    /// leaves the lowest corner along j.
    pub(super) edge: [[WideWord; 3]; 3],
    /// By axis l: the constant `c` of the plane through the eye that is
    /// perpendicular to axis l. `a` and `b` are the same for all records.
    pub(super) axis_c: [WideWord; 3],
}

/// An entry of the stack.
#[derive(Debug, Clone, Copy)]
pub(super) struct Record<L> {
    /// Lowest vertex in object space, units of `2^-sub_levels` voxels.
    pub(super) min: [Word; 3],
    /// Highest vertex in object space.
    pub(super) max: [Word; 3],
    /// Octree node.
    pub(super) node: u32,
    /// Octree level, 0 = root.
    pub(super) level: u32,
    /// Level of the voxel that this is a part of: differs from `level`
    /// inside a solid, whose node points to itself.
    pub(super) voxel_level: u32,
    /// Whether this is (a part of) a solid voxel.
    pub(super) solid: bool,
    /// Quadtree node.
    pub(super) quad: QuadNode,
    /// Whether the box lies inside the quadtree node. If not, it leaves the
    /// picture's root where it leaves the node.
    pub(super) inside: bool,
    /// Projected vertices.
    pub(super) pose: Pose<L>,
}

impl<L> Record<L> {
    /// Where it is in the image.
    #[inline]
    pub(super) fn place(&self) -> Place {
        Place {
            quad: self.quad,
            inside: self.inside,
        }
    }
}
