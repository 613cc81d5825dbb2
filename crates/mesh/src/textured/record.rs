//! Records of primitives, voxels and texels. Plain bytes, little-endian.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use crate::Triangle;
use crate::geometry::{plane_normal, point};
use crate::material::{to_light, to_srgb};
use shiftvox::graph::PackedNormal;
use shiftvox::graph::file::Stored;

#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Primitive {
    pub corners: [[f32; 3]; 3],
    /// Normals of the corners, packed; 0 where it is the plane's.
    pub normals: [u16; 3],
    pub colors: [[u8; 3]; 3],
    pub spare: u8,
}

impl Primitive {
    pub fn of(triangle: &Triangle<'_>, colors: [DVec3; 3]) -> Self {
        let plane = plane_normal(triangle.corners);
        // Normals of a file are in single precision.
        let normal = |n: DVec3| match n.distance_squared(plane) < 1e-12 {
            true => PackedNormal::NONE.0,
            false => PackedNormal::encode(n).0,
        };
        Self {
            corners: triangle.corners.map(|p| p.as_vec3().to_array()),
            normals: triangle.normals.map(normal),
            colors: colors.map(to_srgb),
            spare: 0,
        }
    }

    pub fn positions(&self) -> [DVec3; 3] {
        self.corners.map(point)
    }

    pub fn triangle(&self) -> Triangle<'static> {
        let corners = self.positions();
        let plane = plane_normal(corners);
        let normal = |n: u16| PackedNormal(n).decode().unwrap_or(plane);
        Triangle {
            corners,
            normals: self.normals.map(normal),
            colors: self.colors.map(to_light),
            alpha: 1.0,
            sampler: None,
        }
    }
}

impl Stored for Primitive {
    const NUMBERS: &'static [(usize, usize)] = &[(9, 4), (3, 2), (10, 1)];
}

impl Stored for VoxelRecord {
    const NUMBERS: &'static [(usize, usize)] = &[(4, 2), (4, 4)];
}

impl Stored for Texel {
    const NUMBERS: &'static [(usize, usize)] = &[(4, 1), (1, 2)];
}

/// A voxel that is not empty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct VoxelRecord {
    pub cell: [u16; 3],
    /// Erosions that it survives.
    pub depth: u16,
    /// The first entry of its list; the list ends where the next voxel's begins.
    pub first: u32,
    /// For the outer face along each axis: the number of its sub-texture, [`CLEAR`] or [`NEVER`].
    pub textures: [u32; 3],
}

/// The primitives of voxel `number`, rising.
pub(super) fn list_of<'l>(voxels: &[VoxelRecord], lists: &'l [u32], number: usize) -> &'l [u32] {
    let end = voxels
        .get(number + 1)
        .map_or(lists.len(), |v| v.first as usize);
    &lists[voxels[number].first as usize..end]
}

/// A face that some level shows, but nothing projects on it.
pub const CLEAR: u32 = u32::MAX - 1;
/// A face that no level shows.
pub const NEVER: u32 = u32::MAX;

/// A texel; all zeros where nothing projects on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Pod, Zeroable)]
#[repr(C)]
pub struct Texel {
    /// Colour, sRGB, without light.
    pub color: [u8; 3],
    /// 255 where something projects on it, else 0.
    pub opacity: u8,
    /// Normal, packed, on the outer side.
    pub normal: u16,
}

impl Texel {
    pub fn is_clear(&self) -> bool {
        self.opacity == 0
    }

    pub fn is_sound(&self) -> bool {
        match self.opacity {
            0 => *self == Self::default(),
            255 => self.normal != PackedNormal::NONE.0,
            _ => false,
        }
    }
}
