//! The lattice of voxels around a surface.

use glam::DVec3;

use super::walk::Cube;
use crate::Surface;

/// Levels by default: at most 512 voxels a side.
pub const DEFAULT_DEPTH: u32 = 9;
/// Most levels.
pub const MAX_DEPTH: u32 = 20;
/// Most pairs of a voxel and a triangle, by [`least_looked_at`](super::least_looked_at).
pub const MOST_LOOKED_AT: u64 = 1 << 33;
/// Bits of a coordinate on the lattice; `touch.rs` counts on it.
const BITS: u32 = 30;

/// Why there is no grid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GridError {
    /// Too few or too many levels.
    #[error("a mesh is voxelised with 1 to {MAX_DEPTH} levels, not {0}")]
    Depth(u32),
    /// The surface has no triangles, or none of any extent.
    #[error("the mesh has no extent, so it has no voxels")]
    Empty,
    /// More triangles than 32 bits number.
    #[error("{0} triangles are more than 32 bits can number; split the mesh")]
    TooMany(usize),
    /// More pairs of a voxel and a triangle than are looked at.
    #[error(
        "at {depth} levels its triangles cross voxels {least} times or more, and at most {MOST_LOOKED_AT} are \
         looked at: ask for fewer levels, or cut the mesh into parts"
    )]
    TooMuch {
        /// Levels that were asked for.
        depth: u32,
        /// Pairs, at the least.
        least: u64,
    },
    /// Coordinates that are infinite, or nearly equal far from the origin.
    #[error(
        "the mesh spans {extent} units {distance} units from the origin: too little for its \
         coordinates; move it to the origin"
    )]
    Coordinates {
        /// Longest side of its box.
        extent: f64,
        /// Largest coordinate, without sign.
        distance: f64,
    },
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
    /// The grid of 1 to [`MAX_DEPTH`] levels around a surface.
    ///
    /// # Errors
    /// See [`GridError`].
    pub fn around<S: Surface + ?Sized>(surface: &S, depth: u32) -> Result<Self, GridError> {
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

    /// Levels below the root.
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// World position of the lowest corner of voxel (0, 0, 0).
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// World length of a voxel's side.
    pub fn voxel_size(&self) -> f64 {
        self.voxel_size
    }

    /// The world position and voxel size for [`Builder::finish`](shiftvox::graph::Builder::finish).
    pub fn placement(&self) -> ([f64; 3], f64) {
        (self.origin.to_array(), self.voxel_size)
    }

    /// The triangle's corners on the lattice, 0 to `2^30 - 1`: the nearest points.
    pub fn corners<S: Surface + ?Sized>(&self, surface: &S, number: u32) -> [[i64; 3]; 3] {
        let steps = f64::from(1u32 << (BITS - self.depth)) / self.voxel_size;
        surface.corners(number as usize).map(|corner| {
            let at = (corner - self.origin) * steps;
            // Inside by half a voxel, which is more than rounding.
            let limit = ((1i64 << BITS) - 1) as f64;
            at.to_array()
                .map(|c| libm::round(c.clamp(0.0, limit)) as i64)
        })
    }

    /// All of it.
    pub(super) fn cube(&self) -> Cube {
        Cube {
            corner: [0; 3],
            voxel: 1 << (BITS - self.depth),
            depth: self.depth,
        }
    }
}
