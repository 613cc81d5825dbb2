//! The machine's vertices of many voxels in real numbers, to measure errors.

use super::descent::{Cage, CageWords, Descent};
use crate::machine::cage::{CageCoordinate, with_cage};
use crate::project::FrameSetup;

/// Space of a record's vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Space {
    /// In clip space, where halving is exact.
    Clip,
    /// On the screen, where it is an approximation.
    Screen,
}

/// The vertices of one record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Positions {
    /// Octree level, 0 = root.
    pub level: u32,
    /// The voxel's lowest corner, finest voxels.
    pub corner: [i64; 3],
    pub space: Space,
    /// Vertices in Morton order: samples across and down, from the picture's top left. `None`: not before the eye.
    pub samples: [Option<[f64; 2]>; 8],
}

/// Calls `visit` for some voxels and all their ancestors, each once. Voxels are given as in a frame: lowest corner in
/// finest voxels, and level. Returns whether all arithmetic stayed within its words.
pub fn visit_positions(
    setup: &FrameSetup,
    voxels: &[[i32; 4]],
    visit: &mut dyn FnMut(&Positions),
) -> bool {
    let mut paths: Vec<PathToVoxel> = voxels
        .iter()
        .map(|voxel| PathToVoxel::to(setup, voxel))
        .collect();
    paths.sort_unstable();
    paths.dedup();
    with_cage!(setup, L => visit_as::<L>(setup, &paths, visit))
}

fn visit_as<L: CageCoordinate>(
    setup: &FrameSetup,
    paths: &[PathToVoxel],
    visit: &mut dyn FnMut(&Positions),
) -> bool {
    let (descent, root) = Descent::new::<L>(setup);
    let mut visitor = Visitor {
        descent,
        setup,
        visit,
    };
    visitor.node(0, [0; 3], root, paths).is_some()
}

/// The path from the root to a voxel: octants, three bits each from bit 92 downwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct PathToVoxel {
    octants: u128,
    level: u32,
}

/// Place of the first octant's lowest bit.
const FIRST_OCTANT: u32 = 90;

impl PathToVoxel {
    fn to(setup: &FrameSetup, voxel: &[i32; 4]) -> Self {
        let level = voxel[3].max(0) as u32;
        let octants = (0..level.min(setup.depth)).fold(0u128, |octants, step| {
            let bit = setup.depth - 1 - step;
            let octant = (0..3).fold(0u128, |octant, k| {
                octant << 1 | (voxel[k] >> bit & 1) as u128
            });
            octants | octant << (FIRST_OCTANT - 3 * step)
        });
        Self { octants, level }
    }

    fn octant(&self, step: u32) -> usize {
        (self.octants >> (FIRST_OCTANT - 3 * step) & 7) as usize
    }
}

struct Visitor<'v> {
    descent: Descent,
    setup: &'v FrameSetup,
    visit: &'v mut dyn FnMut(&Positions),
}

