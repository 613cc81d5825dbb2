//! Cages on the way down the octree, computed by the machine's own steps in the root of the quadtree.

use crate::machine::cage::{CageCoordinate, with_cage};
use hwmodel::{Datapath, NoProbe, Overflow, Trap, Word};

use crate::machine::constants::Constants;
use crate::machine::record::{Clip, ImagePlace, Screen};
use crate::machine::to_screen;
use crate::project::FrameSetup;

/// The eight vertices of a voxel, in Morton order, relative to the whole picture, in units of the last place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Cage {
    /// X, Y, W.
    Clip([[i64; 8]; 3]),
    /// x and y, in screen units.
    Screen([[i64; 8]; 2]),
}

#[derive(Debug, Clone, Copy)]
pub(super) enum CageWords<L> {
    /// X, Y, W.
    Clip([L; 3]),
    /// x and y.
    Screen([L; 2]),
}

/// A walk down an octree.
pub(super) struct Descent {
    dp: Datapath<NoProbe>,
    constants: Constants,
}

impl Descent {
    /// A descent, and the root's cage, which has not arrived.
    pub(super) fn new<L: CageCoordinate>(setup: &FrameSetup) -> (Self, CageWords<L>) {
        let mut dp = Datapath::new(setup.format, Overflow::Trap, NoProbe);
        let constants = Constants::load(&mut dp, setup);
        let root =
            [0, 1, 2].map(|c| L::from_frame(&mut dp, constants.origin[c], constants.edges[c]));
        (Self { dp, constants }, CageWords::Clip(root))
    }

    /// The cage of a voxel of level `level`, changed to screen space where the machine does so.
    pub(super) fn arrive<L: CageCoordinate>(
        &mut self,
        level: u32,
        held: CageWords<L>,
    ) -> CageWords<L> {
        let CageWords::Clip([x, y, w]) = held else {
            return held;
        };
        let (dp, constants) = (&mut self.dp, &self.constants);
        let (w_min, _) = w.span(dp);
        let clip = Clip { x, y, w, w_min };
        if to_screen::may_change(dp, constants, level, ImagePlace::ROOT, &clip) {
            let Screen { x, y, .. } = to_screen::change(dp, constants, ImagePlace::ROOT, &clip);
            CageWords::Screen([x, y])
        } else {
            held
        }
    }

    pub(super) fn children<L: CageCoordinate>(&mut self, held: CageWords<L>) -> [CageWords<L>; 8] {
        let dp = &mut self.dp;
        match held {
            CageWords::Clip(coordinates) => {
                let children = coordinates.map(|coordinate| coordinate.children(dp));
                std::array::from_fn(|i| CageWords::Clip(children.map(|of| of[i])))
            }
            CageWords::Screen(coordinates) => {
                let children = coordinates.map(|coordinate| coordinate.children(dp));
                std::array::from_fn(|i| CageWords::Screen(children.map(|of| of[i])))
            }
        }
    }

    /// Fails if a word has overflowed.
    pub(super) fn vertices<L: CageCoordinate>(&mut self, held: CageWords<L>) -> Result<Cage, Trap> {
        let dp = &mut self.dp;
        let mut vertices = |coordinate: L| coordinate.vertices(dp).map(Word::to_host); // host: read by an experiment
        let cage = match held {
            CageWords::Clip(coordinates) => Cage::Clip(coordinates.map(&mut vertices)),
            CageWords::Screen(coordinates) => Cage::Screen(coordinates.map(&mut vertices)),
        };
        match self.dp.trap() {
            Some(trap) => Err(trap),
            None => Ok(cage),
        }
    }
}

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
