//! Importers and exporters of voxel files.
//!
//! Importers pass voxels to a sink one by one. File coordinates are kept: voxel `(i, j, k)` fills
//! `[i, i+1) x [j, j+1) x [k, k+1)`, Z up, and colours are sRGB as stored. [`FORMATS`] is the table of formats.

mod build_file;
mod emit;
mod error;
mod fault;
mod file;
mod formats;
pub mod generate;
mod input;
mod mesh;
pub mod numbers;
mod open;
mod open_error;
mod options;
pub mod ply;

pub use build_file::{BuiltFile, build_file};
pub use emit::MAX_EXTENT;
pub use error::SceneError;
pub use fault::{Fault, Place, Problem};
pub use file::{SceneFile, Source};
pub use formats::{
    FORMATS, FileKind, Format, VoxWriter, VoxWritten, detect, is_binary_stl, is_text_stl, write_ply,
};
pub use mesh::{MeshFile, MeshReader, MeshSummary, MeshVoxels, NoMeshes};
pub use open::{OpenOptions, Opened, open_bytes, open_source};
pub use open_error::{MeshFailure, OpenError};
pub use options::{ReadOptions, SceneInfo};

pub const BUNDLED_TREE: &[u8] = include_bytes!("../../assets/tree.vox");

/// sRGB colour of voxels and triangles in files without colours.
pub const DEFAULT_COLOR: [u8; 3] = [200; 3];
