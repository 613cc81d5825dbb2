//! From what a user calls a scene to a graph: a generator's specification or
//! a file of any known format.

use std::io::{Read, Seek};
use std::path::{Path, PathBuf};

use super::generate::Spec;
use super::memory;
use super::mesh::{MeshReader, MeshSummary, MeshVoxels};
use super::open_error::OpenError;
use super::{FileKind, ReadOptions, SceneError, SceneFile, SceneInfo, Source};
use crate::budget;
use crate::graph::{BuildOptions, Builder, Graph, Progress, vxg};

/// Where nothing else is said; of larger files only the pages that a picture needs are read.
const VERIFY_BYTES: u64 = 256 << 20;

/// How a scene is opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpenOptions {
    /// How voxel files are read.
    pub read: ReadOptions,
    /// Graph files of so many bytes are checked in full; of larger ones, which are mapped, the header only. What
    /// is going to read all of a file has it checked at any size.
    pub verify_up_to: u64,
}

impl Default for OpenOptions {
    fn default() -> Self {
        Self {
            read: ReadOptions::default(),
            verify_up_to: VERIFY_BYTES,
        }
    }
}

/// An open scene.
#[derive(Debug)]
pub struct Opened {
    /// What to draw; not empty.
    pub graph: Graph,
    /// The format, in words.
    pub format: String,
    /// What a voxel file held beside its voxels.
    pub info: Option<SceneInfo>,
    /// What the mesh was, where it was one.
    pub mesh: Option<MeshSummary>,
    /// Whether all of it was checked: not the contents of a graph file larger than [`OpenOptions::verify_up_to`].
    pub is_verified: bool,
}

/// Opens a file, or makes the scene of a `gen:` specification.
///
/// Voxels are gathered and built in memory; more than fit the memory that is
/// free at the beginning are an error, in advance where their number is given.
/// [`build_file`](super::build_file()) makes a `.vxg` file of those.
///
/// # Errors
/// See [`OpenError`].
pub fn open(
    source: &str,
    options: &OpenOptions,
    meshes: &dyn MeshReader,
    progress: &dyn Progress,
) -> Result<Opened, OpenError> {
    open_source(Source::find(source)?, options, meshes, progress)
}

/// [`open`], of what was found already.
///
/// # Errors
/// See [`OpenError`].
pub fn open_source(
    source: Source,
    options: &OpenOptions,
    meshes: &dyn MeshReader,
    progress: &dyn Progress,
) -> Result<Opened, OpenError> {
    let file = match source {
        Source::Generated(spec) => return open_generated(&spec, progress),
        Source::File(file) => file,
    };
    if file.kind() == Some(FileKind::Vxg) {
        let is_verified = file.length() <= options.verify_up_to;
        let graph = match is_verified {
            true => vxg::verify(file.path())?,
            false => vxg::open(file.path())?,
        };
        return Ok(Opened {
            is_verified,
            ..of_graph(graph)
        });
    }
    let folder = file.path().parent().map(Path::to_owned);
    open_file(file, folder, options, meshes, progress)
}

/// A scene of a `.vxg` file's graph.
fn of_graph(graph: Graph) -> Opened {
    Opened {
        graph,
        format: FileKind::Vxg.to_string(),
        info: None,
        mesh: None,
        is_verified: true,
    }
}

/// Opens voxels or a mesh.
fn open_file<R: Read + Seek>(
    file: SceneFile<R>,
    folder: Option<PathBuf>,
    options: &OpenOptions,
    meshes: &dyn MeshReader,
    progress: &dyn Progress,
) -> Result<Opened, OpenError> {
    let name = file.name();
    let ending = file.kind().map(|kind| kind.to_string()).unwrap_or_default();
    if file.kind().is_some_and(FileKind::is_mesh) {
        let mesh = meshes.read(file.mesh_file(folder)?, progress)?;
        return open_mesh(&*mesh, format!("{ending} mesh"), &name, progress);
    }
    let mut gathered = Gathered::default();
    let read = ReadOptions {
        most_voxels: options.read.most_voxels.min(gathered.most),
        ..options.read.clone()
    };
    let read = file.read_voxels(&read, &mut |v| gathered.push(v), progress);
    let info = read.map_err(|error| match error {
        // Fewer than the caller would take: for want of memory.
        SceneError::TooMany { file, voxels, most } if most < options.read.most_voxels => {
            OpenError::TooMany {
                source_name: file,
                voxels,
                needed: memory::least_bytes(voxels),
                available: gathered.available.unwrap_or_default(),
            }
        }
        error => error.into(),
    })?;
    Ok(Opened {
        graph: gathered.finish(&name, UNIT, progress)?,
        format: ending,
        info: Some(info),
        mesh: None,
        is_verified: true,
    })
}

