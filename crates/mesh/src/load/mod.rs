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
use std::path::{Component, Path};

pub(super) use shiftvox::scene::{Fault, Place, Problem};

use super::{ColorSpace, Mesh, MeshBuilder, SceneError};
use shiftvox::bounded;
use shiftvox::graph::Progress;
use shiftvox::scene::FileKind;

/// Reads a file that a mesh names.
pub type Beside<'a> = dyn Fn(&str) -> io::Result<Vec<u8>> + 'a;

/// Files in this folder, that of the mesh, or below it. Of a name that leads elsewhere, only the last part counts.
pub fn same_folder(folder: &Path) -> impl Fn(&str) -> io::Result<Vec<u8>> {
    move |name| {
        let name = name.replace('\\', "/");
        let path = Path::new(&name);
        let inside = |c: Component<'_>| matches!(c, Component::Normal(_) | Component::CurDir);
        if path.components().all(inside) {
            let found = bounded::read(&folder.join(path), u64::MAX);
            // The mesh means a file that exists, even if it cannot be read.
            if !matches!(&found, Err(error) if error.kind() == io::ErrorKind::NotFound) {
                return found;
            }
        }
        let last = path.file_name().ok_or(io::ErrorKind::NotFound)?;
        bounded::read(&folder.join(last), u64::MAX)
    }
}

/// No other files.
pub fn no_files(_: &str) -> io::Result<Vec<u8>> {
    Err(io::ErrorKind::NotFound.into())
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

/// Reads a mesh that is in memory. `name` is what errors call it, and `mtl_colors` how an MTL's colours are meant, as the
/// format does not say.
///
/// # Errors
/// [`SceneError`] where the content breaks its format's rules or holds no triangle that can be drawn.
pub fn read(
    bytes: &[u8],
    format: FileKind,
    name: &str,
    beside: &Beside<'_>,
    mtl_colors: ColorSpace,
    progress: &dyn Progress,
) -> Result<Mesh, SceneError> {
    let builder = MeshBuilder::new();
    read_into(builder, bytes, format, name, beside, mtl_colors, progress)
}

pub(super) fn read_into(
    mut builder: MeshBuilder,
    bytes: &[u8],
    format: FileKind,
    name: &str,
    beside: &Beside<'_>,
    mtl_colors: ColorSpace,
    progress: &dyn Progress,
) -> Result<Mesh, SceneError> {
    progress.begin(&format!("reading {name}"), 0);
    let result = match format {
        FileKind::Obj => obj::read(bytes, beside, mtl_colors, &mut builder),
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
