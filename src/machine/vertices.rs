//! A window on the machine's vertices, for who checks what is said about them.

use hwmodel::{Datapath, NoProbe, Overflow, Trap, Word};

use super::constants::Constants;
use super::fit::Place;
use super::lattice::{Corners, Frame, Lattice};
use super::record::Clip;
use super::to_screen;
use crate::frame::QuadNode;
use crate::project::{CageKind, FrameSetup};

/// The eight vertices of a voxel, in Morton order, as the machine has them
/// relative to the whole picture.
#[derive(Debug, Clone, PartialEq, Eq)]
#[allow(
    clippy::large_enum_variant,
    reason = "there are a few of them at a time, one for each level"
)]
pub(crate) enum Held {
    /// X, Y, W.
    Clip([[i64; 8]; 3]),
    /// x and y, in screen units.
    Screen([[i64; 8]; 2]),
}

/// The voxels on the way that `path` leads from the root, octant by octant,
/// the root first, in the cage of the set-up. Each changes to screen space
/// where the machine would let it.
///
/// # Errors
/// Where a word overflows. The machine has these vertices relative to a node
/// of the quadtree, which are never larger.
pub(crate) fn follow(setup: &FrameSetup, path: &[u8]) -> Result<Vec<Held>, Trap> {
    match setup.options.cage {
        CageKind::Corners => follow_as::<Corners>(setup, path),
        CageKind::Frame => follow_as::<Frame>(setup, path),
    }
}

/// As [`follow`], in any lattice.
///
/// # Errors
/// Where a word overflows.
pub(super) fn follow_as<L: Lattice>(setup: &FrameSetup, path: &[u8]) -> Result<Vec<Held>, Trap> {
    let mut dp = Datapath::new(setup.format, Overflow::Trap, NoProbe);
    let constants = Constants::load(&mut dp, setup);
    let mut way = Vec::new();
    let [x, y, w] =
        [0, 1, 2].map(|c| L::from_frame(&mut dp, constants.origin[c], constants.edges[c]));
    let place = Place {
        quad: QuadNode::ROOT,
        inside: false,
    };
    let (mut clip, mut screen) = ([x, y, w], None::<[L; 2]>);
    for level in 0..=path.len() as u32 {
        if let Some(octant) = level
            .checked_sub(1)
            .map(|at| usize::from(path[at as usize]))
        {
            if let Some(lattices) = &mut screen {
                *lattices = lattices.map(|lattice| lattice.children(&mut dp)[octant]);
            } else {
                clip = clip.map(|lattice| lattice.children(&mut dp)[octant]);
            }
        }
        if screen.is_none() {
            let [x, y, w] = clip;
            let (w_min, _) = w.span(&mut dp);
            let pose = Clip { x, y, w, w_min };
            if to_screen::may_change(&mut dp, &constants, level, &place, &pose) {
                let changed = to_screen::change(&mut dp, &constants, &place, &pose);
                screen = Some([changed.x, changed.y]);
            }
        }
        let host = |vertices: [Word; 8]| vertices.map(Word::to_host);
        way.push(if let Some(lattices) = screen {
            Held::Screen(lattices.map(|lattice| host(lattice.vertices(&mut dp))))
        } else {
            Held::Clip(clip.map(|lattice| host(lattice.vertices(&mut dp))))
        });
        if let Some(trap) = dp.trap() {
            return Err(trap);
        }
    }
    Ok(way)
}

/// The eight corners (Morton order), x and y in screen units, of the voxel
/// that `path` leads to from the root, octant by octant; the first
/// `exact_levels` steps are made in clip space, the others in screen space.
/// `None` where the set-up does not let the record change to screen space.
#[cfg(test)]
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
