//! Silhouettes in screen space, under the exact rule (`SPEC.md`, "Strips").
//!
//! Once a voxel has changed to screen space, it and all that is below it are
//! one affine lattice. Its outline on the picture is the intersection of three
//! strips, one along each edge, and its box is two more: five linear
//! functions of the sample. A record holds the five functions' values at the
//! first sample of its quadtree node, relative to its centre. Everything else
//! is a constant of the lattice: what a sample adds, what a half edge adds, and
//! half the width. Half edges are rounded once, for the finest level; at
//! coarser levels they are shifted copies, so that children tile their parent
//! without gap or overlap. The products that a lattice needs are made by
//! shifts and adds, when it is made.

use hwmodel::{Datapath, Probe, Short, WideWord, Word};

use super::alpha::Aim;
use super::constants::Constants;
use super::silhouette::{Cover, Silhouette};
use super::taps::{Block, LEVEL_BITS};
use crate::project::STRIP_NORMAL_BITS;

/// Linear functions of an outline: three strips, the box across, the box down.
pub(super) const FUNCTIONS: usize = 5;
/// The function of the box across the picture.
pub(super) const ACROSS: usize = 3;
/// The function of the box down the picture.
pub(super) const DOWN: usize = 4;

/// Fraction bits that a sum over eight vertices has beyond a position.
const SUM_BITS: u32 = 3;
/// Levels below a lattice's own whose rounding needs no further fraction bits.
const FREE_LEVELS: u32 = 2;

/// A projected voxel as its eight vertices have it on average.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mean {
    /// By coordinate, the sum of the vertices, relative to the quadtree
    /// node's corner: units of `2^-(frac + 3)` samples.
    pub(super) sum: [Word; 2],
    /// By coordinate, then by axis: the sum over the four edges along it,
    /// units of `2^-(frac + 2)` samples of an edge.
    pub(super) edges: [[Word; 3]; 2],
}

impl Mean {
    /// The sum and the three sums of differences of eight vertices in Morton order.
    pub(super) fn of<P: Probe>(dp: &mut Datapath<P>, vertices: [Word; 8]) -> (Word, [Word; 3]) {
        // Pairs along z, then y, then x: 7 adds and 4 + 4 + 4 subtracts less those not wanted.
        let z_sum: [Word; 4] =
            std::array::from_fn(|i| dp.add(vertices[i << 1], vertices[i << 1 | 1]));
        let z_edge: [Word; 4] =
            std::array::from_fn(|i| dp.sub(vertices[i << 1 | 1], vertices[i << 1]));
        let y_sum: [Word; 2] = std::array::from_fn(|i| dp.add(z_sum[i << 1], z_sum[i << 1 | 1]));
        let y_edge: [Word; 2] = std::array::from_fn(|i| dp.sub(z_sum[i << 1 | 1], z_sum[i << 1]));
        let sum = dp.add(y_sum[0], y_sum[1]);
        let x = dp.sub(y_sum[1], y_sum[0]);
        let y = dp.add(y_edge[0], y_edge[1]);
        let z_low = dp.add(z_edge[0], z_edge[1]);
        let z_high = dp.add(z_edge[2], z_edge[3]);
        let z = dp.add(z_low, z_high);
        dp.tap(Block::StripMean, &vertices, &(sum, [x, y, z]));
        (sum, [x, y, z])
    }
}

/// What all records below a change to screen space have in common.
#[derive(Debug, Clone)]
pub(super) struct Subtree {
    /// By function, what a step of one sample along x and y adds.
    step: [[WideWord; 2]; FUNCTIONS],
    /// By function, what half an edge along x, y, z adds, at the finest level.
    half_edge: [[WideWord; 3]; FUNCTIONS],
    /// By function, half the width of a voxel of the finest level.
    half_width: [WideWord; FUNCTIONS],
    /// By function, how much more than half its width bounds a voxel of any
    /// level, if anything.
    slack: Option<[WideWord; FUNCTIONS]>,
    /// Octree level of the finest voxels: solids, by nature or by level of detail.
    finest: u32,
    /// The shares of its sides, under the rule that blends.
    pub(super) aim: Option<Aim>,
}

