//! The interface to readers of triangle meshes, which are a crate of their own (`shiftvox-mesh`).
//!
//! A [`MeshReader`] reads triangles and turns them into voxels. [`NoMeshes`] rejects every mesh.

use std::path::PathBuf;

use glam::DVec3;

use super::{FileKind, OpenError, SceneInfo};
use crate::graph::{Graph, MeshBox, Progress, Voxel};

#[derive(Debug)]
pub struct MeshFile {
    pub name: String,
    pub kind: FileKind,
    pub bytes: Vec<u8>,
    /// Of the other files that the mesh names; `None` for a file in memory.
    pub folder: Option<PathBuf>,
}

pub trait MeshReader: Sync {
    fn read(
        &self,
        file: MeshFile,
        progress: &dyn Progress,
    ) -> Result<Box<dyn MeshVoxels>, OpenError>;
}

pub trait MeshVoxels {
    fn bytes(&self) -> u64;

    /// A low estimate of the number of voxels; `None` if finding them takes no longer than estimating.
    fn expected_voxels(&self, progress: &dyn Progress) -> Option<u64>;

    /// World position of voxel (0, 0, 0)'s lowest corner, and the side of a voxel, world units.
    fn placement(&self) -> ([f64; 3], f64);

    /// The points that a fitted camera must see.
    fn mesh_box(&self) -> MeshBox;

    /// Passes each voxel to `sink`, in any order, each once.
    fn voxels(
        &self,
        sink: &mut dyn FnMut(Voxel),
        progress: &dyn Progress,
    ) -> (SceneInfo, MeshSummary);

    /// Adds to a graph of the voxels what it takes from the mesh itself: opacities, if they were requested.
    fn finish(&self, graph: &mut Graph, progress: &dyn Progress);
}

/// Rejects every mesh: for callers without a reader.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoMeshes;

impl MeshReader for NoMeshes {
    fn read(&self, file: MeshFile, _: &dyn Progress) -> Result<Box<dyn MeshVoxels>, OpenError> {
        Err(OpenError::NoMeshes(file.name))
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct MeshSummary {
    /// Triangles of an area above zero.
    pub triangles: u64,
    pub positions: u64,
    pub materials: u64,
    /// Lowest and highest corner of the box around it, world units.
    pub bounds: (DVec3, DVec3),
    pub bytes: u64,
    /// Octree levels below the root at which it was voxelised.
    pub depth: u32,
    /// Pairs of a voxel and a triangle that touches it.
    pub touches: u64,
    /// Time to read the file, milliseconds.
    pub load_ms: f64,
    /// Time to find the voxels, without building the graph, milliseconds.
    pub voxelize_ms: f64,
}
