//! How large a scene a word format is safe for.
//!
//! Safe: no word of the frame can overflow (*headroom*), and rounding moves
//! nothing by more than a quarter of a pixel, seen from its own size away.

use serde::Serialize;

use shiftvox::graph::{Graph, MAX_DEPTH, Placement};
use shiftvox::project::camera::MAX_SIDE;
use shiftvox::project::{Camera, FrameSetup, SetupOptions};

/// Most rounding that is safe, pixels.
const MOST_ROUNDING_PX: f64 = 0.25;

/// How far, in pixels, rounding may turn or stretch a view: the edges of a
/// voxel are rounded to units of `2^-clip_frac`.
pub(super) fn rounding_px(setup: &FrameSetup) -> f64 {
    let root_px = setup.levels - setup.options.aa_log2;
    libm::ldexp(1.0, root_px as i32 - 2 - setup.clip_frac as i32)
}

/// What a format is safe for; each alone, with all else as in the scene.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Safe {
    /// Most octree levels, of an object of the same size in the world.
    pub depth: Option<u32>,
    /// Largest picture, pixels a side.
    pub picture: Option<u32>,
    /// Least distance at which `any` and `center` draw, in finest voxels: the
    /// near plane is a sixteenth of a voxel, where the format can express that.
    pub near_voxels: Option<f64>,
}

fn is_safe(setup: &FrameSetup) -> bool {
    setup.has_headroom && rounding_px(setup) <= MOST_ROUNDING_PX
}

/// What `options`' format is safe for in a view.
pub(super) fn of(graph: &Graph, camera: &Camera, options: &SetupOptions) -> Safe {
    let setup = |camera: &Camera, placement: &Placement, depth: u32| {
        FrameSetup::new(camera, placement, depth, options).ok()
    };
    let at_depth = |depth: u32| {
        let mut placement = graph.placement;
        let scale = libm::ldexp(1.0, graph.depth as i32 - depth as i32);
        placement.voxel_size *= scale;
        // The same corner of the world, in voxels of the other size.
        placement.origin_index = placement
            .origin_index
            .map(|index| libm::round(index as f64 / scale) as i64);
        setup(camera, &placement, depth).is_some_and(|setup| is_safe(&setup))
    };
    let of_size = |side: u32| {
        let camera = Camera {
            width: side,
            height: side,
            ..*camera
        };
        setup(&camera, &graph.placement, graph.depth).is_some_and(|setup| is_safe(&setup))
    };
    let own = setup(camera, &graph.placement, graph.depth);
    Safe {
        depth: (1..=MAX_DEPTH).take_while(|&depth| at_depth(depth)).last(),
        picture: largest(MAX_SIDE, of_size),
        near_voxels: own.map(|own| own.near as f64 / libm::ldexp(1.0, own.clip_frac as i32)),
    }
}

/// The largest number up to `most` for which `holds`, which holds for all
/// smaller ones if for one.
fn largest(most: u32, holds: impl Fn(u32) -> bool) -> Option<u32> {
    if !holds(1) {
        return None;
    }
    let (mut yes, mut no) = (1, most + 1);
    while no - yes > 1 {
        let middle = yes + (no - yes) / 2;
        if holds(middle) {
            yes = middle;
        } else {
            no = middle;
        }
    }
    Some(yes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_is_found() {
        assert_eq!(largest(100, |n| n <= 37), Some(37));
        assert_eq!(largest(100, |_| true), Some(100));
        assert_eq!(largest(100, |_| false), None);
        assert_eq!(largest(100, |n| n <= 1), Some(1));
    }
}