/// A record's place in its lattice.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strips {
    /// The functions' values at the first sample of the record's quadtree
    /// node, relative to the record's centre.
    pub(super) value: [WideWord; FUNCTIONS],
}

impl Subtree {
    /// The lattice of a voxel of octree level `level`, and the voxel's place in it.
    pub(super) fn new<P: Probe>(
        dp: &mut Datapath<P>,
        constants: &Constants,
        level: u32,
        mean: &Mean,
    ) -> (Self, Strips) {
        let levels = levels_below(dp, constants, level, mean);
        let frac = constants.screen_frac;
        let fine = levels.saturating_sub(FREE_LEVELS).min(frac) + constants.strip_guard;
        // From products in units of 2^-(frac + 3) to units of 2^-fine.
        let places = (frac + SUM_BITS) as i32 - fine as i32;
        // The first sample's centre is half a sample from the node's corner.
        let half_sample = dp.load(1i64 << (frac + SUM_BITS - 1));
        let centre = mean.sum.map(|sum| dp.sub(sum, half_sample));

        let mut step = [[WideWord::ZERO; 2]; FUNCTIONS];
        let mut half_edge = [[WideWord::ZERO; 3]; FUNCTIONS];
        let mut value = [WideWord::ZERO; FUNCTIONS];
        for function in 0..FUNCTIONS {
            let normal = Normal::of(dp, &mean.edges, function);
            step[function] = normal.steps(dp).map(|step| dp.shl(step, fine));
            let at_centre = normal.along(dp, centre);
            let at_centre = shifted(dp, at_centre, places);
            value[function] = dp.neg(at_centre);
            for k in 0..3 {
                // An edge sum has half the unit of a half edge: no further shift.
                let edge = normal.along(dp, [mean.edges[0][k], mean.edges[1][k]]);
                half_edge[function][k] = nearest(dp, edge, places + levels as i32);
            }
        }
        let half_width = half_edge.map(|[x, y, z]| {
            let [x, y, z] = [x, y, z].map(|edge| magnitude(dp, edge));
            let sum = dp.add(x, y);
            dp.add(sum, z)
        });
        let slack = constants.strip_slack.map(|places| {
            step.map(|[x, y]| {
                let (x, y) = (magnitude(dp, x), magnitude(dp, y));
                let both = dp.add(x, y);
                dp.shr(both, places)
            })
        });
        dp.tap(
            Block::StripLattice,
            &(
                mean.sum,
                mean.edges,
                Short::unsigned(level, LEVEL_BITS),
                constants.lod_limit_screen,
            ),
            &(
                Short::unsigned(levels, LEVEL_BITS),
                step,
                half_edge,
                [half_width, slack.unwrap_or_default()],
                value,
            ),
        );
        let subtree = Self {
            step,
            half_edge,
            half_width,
            slack,
            finest: level + levels,
            aim: None,
        };
        (subtree, Strips { value })
    }

    /// Octree level of the finest voxels.
    pub(super) fn finest(&self) -> u32 {
        self.finest
    }

    /// What one sample adds to a function of the box, as [`Self::box_step`] shifts it.
    pub(super) fn sample_step(&self, function: usize) -> WideWord {
        self.step[function][function - ACROSS]
    }

