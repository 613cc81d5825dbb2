//! Which nodes are drawn: those whose voxels are small enough, else their children.

use glam::DVec3;

use super::{Counts, in_view, on_picture};
use crate::far::store::FarFile;
use crate::mesh::raster::View;

/// A node of the cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chosen {
    pub(super) number: usize,
    /// Distance of the eye from its box, world units.
    pub(super) distance: f64,
    /// Distance of the eye from the middle of its box, world units.
    pub(super) middle: f64,
    pub(super) outline: Outline,
}

/// Where in the picture a node may show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Outline {
    /// First and last pixel, right and down, also outside the picture; `None`:
    /// anywhere, since the box reaches behind the eye.
    pub(super) pixels: Option<[[f64; 2]; 2]>,
    /// Depth of its nearest point.
    pub(super) depth: f64,
    /// Depth of its farthest point.
    pub(super) farthest: f64,
}

impl Outline {
    /// Of a box, and everything within `margin` of it.
    fn of(view: &View, low: DVec3, high: DVec3, margin: f64) -> Self {
        let (low, high) = (low - DVec3::splat(margin), high + DVec3::splat(margin));
        let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        let (mut depth, mut farthest) = (f64::INFINITY, f64::NEG_INFINITY);
        for corner in 0..8 {
            let pick = |k: usize| {
                if corner >> k & 1 == 1 {
                    high[k]
                } else {
                    low[k]
                }
            };
            let seen = in_view(view, DVec3::new(pick(0), pick(1), pick(2)));
            depth = depth.min(seen.z);
            farthest = farthest.max(seen.z);
            if seen.z >= view.near {
                let place = on_picture(view, seen);
                for k in 0..2 {
                    bounds[0][k] = bounds[0][k].min(place[k]);
                    bounds[1][k] = bounds[1][k].max(place[k]);
                }
            }
        }
        // A pixel more, since a voxel covers one at least.
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

    fn is_outside(&self, view: &View) -> bool {
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

/// The cut that `cut_of` asks for, of what is in `view`, from near to far.
pub(super) fn cut(
    file: &FarFile,
    view: &View,
    cut_of: &View,
    voxel_px: f64,
    counts: &mut Counts,
) -> Vec<Chosen> {
    let mut chosen = Vec::new();
    let mut waiting = vec![0];
    while let Some(number) = waiting.pop() {
        counts.visited += 1;
        let node = &file.nodes()[number];
        let (low, high) = node.bounds();
        let (low, high) = (low + file.centre(), high + file.centre());
        // Voxels are drawn as squares that reach beyond their cubes.
        let outline = Outline::of(view, low, high, f64::from(node.voxel));
        if outline.is_outside(view) {
            counts.outside += 1;
            continue;
        }
        let distance_from = |eye: DVec3| (low - eye).max(eye - high).max(DVec3::ZERO).length();
        let distance = distance_from(view.eye);
        let from = distance_from(cut_of.eye);
        let voxel = f64::from(node.voxel);
        let is_small = voxel * cut_of.focal_px <= voxel_px * from;
        // Nearer, things that were taken to hide it may be behind the eye.
        let is_far = from >= file.distance_voxels() * voxel;
        if !(node.is_leaf() || is_small && is_far) {
            waiting.extend(node.children.map(|child| child as usize));
            continue;
        }
        if node.is_leaf() {
            counts.leaves += 1;
        } else {
            counts.voxel_nodes += 1;
        }
        chosen.push(Chosen {
            number,
            distance,
            middle: ((low + high) / 2.0 - view.eye).length(),
            outline,
        });
    }
    chosen.sort_by(|a, b| {
        a.distance
            .total_cmp(&b.distance)
            .then(a.number.cmp(&b.number))
    });
    chosen
}

#[cfg(test)]
impl Outline {
    /// Of what may be anywhere.
    pub(super) fn anywhere() -> Self {
        Self {
            pixels: None,
            depth: 0.0,
            farthest: 0.0,
        }
    }
}
