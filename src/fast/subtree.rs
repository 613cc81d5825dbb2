//! A voxel that changed to screen space, and all that is below it: one affine
//! lattice (`SPEC.md`, "Strips"). The same whole numbers as the machine's.

use super::canvas::TILE_LOG2;
use super::clip::ClipRecord;
use super::view::{Vertices, View};
use crate::project::STRIP_NORMAL_BITS;

/// Lanes of a vector of functions: three strips, nothing, and the box across
/// and down twice, for its lower and its upper bound.
pub(super) const LANES: usize = 8;
/// Strips of an outline, one along each edge.
pub(super) const STRIPS: usize = 3;
/// The lane of the box across the picture; the next is the box down.
pub(super) const ACROSS: usize = 4;

/// Fraction bits that a sum over eight vertices has beyond a position.
const SUM_BITS: u32 = 3;
/// Levels below a lattice's own whose rounding needs no further fraction bits.
const FREE_LEVELS: u32 = 2;
/// More levels than this are not for these lanes.
const MOST_LEVELS: u32 = 24;
/// Values of functions in a subtree's window stay below this.
const VALUE_LIMIT: f64 = (1 << 29) as f64;

/// What all records below a change to screen space have in common.
#[derive(Debug)]
pub(super) struct Subtree {
    /// Octree level of the finest voxels: solids, by nature or by level of detail.
    pub(super) finest: u32,
    /// Side of a voxel of that level, finest voxels of the object.
    pub(super) finest_side: i32,
    /// What a step of one sample along x, and along y, adds.
    pub(super) step: [[i32; LANES]; 2],
    /// Binary digits of a sample's step of the box functions.
    pub(super) box_bits: u32,
    /// Half the width of a voxel of the finest level.
    pub(super) half_width: [i32; LANES],
    /// By how much a lattice may be wrong: what is within half width plus
    /// this may be covered, what is within half width less
    /// [`Subtree::doubt`] is. Zero where the lattice defines the picture.
    pub(super) reach: [i32; LANES],
    /// See `reach`.
    pub(super) doubt: [i32; LANES],
    /// By axis, what half an edge of a voxel of the finest level adds.
    pub(super) half_edge: [[i32; LANES]; 3],
    /// By octant, the centre of a child of the finest level relative to its parent's.
    pub(super) child: [[i32; LANES]; 8],
    /// The sample that values are relative to: column and row, twice.
    pub(super) origin: [i32; 4],
    /// The octant of all its voxels, if it is one.
    pub(super) octant: Option<u8>,
    /// Whether a voxel of the finest level is so large on the picture that
    /// voxels are better drawn one by one.
    pub(super) is_coarse: bool,
}

/// Width on the picture, in samples, from which on voxels are drawn one by one.
const COARSE_SAMPLES: i64 = 2;

impl Subtree {
    /// Nothing yet.
    const EMPTY: Self = Self {
        finest: 0,
        finest_side: 0,
        step: [[0; LANES]; 2],
        box_bits: 0,
        half_width: [0; LANES],
        reach: [0; LANES],
        doubt: [0; LANES],
        half_edge: [[0; LANES]; 3],
        child: [[0; LANES]; 8],
        origin: [0; 4],
        octant: None,
        is_coarse: false,
    };

