//! Files to meshes.

mod gltf;
mod mtl;
mod obj;
mod ply;
mod polygon;
mod stl;
mod text;
mod texture;

use std::io;
use std::path::{Component, Path, PathBuf};

pub(super) use shiftvox::scene::{Fault, Place, Problem};

use super::{ColorSpace, Mesh, MeshBuilder, SceneError};
use shiftvox::bounded;
use shiftvox::graph::Progress;
use shiftvox::scene::FileKind;

/// How a mesh is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LoadOptions {
    /// How an MTL's colours are meant; the format does not say.
    pub mtl_colors: ColorSpace,
}

/// Reads the files that a mesh names.
pub trait Beside {
    /// The bytes of a file.
    ///
    /// # Errors
    /// When there is no such file or it cannot be read.
    fn read(&self, name: &str) -> io::Result<Vec<u8>>;
}

/// Files in the folder of the mesh, or below it. Of a name that leads elsewhere, only the last part counts.
#[derive(Debug, Clone)]
pub struct SameFolder(PathBuf);

impl SameFolder {
    /// Files in this folder.
    pub fn new(folder: &Path) -> Self {
        Self(folder.to_owned())
    }
}

impl Beside for SameFolder {
    fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        let name = name.replace('\\', "/");
        let path = Path::new(&name);
        let inside = |c: Component<'_>| matches!(c, Component::Normal(_) | Component::CurDir);
        if path.components().all(inside) {
            let found = bounded::read(&self.0.join(path), u64::MAX);
            // The mesh means a file that exists, even if it cannot be read.
            if !matches!(&found, Err(error) if error.kind() == io::ErrorKind::NotFound) {
                return found;
            }
        }
        let last = path.file_name().ok_or(io::ErrorKind::NotFound)?;
        bounded::read(&self.0.join(last), u64::MAX)
    }
}

/// No other files.
#[derive(Debug, Clone, Copy, Default)]
pub struct Nothing;

impl Beside for Nothing {
    fn read(&self, _name: &str) -> io::Result<Vec<u8>> {
        Err(io::ErrorKind::NotFound.into())
    }
}

/// Most corners of a face. Of a fan of more, each triangle would cross the whole face.
const MOST_CORNERS: usize = 1 << 16;

fn check_corners(corners: usize, place: Place) -> Result<(), Problem> {
    if corners <= MOST_CORNERS {
        return Ok(());
    }
    Err(Problem::Limit(Fault::new(
        "face",
        place,
        format!("at most {MOST_CORNERS} corners"),
        corners.to_string(),
        "cut the face into triangles where the mesh is made: a fan of so many would be slivers",
    )))
}

/// Reads a mesh that is in memory; `name` is what errors call it.
///
/// # Errors
/// [`SceneError`] where the content breaks its format's rules or holds no triangle that can be drawn.
pub fn read(
    bytes: &[u8],
    format: FileKind,
    name: &str,
    beside: &dyn Beside,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Mesh, SceneError> {
    let builder = MeshBuilder::new();
    read_into(builder, bytes, format, name, beside, options, progress)
}

pub(super) fn read_into(
    mut builder: MeshBuilder,
    bytes: &[u8],
    format: FileKind,
    name: &str,
    beside: &dyn Beside,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Mesh, SceneError> {
    progress.begin(&format!("reading {name}"), 0);
    let result = match format {
        FileKind::Obj => obj::read(bytes, beside, options, &mut builder),
        FileKind::Ply | FileKind::PlyMesh => ply::read(bytes, beside, &mut builder),
        FileKind::Stl => stl::read(bytes, &mut builder),
        FileKind::Gltf => gltf::read_json(bytes, beside, &mut builder),
        FileKind::Glb => gltf::read_binary(bytes, beside, &mut builder),
        kind => {
            let file = name.to_owned();
            return Err(SceneError::NotMesh { file, kind });
        }
    };
    progress.end();
    builder.check_folder()?;
    result.map_err(|error| error.in_file(name))?;
    builder.finish(name)
}
