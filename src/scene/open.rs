//! From what a user calls a scene to a graph: a generator's specification or
//! a file of any known format.

use std::io::{Read, Seek};

use super::generate::Spec;
use super::memory;
use super::mesh::{Beside, MeshOptions, MeshSummary, Nothing, Ready, SameFolder};
use super::open_error::OpenError;
use super::{FileKind, ReadOptions, SceneFile, SceneInfo, Source};
use crate::graph::{BuildOptions, Builder, Graph, Progress, vxg};

/// Graph files up to this size are checked in full when they are opened;
/// larger ones are mapped, and only the pages that a picture needs are read.
const VERIFY_BYTES: u64 = 256 << 20;

/// How a scene is opened.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct OpenOptions {
    /// How voxel files are read.
    pub read: ReadOptions,
    /// How meshes are read and voxelised.
    pub mesh: MeshOptions,
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
    progress: &dyn Progress,
) -> Result<Opened, OpenError> {
    open_source(Source::find(source)?, options, progress)
}

/// [`open`], of what was found already.
///
/// # Errors
/// See [`OpenError`].
pub fn open_source(
    source: Source,
    options: &OpenOptions,
    progress: &dyn Progress,
) -> Result<Opened, OpenError> {
    let file = match source {
        Source::Generated(spec) => return open_generated(&spec, progress),
        Source::File(file) => file,
    };
    if file.kind() == Some(FileKind::Vxg) {
        let graph = if file.length() <= VERIFY_BYTES {
            vxg::verify(file.path())?
        } else {
            vxg::open(file.path())?
        };
        return Ok(of_graph(graph));
    }
    let beside = SameFolder::of(file.path());
    open_file(file, &beside, options, progress)
}

/// A scene of a `.vxg` file's graph.
fn of_graph(graph: Graph) -> Opened {
    Opened {
        graph,
        format: FileKind::Vxg.to_string(),
        info: None,
        mesh: None,
    }
}

/// Opens voxels or a mesh.
fn open_file<R: Read + Seek>(
    file: SceneFile<R>,
    beside: &dyn Beside,
    options: &OpenOptions,
    progress: &dyn Progress,
) -> Result<Opened, OpenError> {
    let name = file.name();
    if file.kind().is_some_and(FileKind::is_mesh) {
        let ready = Ready::read(file, beside, &options.mesh, progress)?;
        return open_mesh(&ready, options.mesh.opacities, &name, progress);
    }
    let mut gathered = Gathered::default();
    let info = file.read_voxels(&options.read, &mut |v| gathered.push(v), progress)?;
    Ok(Opened {
        graph: gathered.finish(&name, UNIT, progress)?,
        format: info.kind.to_string(),
        info: Some(info),
        mesh: None,
    })
}

/// Voxels of side 1 from the origin: file indices are world coordinates.
const UNIT: ([f64; 3], f64) = ([0.0; 3], 1.0);

/// Voxelises a mesh that was read.
fn open_mesh(
    ready: &Ready,
    opacities: bool,
    source: &str,
    progress: &dyn Progress,
) -> Result<Opened, OpenError> {
    let mut gathered = Gathered::default();
    let placement = ready.placement();
    let (info, summary) = ready.voxels(&mut |v| gathered.push(v), progress);
    let mut graph = gathered.finish(source, placement, progress)?;
    if opacities {
        ready.add_opacities(&mut graph, progress);
    }
    Ok(Opened {
        graph,
        format: format!("{} mesh", info.kind),
        info: Some(info),
        mesh: Some(summary),
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
    progress: &dyn Progress,
) -> Result<Opened, OpenError> {
    let file = SceneFile::in_memory(bytes, name)?;
    if file.kind() == Some(FileKind::Vxg) {
        return Ok(of_graph(vxg::from_bytes(bytes)?));
    }
    open_file(file, &Nothing, options, progress)
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
        let available = memory::available();
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
