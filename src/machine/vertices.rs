//! A window on the machine's vertices, for tests of what is said about them.

use hwmodel::{Datapath, NoProbe, Overflow, Word};

use super::constants::Constants;
use super::fit::Place;
use super::lattice::{Corners, Lattice};
use super::record::Clip;
use super::to_screen;
use crate::frame::QuadNode;
use crate::project::FrameSetup;

/// The eight corners (Morton order), x and y in screen units, of the voxel
/// that `path` leads to from the root, octant by octant; the first
/// `exact_levels` steps are made in clip space, the others in screen space.
/// `None` where the set-up does not let the record change to screen space.
pub(crate) fn screen_corners(
    setup: &FrameSetup,
    exact_levels: u32,
    path: &[u8],
) -> Option<[[i64; 8]; 2]> {
    let mut dp = Datapath::new(setup.format, Overflow::Trap, NoProbe);
    let constants = Constants::load(&mut dp, setup);
    let (exact, screen) = path.split_at(exact_levels as usize);
    let mut clip =
        [0, 1, 2].map(|c| Corners::from_frame(&mut dp, constants.origin[c], constants.edges[c]));
    for &octant in exact {
        clip = clip.map(|lattice| lattice.children(&mut dp)[usize::from(octant)]);
    }
    let [x, y, w] = clip;
    let (w_min, _) = w.span(&mut dp);
    let place = Place {
        quad: QuadNode::ROOT,
        inside: false,
    };
    let pose = Clip { x, y, w, w_min };
    if !to_screen::may_change(&mut dp, &constants, exact_levels, &place, &pose) {
        return None;
    }
    let changed = to_screen::change(&mut dp, &constants, &place, &pose);
    let mut vertices = [changed.x, changed.y];
    for &octant in screen {
        vertices = vertices.map(|lattice| lattice.children(&mut dp)[usize::from(octant)]);
    }
    assert!(dp.trap().is_none(), "{:?}", dp.trap());
    Some(vertices.map(|lattice| lattice.corners().map(Word::to_host)))
}
