//! Vertices as `SPEC.md`, sections 4 and 5, defines them, in wide integers
//! with products and quotients. It is written from the specification and shares
//! nothing with the machine but the recorded integers of a frame.

use shiftvox::machine::Cage;
use shiftvox::project::{CageKind, FrameSetup};

pub(super) struct SpecifiedVertices<'s> {
    setup: &'s FrameSetup,
}

type Wide = i128;

impl<'s> SpecifiedVertices<'s> {
    pub(super) fn new(setup: &'s FrameSetup) -> Self {
        Self { setup }
    }

    /// Lowest corner and side of the voxel that a path leads to, in units of
    /// `2^-sub_levels` finest voxels.
    pub(super) fn cube(&self, path: &[u8]) -> ([i64; 3], i64) {
        let bound = self.setup.level_bound();
        let mut corner = [0i64; 3];
        for (at, octant) in path.iter().enumerate() {
            let side = 1i64 << (bound - 1 - at as u32);
            for (k, c) in corner.iter_mut().enumerate() {
                *c += side * i64::from(octant >> (2 - k) & 1);
            }
        }
        (corner, 1 << (bound - path.len() as u32))
    }

    fn clip(&self, path: &[u8]) -> [[Wide; 8]; 3] {
        let (corner, side) = self.cube(path);
        let setup = self.setup;
        std::array::from_fn(|c| {
            std::array::from_fn(|vertex| {
                let origin = Wide::from(setup.origin_clip[c]) << setup.sub_levels;
                (0..3).fold(origin, |sum, k| {
                    let u = corner[k] + if vertex >> (2 - k) & 1 != 0 { side } else { 0 };
                    sum + Wide::from(u) * Wide::from(setup.edge_clip[k][c])
                })
            })
        })
    }

    /// The least depth of a path's voxel, and the least at which it may
    /// change to screen space.
    pub(super) fn change_depths(&self, path: &[u8]) -> (Wide, Wide) {
        let w = self.clip(path)[2];
        let least = self.setup.screen_depth.get(path.len());
        let least = least.map_or(Wide::MAX, |&w| Wide::from(w) << self.setup.sub_levels);
        (w.into_iter().min().unwrap_or(0), least)
    }

    /// Screen positions of eight vertices, each rounded down; `None` if one of
    /// them is not before the eye, where nothing may be projected.
    fn projected(&self, path: &[u8]) -> Option<[[Wide; 8]; 2]> {
        let clip = self.clip(path);
        if clip[2].iter().any(|&w| w <= 0) {
            return None;
        }
        let bits = self.setup.levels + self.setup.format.frac();
        Some([0, 1].map(|c| std::array::from_fn(|v| (clip[c][v] << bits).div_euclid(clip[2][v]))))
    }

    /// The cage of a voxel that changed to screen space `changed` levels below the root,
    /// or not at all. `None` for a change that is not allowed.
    pub(super) fn held(&self, path: &[u8], changed: Option<usize>) -> Option<Cage> {
        let narrow = |values: [Wide; 8]| values.map(|v| i64::try_from(v).unwrap_or(i64::MAX));
        let Some(changed) = changed else {
            return Some(Cage::Clip(self.clip(path).map(narrow)));
        };
        let (to, below) = path.split_at(changed);
        let projected = self.projected(to)?;
        let by_cage: fn([Wide; 8], &[u8]) -> [Wide; 8] = match self.setup.options.cage {
            CageKind::Corners => corners_below,
            CageKind::Frame => frame_below,
        };
        Some(Cage::Screen(projected.map(|p| narrow(by_cage(p, below)))))
    }
}

/// Corner and three edges, halved towards zero: the edge at a level is the
/// first one over a power of two, cut.
fn frame_below(projected: [Wide; 8], below: &[u8]) -> [Wide; 8] {
    let edges = [4, 2, 1].map(|end: usize| projected[end] - projected[0]);
    let cut = |edge: Wide, level: usize| edge.signum() * (edge.abs() >> level);
    let mut corner = projected[0];
    for (at, octant) in below.iter().enumerate() {
        for k in 0..3 {
            if octant >> (2 - k) & 1 != 0 {
                corner += cut(edges[k], at + 1);
            }
        }
    }
    std::array::from_fn(|v| {
        (0..3)
            .filter(|k| v >> (2 - k) & 1 != 0)
            .fold(corner, |sum, k| sum + cut(edges[k], below.len()))
    })
}

/// Eight corners, midpoints rounded down, along x, then y, then z.
fn corners_below(projected: [Wide; 8], below: &[u8]) -> [Wide; 8] {
    below.iter().fold(projected, |parent, octant| {
        // At 0, 1 or 2 halves of the parent along each axis.
        let at = |halves: [usize; 3]| {
            let along = |a: Wide, b: Wide, halves: usize| match halves {
                0 => a,
                1 => (a + b).div_euclid(2),
                _ => b,
            };
            let x =
                |y: usize, z: usize| along(parent[y << 1 | z], parent[4 | y << 1 | z], halves[0]);
            let y = |z: usize| along(x(0, z), x(1, z), halves[1]);
            along(y(0), y(1), halves[2])
        };
        std::array::from_fn(|v| {
            at([0, 1, 2].map(|k| usize::from(octant >> (2 - k) & 1) + (v >> (2 - k) & 1)))
        })
    })
}
