//! Opens a scene as a graph: a generator's specification, or a file of any known format.

use std::io::{Read, Seek};
use std::path::{Path, PathBuf};

use super::generate::Spec;
use super::mesh::{MeshReader, MeshSummary, MeshVoxels};
use super::open_error::OpenError;
use super::{FileKind, ReadOptions, SceneError, SceneFile, SceneInfo, Source};
use crate::budget;
use crate::graph::{Builder, Graph, Progress, vxg};

/// The default limit. Of a larger file, only the pages that a picture needs are read.
const VERIFY_BYTES: u64 = 1 << 20;

/// Least bytes per voxel: 20 while voxels are collected and sorted, 5 in the graph (`spec/graph.md`).
const LEAST_BYTES: u64 = 25;

#[derive(Debug, Clone, PartialEq)]
pub struct OpenOptions {
    pub read: ReadOptions,
    /// Graph files of up to this many bytes are checked in full; of larger ones, only the header.
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

#[derive(Debug)]
pub struct Opened {
    /// The voxels, at least one.
    pub graph: Graph,
    pub format: String,
    pub info: SceneInfo,
    pub mesh: Option<MeshSummary>,
    /// `false` for a graph file larger than [`OpenOptions::verify_up_to`].
    pub is_verified: bool,
    /// The graph file that is mapped.
    pub mapped: Option<PathBuf>,
}

impl Opened {
    fn of(graph: Graph, format: impl ToString) -> Self {
        Self {
            graph,
            format: format.to_string(),
            info: SceneInfo::default(),
            mesh: None,
            is_verified: true,
            mapped: None,
        }
    }
}

/// Opens a file, or makes the scene of a `gen:` specification. Too many voxels for the memory are an error, before they
/// are read if the file states their number.
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
            mapped: Some(file.path().to_owned()),
            ..Opened::of(graph, FileKind::Vxg)
        });
    }
    let folder = file.path().parent().map(Path::to_owned);
    open_file(file, folder, options, meshes, progress)
}

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
    // If the limit was free memory, not the caller's, that is the error.
    if let Err(SceneError::TooMany { voxels, most, .. }) = read
        && most < options.read.most_voxels
    {
        gathered.expect(voxels, &name)?;
    }
    let info = read?;
    let graph = gathered.finish(&name, placement(&info), progress)?;
    Ok(Opened {
        info,
        ..Opened::of(graph, ending)
    })
}

/// Voxels of side 1 from the origin: file indices are world coordinates.
pub(super) const UNIT: ([f64; 3], f64) = ([0.0; 3], 1.0);

/// World coordinates are those of the file.
pub(super) fn placement(info: &SceneInfo) -> ([f64; 3], f64) {
    ([0.0; 3], info.voxel_size.unwrap_or(1.0))
}

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
        info,
        mesh: Some(summary),
        ..Opened::of(graph, format)
    })
}

/// [`open_source`] for a file in memory. A mesh there has no other files.
pub fn open_bytes(
    bytes: &[u8],
    name: &str,
    options: &OpenOptions,
    meshes: &dyn MeshReader,
    progress: &dyn Progress,
) -> Result<Opened, OpenError> {
    let file = SceneFile::in_memory(bytes, name)?;
    if file.kind() == Some(FileKind::Vxg) {
        return Ok(Opened::of(vxg::from_bytes(bytes)?, FileKind::Vxg));
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
    Ok(Opened::of(graph, "generated"))
}

struct Gathered {
    builder: Builder,
    available: Option<u64>,
    most: u64,
    seen: u64,
}

impl Default for Gathered {
    fn default() -> Self {
        let available = budget::available();
        Self {
            builder: Builder::default(),
            available,
            most: available.map_or(u64::MAX, |bytes| bytes / LEAST_BYTES),
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
            self.builder = Builder::default();
        }
    }

    fn expect(&self, voxels: u64, source: &str) -> Result<(), OpenError> {
        match self.available {
            Some(available) if voxels > self.most => Err(OpenError::TooMany {
                source_name: source.to_owned(),
                voxels,
                needed: voxels.saturating_mul(LEAST_BYTES),
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
        self.builder
            .finish(placement, progress)
            .map_err(|error| OpenError::Build {
                source_name: source.to_owned(),
                error: error.into(),
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{Silent, Voxel};

    #[test]
    fn more_voxels_than_memory_are_refused() {
        let mut gathered = Gathered {
            available: Some(100),
            most: 4,
            ..Gathered::default()
        };
        (0..5).for_each(|_| gathered.push(Voxel::default()));
        assert!(gathered.builder.is_empty());
        let error = gathered.finish("a.ply", UNIT, &Silent).unwrap_err();
        let told = error.to_string();
        let part = "a.ply: 5 voxels or more take at least 125 bytes of memory while they are built, and 100";
        assert!(error.is_limit() && told.starts_with(part), "{told}");
    }
}
