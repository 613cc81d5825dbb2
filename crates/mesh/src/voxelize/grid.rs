//! The lattice of voxels around a surface.

use glam::DVec3;

use crate::Surface;

/// Levels by default: at most 512 voxels a side.
pub const DEFAULT_DEPTH: u32 = 9;
/// Most levels.
pub const MAX_DEPTH: u32 = 20;
/// Most pairs of a voxel and a triangle that are looked at, by [`least_looked_at`](super::least_looked_at): 2^32 voxels,
/// the most of a graph, are a smaller area.
pub const MOST_LOOKED_AT: u64 = 1 << 33;
/// Bits of a coordinate on the lattice; `touch.rs` counts on it.
pub(super) const BITS: u32 = 30;

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
    /// Voxels and triangles that are compared without end.
    #[error(
        "at {depth} levels its triangles cross voxels {least} times or more, and at most {MOST_LOOKED_AT} are \
         looked at: ask for fewer levels, or cut the mesh into parts"
    )]
    TooMuch {
        /// Levels that were asked for.
        depth: u32,
        /// How often a triangle crosses a voxel, at the least.
        least: u64,
    },
    /// Coordinates beyond what numbers hold, or all but equal far from the origin.
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

/// Where voxels lie in the world: cubes of one size, `2^depth` a side, in the
/// axes of the mesh.
///
/// The longest side of the mesh's box spans `2^depth - 1` voxels, from the
/// middle of the first layer to the middle of the last. So the mesh's outermost
/// planes lie within a layer and not between two, which would both be touched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    depth: u32,
    origin: DVec3,
    voxel_size: f64,
}

impl Grid {
    /// The grid of so many levels around a surface.
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
        // The origin must be distinct from a neighbouring voxel's.
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

    /// Side of a cube of a level on the lattice.
    pub(super) fn side(&self, level: u32) -> i64 {
        1 << (BITS - level)
    }
}