    /// By function, the values of a voxel's eight vertices relative to the
    /// first sample, in Morton order: for who checks them.
    pub(super) fn vertices<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        level: u32,
        place: &Strips,
    ) -> [[WideWord; 8]; FUNCTIONS] {
        std::array::from_fn(|function| {
            let halves = self.half_edge[function].map(|half| dp.shl(half, self.finest - level));
            // The place is the first sample's, relative to the centre.
            let centre = dp.neg(place.value[function]);
            std::array::from_fn(|vertex| {
                let mut value = centre;
                for (k, &half) in halves.iter().enumerate() {
                    let is_high = vertex >> (2 - k) & 1 != 0;
                    value = if is_high {
                        dp.add(value, half)
                    } else {
                        dp.sub(value, half)
                    };
                }
                value
            })
        })
    }

    /// By function, what a step of a sample along x and y adds.
    pub(super) fn steps(&self) -> [[WideWord; 2]; FUNCTIONS] {
        self.step
    }

    /// What a step of `2^places` samples adds to a function of the box.
    pub(super) fn box_step<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        function: usize,
        places: u32,
    ) -> WideWord {
        dp.shl(self.sample_step(function), places)
    }

    /// What bounds the outline of a voxel of octree level `level` on either
    /// side of its centre: half its width, and the slack.
    pub(super) fn half_width<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        function: usize,
        level: u32,
    ) -> WideWord {
        let half = dp.shl(self.half_width[function], self.finest - level);
        match &self.slack {
            Some(slack) => dp.add(half, slack[function]),
            None => half,
        }
    }

    /// What a sample and what half edges at the finest level add to a function
    /// of the box: for who looks on.
    pub(super) fn box_constants(&self, function: usize) -> (WideWord, [WideWord; 3]) {
        (
            self.step[function][function - ACROSS],
            self.half_edge[function],
        )
    }

    /// Whether a voxel of octree level `level` is no larger than a sample.
    pub(super) fn at_most_a_sample<P: Probe>(&self, dp: &mut Datapath<P>, level: u32) -> bool {
        [ACROSS, DOWN].into_iter().all(|function| {
            let half = self.half_width(dp, function, level);
            let width = dp.shl(half, 1);
            let sample = self.box_step(dp, function, 0);
            dp.le(width, sample)
        })
    }

    /// The places of a record's eight children of octree level `level`, in Morton order.
    pub(super) fn children<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        level: u32,
        parent: &Strips,
    ) -> [Strips; 8] {
        let mut children = [*parent; 8];
        for function in 0..FUNCTIONS {
            let [x, y, z] = self.half_edge[function].map(|edge| dp.shl(edge, self.finest - level));
            let value = parent.value[function];
            // The value falls where the centre moves on: low children have more.
            let by_x = [dp.add(value, x), dp.sub(value, x)];
            for (i, &value) in by_x.iter().enumerate() {
                let by_y = [dp.add(value, y), dp.sub(value, y)];
                for (j, &value) in by_y.iter().enumerate() {
                    children[i << 2 | j << 1].value[function] = dp.add(value, z);
                    children[i << 2 | j << 1 | 1].value[function] = dp.sub(value, z);
                }
            }
            let values = children.map(|child| child.value[function]);
            dp.tap(Block::StripChildren, &(value, [x, y, z]), &values);
        }
        children
    }

    /// A place relative to a quadrant of a node that is `below` levels above the samples.
    pub(super) fn in_quadrant<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        place: &Strips,
        quadrant: u8,
        below: u32,
    ) -> Strips {
        Strips {
            value: std::array::from_fn(|function| {
                self.moved(dp, function, place.value[function], quadrant, below)
            }),
        }
    }

    /// A function's value at the first sample of a quadrant.
    fn moved<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        function: usize,
        value: WideWord,
        quadrant: u8,
        below: u32,
    ) -> WideWord {
        let mut moved = value;
        for axis in 0..2 {
            if quadrant >> axis & 1 != 0 {
                let step = dp.shl(self.step[function][axis], below - 1);
                moved = dp.add(moved, step);
            }
        }
        let quadrant = Short::unsigned(quadrant, 2);
        let below = Short::unsigned(below, LEVEL_BITS);
        dp.tap(
            Block::StripQuadrant,
            &(value, self.step[function], quadrant, below),
            &moved,
        );
        moved
    }
}

