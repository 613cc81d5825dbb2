//! A scene's file: opened once, its format found, then read from the same handle.

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::detect::{DETECT_BYTES, detect_named};
use super::emit::Emitter;
use super::error::{Problem, printable};
use super::{FileKind, MeshFile, ReadOptions, SceneError, SceneInfo, generate, npy, ply, vox};
use crate::bounded;
use crate::graph::{Progress, Voxel};

/// What a user calls a scene.
#[derive(Debug)]
pub enum Source {
    /// A generator's specification, `gen:...`.
    Generated(String),
    /// A file, open.
    File(SceneFile),
}

impl Source {
    /// Whether a name is a generator's specification.
    #[must_use]
    pub fn is_generated(name: &str) -> bool {
        name.starts_with(generate::PREFIX)
    }

    /// Opens the file, unless the name is a generator's specification.
    ///
    /// # Errors
    /// As [`SceneFile::open`].
    pub fn find(name: impl AsRef<Path>) -> Result<Self, SceneError> {
        let name = name.as_ref();
        match name.to_str() {
            Some(text) if Self::is_generated(text) => Ok(Self::Generated(text.to_owned())),
            _ => SceneFile::open(name).map(Self::File),
        }
    }

    /// The file's format; `None` of a generator and of what is no known format.
    #[must_use]
    pub fn kind(&self) -> Option<FileKind> {
        match self {
            Self::Generated(_) => None,
            Self::File(file) => file.kind(),
        }
    }
}

/// A file whose format is known, ready to be read from its beginning.
#[derive(Debug)]
pub struct SceneFile<R = File> {
    path: PathBuf,
    reader: R,
    length: u64,
    kind: Option<FileKind>,
    /// At most [`DETECT_BYTES`].
    beginning: Vec<u8>,
}

impl SceneFile<File> {
    /// Opens a file and finds its format. A file of no known format can be opened, not read.
    ///
    /// # Errors
    /// [`SceneError::Io`].
    pub fn open(path: &Path) -> Result<Self, SceneError> {
        let refused = |action| {
            move |source| SceneError::Io {
                file: path.display().to_string(),
                action,
                source,
            }
        };
        let file = bounded::open(path).map_err(refused("open the file"))?;
        let size = file.metadata().map_err(refused("ask for the file's size"));
        Self::begin(file, size?.len(), path)
    }
}

impl<'b> SceneFile<Cursor<&'b [u8]>> {
    /// A file that is held in memory; `name` is what errors call it.
    pub(super) fn in_memory(bytes: &'b [u8], name: &str) -> Result<Self, SceneError> {
        Self::begin(Cursor::new(bytes), bytes.len() as u64, Path::new(name))
    }
}

impl<R: Read + Seek> SceneFile<R> {
    fn begin(reader: R, length: u64, path: &Path) -> Result<Self, SceneError> {
        let mut file = Self {
            path: path.to_owned(),
            reader,
            length,
            kind: None,
            beginning: Vec::new(),
        };
        file.find_kind()
            .map_err(|source| Problem::Read(source).in_file(&file.name()))?;
        Ok(file)
    }

    fn find_kind(&mut self) -> std::io::Result<()> {
        let beginning = (&mut self.reader).take(DETECT_BYTES as u64);
        { beginning }.read_to_end(&mut self.beginning)?;
        self.kind = detect_named(&self.beginning, self.length, &self.path);
        self.reader.seek(SeekFrom::Start(0))?;
        if self.kind == Some(FileKind::Ply) {
            if ply::has_faces(&mut BufReader::new(&mut self.reader)) {
                self.kind = Some(FileKind::PlyMesh);
            }
            self.reader.seek(SeekFrom::Start(0))?;
        }
        Ok(())
    }

    /// The format, if it is a known one.
    #[must_use]
    pub fn kind(&self) -> Option<FileKind> {
        self.kind
    }

    /// Where the file is; of one in memory its name.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What errors call the file.
    pub(super) fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Bytes of the file.
    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// All of the file.
    pub(super) fn bytes(mut self) -> Result<Vec<u8>, SceneError> {
        let mut bytes = Vec::new();
        // All but the last of what is read besides; a length is known of files only.
        let length = usize::try_from(self.length).unwrap_or(usize::MAX);
        if let Err(refused) = bytes.try_reserve_exact(length) {
            let source = std::io::Error::new(std::io::ErrorKind::OutOfMemory, refused);
            return Err(Problem::Read(source).in_file(&self.name()));
        }
        match self.reader.read_to_end(&mut bytes) {
            Ok(_) => Ok(bytes),
            Err(source) => Err(Problem::Read(source).in_file(&self.name())),
        }
    }

