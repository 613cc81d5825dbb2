//! Opening scenes of any kind: voxel files by the renderer's own readers, meshes read and voxelised here.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use shiftvox::graph::{ExternalError, Graph, MeshBox, Progress, Voxel};
use shiftvox::scene::{
    self, FileKind, MeshFailure, MeshFile, MeshReader, MeshSummary, MeshVoxels, OpenError, Opened,
    SceneError, SceneFile, SceneInfo,
};

use crate::load::read_into;
use crate::voxelize::{self, DEFAULT_DEPTH, Grid, GridError};
use crate::{Beside, ColorSpace, ListFolder, Mesh, MeshBuilder, mesh_box, no_files, same_folder};

const COUNTED_DEPTH: u32 = 8;

/// How a mesh becomes a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeshOptions {
    /// Levels below the root: at most `2^depth` voxels a side.
    pub depth: u32,
    /// How the colours of an MTL are meant.
    pub mtl_colors: ColorSpace,
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
            mtl_colors: ColorSpace::default(),
            opacities: false,
            y_up: None,
        }
    }
}

impl MeshReader for MeshOptions {
    fn read(
        &self,
        file: MeshFile,
        progress: &dyn Progress,
    ) -> Result<Box<dyn MeshVoxels>, OpenError> {
        let started = Instant::now();
        let mesh = read(&file, self.mtl_colors, progress)?;
        let load_ms = started.elapsed().as_secs_f64() * 1e3;
        let refused = |error: GridError| {
            let is_limit = matches!(error, GridError::TooMany(_) | GridError::TooMuch { .. });
            OpenError::Mesh(MeshFailure {
                is_limit,
                error: format!("{}: {error}", file.name).into(),
            })
        };
        let grid = Grid::around(&mesh, self.depth).map_err(refused)?;
        let (depth, least) = (self.depth, voxelize::least_looked_at(&mesh, &grid));
        if least > voxelize::MOST_LOOKED_AT {
            return Err(refused(GridError::TooMuch { depth, least }));
        }
        Ok(Box::new(Ready {
            y_up: self.y_up.unwrap_or(is_y_up(file.kind)),
            opacities: self.opacities,
            mesh,
            grid,
            load_ms,
        }))
    }
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct OpenOptions {
    pub voxels: scene::OpenOptions,
    pub mesh: MeshOptions,
}

/// Opens a file that is held in memory; a mesh finds no other files. [`scene::open_bytes`] with meshes.
pub fn open_bytes(
    bytes: &[u8],
    name: &str,
    options: &OpenOptions,
    progress: &dyn Progress,
) -> Result<Opened, OpenError> {
    scene::open_bytes(bytes, name, &options.voxels, &options.mesh, progress)
}

/// Reads a mesh file, for its triangles; also returns whether +Y is up in it. `within`: the mesh is kept in files of
/// this folder, and its own file is mapped.
pub fn read_mesh(
    path: &Path,
    mtl_colors: ColorSpace,
    within: Option<&Arc<ListFolder>>,
    progress: &dyn Progress,
) -> Result<(Mesh, bool), OpenError> {
    let (file, beside) = (SceneFile::open(path)?, path.parent());
    let Some(folder) = within else {
        let file = file.mesh_file(beside.map(Path::to_owned))?;
        let mesh = read(&file, mtl_colors, progress)?;
        return Ok((mesh, is_y_up(file.kind)));
    };
    let (file, kind) = file.mesh_stream()?;
    let name = path.display().to_string();
    let bytes = folder.read(file).map_err(|source| SceneError::Io {
        file: name.clone(),
        action: "map the file",
        source,
    })?;
    let builder = MeshBuilder::within(within);
    let beside = same_folder(beside.unwrap_or(Path::new("")));
    let mesh = read_into(builder, &bytes, kind, &name, &beside, mtl_colors, progress);
    let mesh = mesh.map_err(|error| match error {
        SceneError::Io { source, .. } => OpenError::Build {
            source_name: name.clone(),
            error: ExternalError::Temporary {
                folder: folder.path.clone(),
                source,
            },
        },
        error => error.into(),
    })?;
    Ok((mesh, is_y_up(kind)))
}

fn is_y_up(kind: FileKind) -> bool {
    kind != FileKind::Stl
}

fn read(
    file: &MeshFile,
    mtl_colors: ColorSpace,
    progress: &dyn Progress,
) -> Result<Mesh, OpenError> {
    let folder = file.folder.as_deref().map(same_folder);
    let beside: &Beside<'_> = folder.as_ref().map_or(&no_files, |files| files);
    let (name, kind) = (&file.name, file.kind);
    let mesh = crate::read(&file.bytes, kind, name, beside, mtl_colors, progress);
    mesh.map_err(OpenError::from)
}

struct Ready {
    mesh: Mesh,
    y_up: bool,
    opacities: bool,
    grid: Grid,
    load_ms: f64,
}

impl MeshVoxels for Ready {
    fn bytes(&self) -> u64 {
        self.mesh.bytes()
    }

    /// About how many voxels there are going to be, rather fewer than more; none of so few levels that it is as
    /// quick to find them. A surface has four times as many at each further level, what is thin fewer at first.
    fn expected_voxels(&self, progress: &dyn Progress) -> Option<u64> {
        let further = self
            .grid
            .depth()
            .checked_sub(COUNTED_DEPTH)
            .filter(|&levels| levels > 3)?;
        let count = |depth| {
            let grid = Grid::around(&self.mesh, depth).ok()?;
            Some(
                voxelize::voxelize(&self.mesh, &grid, self.opacities, &mut |_| (), progress).voxels,
            )
        };
        let (coarse, fine) = (count(COUNTED_DEPTH - 1)?, count(COUNTED_DEPTH)?);
        let growth = (fine as f64 / coarse as f64).min(4.0);
        Some((fine as f64 * libm::pow(growth, f64::from(further))) as u64)
    }

    fn placement(&self) -> ([f64; 3], f64) {
        self.grid.placement()
    }

    fn mesh_box(&self) -> MeshBox {
        mesh_box(&self.mesh, self.y_up)
    }

    fn finish(&self, graph: &mut Graph, progress: &dyn Progress) {
        if !self.opacities {
            return;
        }
        let opacities = voxelize::opacities(&self.mesh, &self.grid, graph, progress);
        graph.opacity = opacities.into();
    }

    fn voxels(
        &self,
        sink: &mut dyn FnMut(Voxel),
        progress: &dyn Progress,
    ) -> (SceneInfo, MeshSummary) {
        let started = Instant::now();
        let report = voxelize::voxelize(&self.mesh, &self.grid, self.opacities, sink, progress);
        let voxelize_ms = started.elapsed().as_secs_f64() * 1e3;
        let info = SceneInfo {
            warnings: self.mesh.warnings().to_vec(),
            ..SceneInfo::default()
        };
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
