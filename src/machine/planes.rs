//! Exact coverage (`SPEC.md`, R8): silhouettes of cubes in clip space.
//!
//! A ray meets the inside of a cube exactly if for each axis j the four edges along j do not all pass on one side of it.
//! The plane through the eye and the edge from corner `A` along `e_j` has the normal `A x e_j`. Moving the edge adds a
//! constant of the object, so children's planes follow by shifts and adds.

use hwmodel::{Datapath, Probe, Short, WideWord, Word};

use super::blocks::{Block, LEVEL_BITS};
use super::constants::Constants;
use super::levels;
use super::record::{Cube, Planes};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    /// On both, or not known yet.
    Both,
    Positive,
    Negative,
    /// A degenerate edge, whose line contains the eye.
    Nowhere,
}

impl Side {
    /// 0 both, 1 positive, 2 negative, 3 nowhere.
    #[inline]
    fn wires(self) -> Short {
        Short::unsigned(self as u8, 2)
    }
}

/// The function `a x + b y + c` over a node, `x` and `y` from 0 to 1.
#[derive(Debug, Clone, Copy)]
struct Plane {
    ab: [WideWord; 2],
    c: WideWord,
    /// Least and greatest of `a x + b y` over the node.
    least: WideWord,
    greatest: WideWord,
    side: Side,
}

impl Plane {
    fn new<P: Probe>(dp: &mut Datapath<P>, [a, b, c]: [WideWord; 3]) -> Self {
        let mut sum = |pick: fn(&mut Datapath<P>, WideWord, WideWord) -> WideWord| {
            let a = pick(dp, a, WideWord::ZERO);
            let b = pick(dp, b, WideWord::ZERO);
            dp.add(a, b)
        };
        let least = sum(Datapath::min);
        let greatest = sum(Datapath::max);
        let none = dp.is_zero(a) && dp.is_zero(b) && dp.is_zero(c);
        Self {
            ab: [a, b],
            c,
            least,
            greatest,
            side: if none { Side::Nowhere } else { Side::Both },
        }
    }

    /// Finds the side of the node's samples, which lie strictly inside it.
    fn resolve<P: Probe>(&mut self, dp: &mut Datapath<P>, below: u32) {
        if self.side != Side::Both {
            return;
        }
        let low = dp.add(self.c, self.least);
        let high = dp.add(self.c, self.greatest);
        if !dp.is_negative(low) {
            // At most zero on the node's border, unless the function is constant.
            self.side = if dp.is_zero(low) && dp.is_zero(high) {
                Side::Nowhere
            } else {
                Side::Positive
            };
        } else if !dp.is_positive(high) {
            self.side = Side::Negative;
        } else if below == 0 {
            self.side = self.of_sample(dp);
        }
        let plane = (self.ab, self.c, below == 0);
        dp.tap(Block::PlaneSide, &plane, &self.side.wires());
    }

    /// The side of the node's middle. A tie (R8.1) is decided for a point an infinitesimal right of it, and a smaller one
    /// below.
    fn of_sample<P: Probe>(&self, dp: &mut Datapath<P>) -> Side {
        let [a, b] = self.ab;
        let doubled = dp.shl(self.c, 1);
        let with_a = dp.add(doubled, a);
        let value = dp.add(with_a, b);
        for number in [value, a, b] {
            if dp.is_negative(number) {
                return Side::Negative;
            }
            if !dp.is_zero(number) {
                return Side::Positive;
            }
        }
        Side::Nowhere
    }