/// Levels from a voxel to those that are no larger than the level of detail,
/// or than what positions can part, or finest voxels.
fn levels_below<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    level: u32,
    mean: &Mean,
) -> u32 {
    let sizes = mean.edges.map(|edges| {
        let [x, y, z] = edges.map(|edge| magnitude(dp, edge));
        let sum = dp.add(x, y);
        dp.add(sum, z)
    });
    let mut size = dp.max(sizes[0], sizes[1]);
    let limit = dp.shl(constants.lod_limit_screen, SUM_BITS - 1);
    let mut levels = 0;
    while level + levels < constants.depth && dp.lt(limit, size) {
        size = dp.shr(size, 1);
        levels += 1;
    }
    levels
}

/// A function's gradient: a number of so many bits for each coordinate, or a
/// whole sample's step across or down.
enum Normal {
    Strip([Word; 2]),
    Box(usize),
}

impl Normal {
    fn of<P: Probe>(dp: &mut Datapath<P>, edges: &[[Word; 3]; 2], function: usize) -> Self {
        if function >= ACROSS {
            return Self::Box(function - ACROSS);
        }
        let (x, y) = direction(dp, edges[0][function], edges[1][function]);
        let across = dp.neg(y);
        Self::Strip([across, x])
    }

    /// What a step of a sample along x and y adds.
    fn steps<P: Probe>(&self, dp: &mut Datapath<P>) -> [WideWord; 2] {
        match self {
            Self::Strip(normal) => normal.map(|g| dp.widen(g)),
            Self::Box(axis) => std::array::from_fn(|a| {
                WideWord::from_host(i64::from(a == *axis) << STRIP_NORMAL_BITS)
            }),
        }
    }

    /// The product with a vector.
    fn along<P: Probe>(&self, dp: &mut Datapath<P>, [x, y]: [Word; 2]) -> WideWord {
        match *self {
            Self::Strip([gx, gy]) => {
                let along_x = times(dp, gx, x);
                let along_y = times(dp, gy, y);
                dp.add(along_x, along_y)
            }
            Self::Box(axis) => {
                let wide = dp.widen([x, y][axis]);
                dp.shl(wide, STRIP_NORMAL_BITS)
            }
        }
    }
}

/// An edge's direction in [`STRIP_NORMAL_BITS`] bits; zero for an edge that is none.
fn direction<P: Probe>(dp: &mut Datapath<P>, x: Word, y: Word) -> (Word, Word) {
    let length_x = dp.bit_length(x);
    let length_y = dp.bit_length(y);
    let length = dp.longer(length_x, length_y);
    // Towards zero, so that no component reaches 2^bits.
    let mut part = |v: Word| {
        let size = magnitude(dp, v);
        let size = if length > STRIP_NORMAL_BITS {
            dp.shr(size, length - STRIP_NORMAL_BITS)
        } else {
            dp.shl(size, STRIP_NORMAL_BITS - length)
        };
        let negative = dp.is_negative(v);
        let negated = dp.neg(size);
        dp.select(negative, negated, size)
    };
    if length == 0 {
        return (x, y);
    }
    (part(x), part(y))
}

/// `small * a` by shifts and adds; `|small| < 2^STRIP_NORMAL_BITS`.
fn times<P: Probe>(dp: &mut Datapath<P>, small: Word, a: Word) -> WideWord {
    let size = magnitude(dp, small);
    let a = dp.widen(a);
    let mut sum = WideWord::ZERO;
    for place in 0..STRIP_NORMAL_BITS {
        let part = dp.shl(a, place);
        let with = dp.add(sum, part);
        let bit = dp.bit(size, place);
        sum = dp.select(bit, with, sum);
    }
    let negative = dp.is_negative(small);
    let negated = dp.neg(sum);
    dp.select(negative, negated, sum)
}

