//! Silhouettes in clip space, exact (`SPEC.md`, "Exact coverage").
//!
//! A ray meets a cube's inside exactly if for each axis j, of the four edges
//! along j, some pass on either side of it. The plane through the eye and the
//! edge from `A` along `e_j` has the normal `A x e_j`; moving the edge by
//! another edge adds a constant of the object. So the planes go down the
//! octree by shifts and adds of constants, and down the quadtree by
//! `c' = 2c + bx a + by b`.

use hwmodel::{Datapath, Probe, Short, WideWord, Word};

use super::constants::Constants;
use super::fit::rebased;
use super::record::Planes;
use super::taps::{Block, LEVEL_BITS};

/// On which side of a plane all samples of a node are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    /// Not all on one.
    Both,
    Positive,
    Negative,
    /// The plane is none: the edge's line holds the eye. It counts for neither.
    Nowhere,
}

impl Side {
    /// On two wires: 0 both, 1 positive, 2 negative, 3 nowhere.
    #[inline]
    fn wires(self) -> Short {
        Short::unsigned(self as u8, 2)
    }
}

/// `a x + b y + c` over a node, `x` and `y` from 0 to 1.
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

    /// Finds the side of a node's samples, which lie strictly inside it.
    fn resolve<P: Probe>(&mut self, dp: &mut Datapath<P>, below: u32) {
        if self.side != Side::Both {
            return;
        }
        let low = dp.add(self.c, self.least);
        let high = dp.add(self.c, self.greatest);
        if !dp.is_negative(low) {
            // Zero at most on the node's border, unless the function is constant.
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

    /// The side of the node's middle; on the plane itself, of a point right
    /// of it by an infinitesimal, and below by one infinitely smaller.
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

    fn quadrant<P: Probe>(&self, dp: &mut Datapath<P>, quadrant: u8) -> Self {
        if self.side != Side::Both {
            return *self;
        }
        Self {
            c: rebased(dp, self.ab, self.c, quadrant),
            ..*self
        }
    }
}

/// What is known of a quadtree node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cover {
    /// No sample of the node is covered.
    None,
    /// Some may be.
    Some,
    /// All are.
    All,
}

impl Cover {
    /// On two wires: 0 outside, 1 mixed, 2 covered.
    #[inline]
    pub(super) fn wires(self) -> Short {
        Short::unsigned(self as u8, 2)
    }
}

/// The silhouette of a cube in clip space, relative to a quadtree node. It is
/// carried down the image quadtree: whole quadrants are accepted or refused,
/// samples decided by their centres.
#[derive(Debug, Clone)]
pub(super) struct Silhouette {
    /// By direction, the planes of the four edges along it.
    edges: [[Plane; 4]; 3],
    /// For a cube beside or behind the eye: a plane perpendicular to an axis,
    /// and the side of it on which rays reach the cube and not its mirror
    /// image behind the eye.
    front: Option<(Plane, Side)>,
}

/// A cube as the silhouette needs it.
pub(super) struct Cube<'a> {
    pub(super) planes: &'a Planes,
    /// Octree level, at most that of the finest voxels.
    pub(super) level: u32,
    pub(super) min: [Word; 3],
    pub(super) max: [Word; 3],
    /// Whether all of it lies before the eye.
    pub(super) before_eye: bool,
}

impl Silhouette {
    pub(super) fn new<P: Probe>(
        dp: &mut Datapath<P>,
        constants: &Constants,
        cube: &Cube<'_>,
    ) -> Self {
        let side_shift = constants.depth - cube.level;
        // By axis: what an edge's plane gains when the edge moves one side along it.
        let across = [0, 1, 2].map(|l| {
            let axis = axis_plane(constants, cube.planes, l);
            axis.map(|v| dp.shl(v, side_shift))
        });
        let edges = [0, 1, 2].map(|j| {
            let (k, l) = ((j + 1) % 3, (j + 2) % 3);
            let here = cube.planes.edge[j];
            // (A + E_k) x e_j = A x e_j - E_j x e_k, and E_l x e_j = E_k-plane.
            let moved_k = combine(dp, here, across[l], false);
            let moved_l = combine(dp, here, across[k], true);
            let moved_both = combine(dp, moved_k, across[k], true);
            [here, moved_k, moved_l, moved_both]
        });
        let side = Short::unsigned(side_shift, LEVEL_BITS);
        let axes = (constants.axis_ab, cube.planes.axis_c);
        dp.tap(Block::CubePlanes, &(cube.planes.edge, axes, side), &edges);
        let edges = edges.map(|planes| planes.map(|plane| Plane::new(dp, plane)));
        let front = if cube.before_eye {
            None
        } else {
            Self::front(dp, constants, cube)
        };
        Self { edges, front }
    }

    /// The half of the rays that reach a cube which does not hold the eye:
    /// along an axis on which the eye is outside it, rays go towards it.
    fn front<P: Probe>(
        dp: &mut Datapath<P>,
        constants: &Constants,
        cube: &Cube<'_>,
    ) -> Option<(Plane, Side)> {
        let mut front = None;
        for axis in 0..3 {
            let upwards = dp.le(constants.eye_ceil[axis], cube.min[axis]);
            let downwards = dp.le(cube.max[axis], constants.eye_floor[axis]);
            if upwards || downwards {
                let plane = Plane::new(dp, axis_plane(constants, cube.planes, axis));
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

    /// What the sides of all planes come to, as far as they are found.
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

impl Silhouette {
    /// What the node, `below` levels above the samples, has of the
    /// silhouette; never [`Cover::Some`] for a sample (`below` = 0).
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

    /// The silhouette relative to a quadrant (`y << 1 | x`) of the node.
    pub(super) fn quadrant<P: Probe>(&self, dp: &mut Datapath<P>, quadrant: u8) -> Self {
        Self {
            edges: std::array::from_fn(|j| {
                std::array::from_fn(|e| self.edges[j][e].quadrant(dp, quadrant))
            }),
            front: self
                .front
                .as_ref()
                .map(|(plane, side)| (plane.quadrant(dp, quadrant), *side)),
        }
    }
}

/// The planes of a child, from its parent's: half a side along each axis of
/// which the child's octant has the bit.
pub(super) fn of_child<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    parent: &Planes,
    parent_level: u32,
    octant: u8,
) -> Planes {
    let half_shift = constants.depth - parent_level - 1;
    let mut planes = *parent;
    for j in 0..3 {
        let (k, l) = ((j + 1) % 3, (j + 2) % 3);
        for (axis, of, add) in [(k, l, false), (l, k, true)] {
            if octant >> (2 - axis) & 1 != 0 {
                let across = axis_plane(constants, parent, of).map(|v| dp.shl(v, half_shift));
                planes.edge[j] = combine(dp, planes.edge[j], across, add);
            }
        }
    }
    let axes = (constants.axis_ab, parent.axis_c);
    let half = Short::unsigned(half_shift, LEVEL_BITS);
    let octant = Short::unsigned(octant, 3);
    dp.tap(
        Block::ChildPlanes,
        &(parent.edge, axes, half, octant),
        &planes.edge,
    );
    planes
}