    /// The lattice of the voxel with these vertices, and its place in it.
    /// `finest`: the level at which level of detail ends it, at most; what the
    /// lattice itself finds small enough ends it before. `w_min`: the vertices'
    /// least depth. `None`: its numbers
    /// are too large for the lanes.
    ///
    /// Whole numbers below 2^53 in `f64`, lane by lane: exact.
    #[inline(always)]
    pub(super) fn new(
        view: &View,
        vertices: &Vertices,
        record: &ClipRecord,
        finest: u32,
        w_min: f64,
    ) -> Option<(Self, [i32; LANES])> {
        let (sum_x, edges_x) = mean(positions(view, &vertices[0], &vertices[2]));
        let (sum_y, edges_y) = mean(positions(view, &vertices[1], &vertices[2]));
        let levels = if view.search.is_some() {
            finest - record.level
        } else {
            levels_below(view, record.level, &edges_x, &edges_y)
        };
        if levels > MOST_LEVELS || view.search.is_some() && levels > view.frac + FREE_LEVELS {
            // Rounding would add up to more than a search allows for.
            return None;
        }
        let fine = levels.saturating_sub(FREE_LEVELS).min(view.frac) + view.strip_guard;
        let half_sample = (1u64 << (view.frac + SUM_BITS - 1)) as f64;
        let (centre_x, centre_y) = (sum_x - half_sample, sum_y - half_sample);
        let left = record.window.left >> TILE_LOG2 << TILE_LOG2;
        let top = record.window.top >> TILE_LOG2 << TILE_LOG2;

        let mut subtree = Self::EMPTY;
        subtree.finest = record.level + levels;
        subtree.finest_side = view.levels[subtree.finest as usize].side;
        subtree.box_bits = STRIP_NORMAL_BITS + fine;
        subtree.origin = [left, top, left, top];
        let side = view.levels[record.level as usize].side;
        // The lowest centre of a voxel that is subdivided is one side of the
        // finest voxels above the lowest corner.
        subtree.octant = view.common_octant(record.min, side, subtree.finest_side.min(side));

        let (normal_x, normal_y) = normals(&edges_x, &edges_y);
        let scale = power_of_two(fine as i32);
        let unit = power_of_two(fine as i32 - (view.frac + SUM_BITS) as i32);
        let edge_unit = unit * power_of_two(-(levels as i32));
        let (left, top) = (f64::from(left), f64::from(top));
        let mut step = [[0.0; LANES]; 2];
        let mut place = [0.0; LANES];
        for f in 0..LANES {
            let (x, y) = (normal_x[f], normal_y[f]);
            step[0][f] = x * scale;
            step[1][f] = y * scale;
            let at = ((x * centre_x + y * centre_y) * unit).floor();
            place[f] = at - (step[0][f] * left + step[1][f] * top);
        }
        let mut half = [0.0; LANES];
        let mut half_edge = [[0.0; LANES]; 3];
        for k in 0..3 {
            for f in 0..LANES {
                let edge = (normal_x[f] * edges_x[k] + normal_y[f] * edges_y[k]) * edge_unit;
                // To the nearest, halves up.
                half_edge[k][f] = (edge + 0.5).floor();
                half[f] += half_edge[k][f].abs();
            }
        }
        let across = f64::from(record.window.right - record.window.left) + 16.0;
        let down = f64::from(record.window.bottom - record.window.top) + 16.0;
        let least_depth = view.levels[record.level as usize].screen_depth;
        let samples = view
            .search
            .map_or(0.0, |search| search.deviation(least_depth, w_min));
        let whole = power_of_two(levels as i32);
        let mut most = 0.0;
        let mut reaches = [0.0; LANES];
        for f in 0..LANES {
            let slope = step[0][f].abs() + step[1][f].abs();
            let reach = if samples * slope > 0.0 {
                (slope * samples).floor() + 2.0
            } else {
                0.0
            };
            reaches[f] = reach;
            let value = place[f].abs()
                + (half[f] + reach) * whole
                + step[0][f].abs() * across
                + step[1][f].abs() * down;
            most = if value > most { value } else { most };
        }
        if most >= VALUE_LIMIT {
            return None;
        }
        let mut lanes = [0i32; LANES];
        for f in 0..LANES {
            lanes[f] = whole_number(place[f]);
            subtree.step[0][f] = whole_number(step[0][f]);
            subtree.step[1][f] = whole_number(step[1][f]);
            subtree.half_width[f] = whole_number(half[f]);
            subtree.reach[f] = whole_number(reaches[f]);
        }
        for k in 0..3 {
            for f in 0..LANES {
                subtree.half_edge[k][f] = whole_number(half_edge[k][f]);
            }
        }
        if view.search.is_some() {
            // A strip's normal is rounded, so its bounds hold more than the
            // outline: along its edge the function is not quite constant.
            for f in 0..LANES {
                let along = if f < STRIPS {
                    subtree.half_edge[f][f].abs()
                } else {
                    0
                };
                let reach = subtree.reach[f];
                subtree.doubt[f] = if reach > 0 { reach + 2 * along + 2 } else { 0 };
            }
        }
        let box_width = subtree.half_width[ACROSS].max(subtree.half_width[ACROSS + 1]);
        subtree.is_coarse =
            view.search.is_none() && 2 * i64::from(box_width) >= COARSE_SAMPLES << subtree.box_bits;
        subtree.make_children();
        Some((subtree, lanes))
    }