    /// All of a mesh file; `folder` is where it finds other files.
    ///
    /// # Errors
    /// If this is no mesh, or it cannot be read.
    pub fn mesh_file(self, folder: Option<PathBuf>) -> Result<MeshFile, SceneError> {
        let kind = match self.kind {
            // The mesh reader says that a cloud has no faces, or what is wrong with its header.
            Some(kind) if kind.is_mesh() || kind == FileKind::Ply => kind,
            _ => return Err(self.refused(|file, kind| SceneError::NotMesh { file, kind })),
        };
        Ok(MeshFile {
            name: self.name(),
            kind,
            bytes: self.bytes()?,
            folder,
        })
    }

    /// Why there is nothing of a kind in the file, where its format holds something else.
    pub(super) fn refused(
        &self,
        otherwise: impl FnOnce(String, FileKind) -> SceneError,
    ) -> SceneError {
        let file = self.name();
        match self.kind {
            None => SceneError::Unknown {
                file,
                begins: printable(&self.beginning),
            },
            Some(kind) if kind.is_built_of_mesh() => SceneError::BuiltOfMesh { file, kind },
            Some(kind) => otherwise(file, kind),
        }
    }

    /// Hands each voxel of a voxel file to `sink`; see [`read_voxels`](super::read_voxels).
    ///
    /// # Errors
    /// As [`read_voxels`](super::read_voxels).
    pub fn read_voxels(
        self,
        options: &ReadOptions,
        sink: &mut dyn FnMut(Voxel),
        progress: &dyn Progress,
    ) -> Result<SceneInfo, SceneError> {
        let (name, length) = (self.name(), self.length);
        let most = options.most_voxels;
        match self.kind {
            Some(FileKind::Vox) => {
                let bytes = self.bytes()?;
                import(&name, sink, most, progress, |to| {
                    vox::read(&bytes, options, to)
                })
            }
            Some(FileKind::Npy) => import(&name, sink, most, progress, |to| {
                npy::read(&mut self.buffered(), length, options, to)
            }),
            Some(FileKind::Ply) => import(&name, sink, most, progress, |to| {
                ply::read(&mut self.buffered(), options, to)
            }),
            _ => Err(self.refused(|file, kind| match kind {
                FileKind::Vxg => SceneError::IsGraph { file },
                kind => SceneError::Mesh { file, kind },
            })),
        }
    }

    fn buffered(self) -> impl BufRead + Seek {
        BufReader::with_capacity(1 << 16, self.reader)
    }
}

/// Runs an importer between the beginning and the end of its progress.
fn import(
    name: &str,
    sink: &mut dyn FnMut(Voxel),
    most: u64,
    progress: &dyn Progress,
    read: impl FnOnce(&mut Emitter<'_>) -> Result<SceneInfo, Problem>,
) -> Result<SceneInfo, SceneError> {
    progress.begin(&format!("reading {name}"), 0);
    let mut emitter = Emitter::new(sink, most, progress);
    let result = read(&mut emitter).map(|mut info| {
        emitter.finish(&mut info);
        info
    });
    progress.end();
    result.map_err(|problem| problem.in_file(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(bytes: &[u8], name: &str) -> Option<FileKind> {
        SceneFile::in_memory(bytes, name).unwrap().kind()
    }

    /// A PLY header longer than what is examined of other formats.
    fn ply(elements: &str) -> Vec<u8> {
        let comments = "comment nothing\n".repeat(1000);
        format!("ply\nformat ascii 1.0\n{comments}{elements}end_header\n").into_bytes()
    }

    #[test]
    fn faces_make_a_mesh_of_a_ply_however_long_its_header() {
        let vertex = "element vertex 3\nproperty float x\n";
        let list = "property list uchar int vertex_indices\n";
        let with = |faces: u32| ply(&format!("{vertex}element face {faces}\n{list}"));
        assert_eq!(kind(&with(1), "a"), Some(FileKind::PlyMesh));
        assert_eq!(kind(&with(0), "a"), Some(FileKind::Ply));
        assert_eq!(kind(&ply(vertex), "a"), Some(FileKind::Ply));
        assert_eq!(kind(b"ply\nelement face 1\n", "a"), Some(FileKind::Ply));
    }

    #[test]
    fn a_name_counts_for_a_binary_stl_that_was_cut_short() {
        assert_eq!(kind(&[0; 90], "a.stl"), Some(FileKind::Stl));
        assert_eq!(kind(&[0; 90], "a"), None);
        assert_eq!(kind(b"VOX ", "a.stl"), Some(FileKind::Vox));
    }

    #[test]
    fn what_was_built_of_a_mesh_is_neither_voxels_nor_a_mesh() {
        let file = SceneFile::in_memory(b"\x89FAR\r\n\x1a\n", "a.far").unwrap();
        assert_eq!(file.kind(), Some(FileKind::Far));
        let refused = file.read_voxels(&ReadOptions::default(), &mut |_| (), &crate::graph::Silent);
        assert!(matches!(refused, Err(SceneError::BuiltOfMesh { .. })));
    }
}
