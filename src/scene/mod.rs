//! Importers and exporters of voxel files.
//!
//! Importers hand voxels to a sink one by one, so that memory stays bounded by
//! what the sink keeps (and, for `.vox`, by the file, which is held whole). The
//! format is told by content. File coordinates are kept: voxel `(i, j, k)`
//! fills `[i, i+1) x [j, j+1) x [k, k+1)`, Z up, and colours are sRGB as stored.

use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use crate::graph::{Progress, Voxel};

mod build_file;
mod detect;
mod emit;
mod error;
pub mod generate;
mod memory;
mod mesh;
mod npy;
mod open;
mod options;
mod ply;
mod ply_write;
mod vox;

pub use build_file::{BuiltFile, build_file};
pub use detect::{DETECT_BYTES, FileKind, detect, detect_named, detect_with_length};
pub use emit::MAX_EXTENT;
pub use error::{Fault, SceneError};
pub use memory::available as available_memory;
pub use mesh::{MeshOptions, MeshSummary, read_mesh};
pub use open::{OpenError, OpenOptions, Opened, open, open_bytes};
pub use options::{OutOfBounds, ReadOptions, SceneInfo};
pub use ply_write::write_ply;
pub use vox::{VoxWriter, VoxWritten};

use emit::Emitter;
use error::{Problem, printable};

/// Reads a voxel file and hands each voxel to `sink`.
///
/// Voxels handed on before an error was found must be thrown away by the caller.
///
/// # Errors
/// [`SceneError`] where the file cannot be read, is of no supported format, breaks
/// its format's rules, or exceeds [`MAX_EXTENT`] or the range of `i32`.
pub fn read_voxels(
    path: &Path,
    options: &ReadOptions,
    sink: &mut dyn FnMut(Voxel),
    progress: &dyn Progress,
) -> Result<SceneInfo, SceneError> {
    let name = path.display().to_string();
    let open = |action| {
        let name = name.clone();
        move |source| SceneError::Io {
            file: name,
            action,
            source,
        }
    };
    let mut file = File::open(path).map_err(open("open the file"))?;
    let length = file
        .metadata()
        .map_err(open("ask for the file's size"))?
        .len();
    let mut prefix = Vec::with_capacity(DETECT_BYTES);
    (&mut file)
        .take(DETECT_BYTES as u64)
        .read_to_end(&mut prefix)
        .map_err(open("read the file"))?;
    file.seek(SeekFrom::Start(0))
        .map_err(open("seek in the file"))?;
    let kind = supported(&prefix, length, &name)?;
    if kind == FileKind::Vox {
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)
            .map_err(open("read the file"))?;
        return read_voxels_from(&bytes, &name, options, sink, progress);
    }
    read_stream(
        kind,
        &mut BufReader::with_capacity(1 << 16, file),
        length,
        &name,
        options,
        sink,
        progress,
    )
}

/// Reads a voxel file that is in memory; `name` is what errors call it. See [`read_voxels`].
///
/// # Errors
/// As [`read_voxels`], except that reading cannot fail.
pub fn read_voxels_from(
    bytes: &[u8],
    name: &str,
    options: &ReadOptions,
    sink: &mut dyn FnMut(Voxel),
    progress: &dyn Progress,
) -> Result<SceneInfo, SceneError> {
    let length = bytes.len() as u64;
    let kind = supported(&bytes[..bytes.len().min(DETECT_BYTES)], length, name)?;
    if kind == FileKind::Vox {
        return tell(name, sink, progress, |emitter| {
            vox::read(bytes, options, emitter)
        });
    }
    read_stream(
        kind,
        &mut Cursor::new(bytes),
        length,
        name,
        options,
        sink,
        progress,
    )
}

/// Reads one of the formats that need not be held whole.
fn read_stream<R: std::io::BufRead + Seek>(
    kind: FileKind,
    reader: &mut R,
    length: u64,
    name: &str,
    options: &ReadOptions,
    sink: &mut dyn FnMut(Voxel),
    progress: &dyn Progress,
) -> Result<SceneInfo, SceneError> {
    tell(name, sink, progress, |emitter| match kind {
        FileKind::Npy => npy::read(reader, length, options, emitter),
        _ => ply::read(reader, options, emitter),
    })
}

/// Runs an importer between the beginning and the end of its progress.
fn tell(
    name: &str,
    sink: &mut dyn FnMut(Voxel),
    progress: &dyn Progress,
    import: impl FnOnce(&mut Emitter<'_>) -> Result<SceneInfo, Problem>,
) -> Result<SceneInfo, SceneError> {
    progress.begin(&format!("reading {name}"), 0);
    let mut emitter = Emitter::new(sink, progress);
    let result = import(&mut emitter).map(|mut info| {
        emitter.finish(&mut info);
        info
    });
    progress.end();
    result.map_err(|problem| problem.in_file(name))
}

/// The format, where it is one that holds voxels.
fn supported(prefix: &[u8], length: u64, name: &str) -> Result<FileKind, SceneError> {
    let file = name.to_owned();
    match detect_named(prefix, length, Path::new(name)) {
        Some(kind) if kind.is_voxels() => Ok(kind),
        Some(FileKind::Vxg) => Err(SceneError::IsGraph { file }),
        Some(kind) => Err(SceneError::Mesh { file, kind }),
        None => Err(SceneError::Unknown {
            file,
            begins: printable(prefix),
        }),
    }
}
