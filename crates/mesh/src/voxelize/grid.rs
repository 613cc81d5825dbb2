//! The lattice of voxels around a surface.

use glam::DVec3;

use super::walk::Cube;
use crate::Surface;

pub const DEFAULT_DEPTH: u32 = 9;
pub const MAX_DEPTH: u32 = 20;
/// Most pairs of a voxel and a triangle, by [`least_looked_at`](super::least_looked_at).
pub const MOST_LOOKED_AT: u64 = 1 << 33;
/// Bits of a coordinate on the lattice; `touch.rs` counts on it.
const BITS: u32 = 30;

#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GridError {
    #[error("a mesh is voxelised with 1 to {MAX_DEPTH} levels, not {0}")]
    Depth(u32),
    #[error("the mesh has no extent, so it has no voxels")]
    Empty,
    #[error("{0} triangles are more than 32 bits can number; split the mesh")]
    TooMany(usize),
    #[error(
        "at {depth} levels its triangles cross voxels {least} times or more, and at most {MOST_LOOKED_AT} are \
         looked at: ask for fewer levels, or cut the mesh into parts"
    )]
    TooMuch { depth: u32, least: u64 },
    #[error(
        "the mesh spans {extent} units {distance} units from the origin: too little for its \
         coordinates; move it to the origin"
    )]
    Coordinates { extent: f64, distance: f64 },
}

/// Where voxels lie in the world: `2^depth` cubes a side, in the axes of the mesh.
///
/// The mesh's outermost planes lie in the middle of a layer, and not between two, which would both be touched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    depth: u32,
    origin: DVec3,
    voxel_size: f64,
}

impl Grid {
    pub fn around(surface: &dyn Surface, depth: u32) -> Result<Self, GridError> {
        if !(1..=MAX_DEPTH).contains(&depth) {
            return Err(GridError::Depth(depth));
        }
        if u32::try_from(surface.len()).is_err() {
            return Err(GridError::TooMany(surface.len()));
        }
        let (low, high) = surface.bounds();
        let extent = (high - low).max_element();
        if surface.is_empty() || extent <= 0.0 {
            return Err(GridError::Empty);
        }
        let distance = low.abs().max(high.abs()).max_element();
        let voxel_size = extent / ((1u64 << depth) - 1) as f64;
        if !(extent.is_finite() && voxel_size.is_normal() && voxel_size > distance * 1e-12) {
            return Err(GridError::Coordinates { extent, distance });
        }
        Ok(Self {
            depth,
            origin: low - DVec3::splat(voxel_size / 2.0),
            voxel_size,
        })
    }

    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// World position of the lowest corner of voxel (0, 0, 0), and length of a voxel's side.
    pub fn placement(&self) -> ([f64; 3], f64) {
        (self.origin.to_array(), self.voxel_size)
    }

    /// The triangle's corners on the lattice, 0 to `2^30 - 1`: the nearest points.
    pub fn corners(&self, surface: &dyn Surface, number: u32) -> [[i64; 3]; 3] {
        let steps = f64::from(1u32 << (BITS - self.depth)) / self.voxel_size;
        surface.corners(number as usize).map(|corner| {
            let at = (corner - self.origin) * steps;
            let limit = ((1i64 << BITS) - 1) as f64;
            at.to_array()
                .map(|c| libm::round(c.clamp(0.0, limit)) as i64)
        })
    }

    pub(super) fn cube(&self) -> Cube {
        Cube {
            corner: [0; 3],
            voxel: 1 << (BITS - self.depth),
            depth: self.depth,
        }
    }
}