fn magnitude<P: Probe, N: hwmodel::Number>(dp: &mut Datapath<P>, a: N) -> N {
    let negated = dp.neg(a);
    dp.max(a, negated)
}

/// `a >> places` rounded down, or to the left for negative `places`.
fn shifted<P: Probe>(dp: &mut Datapath<P>, a: WideWord, places: i32) -> WideWord {
    if places >= 0 {
        dp.shr(a, places as u32)
    } else {
        dp.shl(a, places.unsigned_abs())
    }
}

/// `a >> places` rounded to the nearest, halves up.
fn nearest<P: Probe>(dp: &mut Datapath<P>, a: WideWord, places: i32) -> WideWord {
    if places <= 0 {
        return shifted(dp, a, places);
    }
    let most = shifted(dp, a, places - 1);
    let up = dp.add(most, WideWord::from_host(1));
    dp.shr(up, 1)
}

/// The outline of a voxel, relative to a quadtree node.
#[derive(Debug, Clone)]
pub(super) struct StripSilhouette<'s> {
    subtree: &'s Subtree,
    half_width: [WideWord; FUNCTIONS],
    place: Strips,
    /// Whether all samples of the node are inside, by function.
    settled: [bool; FUNCTIONS],
}

impl<'s> StripSilhouette<'s> {
    /// The outline of a voxel of octree level `level`, relative to its own quadtree node.
    pub(super) fn new<P: Probe>(
        dp: &mut Datapath<P>,
        subtree: &'s Subtree,
        level: u32,
        place: Strips,
    ) -> Self {
        Self {
            subtree,
            half_width: std::array::from_fn(|f| subtree.half_width(dp, f, level)),
            place,
            settled: [false; FUNCTIONS],
        }
    }

    /// What a node `below` levels above the samples has of one strip.
    fn cover_of<P: Probe>(&self, dp: &mut Datapath<P>, function: usize, below: u32) -> Cover {
        let value = self.place.value[function];
        let (mut least, mut greatest) = (value, value);
        if below > 0 {
            for step in self.subtree.step[function] {
                // To the last sample: 2^below - 1 steps.
                let all = dp.shl(step, below);
                let to_last = dp.sub(all, step);
                let under = dp.min(to_last, WideWord::ZERO);
                let over = dp.max(to_last, WideWord::ZERO);
                least = dp.add(least, under);
                greatest = dp.add(greatest, over);
            }
        }
        let high = self.half_width[function];
        let low = dp.neg(high);
        let cover = if dp.lt(greatest, low) || dp.lt(high, least) {
            Cover::None
        } else if dp.le(low, least) && dp.le(greatest, high) {
            Cover::All
        } else {
            Cover::Some
        };
        let below = Short::unsigned(below, LEVEL_BITS);
        dp.tap(
            Block::StripCover,
            &(value, high, self.subtree.step[function], below),
            &cover.wires(),
        );
        cover
    }
}

impl Silhouette for StripSilhouette<'_> {
    fn cover<P: Probe>(&mut self, dp: &mut Datapath<P>, below: u32) -> Cover {
        let mut all = true;
        for function in 0..FUNCTIONS {
            if self.settled[function] {
                continue;
            }
            match self.cover_of(dp, function, below) {
                Cover::None => return Cover::None,
                Cover::Some => all = false,
                Cover::All => self.settled[function] = true,
            }
        }
        if all { Cover::All } else { Cover::Some }
    }

    fn quadrant<P: Probe>(&self, dp: &mut Datapath<P>, quadrant: u8, below: u32) -> Self {
        let mut inner = self.clone();
        for function in 0..FUNCTIONS {
            if !self.settled[function] {
                let value = self.place.value[function];
                inner.place.value[function] =
                    self.subtree.moved(dp, function, value, quadrant, below);
            }
        }
        inner
    }
}
