//! The word format of a frame, and how large a scene it is safe for.
//!
//! Safe means that no word of the frame can overflow (*headroom*), and that rounding moves nothing by more than a quarter
//! of a pixel, seen from its own size away.

use serde::{Deserialize, Serialize};

use shiftvox::graph::{Graph, MAX_DEPTH, Placement};
use shiftvox::project::camera::MAX_SIDE;
use shiftvox::project::{Camera, FrameSetup};

/// Most rounding that is safe, pixels.
const MOST_ROUNDING_PX: f64 = 0.25;

/// The word format of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Format {
    pub clip_fraction_bits: u32,
    pub screen_fraction_bits: u32,
    pub has_headroom: bool,
    /// The rounding error of the view, pixels, seen from the object's own size away.
    pub rounding_px: f64,
    /// Most octree levels that are safe, for an object of the same size in the world.
    pub safe_depth: Option<u32>,
    /// Largest safe picture, pixels per side.
    pub safe_picture: Option<u32>,
    /// The near plane of rules `any` and `center`, finest voxels: a sixteenth, where the format can express it.
    pub near_voxels: f64,
}

impl Format {
    pub fn new(graph: &Graph, camera: &Camera, own: &FrameSetup) -> Self {
        let is_safe = |camera: &Camera, placement: &Placement, depth: u32| {
            let setup = FrameSetup::new(camera, placement, depth, &own.options).ok();
            setup.is_some_and(|of| of.has_headroom && rounding_px(&of) <= MOST_ROUNDING_PX)
        };
        let at_depth = |depth: u32| {
            let mut placement = graph.placement;
            let scale = libm::ldexp(1.0, graph.depth as i32 - depth as i32);
            placement.voxel_size *= scale;
            // The same corner of the world, in voxels of the other size.
            let scaled = |index: i64| libm::round(index as f64 / scale) as i64;
            placement.origin_index = placement.origin_index.map(scaled);
            is_safe(camera, &placement, depth)
        };
        let of_size = |side: u32| {
            let camera = Camera {
                width: side,
                height: side,
                ..*camera
            };
            is_safe(&camera, &graph.placement, graph.depth)
        };
        Self {
            clip_fraction_bits: own.clip_frac,
            screen_fraction_bits: own.format.frac(),
            has_headroom: own.has_headroom,
            rounding_px: rounding_px(own),
            safe_depth: (1..=MAX_DEPTH).take_while(|&depth| at_depth(depth)).last(),
            safe_picture: largest(MAX_SIDE, of_size),
            near_voxels: own.near as f64 / libm::ldexp(1.0, own.clip_frac as i32),
        }
    }
}

/// The rotation or stretch of a view by rounding, pixels: voxels' edges are rounded to units of `2^-clip_frac`.
fn rounding_px(setup: &FrameSetup) -> f64 {
    let root_px = setup.levels - setup.options.aa_log2;
    libm::ldexp(1.0, root_px as i32 - 2 - setup.clip_frac as i32)
}

/// The largest number up to `most` for which `holds`. If it holds for a number, it holds for all smaller ones.
fn largest(most: u32, holds: impl Fn(u32) -> bool) -> Option<u32> {
    if !holds(1) {
        return None;
    }
    let (mut yes, mut no) = (1, most + 1);
    while no - yes > 1 {
        let middle = yes + (no - yes) / 2;
        match holds(middle) {
            true => yes = middle,
            false => no = middle,
        }
    }
    Some(yes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_is_found() {
        let found = [37, 200, 0, 1].map(|most| largest(100, |n| n <= most));
        assert_eq!(found, [Some(37), Some(100), None, Some(1)]);
    }
}
