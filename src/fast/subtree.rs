//! A voxel that changed to screen space, and all that is below it: one affine
//! lattice (`SPEC.md`, "Strips"). The same whole numbers as the machine's.

use super::canvas::TILE_LOG2;
use super::clip::ClipRecord;
use super::lanes::{Isa, Reals};
use super::view::View;
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
    /// What is within half width plus this may be covered. Where the lattice
    /// defines the picture it is, and this is the slack; elsewhere it is by
    /// how much a lattice may be wrong.
    pub(super) reach: [i32; LANES],
    /// Where a lattice may be wrong, what is within half width less this is covered.
    pub(super) doubt: [i32; LANES],
    /// Half width plus reach: the bounds of a voxel of the finest level.
    pub(super) bound: [i32; LANES],
    /// By axis, what half an edge of a voxel of the finest level adds.
    pub(super) half_edge: [[i32; LANES]; 3],
    /// By octant, the centre of a child of the finest level relative to its parent's.
    pub(super) child: [[i32; LANES]; 8],
    /// The box functions of `child`, by function and octant.
    pub(super) child_box: [[i32; 8]; 2],
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
    /// A lattice, with the tables that its records need.
    #[inline(always)]
    pub(super) fn new<I: Isa>(
        isa: I,
        view: &View,
        record: &ClipRecord,
        lattice: &Lattice<I>,
    ) -> Self {
        let finest_side = view.levels[lattice.finest as usize].side;
        let side = view.levels[record.level as usize].side;
        let half_width = isa.store(lattice.half_width);
        let half_edge = [
            isa.store(lattice.half_edge[0]),
            isa.store(lattice.half_edge[1]),
            isa.store(lattice.half_edge[2]),
        ];
        let reach = isa.store(lattice.reach);
        let mut doubt = [0; LANES];
        if view.search.is_some() {
            // A strip's normal is rounded, so its bounds hold more than the
            // outline: along its edge the function is not quite constant.
            for f in 0..LANES {
                let along = if f < STRIPS { half_edge[f][f].abs() } else { 0 };
                doubt[f] = if reach[f] > 0 {
                    reach[f] + 2 * along + 2
                } else {
                    0
                };
            }
        }
        let box_width = half_width[ACROSS].max(half_width[ACROSS + 1]);
        let is_coarse = view.opacity_eye.is_some()
            || view.search.is_none()
                && 2 * i64::from(box_width) >= COARSE_SAMPLES << lattice.box_bits;
        let [left, top] = lattice.origin;
        let [x, y, z] = lattice.half_edge;
        let (y_and_z, y_less_z) = (isa.add(y, z), isa.sub(y, z));
        let (z_less_y, neither) = (isa.negative(y_less_z), isa.negative(y_and_z));
        let child = [
            isa.store(isa.sub(neither, x)),
            isa.store(isa.sub(z_less_y, x)),
            isa.store(isa.sub(y_less_z, x)),
            isa.store(isa.sub(y_and_z, x)),
            isa.store(isa.add(neither, x)),
            isa.store(isa.add(z_less_y, x)),
            isa.store(isa.add(y_less_z, x)),
            isa.store(isa.add(y_and_z, x)),
        ];
        Self {
            finest: lattice.finest,
            finest_side,
            step: [isa.store(lattice.step[0]), isa.store(lattice.step[1])],
            box_bits: lattice.box_bits,
            half_width,
            reach,
            doubt,
            bound: isa.store(isa.add(lattice.half_width, lattice.reach)),
            half_edge,
            child_box: [
                isa.store(by_octant(isa, &half_edge, ACROSS)),
                isa.store(by_octant(isa, &half_edge, ACROSS + 1)),
            ],
            child,
            origin: [left, top, left, top],
            // The lowest centre of a voxel that is subdivided is one side of
            // the finest voxels above the lowest corner.
            octant: view.common_octant(record.min, side, finest_side.min(side)),
            is_coarse,
        }
    }

    /// What a function's values in a brick of two levels, at samples of its window,
    /// relative to the lower bound of any of its parts, stay below; and above
    /// the negative of.
    #[inline(always)]
    pub(super) fn brick_range(&self, f: usize) -> i32 {
        // From the centre to the ends of the window, in units of the box functions.
        let x = 4 * i64::from(self.bound[ACROSS]);
        let y = 4 * i64::from(self.bound[ACROSS + 1]);
        let along_x = i64::from(self.step[0][f].abs()) * x;
        let along_y = i64::from(self.step[1][f].abs()) * y;
        let from_centre = ((along_x + along_y) >> self.box_bits) as i32;
        from_centre + 5 * self.half_width[f] + 2 * self.reach[f] + 2
    }

    /// What a function's values at samples of a finest voxel's window,
    /// relative to its lower bound, stay below; and above the negative of.
    #[inline(always)]
    pub(super) fn voxel_range(&self, f: usize) -> i32 {
        let bound = |f: usize| i64::from(self.bound[f]);
        let along_x = i64::from(self.step[0][f].abs()) * bound(ACROSS);
        let along_y = i64::from(self.step[1][f].abs()) * bound(ACROSS + 1);
        ((along_x + along_y) >> self.box_bits) as i32 + bound(f) as i32 + 2
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

/// One function of [`Subtree::child`] by octant, one lane each.
#[inline(always)]
fn by_octant<I: Isa>(isa: I, half_edge: &[[i32; LANES]; 3], f: usize) -> I::Eight {
    /// By axis, which way an octant lies.
    static SIDES: [[i32; 8]; 3] = [
        [-1, -1, -1, -1, 1, 1, 1, 1],
        [-1, -1, 1, 1, -1, -1, 1, 1],
        [-1, 1, -1, 1, -1, 1, -1, 1],
    ];
    let none = isa.load(&[0; LANES]);
    let x = isa.plus_times(none, isa.load(&SIDES[0]), half_edge[0][f]);
    let y = isa.plus_times(x, isa.load(&SIDES[1]), half_edge[1][f]);
    isa.plus_times(y, isa.load(&SIDES[2]), half_edge[2][f])
}

/// The numbers of a lattice, lane by lane.
pub(super) struct Lattice<I: Isa> {
    finest: u32,
    box_bits: u32,
    origin: [i32; 2],
    step: [I::Eight; 2],
    half_width: I::Eight,
    reach: I::Eight,
    half_edge: [I::Eight; 3],
    /// The place of the voxel in it.
    pub(super) place: I::Eight,
}

impl<I: Isa> Lattice<I> {
    /// The lattice of the voxel with these vertices. `finest`: the level at
    /// which level of detail ends it, at most; what the lattice itself finds
    /// small enough ends it before. `w_min`: the vertices' least depth.
    /// `None`: its numbers are too large for the lanes.
    ///
    /// Whole numbers below 2^53 in `f64`, lane by lane: exact.
    #[inline(always)]
    pub(super) fn new(
        isa: I,
        view: &View,
        vertices: &[I::Reals; 3],
        record: &ClipRecord,
        finest: u32,
        w_min: f64,
    ) -> Option<Self> {
        let (sum_x, strips_x) = positions(isa, view, vertices[0], vertices[2]).sums();
        let (sum_y, strips_y) = positions(isa, view, vertices[1], vertices[2]).sums();
        let (edges_x, edges_y) = (strips_x.first(), strips_y.first());
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

        let (normal_x, normal_y) = normals(isa, strips_x, strips_y);
        let scale = isa.real(power_of_two(fine as i32));
        let unit = power_of_two(fine as i32 - (view.frac + SUM_BITS) as i32);
        let edge_unit = isa.real(unit * power_of_two(-(levels as i32)));
        let step = [normal_x * scale, normal_y * scale];
        let centre = normal_x.fused(isa.real(centre_x), normal_y * isa.real(centre_y));
        let at = (centre * isa.real(unit)).floor();
        let to_origin = step[0].fused(
            isa.real(f64::from(left)),
            step[1] * isa.real(f64::from(top)),
        );
        let place = at - to_origin;
        let zero = isa.real(0.0);
        let mut half = zero;
        let mut half_edge = [zero; 3];
        for k in 0..3 {
            let edge = normal_x.fused(isa.real(edges_x[k]), normal_y * isa.real(edges_y[k]));
            // To the nearest, halves up.
            half_edge[k] = edge.fused(edge_unit, isa.real(0.5)).floor();
            half = half + half_edge[k].abs();
        }
        let across = f64::from(record.window.right - record.window.left) + 16.0;
        let down = f64::from(record.window.bottom - record.window.top) + 16.0;
        let slope = [step[0].abs(), step[1].abs()];
        let mut reach = zero;
        if let Some(search) = &view.search {
            let least_depth = view.levels[record.level as usize].screen_depth;
            let samples = isa.real(search.deviation(least_depth, w_min));
            // Where there is no slope there is nothing to reach: a slope is
            // one at least, and less than half of it is none.
            let slope = slope[0] + slope[1];
            let is_sloped = slope.is_at_least(isa.real(0.5));
            reach = ((slope * samples).floor() + isa.real(2.0)) * is_sloped;
        } else if let Some(places) = view.strip_slack {
            let slope = slope[0] + slope[1];
            reach = (slope * isa.real(power_of_two(-(places as i32)))).floor();
        }
        let whole = isa.real(power_of_two(levels as i32));
        let most = (half + reach).fused(whole, place.abs());
        let most = slope[0].fused(isa.real(across), most);
        let most = slope[1].fused(isa.real(down), most);
        if (isa.real(VALUE_LIMIT - 1.0) - most).any_negative() {
            return None;
        }
        Some(Self {
            finest: record.level + levels,
            box_bits: STRIP_NORMAL_BITS + fine,
            origin: [left, top],
            step: [isa.whole(step[0]), isa.whole(step[1])],
            half_width: isa.whole(half),
            reach: isa.whole(reach),
            half_edge: [
                isa.whole(half_edge[0]),
                isa.whole(half_edge[1]),
                isa.whole(half_edge[2]),
            ],
            place: isa.whole(place),
        })
    }
}

/// Screen positions of eight vertices, `floor(x / w)` in units of `2^-frac` samples.
#[inline(always)]
fn positions<I: Isa>(isa: I, view: &View, x: I::Reals, w: I::Reals) -> I::Reals {
    let unit = view.root_samples * (1u64 << view.frac) as f64;
    // Whole numbers below 2^53 times a power of two: exact.
    let x = x * isa.real(unit);
    let quotient = x.over(w).floor();
    // The quotient is rounded before it is rounded down, so it may be one
    // too large or too small. The remainder is a whole number below 2^53.
    let rest = (isa.real(0.0) - quotient).fused(w, x);
    let above = rest.is_at_least(w);
    let not_below = rest.is_at_least(isa.real(0.0));
    quotient + (above + not_below - isa.real(1.0))
}

/// Levels from a voxel to those that are no larger than the level of detail,
/// or than what positions can part, or finest voxels.
#[inline(always)]
fn levels_below(view: &View, level: u32, x: &[f64; 4], y: &[f64; 4]) -> u32 {
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

/// `2^exponent`, of an exponent between -1022 and 1023.
#[inline(always)]
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// The normals of all functions: the edges' directions in
/// [`STRIP_NORMAL_BITS`] bits, towards zero, turned by a right angle; and the
/// steps of the box.
#[inline(always)]
fn normals<I: Isa>(isa: I, x: I::Reals, y: I::Reals) -> (I::Reals, I::Reals) {
    const UNIT: f64 = (1u32 << STRIP_NORMAL_BITS) as f64;
    /// The functions that are the box across, and the box down.
    const ACROSS_LANES: [f64; LANES] = [0.0, 0.0, 0.0, 0.0, UNIT, 0.0, UNIT, 0.0];
    const DOWN_LANES: [f64; LANES] = [0.0, 0.0, 0.0, 0.0, 0.0, UNIT, 0.0, UNIT];
    // An edge that is none stays so: its scale is that of the number one. The
    // exponent of a number of n bits is n - 1.
    let longer = x.abs().greatest(y.abs()).greatest(isa.real(1.0));
    let scale = longer.scale_to(STRIP_NORMAL_BITS - 1);
    let (along_x, along_y) = ((x * scale).trunc(), (y * scale).trunc());
    (
        isa.reals(&ACROSS_LANES) - along_y,
        isa.reals(&DOWN_LANES) + along_x,
    )
}
