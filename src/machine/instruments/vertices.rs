//! The machine's vertices along one path down the octree, for checks.

use hwmodel::Trap;

pub use super::descent::Cage;
use super::descent::Descent;
use crate::machine::cage::{CageCoordinate, with_cage};
use crate::project::FrameSetup;

/// The cages of the voxels on a path of octants from the root, the root's first, changed to screen space where the
/// machine does so. Fails if a word overflows. The machine has these vertices relative to a node of the quadtree, where
/// they are never larger.
pub fn cages_along(setup: &FrameSetup, path: &[u8]) -> Result<Vec<Cage>, Trap> {
    with_cage!(setup, L => cages_as::<L>(setup, path))
}

pub(super) fn cages_as<L: CageCoordinate>(
    setup: &FrameSetup,
    path: &[u8],
) -> Result<Vec<Cage>, Trap> {
    let (mut descent, root) = Descent::new::<L>(setup);
    let mut held = descent.arrive(0, root);
    let mut cages = vec![descent.vertices(held)?];
    for (level, &octant) in (1..).zip(path) {
        let child = descent.children(held)[usize::from(octant)];
        held = descent.arrive(level, child);
        cages.push(descent.vertices(held)?);
    }
    Ok(cages)
}