/// Voxels of side 1 from the origin: file indices are world coordinates.
const UNIT: ([f64; 3], f64) = ([0.0; 3], 1.0);

/// Voxelises a mesh that was read.
fn open_mesh(
    mesh: &dyn MeshVoxels,
    format: String,
    source: &str,
    progress: &dyn Progress,
) -> Result<Opened, OpenError> {
    let mut gathered = Gathered::default();
    let placement = mesh.placement();
    if let Some(voxels) = mesh.expected_voxels(progress) {
        gathered.expect(voxels, source)?;
    }
    let (info, summary) = mesh.voxels(&mut |v| gathered.push(v), progress);
    let mut graph = gathered.finish(source, placement, progress)?;
    graph.placement.mesh = Some(mesh.mesh_box());
    mesh.finish(&mut graph, progress);
    Ok(Opened {
        graph,
        format,
        info: Some(info),
        mesh: Some(summary),
        is_verified: true,
    })
}

/// Opens a file that is held in memory. A mesh finds no other files there.
///
/// # Errors
/// See [`OpenError`].
pub fn open_bytes(
    bytes: &[u8],
    name: &str,
    options: &OpenOptions,
    meshes: &dyn MeshReader,
    progress: &dyn Progress,
) -> Result<Opened, OpenError> {
    let file = SceneFile::in_memory(bytes, name)?;
    if file.kind() == Some(FileKind::Vxg) {
        return Ok(of_graph(vxg::from_bytes(bytes)?));
    }
    open_file(file, None, options, meshes, progress)
}

fn open_generated(source: &str, progress: &dyn Progress) -> Result<Opened, OpenError> {
    let spec = Spec::parse(source)?;
    let graph = match spec.linked() {
        Some(graph) => graph,
        None => {
            let mut gathered = Gathered::default();
            gathered.expect(spec.least_voxels(), source)?;
            spec.voxels(&mut |v| gathered.push(v), progress);
            gathered.finish(source, UNIT, progress)?
        }
    };
    Ok(Opened {
        graph,
        format: "generated".to_owned(),
        info: None,
        mesh: None,
        is_verified: true,
    })
}

/// Voxels on their way into a graph.
struct Gathered {
    builder: Builder,
    /// Free memory at the beginning, where the system reports it.
    available: Option<u64>,
    /// Most voxels that fit it.
    most: u64,
    /// Voxels seen, kept or not.
    seen: u64,
}

impl Default for Gathered {
    fn default() -> Self {
        let available = budget::available();
        Self {
            builder: Builder::new(BuildOptions::default()),
            available,
            most: available.map_or(u64::MAX, memory::most_voxels),
            seen: 0,
        }
    }
}

impl Gathered {
    fn push(&mut self, voxel: crate::graph::Voxel) {
        self.seen += 1;
        if self.seen <= self.most {
            self.builder.push(voxel);
        } else if !self.builder.is_empty() {
            // It is lost; let go of what there is.
            self.builder = Builder::new(BuildOptions::default());
        }
    }

    /// Fails where so many voxels cannot be built in memory.
    fn expect(&self, voxels: u64, source: &str) -> Result<(), OpenError> {
        match self.available {
            Some(available) if voxels > self.most => Err(OpenError::TooMany {
                source_name: source.to_owned(),
                voxels,
                needed: memory::least_bytes(voxels),
                available,
            }),
            _ => Ok(()),
        }
    }

    fn finish(
        self,
        source: &str,
        placement: ([f64; 3], f64),
        progress: &dyn Progress,
    ) -> Result<Graph, OpenError> {
        self.expect(self.seen, source)?;
        let source_name = source.to_owned();
        self.builder
            .finish(placement, progress)
            .map_err(|error| OpenError::Build { source_name, error })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{Silent, Voxel};

    #[test]
    fn more_voxels_than_memory_are_told() {
        let mut gathered = Gathered {
            available: Some(100),
            most: 4,
            ..Gathered::default()
        };
        for x in 0..5 {
            gathered.push(Voxel {
                index: [x, 0, 0],
                ..Voxel::default()
            });
        }
        assert!(gathered.builder.is_empty());
        let error = gathered
            .finish("a.ply", UNIT, &Silent)
            .expect_err("too many");
        assert!(error.is_limit());
        assert_eq!(
            error.to_string(),
            "a.ply: 5 voxels or more take at least 125 bytes of memory while they are built, \
             and 100 are free"
        );
    }
}
