//! Constants of a frame, and the nearest octant (R9). Clip vectors of nodes are halves of whole numbers, exact in `f64`,
//! so level of detail compares the same depths as the machine.

use crate::project::vector::cross;
use crate::project::{FrameSetup, OpacityEye};

/// Bound of positions times sixteen: whole numbers of an `f64`.
const EXACT_LIMIT: i128 = 1 << 53;

/// Bound of the error in `f64` of a direction, relative to the size of its terms ([`is_rough`]).
pub(super) const DIRECTION_ERROR: f64 = 1.0 / (1u64 << 25) as f64;
/// The same relative to the products whose differences are its coefficients (`doubles.gappa`).
pub(super) const PRODUCT_ERROR: f64 = 1.0 / (1u64 << 49) as f64;

/// Most of the image root's width over the focal length: fields of view up to about 179.97 degrees.
const MOST_WIDTH: f64 = (1 << 13) as f64;
/// Most of that width squared over the focal length, samples, for the slopes in `f64` (`spec/fast.md`, section 2).
const MOST_AREA: f64 = (1 << 25) as f64;
/// Least size of voxels drawn one by one (`voxels.rs`), samples. This and the next two are measured.
const COARSE_SAMPLES: f64 = 3.0;
/// Largest size of voxels of bricks of four levels.
const FINE_SAMPLES: f64 = 1.1;
/// Least size of a cube drawn by its planes (`planes.rs`).
const LARGE_SAMPLES: f64 = 24.0;

const TINY_SAMPLES: f64 = 1.0 / 8.0;

#[derive(Debug, Clone)]
pub(super) struct Level {
    /// The children's centres relative to their parent's: by coordinate of the clip vector, then by octant.
    pub(super) child: [[f64; 8]; 3],
    pub(super) vertices: [[f64; 8]; 3],
    pub(super) half_depth: f64,
    pub(super) lod_depth: f64,
    pub(super) side: i32,
    pub(super) inverse_side: f64,
    /// Largest depth at which parts of a quarter of a node's side are coarse ([`COARSE_SAMPLES`]).
    pub(super) coarse_depth: f64,
    /// Least depth at which parts of a sixteenth of its side are fine ([`FINE_SAMPLES`]).
    pub(super) fine_depth: f64,
    pub(super) tiny_depth: f64,
    pub(super) large_depth: f64,
}

#[derive(Debug, Clone)]
pub(super) struct Constants {
    pub(super) levels: Vec<Level>,
    pub(super) depth: u32,
    pub(super) centre: [f64; 3],
    pub(super) root_samples: f64,
    /// Clip vectors of a finest voxel's edges, X and Y in samples from the centre of the first sample:
    /// `(R e_X - e_W / 2, R e_Y - e_W / 2, e_W)`.
    pub(super) edge: [[f64; 3]; 3],
    /// Direction of a ray, by axis: `[per column, per row, at sample 0]`. Scaled to about 1.
    pub(super) direction: [[f64; 3]; 3],
    pub(super) direction_lanes: [[f32; 4]; 3],
    pub(super) edge_columns: [[f64; 4]; 3],
    pub(super) edge_lanes: [[f32; 3]; 3],
    pub(super) scale: f64,
    pub(super) inverse_scale: f64,
    pub(super) eye_floor: [i64; 3],
    pub(super) opacity_eye: Option<OpacityEye>,
}

