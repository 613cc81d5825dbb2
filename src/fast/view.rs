//! The constants of a frame, as the walk needs them.
//!
//! Clip vectors are whole numbers in `f64`: exact, because [`View::new`] takes
//! no frame whose positions, times sixteen, leave 53 bits. So comparisons with
//! the machine's thresholds have the machine's outcome, and the same lanes can
//! divide.

use crate::project::{Coverage, FrameSetup, OpacityEye};

/// Positions, times sixteen, stay below this: whole numbers of an `f64`.
const EXACT_LIMIT: i128 = 1 << 53;
/// Deviation, in samples, at which a frame without tolerance uses lattices to
/// find the few voxels that it then decides exactly.
const SEARCH_TOLERANCE: f64 = 1.0 / 8.0;
/// What windows of clip-space boxes are widened by beyond the tolerance, for
/// the rounding of quotients, in samples: millions of times as much as needed.
const QUOTIENT_MARGIN: f64 = 1e-6;
/// Screen positions above this many bits do not fit the lanes.
const MAX_POSITION_BITS: u32 = 40;

/// Clip vectors of eight vertices: by coordinate (X, Y, W), then in Morton order.
pub(super) type Vertices = [[f64; 8]; 3];

/// What voxels of one octree level have in common.
#[derive(Debug, Clone)]
pub(super) struct Level {
    /// The vertices relative to the lowest corner.
    pub(super) vertices: Vertices,
    /// The children's lowest corners relative to their parent's, by octant.
    pub(super) child: [[f64; 3]; 8],
    /// Least and greatest W of a vertex, relative to the lowest corner's.
    pub(super) w_span: [f64; 2],
    /// Least W of a record that may change to screen space; infinite: none may.
    pub(super) screen_depth: f64,
    /// Least W of a node that is a solid by level of detail; infinite: none is.
    pub(super) lod_depth: f64,
    /// A voxel's side, finest voxels.
    pub(super) side: i32,
}

impl Level {
    /// The vertices of the voxel whose lowest corner is here.
    #[inline(always)]
    pub(super) fn vertices_at(&self, corner: [f64; 3]) -> Vertices {
        let mut vertices = self.vertices;
        for c in 0..3 {
            for v in &mut vertices[c] {
                *v += corner[c];
            }
        }
        vertices
    }
}

/// How far lattices are from the truth at most, in samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct Search {
    /// By what a voxel's projection bends, at the least depth of its level.
    bend: f64,
    /// By rounding.
    rounding: f64,
}

impl Search {
    /// The deviation of a voxel at this depth. Bends fall with its square, or faster.
    #[inline(always)]
    pub(super) fn deviation(&self, least_depth: f64, depth: f64) -> f64 {
        let ratio = least_depth / depth;
        self.bend * (ratio * ratio) + self.rounding
    }
}

/// The constants of a frame.
#[derive(Debug, Clone)]
pub(super) struct View {
    /// By octree level.
    pub(super) levels: Vec<Level>,
    /// Octree level of the finest voxels.
    pub(super) depth: u32,
    /// Clip vector of the object's lowest corner.
    pub(super) origin: [f64; 3],
    /// Samples a side of the image root.
    pub(super) root_samples: f64,
    /// Fraction bits of screen positions.
    pub(super) frac: u32,
    /// Level of detail in the unit of screen positions.
    pub(super) lod_limit: i64,
    /// Fraction bits of strips beyond those that their levels need.
    pub(super) strip_guard: u32,
    /// See [`FrameSetup::strip_slack`].
    pub(super) strip_slack: Option<u32>,
    /// The eye, finest voxels, rounded down.
    pub(super) eye_floor: [i64; 3],
    /// Under the rule that blends.
    pub(super) opacity_eye: Option<OpacityEye>,
    /// What windows of clip-space boxes are widened by, samples.
    pub(super) margin: f64,
    /// In a frame without tolerance: how far lattices are from the truth. What
    /// they find is then decided exactly.
    pub(super) search: Option<Search>,
}