    /// By octant, a child's centre relative to its parent's.
    #[inline(always)]
    fn make_children(&mut self) {
        let half_edge = &self.half_edge;
        for lane in 0..LANES {
            let [x, y, z] = [half_edge[0][lane], half_edge[1][lane], half_edge[2][lane]];
            self.child[0][lane] = -x - y - z;
            self.child[1][lane] = -x - y + z;
            self.child[2][lane] = -x + y - z;
            self.child[3][lane] = -x + y + z;
            self.child[4][lane] = x - y - z;
            self.child[5][lane] = x - y + z;
            self.child[6][lane] = x + y - z;
            self.child[7][lane] = x + y + z;
        }
    }

    /// What a function's values in a brick, at samples of its window, relative
    /// to the lower bound of any of its parts, stay below; and above the
    /// negative of.
    #[inline(always)]
    pub(super) fn brick_range(&self, f: usize) -> i32 {
        // From the centre to the ends of the window, in units of the box functions.
        let x = 4 * i64::from(self.half_width[ACROSS] + self.reach[ACROSS]);
        let y = 4 * i64::from(self.half_width[ACROSS + 1] + self.reach[ACROSS + 1]);
        let along_x = i64::from(self.step[0][f].abs()) * x;
        let along_y = i64::from(self.step[1][f].abs()) * y;
        let from_centre = ((along_x + along_y) >> self.box_bits) as i32;
        from_centre + 5 * self.half_width[f] + 2 * self.reach[f] + 2
    }

    /// What a function's values at samples of a finest voxel's window,
    /// relative to its lower bound, stay below; and above the negative of.
    #[inline(always)]
    pub(super) fn voxel_range(&self, f: usize) -> i32 {
        let along_x = i64::from(self.step[0][f].abs()) * i64::from(self.half_width[ACROSS]);
        let along_y = i64::from(self.step[1][f].abs()) * i64::from(self.half_width[ACROSS + 1]);
        ((along_x + along_y) >> self.box_bits) as i32 + self.half_width[f] + 2
    }

    /// What is added to a record's box functions, `left` levels above the
    /// finest, to have its first and last column and row after a shift.
    #[inline(always)]
    pub(super) fn window_bias(&self, left: u32) -> [i32; 4] {
        let half = |f: usize| (self.half_width[f] << left) + self.reach[f];
        let up = (1 << self.box_bits) - 1;
        let (x, y) = (half(ACROSS), half(ACROSS + 1));
        [up - x, up - y, x, y]
    }
}

/// Screen positions of eight vertices, `floor(x / w)` in units of `2^-frac` samples.
#[inline(always)]
fn positions(view: &View, x: &[f64; 8], w: &[f64; 8]) -> [f64; 8] {
    let unit = view.root_samples * (1u64 << view.frac) as f64;
    let mut positions = [0.0; 8];
    for i in 0..8 {
        // Whole numbers below 2^53 times a power of two: exact.
        let x = x[i] * unit;
        let quotient = (x / w[i]).floor();
        // The quotient is rounded before it is rounded down, so it may be one
        // too large or too small. The remainder is a whole number below 2^53.
        let rest = (-quotient).mul_add(w[i], x);
        let above = if rest >= w[i] { 1.0 } else { 0.0 };
        let below = if rest < 0.0 { 1.0 } else { 0.0 };
        positions[i] = quotient + above - below;
    }
    positions
}

