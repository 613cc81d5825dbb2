//! The nodes to draw: those whose voxels are small enough, else their children.

use glam::DVec3;

use super::FarCounts;
use crate::far::store::FarFile;
use crate::geometry::point;
use crate::raster::RasterCamera;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chosen {
    pub(super) number: usize,
    /// Its voxels and triangles are drawn; else its children are, and the outline holds all that is below.
    pub(super) is_drawn: bool,
    /// Of the eye from its box and from the box's middle, world units.
    pub(super) distance: f64,
    pub(super) middle: f64,
    pub(super) outline: Outline,
}

/// Where in the picture a node may show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Outline {
    /// The first and the last pixel, also outside the picture. `None` if the box reaches behind the eye.
    pub(super) pixels: Option<[[f64; 2]; 2]>,
    pub(super) depth: f64,
    pub(super) farthest: f64,
}

impl Outline {
    fn of(view: &RasterCamera, low: DVec3, high: DVec3, margin: f64) -> Self {
        let (low, high) = (low - DVec3::splat(margin), high + DVec3::splat(margin));
        let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        let (mut depth, mut farthest) = (f64::INFINITY, f64::NEG_INFINITY);
        for corner in 0..8 {
            let seen = view.seen(point([0, 1, 2].map(|k| [low, high][corner >> k & 1][k])));
            depth = depth.min(seen.z);
            farthest = farthest.max(seen.z);
            if seen.z >= view.near {
                let place = view.place(seen);
                for k in 0..2 {
                    bounds[0][k] = bounds[0][k].min(place[k]);
                    bounds[1][k] = bounds[1][k].max(place[k]);
                }
            }
        }
        let pixels = [
            bounds[0].map(|c| (c - 1.5).floor()),
            bounds[1].map(|c| (c + 1.5).ceil()),
        ];
        Self {
            pixels: (depth >= view.near).then_some(pixels),
            depth,
            farthest,
        }
    }

    fn is_outside(&self, view: &RasterCamera) -> bool {
        if self.farthest < view.near {
            return true;
        }
        self.pixels.is_some_and(|[low, high]| {
            high[0] < 0.0
                || high[1] < 0.0
                || low[0] >= f64::from(view.width)
                || low[1] >= f64::from(view.height)
        })
    }
}

const BRANCH_MARGIN: f64 = 2.0;

#[derive(Debug, Clone, Copy)]
pub(super) struct Cut<'f> {
    pub(super) file: &'f FarFile,
    pub(super) view: RasterCamera,
    pub(super) voxel_px: f64,
}

impl Cut<'_> {
    /// Classifies a node; `None` if it is beside or behind the picture.
    pub(super) fn classify(&self, number: usize, counts: &mut FarCounts) -> Option<Chosen> {
        counts.visited += 1;
        let node = &self.file.nodes()[number];
        let centre = self.file.settings.centre;
        let (low, high) = node.bounds();
        let (low, high) = (low + centre, high + centre);
        let voxel = f64::from(node.voxel);
        let eye = self.view.eye;
        let distance = (low - eye).max(eye - high).max(DVec3::ZERO).length();
        let is_small = voxel * self.view.focal_px <= self.voxel_px * distance;
        // Nearer, things that hide it may be behind the eye, unless the eye is outside the box of everything.
        let all = self.file.bounds();
        let is_outside_all = eye.cmplt(all.0).any() || eye.cmpgt(all.1).any();
        let is_far = distance >= self.file.settings.distance_voxels * voxel || is_outside_all;
        let is_drawn = node.is_leaf() || node.has_grid() && is_small && is_far;
        // Voxels are drawn as squares that reach beyond their cubes.
        let margin = if is_drawn {
            voxel
        } else {
            let least = (high - low).max_element() / f64::from(self.file.settings.grid - 1);
            BRANCH_MARGIN * voxel.max(least)
        };
        let outline = Outline::of(&self.view, low, high, margin);
        if outline.is_outside(&self.view) {
            counts.outside += 1;
            return None;
        }
        Some(Chosen {
            number,
            is_drawn,
            distance,
            middle: ((low + high) / 2.0 - eye).length(),
            outline,
        })
    }

    pub(super) fn children(&self, number: usize) -> impl Iterator<Item = usize> + use<> {
        self.file.nodes()[number].below()
    }
}