impl Constants {
    /// An error is the counter of frames that are declined for this reason: the machine's own steps define the rule, words
    /// may overflow, positions exceed an `f64`, or slopes round too much.
    pub(super) fn new(setup: &FrameSetup) -> Result<Self, &'static str> {
        if !setup.options.coverage.draws_outlines() || setup.options.tolerance_px != 0.0 {
            return Err("handed_for_rule");
        }
        if !setup.has_headroom {
            return Err("handed_for_words");
        }
        let reach = setup.position_reach().ok_or("handed_for_range")?;
        if reach * 16 >= EXACT_LIMIT {
            return Err("handed_for_range");
        }
        let root_samples = libm::ldexp(1.0, setup.levels as i32);
        let clip = setup.edge_clip.map(|e| e.map(|c| c as f64));
        let edge =
            clip.map(|[x, y, w]| [x * root_samples - w / 2.0, y * root_samples - w / 2.0, w]);
        let middle = [f64::from(setup.width) / 2.0, f64::from(setup.height) / 2.0];
        let normal = [0, 1, 2].map(|k| cross(edge[(k + 1) % 3], edge[(k + 2) % 3]));
        let at_middle = |n: [f64; 3]| (n[0] * middle[0] + n[1] * middle[1] + n[2]).abs();
        let length = normal
            .map(at_middle)
            .into_iter()
            .fold(f64::MIN_POSITIVE, f64::max);
        let scale = if setup.positive { 1.0 } else { -1.0 } / length;
        let direction = normal.map(|n| n.map(|c| c * scale));
        let column = |i: usize| {
            let [x, y, z] = [0, 1, 2].map(|k| direction[k][i] as f32);
            [x, y, z, 0.0]
        };
        // From the first sample's centre, the middle is half a sample nearer.
        let across = edge.map(|e| e[0] - (middle[0] - 0.5) * e[2]);
        let focal = libm::sqrt(across.iter().map(|x| x * x).sum());
        let unit = libm::sqrt(edge.iter().map(|e| e[2] * e[2]).sum());
        let is_wide = root_samples * unit > MOST_WIDTH.min(MOST_AREA / root_samples) * focal;
        let size = [f64::from(setup.width), f64::from(setup.height), 1.0];
        if is_wide || (0..3).any(|k| is_rough(edge[(k + 1) % 3], edge[(k + 2) % 3], size)) {
            return Err("handed_for_field_of_view");
        }
        let levels = (0..=setup.depth)
            .map(|level| level_constants(setup, &clip, focal, level))
            .collect();
        let far = 1i64 << setup.depth;
        let half = far as f64 / 2.0;
        let centre = [0, 1, 2].map(|c| {
            let edges = clip[0][c] + clip[1][c] + clip[2][c];
            setup.origin_clip[c] as f64 + edges * half
        });
        Ok(Self {
            levels,
            depth: setup.depth,
            centre,
            root_samples,
            edge,
            direction,
            direction_lanes: [column(0), column(1), column(2)],
            edge_columns: [0, 1, 2].map(|c| [edge[0][c], edge[1][c], edge[2][c], 0.0]),
            edge_lanes: edge.map(|e| e.map(|c| c as f32)),
            scale,
            inverse_scale: 1.0 / scale,
            eye_floor: setup.eye_floor.map(|c| c.clamp(-1, far + 1)),
            opacity_eye: (setup.options.coverage.blends()).then(|| setup.opacity_eye()),
        })
    }

    pub(super) fn rows(&self, height: u32) -> std::ops::Range<usize> {
        let vertices = &self.levels[0].vertices;
        let mut rows = [f64::INFINITY, f64::NEG_INFINITY];
        for vertex in 0..8 {
            let [y, w] = [1, 2].map(|c| self.centre[c] + vertices[c][vertex]);
            if w <= 0.0 {
                return 0..height as usize;
            }
            let row = y / w * self.root_samples;
            rows = [rows[0].min(row), rows[1].max(row)];
        }
        let [top, bottom] = rows.map(|row| row.clamp(0.0, f64::from(height)) as usize);
        top..bottom
    }

    #[inline(always)]
    pub(super) fn nearest_octant(&self, min: [i32; 3], half_side: i32) -> u8 {
        let mut octant = 0;
        for k in 0..3 {
            let centre = i64::from(min[k]) + i64::from(half_side);
            octant = octant << 1 | u8::from(self.eye_floor[k] >= centre);
        }
        octant
    }
}

/// Whether the coefficients of a direction `a x b` lose too many digits where products of `f64` nearly cancel.
fn is_rough(a: [f64; 3], b: [f64; 3], size: [f64; 3]) -> bool {
    let product = |i: usize, c: usize| (a[(c + i) % 3] * b[(c + 3 - i) % 3]).abs();
    let products: f64 = (0..3)
        .map(|c| (product(1, c) + product(2, c)) * size[c])
        .sum();
    let terms: f64 = cross(a, b).map(f64::abs).iter().sum();
    products * PRODUCT_ERROR > terms * DIRECTION_ERROR
}

/// `clip`: a finest voxel's edges. `focal`: samples that it takes, times its depth.
fn level_constants(setup: &FrameSetup, clip: &[[f64; 3]; 3], focal: f64, level: u32) -> Level {
    let side = f64::from(1u32 << (setup.depth - level));
    let corners = |half: f64| -> [[f64; 8]; 3] {
        [0, 1, 2].map(|c| {
            std::array::from_fn(|octant: usize| {
                let sign = |k: usize| {
                    if octant >> (2 - k) & 1 == 1 {
                        half
                    } else {
                        -half
                    }
                };
                (0..3).map(|k| clip[k][c] * sign(k)).sum()
            })
        })
    };
    Level {
        child: corners(side / 4.0),
        vertices: corners(side / 2.0),
        half_depth: clip.iter().map(|e| e[2].abs()).sum::<f64>() * side / 2.0,
        lod_depth: match setup.lod_depth[level as usize] {
            i64::MAX => f64::INFINITY,
            w => w as f64,
        },
        side: 1i32 << (setup.depth - level),
        inverse_side: 1.0 / side,
        coarse_depth: focal * side / 4.0 / COARSE_SAMPLES,
        fine_depth: focal * side / 16.0 / FINE_SAMPLES,
        tiny_depth: focal * side / TINY_SAMPLES,
        large_depth: focal * side / LARGE_SAMPLES,
    }
}

#[test]
fn directions_of_nearly_parallel_edges_are_rough() {
    let is_rough_at = |turn: f64| is_rough([1.0, 1.0, 0.0], [1.0, 1.0 + turn, 0.0], [1.0; 3]);
    assert!(is_rough_at(1e-9) && !is_rough_at(1e-6));
}
