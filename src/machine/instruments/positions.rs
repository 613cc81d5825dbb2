//! The machine's vertices of voxels, to measure errors: computed by its own steps in the root of the quadtree.

use crate::machine::cage::{CageCoordinate, with_cage};
use hwmodel::{Datapath, NoProbe, Overflow, Trap, Word};

use crate::machine::constants::Constants;
use crate::machine::record::{Clip, ImagePlace, Screen};
use crate::machine::to_screen;
use crate::project::FrameSetup;

/// The coordinates of a voxel's vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinates<T> {
    /// X, Y, W.
    Clip([T; 3]),
    /// x and y, in screen units.
    Screen([T; 2]),
}

/// The eight vertices of a voxel, in Morton order, relative to the whole picture, in units of the last place.
pub type Cage = Coordinates<[i64; 8]>;

impl<T> Coordinates<T> {
    fn map<U>(self, f: impl FnMut(T) -> U) -> Coordinates<U> {
        match self {
            Self::Clip(all) => Coordinates::Clip(all.map(f)),
            Self::Screen(all) => Coordinates::Screen(all.map(f)),
        }
    }
}

/// The cages of the voxels on a path of octants from the root, the root's first, changed to screen space where the
/// machine does so. Fails if a word overflows. The machine has these vertices relative to a node of the quadtree, where
/// they are never larger.
pub fn cages_along(setup: &FrameSetup, path: &[u8]) -> Result<Vec<Cage>, Trap> {
    with_cage!(setup, L => cages_as::<L>(setup, path))
}

fn cages_as<L: CageCoordinate>(setup: &FrameSetup, path: &[u8]) -> Result<Vec<Cage>, Trap> {
    let dp = &mut Datapath::new(setup.format, Overflow::Trap, NoProbe);
    let constants = Constants::load(dp, setup);
    let root = [0, 1, 2].map(|c| L::from_frame(dp, constants.origin[c], constants.edges[c]));
    let mut held = Coordinates::Clip(root);
    let octants = std::iter::once(None).chain(path.iter().map(Some));
    let cages = (0..).zip(octants).map(|(level, octant)| {
        if let Some(&octant) = octant {
            held = held.map(|coordinate| L::child(&coordinate.pool(dp), usize::from(octant)));
        }
        if let Coordinates::Clip([x, y, w]) = held {
            let (w_min, _) = w.span(dp);
            let clip = Clip { x, y, w, w_min };
            if to_screen::may_change(dp, &constants, level, ImagePlace::ROOT, &clip) {
                let Screen { x, y, .. } =
                    to_screen::change(dp, &constants, ImagePlace::ROOT, &clip);
                held = Coordinates::Screen([x, y]);
            }
        }
        let cage = held.map(|coordinate| coordinate.vertices(dp).map(Word::to_host));
        dp.trap().map_or(Ok(cage), Err)
    });
    cages.collect()
}