    fn in_quadrant<P: Probe>(&self, dp: &mut Datapath<P>, quadrant: u8) -> Self {
        if self.side != Side::Both {
            return *self;
        }
        Self {
            c: constant_in_quadrant(dp, self.ab, self.c, quadrant),
            ..*self
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cover {
    None,
    Some,
    All,
}

impl Cover {
    #[inline]
    fn wires(self) -> Short {
        Short::unsigned(self as u8, 2)
    }
}

/// The silhouette of a cube, relative to a quadtree node.
#[derive(Debug, Clone)]
pub(super) struct Silhouette {
    /// By direction, the planes of the four edges along it.
    edges: [[Plane; 4]; 3],
    /// Of a cube that is not wholly before the eye: a plane across an axis, and the side on which rays reach the cube, not
    /// its mirror image.
    front: Option<(Plane, Side)>,
}

impl Silhouette {
    /// Of a cube at most as deep as the finest voxels, whose least depth is `w_min`.
    pub(super) fn new<P: Probe>(
        dp: &mut Datapath<P>,
        constants: &Constants,
        cube: &Cube,
        planes: &Planes,
        w_min: Word,
    ) -> Self {
        let is_before_eye = dp.is_positive(w_min);
        let side_shift = levels::above(dp, cube.level, constants.depth);
        // By axis: the change of a plane when its edge moves one side.
        let across = [0, 1, 2].map(|l| {
            let axis = axis_plane(constants, planes, l);
            axis.map(|v| dp.shl(v, side_shift))
        });
        let edges = [0, 1, 2].map(|j| {
            let (k, l) = ((j + 1) % 3, (j + 2) % 3); // host: an index
            let here = planes.edge[j];
            // (A + E_k) x e_j = A x e_j - E_j x e_k, and E_l x e_j = E_k-plane.
            let moved_k = combine(dp, here, across[l], false);
            let moved_l = combine(dp, here, across[k], true);
            let moved_both = combine(dp, moved_k, across[k], true);
            [here, moved_k, moved_l, moved_both]
        });
        let side = Short::unsigned(side_shift, LEVEL_BITS);
        let axes = (constants.axis_ab, planes.axis_c);
        dp.tap(Block::CubePlanes, &(planes.edge, axes, side), &edges);
        let edges = edges.map(|planes| planes.map(|plane| Plane::new(dp, plane)));
        let front = if is_before_eye {
            None
        } else {
            Self::front(dp, constants, cube, planes)
        };
        Self { edges, front }
    }

    /// Plane of the eye (R8.2): the rays towards a cube along an axis on which the eye is outside. `None`: the cube
    /// contains the eye.
    fn front<P: Probe>(
        dp: &mut Datapath<P>,
        constants: &Constants,
        cube: &Cube,
        planes: &Planes,
    ) -> Option<(Plane, Side)> {
        let mut front = None;
        for axis in 0..3 {
            let upwards = dp.le(constants.eye_ceil[axis], cube.min[axis]);
            let downwards = dp.le(cube.max[axis], constants.eye_floor[axis]);
            if upwards || downwards {
                let plane = Plane::new(dp, axis_plane(constants, planes, axis));
                let side = if upwards == constants.positive {
                    Side::Positive
                } else {
                    Side::Negative
                };
                front = Some((axis, plane, side));
                break;
            }
        }
        let eye = (constants.eye_floor, constants.eye_ceil);
        let (axis, side) = front.map_or((0, Side::Both), |(axis, _, side)| (axis as u8, side));
        dp.tap(
            Block::CubeFront,
            &(cube.min, cube.max, eye, constants.positive),
            &(front.is_some(), Short::unsigned(axis, 2), side.wires()),
        );
        front.map(|(_, plane, side)| (plane, side))
    }

    fn resolve<P: Probe>(&mut self, dp: &mut Datapath<P>, below: u32) -> Cover {
        let mut all = true;
        for edges in &mut self.edges {
            let (mut positive, mut negative, mut open) = (false, false, false);
            for plane in edges {
                plane.resolve(dp, below);
                positive |= plane.side == Side::Positive;
                negative |= plane.side == Side::Negative;
                open |= plane.side == Side::Both;
            }
            if !(positive && negative) {
                if !open {
                    return Cover::None;
                }
                all = false;
            }
        }
        if let Some((plane, side)) = &mut self.front {
            plane.resolve(dp, below);
            if plane.side == Side::Both {
                all = false;
            } else if plane.side != *side {
                return Cover::None;
            }
        }
        if all { Cover::All } else { Cover::Some }
    }

    /// The cover of the node, `below` levels above the samples; never [`Cover::Some`] for a sample (`below` = 0).
    #[inline]
    pub(super) fn cover<P: Probe>(&mut self, dp: &mut Datapath<P>, below: u32) -> Cover {
        let cover = self.resolve(dp, below);
        let sides = self
            .edges
            .map(|planes| planes.map(|plane| plane.side.wires()));
        let front = self
            .front
            .map_or((Side::Both, Side::Both), |(plane, side)| (plane.side, side));
        let front = (self.front.is_some(), front.0.wires(), front.1.wires());
        dp.tap(Block::PlaneCover, &(sides, front), &cover.wires());
        cover
    }

    /// Relative to a quadrant (`y << 1 | x`) of the node.
    pub(super) fn in_quadrant<P: Probe>(&self, dp: &mut Datapath<P>, quadrant: u8) -> Self {
        Self {
            edges: std::array::from_fn(|j| {
                std::array::from_fn(|e| self.edges[j][e].in_quadrant(dp, quadrant))
            }),
            front: self
                .front
                .map(|(plane, side)| (plane.in_quadrant(dp, quadrant), side)),
        }
    }
}

fn axis_plane(constants: &Constants, planes: &Planes, axis: usize) -> [WideWord; 3] {
    let [a, b] = constants.axis_ab[axis];
    [a, b, planes.axis_c[axis]]
}

fn combine<P: Probe>(
    dp: &mut Datapath<P>,
    a: [WideWord; 3],
    b: [WideWord; 3],
    add: bool,
) -> [WideWord; 3] {
    std::array::from_fn(|i| {
        if add {
            dp.add(a[i], b[i])
        } else {
            dp.sub(a[i], b[i])
        }
    })
}

/// Moved by half a side along each axis whose bit the octant has.
pub(super) fn of_child<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    parent: &Planes,
    parent_level: u32,
    octant: u8,
) -> Planes {
    let mut planes = *parent;
    move_edges(dp, constants, &mut planes, (parent_level, octant), true);
    let axes = (constants.axis_ab, parent.axis_c);
    let half = Short::unsigned(constants.depth - parent_level - 1, LEVEL_BITS);
    let stimulus = (parent.edge, axes, half, Short::unsigned(octant, 3));
    dp.tap(Block::ChildPlanes, &stimulus, &planes.edge);
    planes
}

/// Moves the planes of edges from a parent to its child in an octant, or back.
pub(super) fn move_edges<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    planes: &mut Planes,
    (parent_level, octant): (u32, u8),
    to_child: bool,
) {
    let half_shift = levels::above(dp, parent_level + 1, constants.depth);
    for j in 0..3 {
        let (k, l) = ((j + 1) % 3, (j + 2) % 3); // host: an index
        for (axis, of, add) in [(k, l, !to_child), (l, k, to_child)] {
            if octant >> (2 - axis) & 1 != 0 {
                let across = axis_plane(constants, planes, of).map(|v| dp.shl(v, half_shift));
                planes.edge[j] = combine(dp, planes.edge[j], across, add);
            }
        }
    }
}

pub(super) fn move_out_of_quadrant<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    planes: &mut Planes,
    quadrant: u8,
) {
    each_constant(constants, planes, |[a, b], mut c| {
        if quadrant & 1 != 0 {
            c = dp.sub(c, a);
        }
        if quadrant & 2 != 0 {
            c = dp.sub(c, b);
        }
        dp.shr(c, 1)
    });
}

