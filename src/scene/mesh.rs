//! Meshes as scenes: read, voxelised, placed where the file has them.

use std::io::{Read, Seek};
use std::path::Path;
use std::time::Instant;

use glam::DVec3;

use super::open_error::OpenError;
use super::{FileKind, SceneError, SceneFile, SceneInfo};
use crate::graph::{Graph, MeshBox, Progress, Voxel};
use crate::mesh::voxelize::{self, DEFAULT_DEPTH, Grid, GridError};
use crate::mesh::{self, LoadOptions, Mesh, MeshFormat, mesh_box};
pub(super) use crate::mesh::{Beside, Nothing, SameFolder};

/// Levels at which the voxels of many more levels are estimated.
const COUNTED_DEPTH: u32 = 8;

/// How a mesh becomes a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeshOptions {
    /// Levels below the root: at most `2^depth` voxels a side.
    pub depth: u32,
    /// How the file is read.
    pub load: LoadOptions,
    /// Whether the voxels get opacities (`spec/mesh.md`, "Opacities"); only a
    /// scene that is built in memory has room for them.
    pub opacities: bool,
    /// Whether +Y is up, or else +Z, where the custom of the format is not meant: Y for all but STL.
    pub y_up: Option<bool>,
}

impl Default for MeshOptions {
    fn default() -> Self {
        Self {
            depth: DEFAULT_DEPTH,
            load: LoadOptions::default(),
            opacities: false,
            y_up: None,
        }
    }
}

/// What a mesh was, and what voxelising it took.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshSummary {
    /// Triangles that can be drawn.
    pub triangles: u64,
    /// Vertex positions.
    pub positions: u64,
    /// Materials.
    pub materials: u64,
    /// Lowest and highest corner of the box around it.
    pub bounds: (DVec3, DVec3),
    /// Bytes that the mesh takes in memory.
    pub bytes: u64,
    /// Levels that it was voxelised at.
    pub depth: u32,
    /// Pairs of a voxel and a triangle that touches it.
    pub touches: u64,
    /// Time to read the file, milliseconds.
    pub load_ms: f64,
    /// Time to find the voxels, without building the graph, milliseconds.
    pub voxelize_ms: f64,
}

