//! Replaces `mesh.rs` in builds without the feature `mesh`: meshes are recognised and refused.

use std::io::{Read, Seek};
use std::path::Path;

use super::open_error::OpenError;
use super::{SceneFile, SceneInfo};
use crate::graph::{Graph, MeshBox, Progress, Voxel};

/// Stands in for the options of meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MeshOptions {
    /// Whether the voxels get opacities.
    pub opacities: bool,
}

/// Stands in for what a mesh was; never made.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshSummary;

/// Files beside a mesh.
pub(super) trait Beside {}

/// Those in its folder.
pub(super) struct SameFolder;

/// None.
pub(super) struct Nothing;

impl Beside for SameFolder {}
impl Beside for Nothing {}

impl SameFolder {
    pub(super) fn of(_: &Path) -> Self {
        Self
    }
}

/// A mesh that is ready to be voxelised. There is none.
pub(super) enum Ready {}

impl Ready {
    /// Refuses the mesh.
    pub(super) fn read<R: Read + Seek>(
        file: SceneFile<R>,
        _: &dyn Beside,
        _: &MeshOptions,
        _: &dyn Progress,
    ) -> Result<Self, OpenError> {
        Err(OpenError::NoMeshes(file.name()))
    }

    pub(super) fn bytes(&self) -> u64 {
        match *self {}
    }

    pub(super) fn expected_voxels(&self, _: &dyn Progress) -> Option<u64> {
        match *self {}
    }

    pub(super) fn placement(&self) -> ([f64; 3], f64) {
        match *self {}
    }

    pub(super) fn mesh_box(&self) -> MeshBox {
        match *self {}
    }

    pub(super) fn add_opacities(&self, _: &mut Graph, _: &dyn Progress) {
        match *self {}
    }

    pub(super) fn voxels(
        &self,
        _: &mut dyn FnMut(Voxel),
        _: &dyn Progress,
    ) -> (SceneInfo, MeshSummary) {
        match *self {}
    }
}