/// The sum of eight positions, and by axis the sum of the four edges along it.
#[inline(always)]
fn mean(p: [f64; 8]) -> (f64, [f64; 3]) {
    let mut z_sum = [0.0; 4];
    let mut z_edge = [0.0; 4];
    for i in 0..4 {
        z_sum[i] = p[2 * i] + p[2 * i + 1];
        z_edge[i] = p[2 * i + 1] - p[2 * i];
    }
    let sum = (z_sum[0] + z_sum[1]) + (z_sum[2] + z_sum[3]);
    let x = (z_sum[2] + z_sum[3]) - (z_sum[0] + z_sum[1]);
    let y = (z_sum[1] - z_sum[0]) + (z_sum[3] - z_sum[2]);
    let z = (z_edge[0] + z_edge[1]) + (z_edge[2] + z_edge[3]);
    (sum, [x, y, z])
}

/// Levels from a voxel to those that are no larger than the level of detail,
/// or than what positions can part, or finest voxels.
#[inline(always)]
fn levels_below(view: &View, level: u32, x: &[f64; 3], y: &[f64; 3]) -> u32 {
    let across = x[0].abs() + x[1].abs() + x[2].abs();
    let down = y[0].abs() + y[1].abs() + y[2].abs();
    let mut size = (if across > down { across } else { down }) as i64;
    let limit = view.lod_limit << (SUM_BITS - 1);
    let mut levels = 0;
    while level + levels < view.depth && size > limit {
        size >>= 1;
        levels += 1;
    }
    levels
}

/// A whole number below 2^31 as one: in the lowest bits of a sum with a number
/// whose last place is 1. (A plain conversion has to look for what is too large.)
#[inline(always)]
fn whole_number(value: f64) -> i32 {
    const LAST_PLACE_ONE: f64 = ((1u64 << 52) + (1 << 51)) as f64;
    (value + LAST_PLACE_ONE).to_bits() as i32
}

/// `2^exponent`, of an exponent between -1022 and 1023.
#[inline(always)]
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// The normals of all functions: the edges' directions in
/// [`STRIP_NORMAL_BITS`] bits, towards zero, turned by a right angle; and the
/// steps of the box.
#[inline(always)]
fn normals(edges_x: &[f64; 3], edges_y: &[f64; 3]) -> ([f64; LANES], [f64; LANES]) {
    /// Which functions are the box across, and the box down.
    const ACROSS_LANES: [f64; LANES] = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0];
    const DOWN_LANES: [f64; LANES] = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0];
    let unit = power_of_two(STRIP_NORMAL_BITS as i32);
    let mut x = [0.0; LANES];
    let mut y = [0.0; LANES];
    x[..STRIPS].copy_from_slice(edges_x);
    y[..STRIPS].copy_from_slice(edges_y);
    for f in 0..LANES {
        let (across, down) = (x[f].abs(), y[f].abs());
        let longer = if across > down { across } else { down };
        // The exponent of a number of n bits is n - 1. An edge that is none
        // stays so: its power is made that of the number one.
        let longer = if longer > 0.0 { longer } else { 1.0 };
        let exponent = (longer.to_bits() >> 52) as i32 - 1023;
        let scale = power_of_two(STRIP_NORMAL_BITS as i32 - 1 - exponent);
        let (along_x, along_y) = ((x[f] * scale).trunc(), (y[f] * scale).trunc());
        x[f] = ACROSS_LANES[f] * unit - along_y;
        y[f] = DOWN_LANES[f] * unit + along_x;
    }
    (x, y)
}
