//! A scene's file: opened once, its format found, then read from the same handle.

use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::emit::Emitter;
use super::fault::{Problem, printable};
use super::formats::{self, Contents, DETECT_BYTES, FileKind};
use super::input::Input;
use super::{MeshFile, ReadOptions, SceneError, SceneInfo, generate, ply};
use crate::bounded;
use crate::graph::{Progress, Voxel};

#[derive(Debug)]
pub enum Source {
    Generated(String),
    File(SceneFile),
}

impl Source {
    pub fn is_generated(name: &str) -> bool {
        name.starts_with(generate::PREFIX)
    }

    /// Opens the file, unless the name is a generator's specification.
    pub fn find(name: impl AsRef<Path>) -> Result<Self, SceneError> {
        let name = name.as_ref();
        match name.to_str() {
            Some(text) if Self::is_generated(text) => Ok(Self::Generated(text.to_owned())),
            _ => SceneFile::open(name).map(Self::File),
        }
    }

    pub(super) fn name(&self) -> String {
        match self {
            Self::Generated(spec) => spec.clone(),
            Self::File(file) => file.name(),
        }
    }

    pub fn kind(&self) -> Option<FileKind> {
        match self {
            Self::Generated(_) => None,
            Self::File(file) => file.kind(),
        }
    }
}

#[derive(Debug)]
pub struct SceneFile<R = File> {
    path: PathBuf,
    stream: R,
    length: u64,
    kind: Option<FileKind>,
    beginning: Vec<u8>,
}

impl SceneFile<File> {
    /// Finds the format, too. A file of an unknown format can be opened, but not read.
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
    /// A file that is held in memory; errors call it `name`.
    pub fn in_memory(bytes: &'b [u8], name: &str) -> Result<Self, SceneError> {
        Self::begin(Cursor::new(bytes), bytes.len() as u64, Path::new(name))
    }
}

impl<R: Read + Seek> SceneFile<R> {
    fn begin(stream: R, length: u64, path: &Path) -> Result<Self, SceneError> {
        let mut file = Self {
            path: path.to_owned(),
            stream,
            length,
            kind: None,
            beginning: Vec::new(),
        };
        file.find_kind()
            .map_err(|source| Problem::Read(source).in_file(&file.name()))?;
        Ok(file)
    }

    fn find_kind(&mut self) -> std::io::Result<()> {
        let beginning = (&mut self.stream).take(DETECT_BYTES as u64);
        { beginning }.read_to_end(&mut self.beginning)?;
        self.stream.seek(SeekFrom::Start(0))?;
        self.kind = formats::detect(&self.beginning, self.length);
        let extension = self.path.extension();
        let ends = |ending: &str| extension.is_some_and(|e| e.eq_ignore_ascii_case(ending));
        match self.kind {
            Some(FileKind::Ply) => {
                if ply::has_faces(&mut BufReader::new(&mut self.stream)) {
                    self.kind = Some(FileKind::PlyMesh);
                }
                self.stream.seek(SeekFrom::Start(0))?;
            }
            Some(FileKind::Schem) if ends("litematic") => self.kind = Some(FileKind::Litematic),
            // A truncated binary STL is known by its name only.
            None if ends("stl") => self.kind = Some(FileKind::Stl),
            _ => {}
        }
        Ok(())
    }

    pub fn kind(&self) -> Option<FileKind> {
        self.kind
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn name(&self) -> String {
        self.path.display().to_string()
    }

    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// The stream of a mesh file, at its beginning.
    pub fn mesh_stream(self) -> Result<(R, FileKind), SceneError> {
        match self.kind {
            // The mesh reader reports that a cloud has no faces, or a fault of its header.
            Some(kind) if kind.is_mesh() || kind == FileKind::Ply => Ok((self.stream, kind)),
            _ => Err(self.refused(|file, kind| SceneError::NotMesh { file, kind })),
        }
    }

    /// All of a mesh file; `folder` is where it finds other files.
    pub fn mesh_file(self, folder: Option<PathBuf>) -> Result<MeshFile, SceneError> {
        let (name, length) = (self.name(), self.length);
        let (mut stream, kind) = self.mesh_stream()?;
        let bytes = Input::new(&mut stream, length).bytes();
        Ok(MeshFile {
            bytes: bytes.map_err(|source| Problem::Read(source).in_file(&name))?,
            name,
            kind,
            folder,
        })
    }

    fn refused(&self, otherwise: impl FnOnce(String, FileKind) -> SceneError) -> SceneError {
        let file = self.name();
        let Some(kind) = self.kind else {
            let begins = printable(&self.beginning);
            return SceneError::Unknown { file, begins };
        };
        match kind.contents() {
            Contents::BuiltOfMesh => SceneError::BuiltOfMesh { file, kind },
            _ => otherwise(file, kind),
        }
    }

    /// Passes each voxel to `sink`. After an error the caller must discard what it received.
    pub fn read_voxels(
        mut self,
        options: &ReadOptions,
        sink: &mut dyn FnMut(Voxel),
        progress: &dyn Progress,
    ) -> Result<SceneInfo, SceneError> {
        let Some(Contents::Voxels(read)) = self.kind.map(FileKind::contents) else {
            return Err(self.refused(|file, kind| match kind {
                FileKind::Vxg => SceneError::IsGraph { file },
                kind => SceneError::Mesh { file, kind },
            }));
        };
        let name = self.name();
        progress.begin(&format!("reading {name}"), 0);
        let mut emitter = Emitter::new(sink, options, progress);
        let mut input = Input::new(&mut self.stream, self.length);
        let result = read(&mut input, &mut emitter).map(|()| emitter.finish());
        progress.end();
        result.map_err(|problem| problem.in_file(&name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_and_names_tell_what_the_first_bytes_do_not() {
        let kind = |bytes: &[u8], name| SceneFile::in_memory(bytes, name).unwrap().kind();
        // Headers of more than `DETECT_BYTES`.
        let head = "ply\nformat ascii 1.0\n".to_owned() + &"comment nothing\n".repeat(1000);
        let with = |faces: &str| kind(format!("{head}{faces}end_header\n").as_bytes(), "a");
        assert_eq!(with("element face 1\n"), Some(FileKind::PlyMesh));
        assert_eq!(with("element face 0\n"), Some(FileKind::Ply));
        assert_eq!(kind(b"ply\nelement face 1\n", "a"), Some(FileKind::Ply));
        // A binary STL that was cut short.
        assert_eq!(kind(&[0; 90], "a.stl"), Some(FileKind::Stl));
        assert_eq!(kind(&[0; 90], "a"), None);
        assert_eq!(kind(b"VOX ", "a.stl"), Some(FileKind::Vox));
        // Two formats of gzip.
        assert_eq!(kind(b"\x1f\x8b", "a.Litematic"), Some(FileKind::Litematic));
        assert_eq!(kind(b"\x1f\x8b", "a"), Some(FileKind::Schem));
        let far = SceneFile::in_memory(b"\x89FAR\r\n\x1a\n", "a.far").unwrap();
        let refused = far.read_voxels(&ReadOptions::default(), &mut |_| (), &crate::graph::Silent);
        assert!(matches!(refused, Err(SceneError::BuiltOfMesh { .. })));
    }
}
