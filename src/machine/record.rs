//! The record: a cube on the machine's stack (image-order paper, 2.4).

use hwmodel::{Short, Signal, WideWord, Wires, Word};

use super::blocks::{ADDRESS_BITS, LEVEL_BITS, NODE_BITS};
use super::cage::CageCoordinate;
use crate::frame::QuadNode;

/// A cube of object space, the place of its box in the image, and its projected vertices.
#[derive(Debug, Clone, Copy)]
pub(super) struct Record<L> {
    pub(super) cube: Cube,
    pub(super) place: ImagePlace,
    pub(super) pose: Pose<L>,
}

/// A cube of object space: an octree node, or a part of a solid one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cube {
    /// Lowest vertex in object space, units of `2^-sub_levels` finest voxels.
    pub(super) min: [Word; 3],
    pub(super) max: [Word; 3],
    /// Octree node; a part of a solid keeps the solid's.
    pub(super) node: u32,
    pub(super) level: u32,
    /// Level of the voxel of which this is a part.
    pub(super) voxel_level: u32,
    /// Whether this is a solid voxel or a part of one.
    pub(super) solid: bool,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct ImagePlace {
    pub(super) quad: QuadNode,
    /// Otherwise the box leaves the picture where it leaves the node.
    pub(super) inside: bool,
}

impl ImagePlace {
    pub(super) const ROOT: Self = Self {
        quad: QuadNode::ROOT,
        inside: false,
    };
}

/// A cube that may become a record.
#[derive(Debug, Clone, Copy)]
pub(super) struct Child {
    pub(super) cube: Cube,
    /// Its parent's, where the search for its own begins.
    pub(super) from: ImagePlace,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Pose<L> {
    /// Exact. Only the rules that draw outlines use the planes.
    Clip(Clip<L>, Planes),
    /// An approximation, under the rules that draw single samples (`any`, `center`).
    Screen(Screen<L>),
}

/// Relative to the quadtree node: 0 is its left (upper) edge, `w` its right (lower) one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clip<L> {
    pub(super) x: L,
    pub(super) y: L,
    pub(super) w: L,
    /// Least depth.
    pub(super) w_min: Word,
}

/// Samples from the picture's top left, with the format's fraction bits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Screen<L> {
    pub(super) x: L,
    pub(super) y: L,
    pub(super) spans: Spans,
}

/// Least and greatest x, least and greatest y.
pub(super) type Spans = [(Word, Word); 2];

/// Silhouette planes of a cube (`SPEC.md`, R8): functions `a x + b y + c`, `x` and `y` from 0 to 1 across the quadtree
/// node.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Planes {
    /// By j: through the eye and the edge that leaves the lowest corner along j.
    pub(super) edge: [[WideWord; 3]; 3],
    /// By axis: `c` of the plane through the eye across it.
    pub(super) axis_c: [WideWord; 3],
}

/// Zeros where the pose has no such field.
impl<L: CageCoordinate> Wires for Record<L> {
    fn show(&self, to: &mut Vec<Signal>) {
        let (cube, quad) = (&self.cube, &self.place.quad);
        let in_screen_space = matches!(self.pose, Pose::Screen(_));
        let levels = [cube.level, cube.voxel_level, quad.level];
        let nothing = Spans::default();
        ([cube.solid, self.place.inside, in_screen_space]).show(to);
        levels
            .map(|level| Short::unsigned(level, LEVEL_BITS))
            .show(to);
        Short::unsigned(cube.node, ADDRESS_BITS).show(to);
        [quad.x, quad.y]
            .map(|place| Short::unsigned(place, NODE_BITS))
            .show(to);
        (cube.min, cube.max).show(to);
        match &self.pose {
            Pose::Clip(clip, planes) => {
                (&clip.x, &clip.y, &clip.w, clip.w_min).show(to);
                (nothing, planes.edge, planes.axis_c).show(to);
            }
            Pose::Screen(screen) => {
                let none = screen.x.map(|_| Word::ZERO);
                (&screen.x, &screen.y, none, Word::ZERO).show(to);
                let planes = Planes::default();
                (screen.spans, planes.edge, planes.axis_c).show(to);
            }
        }
    }
}
