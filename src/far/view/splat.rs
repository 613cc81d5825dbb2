//! A voxel in the picture: a square of the size of its cube's outline.

use glam::DVec3;

use super::{in_view, on_picture};
use crate::far::record::Node;
use crate::mesh::raster::RasterCamera;

/// Where the voxels of a node are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places {
    origin: DVec3,
    voxel: f64,
}

/// A voxel's square.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Square {
    /// Its middle, pixels.
    pub(super) middle: [f64; 2],
    /// Half its side, pixels: its area is that of the cube's outline.
    pub(super) half: f64,
    /// View-axis depth of the cube's middle.
    pub(super) depth: f64,
    /// Unit vector to the eye.
    pub(super) towards_eye: DVec3,
}

impl Places {
    pub(super) fn of(node: &Node, centre: DVec3) -> Self {
        Self {
            origin: DVec3::from_array(node.origin.map(f64::from)) + centre,
            voxel: f64::from(node.voxel),
        }
    }

    /// The direction from the middle of a voxel to the eye.
    pub(super) fn towards_eye(&self, view: &RasterCamera, place: &[u8]) -> DVec3 {
        (view.eye - self.middle(place)).normalize_or(-view.forward)
    }

    fn middle(&self, place: &[u8]) -> DVec3 {
        let place = DVec3::new(
            f64::from(place[0]),
            f64::from(place[1]),
            f64::from(place[2]),
        );
        self.origin + (place + DVec3::splat(0.5)) * self.voxel
    }

    /// The square of a voxel; `None` before the near plane.
    pub(super) fn square(&self, view: &RasterCamera, place: &[u8]) -> Option<Square> {
        let seen = in_view(view, self.middle(place));
        if seen.z < view.near {
            return None;
        }
        let towards_eye = self.towards_eye(view, place);
        // The outline of a unit cube has this area.
        let outline = towards_eye.abs().element_sum();
        let side = self.voxel * view.focal_px / seen.z * libm::sqrt(outline);
        Some(Square {
            middle: on_picture(view, seen),
            half: side / 2.0,
            depth: seen.z,
            towards_eye,
        })
    }
}

impl Square {
    /// First pixel and the one after the last, right and down, of those whose
    /// middles it covers, when it is made a pixel large at least.
    pub(super) fn pixels(&self, view: &RasterCamera) -> [[usize; 2]; 2] {
        let half = self.half.max(0.5);
        let range = |k: usize, side: u32| {
            let most = f64::from(side);
            // Within the picture.
            let at = |c: f64| (c - 0.5).ceil().clamp(0.0, most) as usize;
            [at(self.middle[k] - half), at(self.middle[k] + half)]
        };
        let ([x0, x1], [y0, y1]) = (range(0, view.width), range(1, view.height));
        [[x0, y0], [x1, y1]]
    }

    /// First pixel and the one after the last of those that it touches.
    pub(super) fn touched(&self, view: &RasterCamera) -> [[usize; 2]; 2] {
        let range = |k: usize, side: u32| {
            let most = f64::from(side);
            let low = (self.middle[k] - self.half).floor().clamp(0.0, most) as usize;
            let high = (self.middle[k] + self.half).ceil().clamp(0.0, most) as usize;
            [low, high]
        };
        let ([x0, x1], [y0, y1]) = (range(0, view.width), range(1, view.height));
        [[x0, y0], [x1, y1]]
    }

    /// The share of a pixel that it covers.
    pub(super) fn share(&self, x: usize, y: usize) -> f64 {
        let along = |k: usize, pixel: usize| {
            let low = (self.middle[k] - self.half).max(pixel as f64);
            let high = (self.middle[k] + self.half).min(pixel as f64 + 1.0);
            (high - low).max(0.0)
        };
        along(0, x) * along(1, y)
    }
}