/// Reads a mesh file, for its triangles; also returns whether +Y is up in it.
///
/// # Errors
/// Where it cannot be read, is no mesh, breaks its format's rules or holds
/// nothing to draw.
pub fn read_mesh(
    path: &Path,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<(Mesh, bool), OpenError> {
    let file = SceneFile::open(path)?;
    let (mesh, kind) = read(file, &SameFolder::of(path), options, progress)?;
    Ok((mesh, is_y_up(kind)))
}

/// Whether +Y is up, by the custom of the format.
fn is_y_up(kind: FileKind) -> bool {
    kind != FileKind::Stl
}

/// Reads a mesh; `beside` finds the other files that it names.
fn read<R: Read + Seek>(
    file: SceneFile<R>,
    beside: &dyn Beside,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<(Mesh, FileKind), OpenError> {
    let (format, kind) = match file.kind() {
        Some(kind @ FileKind::PlyMesh) => (MeshFormat::Ply, kind),
        Some(kind @ FileKind::Stl) => (MeshFormat::Stl, kind),
        Some(kind @ FileKind::Gltf) => (MeshFormat::Gltf, kind),
        Some(kind @ FileKind::Glb) => (MeshFormat::Glb, kind),
        Some(kind @ FileKind::Obj) => (MeshFormat::Obj, kind),
        // Its reader says that there are no faces, or what is wrong with the header.
        Some(kind @ FileKind::Ply) => (MeshFormat::Ply, kind),
        _ => {
            return Err(file
                .refused(|file, kind| SceneError::NotMesh { file, kind })
                .into());
        }
    };
    let name = file.name();
    let bytes = file.bytes()?;
    let mesh = mesh::read(&bytes, format, &name, beside, options, progress)?;
    Ok((mesh, kind))
}

/// A mesh that is ready to be voxelised.
pub(super) struct Ready {
    kind: FileKind,
    mesh: Mesh,
    y_up: bool,
    grid: Grid,
    load_ms: f64,
}

impl Ready {
    /// Reads a mesh and lays the grid around it.
    pub(super) fn read<R: Read + Seek>(
        file: SceneFile<R>,
        beside: &dyn Beside,
        options: &MeshOptions,
        progress: &dyn Progress,
    ) -> Result<Self, OpenError> {
        let started = Instant::now();
        let source_name = file.name();
        let (mesh, kind) = read(file, beside, &options.load, progress)?;
        let load_ms = started.elapsed().as_secs_f64() * 1e3;
        let refused = |error| OpenError::Grid { source_name, error };
        let grid = match Grid::around(&mesh, options.depth) {
            Ok(grid) => grid,
            Err(error) => return Err(refused(error)),
        };
        let (depth, least) = (options.depth, voxelize::least_looked_at(&mesh, &grid));
        if least > voxelize::MOST_LOOKED_AT {
            return Err(refused(GridError::TooMuch { depth, least }));
        }
        Ok(Self {
            y_up: options.y_up.unwrap_or(is_y_up(kind)),
            kind,
            mesh,
            grid,
            load_ms,
        })
    }

    /// Bytes that the mesh takes while it is voxelised.
    pub(super) fn bytes(&self) -> u64 {
        self.mesh.bytes()
    }

    /// About how many voxels there are going to be, rather fewer than more; none of so few levels that it is as
    /// quick to find them. A surface has four times as many at each further level, what is thin fewer at first.
    pub(super) fn expected_voxels(&self, progress: &dyn Progress) -> Option<u64> {
        let further = self
            .grid
            .depth()
            .checked_sub(COUNTED_DEPTH)
            .filter(|&levels| levels > 3)?;
        let count = |depth| {
            let grid = Grid::around(&self.mesh, depth).ok()?;
            Some(voxelize::voxelize(&self.mesh, &grid, &mut |_| (), progress).voxels)
        };
        let (coarse, fine) = (count(COUNTED_DEPTH - 1)?, count(COUNTED_DEPTH)?);
        let growth = (fine as f64 / coarse as f64).min(4.0);
        Some((fine as f64 * libm::pow(growth, f64::from(further))) as u64)
    }

    /// World position and size of voxels, as the builders take them.
    pub(super) fn placement(&self) -> ([f64; 3], f64) {
        self.grid.placement()
    }

    /// What fitted cameras look at.
    pub(super) fn mesh_box(&self) -> MeshBox {
        mesh_box(&self.mesh, self.y_up)
    }

    /// Gives the nodes of the graph that was built of the voxels opacities.
    pub(super) fn add_opacities(&self, graph: &mut Graph, progress: &dyn Progress) {
        let opacities = voxelize::opacities(&self.mesh, &self.grid, graph, progress);
        graph.opacity = opacities.into();
    }

    /// Hands on the voxels and returns a summary.
    pub(super) fn voxels(
        &self,
        sink: &mut dyn FnMut(Voxel),
        progress: &dyn Progress,
    ) -> (SceneInfo, MeshSummary) {
        let started = Instant::now();
        let (mut low, mut high) = ([i32::MAX; 3], [i32::MIN; 3]);
        let report = voxelize::voxelize(
            &self.mesh,
            &self.grid,
            &mut |voxel| {
                for k in 0..3 {
                    low[k] = low[k].min(voxel.index[k]);
                    high[k] = high[k].max(voxel.index[k]);
                }
                sink(voxel);
            },
            progress,
        );
        let voxelize_ms = started.elapsed().as_secs_f64() * 1e3;
        let mut info = SceneInfo::new(self.kind);
        info.voxels = report.voxels;
        info.stored_voxels = 0;
        info.bounds = (report.voxels > 0).then_some((low, high));
        info.models = 1;
        info.instances = 1;
        info.has_colors = true;
        info.has_normals = true;
        info.warnings = self.mesh.warnings().to_vec();
        let summary = MeshSummary {
            triangles: self.mesh.triangles().len() as u64,
            positions: self.mesh.positions().len() as u64,
            materials: self.mesh.materials().len() as u64,
            bounds: self.mesh.bounds(),
            bytes: self.mesh.bytes(),
            depth: self.grid.depth(),
            touches: report.touches,
            load_ms: self.load_ms,
            voxelize_ms,
        };
        (info, summary)
    }
}
