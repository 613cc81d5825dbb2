//! The view in real numbers, its quantisation, and the depths by level at which records change (`SPEC.md`, "The change to
//! screen space", "Drawing rules"). At twice the depth a voxel of twice the side looks the same, so one ratio of side to
//! depth serves all levels.

use hwmodel::Format;

use super::camera::{Axes, Camera};
use super::options::{
    Coverage, MAX_CLIP_FRAC, MAX_SUB_LEVELS, SCREEN_GUARD_SHIFT, SetupOptions, detail_limit,
    split_fraction,
};
use super::reach::{Quantised, Reach};
use crate::graph::Placement;

pub(super) struct RealView {
    edge: [[f64; 3]; 3],
    /// A point of the object, voxels, that rounding leaves in place, and its clip vector: the eye, or what parallel rays
    /// have in the middle.
    anchor: [f64; 3],
    anchor_clip: [f64; 3],
    /// Pixels of the image root, as a power of two.
    root_px_log2: u32,
}

impl RealView {
    /// Parallel rays meet `distance` voxels before the target, and the picture is moved by `shift` pixels to the left and
    /// up; other cameras do not use either.
    pub(super) fn new(
        camera: &Camera,
        axes: &Axes,
        placement: &Placement,
        root_px_log2: u32,
        distance: f64,
        shift: f64,
    ) -> Self {
        let root_px = (1u64 << root_px_log2) as f64;
        let half = |pixels: u32| f64::from(pixels) / 2.0;
        let (centre_x, centre_y) = (half(camera.width), half(camera.height));
        let focal_px = match camera.ortho {
            Some(_) => axes.focal_px * placement.voxel_size * distance,
            None => axes.focal_px,
        };
        let up_focal = -focal_px;
        let edge = [0, 1, 2].map(|k| {
            let (right, up, forward) = (axes.right[k], axes.up[k], axes.forward[k]);
            let x = (right * focal_px + forward * centre_x) / root_px;
            let y = (up * up_focal + forward * centre_y) / root_px;
            [x, y, forward]
        });
        let (anchor, anchor_clip) = match camera.ortho {
            Some(_) => {
                let [x, y] = [centre_x, centre_y].map(|c| (c - shift) / root_px * distance);
                (camera.target, [x, y, distance])
            }
            None => (camera.eye, [0.0; 3]),
        };
        Self {
            edge,
            anchor: placement.in_voxels(anchor),
            anchor_clip,
            root_px_log2,
        }
    }

    /// Integers of `2^-frac` voxels, if they fit. The origin follows from the rounded edges, so the anchor stays in place.
    pub(super) fn quantise(&self, frac: u32) -> Option<Quantised> {
        let scale = (1u64 << frac) as f64;
        let mut edge = [[0; 3]; 3];
        for (to, from) in edge.iter_mut().zip(&self.edge) {
            for (to, &from) in to.iter_mut().zip(from) {
                *to = to_i64(from * scale)?;
            }
        }
        let mut origin = [0; 3];
        for (c, value) in origin.iter_mut().enumerate() {
            let [x, y, z] = [0, 1, 2].map(|k| edge[k][c] as f64 * self.anchor[k]);
            *value = to_i64(self.anchor_clip[c] * scale - (x + y + z))?;
        }
        Some(Quantised { origin, edge })
    }

    /// The most fraction bits, and levels below a finest voxel, with which words have headroom.
    pub(super) fn widest_fraction(
        &self,
        depth: u32,
        format: Format,
        coverage: Coverage,
    ) -> (u32, u32) {
        let fits = |frac: u32, shift: u32, plane_too: bool| {
            self.quantise(frac)
                .and_then(|quantised| Reach::of(&quantised, depth))
                .is_some_and(|reach| {
                    reach.position_fits(format, shift) && (!plane_too || reach.plane_fits(format))
                })
        };
        let plane_frac = (0..=MAX_CLIP_FRAC).rev().find(|&f| fits(f, 0, true));
        let Some(plane_frac) = plane_frac else {
            return (0, 0);
        };
        let room = (0..=MAX_SUB_LEVELS)
            .rev()
            .find(|&shift| fits(plane_frac, shift, false))
            .unwrap_or(0);
        split_fraction(plane_frac + room, plane_frac, coverage)
    }

    /// Sum over a finest voxel's edges of the speed of a picture position, samples times depth. Convex functions are
    /// greatest at the ends.
    fn total_speed(&self, options: &SetupOptions) -> f64 {
        let root_samples = (1u64 << (self.root_px_log2 + options.aa_log2)) as f64;
        let guard = libm::ldexp(1.0, -(SCREEN_GUARD_SHIFT as i32));
        let mut most = 0.0f64;
        for axis in 0..2 {
            let [low, high] = [-guard, guard + 1.0].map(|position| {
                let speed = |e: [f64; 3]| (e[axis] - position * e[2]) * root_samples;
                self.edge.map(|e| speed(e).abs())
            });
            let [x, y, z] = [0, 1, 2].map(|k| low[k].max(high[k]));
            most = most.max(x + y + z);
        }
        most
    }

    /// Least `W`, by level, at which a record deviates from its screen-space cage by at most the tolerance.
    pub(super) fn screen_depths(
        &self,
        levels: &Levels,
        options: &SetupOptions,
        screen_frac: u32,
    ) -> Vec<i64> {
        let tolerance = options.tolerance_px;
        if tolerance.is_infinite() {
            return levels.all(levels.near);
        }
        // Quotients are rounded down, a corner and three edges by one unit each.
        let rounding = libm::ldexp(4.0, -(screen_frac as i32));
        let allowed = (tolerance - rounding) * (1.0 - 1e-6);
        if tolerance == 0.0 || allowed <= 0.0 {
            return levels.all(i64::MAX);
        }
        let [x, y, z] = self.edge.map(|e| e[2].abs());
        let speed = self.total_speed(options);
        levels.scaled(libm::sqrt(speed * (x + y + z) / allowed))
    }

    /// Least `W`, by level, at which a node with children is no larger than the level of detail.
    pub(super) fn lod_depths(&self, levels: &Levels, options: &SetupOptions) -> Vec<i64> {
        match detail_limit(options) {
            Some(limit) => levels.scaled(self.total_speed(options) / limit.value()),
            None => levels.all(i64::MAX),
        }
    }
}

/// The octree levels of a frame, and the unit of its depths.
pub(super) struct Levels {
    pub(super) depth: u32,
    pub(super) bound: u32,
    pub(super) clip_frac: u32,
    /// Lower bound of all depths below.
    pub(super) near: i64,
}

impl Levels {
    /// By level, the depth that is `unit` for a finest voxel, in clip units, rounded up.
    pub(super) fn scaled(&self, unit: f64) -> Vec<i64> {
        let at = |level: u32| {
            let side = libm::ldexp(unit, self.depth as i32 - level as i32);
            let depth = libm::ceil(libm::ldexp(side, self.clip_frac as i32));
            to_i64(depth).map_or(i64::MAX, |w| w.max(self.near))
        };
        (0..=self.bound).map(at).collect()
    }

    fn all(&self, depth: i64) -> Vec<i64> {
        vec![depth; self.bound as usize + 1]
    }
}

/// A rounded f64 that fits 62 bits.
fn to_i64(value: f64) -> Option<i64> {
    let rounded = libm::round(value);
    (rounded.abs() < (1u64 << 62) as f64).then_some(rounded as i64)
}