impl Visitor<'_> {
    /// Visits a voxel and those below it on the paths. `None` if a word overflowed.
    fn node<L: CageCoordinate>(
        &mut self,
        level: u32,
        corner: [i64; 3],
        held: CageWords<L>,
        paths: &[PathToVoxel],
    ) -> Option<()> {
        if paths.is_empty() {
            return Some(());
        }
        let held = self.descent.arrive(level, held);
        let cage = self.descent.vertices(held).ok()?;
        let samples = self.samples(&cage);
        (self.visit)(&Positions {
            level,
            corner,
            space: match cage {
                Cage::Clip(_) => Space::Clip,
                Cage::Screen(_) => Space::Screen,
            },
            samples,
        });
        let deeper = |path: &PathToVoxel| path.level > level;
        if level >= self.setup.depth || !paths.iter().any(deeper) {
            return Some(());
        }
        let side = 1i64 << (self.setup.depth - level - 1);
        for (octant, child) in self.descent.children(held).into_iter().enumerate() {
            let below: Vec<PathToVoxel> = paths
                .iter()
                .copied()
                .filter(|path| deeper(path) && path.octant(level) == octant)
                .collect();
            let axis = |k: usize| corner[k] + side * (octant as i64 >> (2 - k) & 1);
            self.node(level + 1, [axis(0), axis(1), axis(2)], child, &below)?;
        }
        Some(())
    }

    fn samples(&self, cage: &Cage) -> [Option<[f64; 2]>; 8] {
        match cage {
            Cage::Clip([x, y, w]) => {
                let root = libm::ldexp(1.0, self.setup.levels as i32);
                std::array::from_fn(|i| {
                    let depth = w[i] as f64;
                    let at = [x[i], y[i]].map(|c| c as f64 / depth * root);
                    (depth > 0.0).then_some(at)
                })
            }
            Cage::Screen([x, y]) => {
                let unit = libm::ldexp(1.0, -(self.setup.format.frac() as i32));
                std::array::from_fn(|i| Some([x[i], y[i]].map(|c| c as f64 * unit)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::graph::Placement;
    use crate::machine::cages_along;
    use crate::project::{CageKind, Camera, Coverage, SetupOptions};

    const DEPTH: u32 = 4;

    fn set_up(options: &SetupOptions) -> FrameSetup {
        let camera = Camera {
            eye: DVec3::new(90.0, -70.0, 80.0),
            target: DVec3::splat(8.0),
            up: DVec3::Z,
            fov_degrees: 10.0,
            width: 256,
            height: 256,
        };
        FrameSetup::new(&camera, &Placement::default(), DEPTH, options).unwrap()
    }

    fn found(setup: &FrameSetup, voxels: &[[i32; 4]]) -> Vec<Positions> {
        let mut found = Vec::new();
        assert!(visit_positions(setup, voxels, &mut |p| found.push(*p)));
        found
    }

    #[test]
    fn ancestors_come_once_and_lead_there() {
        let setup = set_up(&SetupOptions::default());
        let voxels = [[5, 6, 7, 4], [5, 6, 6, 4], [5, 6, 7, 4], [8, 0, 0, 1]];
        let found = found(&setup, &voxels);
        let places: Vec<_> = found.iter().map(|p| (p.level, p.corner)).collect();
        // The root, [0..8], [4..8], [4, 6, 6], the two voxels; and the octant.
        let expected = [
            (0, [0, 0, 0]),
            (1, [0, 0, 0]),
            (2, [4, 4, 4]),
            (3, [4, 6, 6]),
            (4, [5, 6, 6]),
            (4, [5, 6, 7]),
            (1, [8, 0, 0]),
        ];
        assert_eq!(places, expected);
    }

    #[test]
    fn the_papers_vertices_are_those_of_the_loop() {
        let setup = set_up(&SetupOptions {
            cage: CageKind::Corners,
            tolerance_px: f64::INFINITY,
            coverage: Coverage::Any,
            ..SetupOptions::of(Coverage::Any)
        });
        let last = *found(&setup, &[[5, 6, 7, 4]]).last().unwrap();
        // 5, 6, 7 are 0101, 0110, 0111: octants from the top.
        let cages = cages_along(&setup, &[0, 7, 3, 5]).unwrap();
        let Some(Cage::Screen(expected)) = cages.last() else {
            panic!("{cages:?}");
        };
        for corner in 0..8 {
            let expected = [0, 1].map(|c| expected[c][corner] as f64 / 65536.0);
            assert_eq!(last.samples[corner], Some(expected));
        }
        assert_eq!(last.space, Space::Screen);
    }

    #[test]
    fn all_rules_and_spaces_are_near_the_truth() {
        let truth = set_up(&SetupOptions {
            tolerance_px: 0.0,
            ..SetupOptions::default()
        });
        let voxel = [[5, 6, 7, 4]];
        let truth = *found(&truth, &voxel).last().unwrap();
        assert_eq!(truth.space, Space::Clip);
        for coverage in [Coverage::Any, Coverage::Center] {
            for cage in [CageKind::Corners, CageKind::Frame] {
                let setup = set_up(&SetupOptions {
                    coverage,
                    cage,
                    tolerance_px: 0.5,
                    ..SetupOptions::of(coverage)
                });
                let held = *found(&setup, &voxel).last().unwrap();
                assert_eq!(held.space, Space::Screen, "{coverage:?} {cage:?}");
                for (held, truth) in held.samples.iter().zip(truth.samples) {
                    let (held, truth) = (held.unwrap(), truth.unwrap());
                    let off = libm::hypot(held[0] - truth[0], held[1] - truth[1]);
                    assert!(off > 0.0 && off < 0.5, "{coverage:?} {cage:?}: {off}");
                }
            }
        }
    }
}