pub(super) fn move_to_quadrant<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    planes: &mut Planes,
    quadrant: u8,
) {
    each_constant(constants, planes, |ab, c| {
        constant_in_quadrant(dp, ab, c, quadrant)
    });
}

fn each_constant(
    constants: &Constants,
    planes: &mut Planes,
    mut replaced: impl FnMut([WideWord; 2], WideWord) -> WideWord,
) {
    for [a, b, c] in &mut planes.edge {
        *c = replaced([*a, *b], *c);
    }
    for (c, &ab) in planes.axis_c.iter_mut().zip(&constants.axis_ab) {
        *c = replaced(ab, *c);
    }
}

/// The constant of `a x + b y + c` in a quadrant's own coordinates, where the function is doubled.
#[inline]
fn constant_in_quadrant<P: Probe>(
    dp: &mut Datapath<P>,
    [a, b]: [WideWord; 2],
    c: WideWord,
    quadrant: u8,
) -> WideWord {
    let mut to = dp.shl(c, 1);
    if quadrant & 1 != 0 {
        to = dp.add(to, a);
    }
    if quadrant & 2 != 0 {
        to = dp.add(to, b);
    }
    let quadrant = Short::unsigned(quadrant, 2);
    dp.tap(Block::PlaneQuadrant, &([a, b], c, quadrant), &to);
    to
}
