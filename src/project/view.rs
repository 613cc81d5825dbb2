//! The view of an object in real numbers, and what is made of it: integers,
//! and the depths by level at which records change.

use hwmodel::Format;

use super::camera::{Camera, HostAxes};
use super::depths::{self, Edges};
use super::host::{Host, Num, Real, lift_all};
use super::reach::{Quantised, Reach};
use super::setup::{
    Coverage, MAX_CLIP_FRAC, MAX_SUB_LEVELS, SetupOptions, detail_limit, split_fraction,
};
use crate::graph::Placement;

/// The view of the object in real numbers.
pub(super) struct View<H> {
    /// Clip vectors of a voxel's edges.
    edge: [[Real<H>; 3]; 3],
    /// The eye in object coordinates, voxels.
    eye: [Real<H>; 3],
    /// Pixels of the image root, as a power of two.
    root_px_log2: u32,
    /// Is told of all steps.
    by: H,
}

impl<H: Host> View<H> {
    pub(super) fn new(
        by: H,
        camera: &Camera,
        axes: &HostAxes<H>,
        placement: &Placement,
        root_px_log2: u32,
    ) -> Self {
        let root_px = (by.lift(1u64) << root_px_log2).to_real();
        let half = |pixels: u32| by.lift(u64::from(pixels)).to_real() / 2.0;
        let (centre_x, centre_y) = (half(camera.width), half(camera.height));
        let up_focal = -axes.focal_px;
        let edge = [0, 1, 2].map(|k| {
            let (right, up, forward) = (axes.right[k], axes.up[k], axes.forward[k]);
            let x = (right * axes.focal_px + forward * centre_x) / root_px;
            let y = (up * up_focal + forward * centre_y) / root_px;
            [x, y, forward]
        });
        let eye_world = lift_all(by, camera.eye.to_array());
        let eye = [0, 1, 2].map(|k| {
            let origin = by.lift(placement.origin_index[k]).to_real();
            (eye_world[k] - placement.world_origin[k]) / placement.voxel_size - origin
        });
        Self {
            edge,
            eye,
            root_px_log2,
            by,
        }
    }

    /// Integers of `2^-frac` voxels, if they fit 64 bits with room.
    ///
    /// The origin is made from the rounded edges, so that the eye stays where
    /// the camera has it and only the view's shape is rounded.
    pub(super) fn quantise(&self, frac: u32) -> Option<Quantised<H>> {
        let scale = (self.by.lift(1u64) << frac).to_real();
        let mut edge = [[self.by.lift(0); 3]; 3];
        for (to, from) in edge.iter_mut().zip(&self.edge) {
            for (to, &from) in to.iter_mut().zip(from) {
                *to = to_i64(from * scale)?;
            }
        }
        let mut origin = [self.by.lift(0); 3];
        for (c, value) in origin.iter_mut().enumerate() {
            let [x, y, z] = [0, 1, 2].map(|k| edge[k][c].to_real() * self.eye[k]);
            *value = to_i64(-(x + y + z))?;
        }
        Some(Quantised { origin, edge })
    }

    /// The most fraction bits, and levels below a finest voxel, with which
    /// positions fit a word and silhouette planes a wide word, with headroom
    /// (bisector tests take `2X - W`, the divide `X + 4W` and `8W`).
    pub(super) fn widest_fraction(
        &self,
        depth: u32,
        format: Format,
        coverage: Coverage,
    ) -> (u32, u32) {
        let fits = |frac: u32, shift: u32, plane_too: bool| {
            self.quantise(frac)
                .and_then(|view| Reach::of(&view, depth))
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

    fn edges(&self, options: &SetupOptions) -> Edges<H> {
        Edges {
            edge: self.edge,
            root_samples: (self.by.lift(1u64) << (self.root_px_log2 + options.aa_log2)).to_real(),
            by: self.by,
        }
    }

    /// Least `W`, by level, at which a record deviates from its screen-space
    /// cage by at most the tolerance: `SPEC.md`, "The change to screen space".
    pub(super) fn screen_depths(
        &self,
        levels: &Levels<H>,
        options: &SetupOptions,
        screen_frac: u32,
    ) -> Vec<i64> {
        let tolerance = self.by.lift(options.tolerance_px);
        if tolerance.is_infinite() {
            return levels.all(levels.near.value);
        }
        let allowed = (tolerance - depths::rounding(self.by, screen_frac)) * (1.0 - 1e-6);
        if tolerance == 0.0 || allowed <= 0.0 {
            return levels.all(i64::MAX);
        }
        levels.scaled(self.edges(options).screen_depth(allowed))
    }

    /// Least `W`, by level, at which a node with children is no larger than
    /// the level of detail, wherever in the picture.
    pub(super) fn lod_depths(&self, levels: &Levels<H>, options: &SetupOptions) -> Vec<i64> {
        match detail_limit(self.by, options) {
            Some(limit) => levels.scaled(self.edges(options).detail_depth(limit.value_by(self.by))),
            None => levels.all(i64::MAX),
        }
    }
}

/// The octree levels of a frame, and the unit of its depths.
pub(super) struct Levels<H> {
    /// Level of the finest voxels.
    pub(super) depth: u32,
    /// Deepest level of a record.
    pub(super) bound: u32,
    pub(super) clip_frac: u32,
    /// Least of all depths below.
    pub(super) near: Num<H, i64>,
}

impl<H: Host> Levels<H> {
    /// By level, the depth that is `unit` for a finest voxel, in clip units, rounded up.
    pub(super) fn scaled(&self, unit: Real<H>) -> Vec<i64> {
        let at = |level: u32| {
            // A record's side in voxels, exact in f64.
            let side = unit.scaled(self.depth as i32 - level as i32);
            let depth = side.scaled(self.clip_frac as i32).ceil();
            to_i64(depth).map_or(i64::MAX, |w| w.max(self.near).value)
        };
        (0..=self.bound).map(at).collect()
    }

    /// The same depth at all levels.
    fn all(&self, depth: i64) -> Vec<i64> {
        vec![depth; self.bound as usize + 1]
    }
}

/// A rounded f64 that fits 62 bits.
fn to_i64<H: Host>(value: Real<H>) -> Option<Num<H, i64>> {
    let rounded = value.round();
    (rounded.abs() < (1u64 << 62) as f64).then(|| rounded.to_i64())
}