impl View {
    /// The constants of a frame, or `None` where this engine has no exact
    /// numbers for it: other coverage rules, no bound on the deviation,
    /// numbers too large, words that may overflow.
    pub(super) fn new(setup: &FrameSetup) -> Option<Self> {
        let options = &setup.options;
        let tolerance = options.tolerance_px;
        let reach = setup.position_reach()?;
        let frac = setup.format.frac();
        if !options.coverage.draws_outlines()
            || !tolerance.is_finite()
            || !setup.has_headroom
            || reach * 16 >= EXACT_LIMIT
            || setup.levels + frac + 5 > MAX_POSITION_BITS
        {
            return None;
        }
        let search = (tolerance == 0.0).then(|| Search {
            bend: SEARCH_TOLERANCE - setup.lattice_rounding(),
            rounding: setup.lattice_rounding(),
        });
        let screen_depth = match search {
            Some(_) => setup.lattice_depths(SEARCH_TOLERANCE),
            None => setup.screen_depth.clone(),
        };
        let edge = setup.edge_clip.map(|e| e.map(|c| c as f64));
        let levels = (0..=setup.depth)
            .map(|level| level_constants(setup, &edge, &screen_depth, level))
            .collect();
        let far = 1i64 << setup.depth;
        let unit = libm::ldexp(1.0, frac as i32);
        let lod = setup.lod_limit.as_ref().map_or(0.0, |l| l.value());
        Some(Self {
            levels,
            depth: setup.depth,
            origin: setup.origin_clip.map(|c| c as f64),
            root_samples: libm::ldexp(1.0, setup.levels as i32),
            frac,
            lod_limit: (libm::floor(lod * unit) as i64).max(LEAST_SIZE),
            strip_guard: setup.strip_guard,
            strip_slack: setup.strip_slack,
            eye_floor: setup.eye_floor.map(|c| c.clamp(-1, far + 1)),
            opacity_eye: (options.coverage == Coverage::Alpha).then(|| setup.opacity_eye()),
            margin: tolerance + QUOTIENT_MARGIN,
            search,
        })
    }

    /// Which octant is nearest for a voxel with this centre: bit k is set
    /// where the centre is above the eye.
    #[inline(always)]
    pub(super) fn octant(&self, min: [i32; 3], half_side: i32) -> u8 {
        let mut octant = 0;
        for k in 0..3 {
            let centre = i64::from(min[k]) + i64::from(half_side);
            octant = octant << 1 | u8::from(self.eye_floor[k] < centre);
        }
        octant
    }

    /// The octant of all voxels of any size inside a box, if it is one.
    #[inline(always)]
    pub(super) fn common_octant(&self, min: [i32; 3], side: i32, least_half: i32) -> Option<u8> {
        let mut octant = 0;
        for k in 0..3 {
            let low = i64::from(min[k]) + i64::from(least_half);
            let high = i64::from(min[k]) + i64::from(side) - i64::from(least_half);
            let eye = self.eye_floor[k];
            if eye >= low && eye < high {
                return None;
            }
            octant = octant << 1 | u8::from(eye < low);
        }
        Some(octant)
    }
}

/// Size, in units of the last place of a screen position, below which nothing
/// is subdivided (the machine's `LEAST_SIZE`).
const LEAST_SIZE: i64 = 4;

fn level_constants(
    setup: &FrameSetup,
    edge: &[[f64; 3]; 3],
    screen_depth: &[i64],
    level: u32,
) -> Level {
    let side = f64::from(1u32 << (setup.depth - level));
    let corner = |index: usize, scale: f64| -> [f64; 3] {
        std::array::from_fn(|c| {
            (0..3)
                .filter(|k| index >> (2 - k) & 1 != 0)
                .map(|k| edge[k][c] * scale)
                .sum::<f64>()
        })
    };
    let corners: [[f64; 3]; 8] = std::array::from_fn(|index| corner(index, side));
    let vertices: Vertices = std::array::from_fn(|c| corners.map(|corner| corner[c]));
    let depth = |depths: &[i64]| match depths[level as usize] {
        i64::MAX => f64::INFINITY,
        w => w as f64,
    };
    Level {
        child: std::array::from_fn(|index| corner(index, side / 2.0)),
        w_span: [
            vertices[2].iter().copied().fold(f64::MAX, f64::min),
            vertices[2].iter().copied().fold(f64::MIN, f64::max),
        ],
        vertices,
        screen_depth: depth(screen_depth),
        lod_depth: depth(&setup.lod_depth),
        side: 1i32 << (setup.depth - level),
    }
}
