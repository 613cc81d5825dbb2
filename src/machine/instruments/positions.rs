//! The machine's vertices of voxels, to measure errors: computed by its own steps in the root of the quadtree.

use std::collections::HashSet;

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

/// A walk down an octree.
struct Descent {
    dp: Datapath<NoProbe>,
    constants: Constants,
}

impl Descent {
    /// A descent, and the root's cage.
    fn new<L: CageCoordinate>(setup: &FrameSetup) -> (Self, Coordinates<L>) {
        let mut dp = Datapath::new(setup.format, Overflow::Trap, NoProbe);
        let constants = Constants::load(&mut dp, setup);
        let root =
            [0, 1, 2].map(|c| L::from_frame(&mut dp, constants.origin[c], constants.edges[c]));
        let mut descent = Self { dp, constants };
        let root = descent.arrive(0, Coordinates::Clip(root));
        (descent, root)
    }

    /// Changes a cage of a level to screen space where the machine does so.
    fn arrive<L: CageCoordinate>(&mut self, level: u32, held: Coordinates<L>) -> Coordinates<L> {
        let Coordinates::Clip([x, y, w]) = held else {
            return held;
        };
        let (dp, constants) = (&mut self.dp, &self.constants);
        let (w_min, _) = w.span(dp);
        let clip = Clip { x, y, w, w_min };
        if to_screen::may_change(dp, constants, level, ImagePlace::ROOT, &clip) {
            let Screen { x, y, .. } = to_screen::change(dp, constants, ImagePlace::ROOT, &clip);
            Coordinates::Screen([x, y])
        } else {
            held
        }
    }

    fn children<L: CageCoordinate>(&mut self, held: Coordinates<L>) -> [Coordinates<L>; 8] {
        let all = held.map(|coordinate| L::all(&coordinate.pool(&mut self.dp)));
        std::array::from_fn(|octant| all.map(|children| children[octant]))
    }

    /// Fails if a word has overflowed.
    fn vertices<L: CageCoordinate>(&mut self, held: Coordinates<L>) -> Result<Cage, Trap> {
        let cage = held.map(|coordinate| coordinate.vertices(&mut self.dp).map(Word::to_host));
        self.dp.trap().map_or(Ok(cage), Err)
    }
}

/// The cages of the voxels on a path of octants from the root, the root's first, in screen space where the machine
/// changes them. Fails if a word overflows. Relative to the machine's quadtree nodes they are never larger.
pub fn cages_along(setup: &FrameSetup, path: &[u8]) -> Result<Vec<Cage>, Trap> {
    with_cage!(setup, L => cages_as::<L>(setup, path))
}

pub(super) fn cages_as<L: CageCoordinate>(
    setup: &FrameSetup,
    path: &[u8],
) -> Result<Vec<Cage>, Trap> {
    let (mut descent, mut held) = Descent::new::<L>(setup);
    let mut cages = vec![descent.vertices(held)?];
    for (level, &octant) in (1..).zip(path) {
        let child = descent.children(held)[usize::from(octant)];
        held = descent.arrive(level, child);
        cages.push(descent.vertices(held)?);
    }
    Ok(cages)
}

/// The vertices of one record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Positions {
    /// Octree level, 0 = root.
    pub level: u32,
    /// The voxel's lowest corner, finest voxels.
    pub corner: [i64; 3],
    /// Vertices in Morton order: samples across and down, from the picture's top left. `None`: not before the eye.
    pub samples: [Option<[f64; 2]>; 8],
}

/// Calls `visit` for some voxels (as in a frame: lowest corner in finest voxels, and level) and all their ancestors, each
/// once, until a word overflows.
pub fn visit_positions(setup: &FrameSetup, voxels: &[[i32; 4]], visit: &mut dyn FnMut(&Positions)) {
    let ancestors = |&[x, y, z, level]: &[i32; 4]| {
        let levels = 0..=(level.max(0) as u32).min(setup.depth);
        levels.map(move |level| {
            let side = setup.depth - level;
            (level, [x, y, z].map(|c| i64::from(c) >> side << side))
        })
    };
    let wanted = voxels.iter().flat_map(ancestors).collect();
    with_cage!(setup, L => {
        let (descent, root) = Descent::new::<L>(setup);
        let mut visitor = Visitor { descent, setup, wanted, visit };
        // A trap ends the visits.
        let _ = visitor.node((0, [0; 3]), root);
    });
}

/// Level, and lowest corner in finest voxels.
type Voxel = (u32, [i64; 3]);

struct Visitor<'v> {
    descent: Descent,
    setup: &'v FrameSetup,
    wanted: HashSet<Voxel>,
    visit: &'v mut dyn FnMut(&Positions),
}

impl Visitor<'_> {
    fn node<L: CageCoordinate>(
        &mut self,
        (level, corner): Voxel,
        held: Coordinates<L>,
    ) -> Result<(), Trap> {
        let cage = self.descent.vertices(held)?;
        let samples = self.samples(&cage);
        (self.visit)(&Positions {
            level,
            corner,
            samples,
        });
        let Some(below) = self.setup.depth.checked_sub(level + 1) else {
            return Ok(());
        };
        let child = |octant: i64| {
            let along = |k: usize| corner[k] + ((octant >> (2 - k) & 1) << below);
            (level + 1, [0, 1, 2].map(along))
        };
        let wanted = (0..8).filter(|&octant| self.wanted.contains(&child(octant)));
        let wanted: Vec<i64> = wanted.collect();
        if wanted.is_empty() {
            return Ok(());
        }
        let children = self.descent.children(held);
        for octant in wanted {
            let held = self.descent.arrive(level + 1, children[octant as usize]);
            self.node(child(octant), held)?;
        }
        Ok(())
    }

    fn samples(&self, cage: &Cage) -> [Option<[f64; 2]>; 8] {
        match cage {
            Coordinates::Clip([x, y, w]) => {
                let root = libm::ldexp(1.0, self.setup.levels as i32);
                std::array::from_fn(|i| {
                    let depth = w[i] as f64;
                    let at = [x[i], y[i]].map(|c| c as f64 / depth * root);
                    (depth > 0.0).then_some(at)
                })
            }
            Coordinates::Screen([x, y]) => {
                let unit = libm::ldexp(1.0, -(self.setup.format.frac() as i32));
                std::array::from_fn(|i| Some([x[i], y[i]].map(|c| c as f64 * unit)))
            }
        }
    }
}
