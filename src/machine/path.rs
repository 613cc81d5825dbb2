//! Restores a record's ancestor from the record. Under the rules that draw outlines every step down can be undone
//! exactly: edges were halved without a remainder, since no record is finer than the finest voxels.

use hwmodel::{Datapath, OpClass, Probe, Short, Signal, Wires};

use super::blocks::LEVEL_BITS;
use super::cage::CageCoordinate;
use super::constants::Constants;
use super::levels;
use super::planes;
use super::record::{Clip, Cube, ImagePlace, Planes, Pose, Record};

/// A parent's entry on the stack.
#[derive(Debug, Clone, Copy)]
pub(super) struct PathEntry {
    /// Octree node; in hardware with its mask and first child.
    pub(super) node: u32,
    pub(super) level: u32,
    /// The level of its quadtree node, which contains its descendants'.
    pub(super) quad_level: u32,
    /// [`ImagePlace::inside`].
    pub(super) inside: bool,
    /// Remaining children, one bit per place in the order.
    pub(super) left: u8,
}

/// The fields except the node.
impl Wires for PathEntry {
    fn show(&self, to: &mut Vec<Signal>) {
        Short::unsigned(self.left, 8).show(to);
        [self.level, self.quad_level]
            .map(|level| Short::unsigned(level, LEVEL_BITS))
            .show(to);
        self.inside.show(to);
    }
}

/// A stored entry's record, from one of its descendants.
pub(super) fn back<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    entry: &PathEntry,
    from: &Record<L>,
) -> Record<L> {
    let Pose::Clip(mut clip, mut planes) = from.pose else {
        unreachable!("`FrameSetup::screen_depth` lets no record change under these rules");
    };
    let mut quad = from.place.quad;
    while !levels::reaches(dp, entry.quad_level, quad.level) {
        out_of_quadrant(dp, constants, &mut clip, &mut planes, quad.in_parent());
        // Hardware undoes one level at a time, of the picture or of the octree.
        dp.next_step(0);
        quad = levels::up(dp, quad);
    }
    let mut min = from.cube.min;
    for level in (entry.level..from.cube.level).rev() {
        // The child's octant is in its lowest vertex: wires.
        let place = constants.depth + constants.sub_levels - level - 1;
        let octant = (0..3).fold(0u8, |bits, k| bits << 1 | u8::from(dp.bit(min[k], place)));
        for coordinate in [&mut clip.x, &mut clip.y, &mut clip.w] {
            *coordinate = coordinate.of_parent(dp, octant);
        }
        planes::move_edges(dp, constants, &mut planes, (level, octant), false);
        min = min.map(|corner| dp.without_bit(corner, place));
        dp.control(OpClass::Sub, LEVEL_BITS);
        if !levels::reaches(dp, entry.level, level) {
            dp.next_step(0);
        }
    }
    let side = levels::above(dp, entry.level, constants.depth + constants.sub_levels);
    let side = dp.load(1i64 << side);
    (clip.w_min, _) = clip.w.span(dp);
    Record {
        cube: Cube {
            min,
            max: min.map(|corner| dp.add(corner, side)),
            node: entry.node,
            level: entry.level,
            voxel_level: entry.level,
            solid: false,
        },
        place: ImagePlace {
            quad,
            inside: entry.inside,
        },
        pose: Pose::Clip(clip, planes),
    }
}

fn out_of_quadrant<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    clip: &mut Clip<L>,
    planes: &mut Planes,
    quadrant: u8,
) {
    let w = clip.w;
    let mut undo = |is_far: bool, x: &L| {
        let doubled = if is_far {
            x.zip(&w, |x, w| dp.add(x, w))
        } else {
            *x
        };
        doubled.map(|x| dp.shr(x, 1))
    };
    (clip.x, clip.y) = (
        undo(quadrant & 1 != 0, &clip.x),
        undo(quadrant & 2 != 0, &clip.y),
    );
    planes::move_out_of_quadrant(dp, constants, planes, quadrant);
}
