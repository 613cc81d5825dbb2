//! Which format a file has, found from its content: the only detector of the program.
//!
//! A file's name counts in one case alone, a binary STL that was cut short ([`detect_named`]).

use std::fmt;
use std::path::Path;

use crate::graph::vxg;

/// How many bytes of a file [`detect`] should be given, where there are so many.
pub(super) const DETECT_BYTES: usize = 4096;

/// The formats that are recognised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FileKind {
    /// MagicaVoxel or VoxelShop model.
    Vox,
    /// PLY: a cloud of voxel indices. [`detect`] does not see the faces of a mesh and returns this for both;
    /// [`SceneFile`](super::SceneFile) reads the header and distinguishes them.
    Ply,
    /// PLY with faces: a mesh.
    PlyMesh,
    /// A numpy array of voxel indices.
    Npy,
    /// A voxel graph of this program.
    Vxg,
    /// Wavefront mesh (text).
    Obj,
    /// glTF mesh (JSON).
    Gltf,
    /// glTF mesh (binary).
    Glb,
    /// Stereolithography mesh (the binary form is known by its length).
    Stl,
    /// Far voxels, built of a mesh.
    Far,
    /// Textured voxels, built of a mesh.
    Tvx,
}

impl FileKind {
    /// Whether files of this kind hold triangles.
    #[must_use]
    pub fn is_mesh(self) -> bool {
        matches!(
            self,
            Self::PlyMesh | Self::Obj | Self::Gltf | Self::Glb | Self::Stl
        )
    }

    /// Whether files of this kind were built of a mesh for one method, which alone draws them.
    #[must_use]
    pub fn is_built_of_mesh(self) -> bool {
        matches!(self, Self::Far | Self::Tvx)
    }
}

impl fmt::Display for FileKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Vox => ".vox",
            Self::Ply | Self::PlyMesh => ".ply",
            Self::Npy => ".npy",
            Self::Vxg => ".vxg",
            Self::Obj => ".obj",
            Self::Gltf => ".gltf",
            Self::Glb => ".glb",
            Self::Stl => ".stl",
            Self::Far => ".far",
            Self::Tvx => ".tvx",
        })
    }
}

/// Tells a file's format from its first bytes (`DETECT_BYTES` of them, or the whole of a shorter file).
///
/// `None` where they begin like no format that is known here. A binary STL is
/// not recognised, since its first 80 bytes are free: see `detect_with_length`.
#[must_use]
pub fn detect(prefix: &[u8]) -> Option<FileKind> {
    let marks: [(&[u8], FileKind); 8] = [
        (b"VOX ", FileKind::Vox),
        (b"\x93NUMPY", FileKind::Npy),
        (b"glTF", FileKind::Glb),
        (b"ply\n", FileKind::Ply),
        (b"ply\r", FileKind::Ply),
        (b"solid", FileKind::Stl),
        // Written by floors above this one, whose tests compare them.
        (b"\x89FAR\r\n\x1a\n", FileKind::Far),
        (b"\x89TVX\r\n\x1a\n", FileKind::Tvx),
    ];
    if let Some((_, kind)) = marks.iter().find(|(mark, _)| prefix.starts_with(mark)) {
        return Some(*kind);
    }
    if vxg::is_vxg(prefix) {
        return Some(FileKind::Vxg);
    }
    let text = prefix.strip_prefix(b"\xef\xbb\xbf").unwrap_or(prefix);
    // Some exporters begin with one of the longer lists.
    let is_gltf = [&b"\"asset\""[..], b"\"accessors\"", b"\"bufferViews\""];
    if text.trim_ascii_start().starts_with(b"{") && is_gltf.iter().any(|key| contains(text, key)) {
        return Some(FileKind::Gltf);
    }
    looks_like_obj(text).then_some(FileKind::Obj)
}

/// Whether a file with this beginning and length, bytes, is a binary STL mesh: 84 bytes of header, of which the last
/// four count the triangles, and 50 bytes per triangle.
#[must_use]
pub fn is_binary_stl(beginning: &[u8], length: u64) -> bool {
    let count = beginning
        .get(80..84)
        .and_then(|count| count.try_into().ok());
    count.is_some_and(|count| length == 84 + 50 * u64::from(u32::from_le_bytes(count)))
}

/// As [`detect`], with the length of the file: that is how a binary STL is known.
#[must_use]
pub(super) fn detect_with_length(prefix: &[u8], length: u64) -> Option<FileKind> {
    match detect(prefix) {
        // A binary one may begin with the word of a text.
        None | Some(FileKind::Stl) if is_binary_stl(prefix, length) => Some(FileKind::Stl),
        kind => kind,
    }
}

/// As [`detect_with_length`]; of what begins like no known format a name that ends in `.stl` is
/// believed: nothing else identifies a binary STL that was cut short, and its reader reports what is missing.
#[must_use]
pub(super) fn detect_named(prefix: &[u8], length: u64, name: &Path) -> Option<FileKind> {
    let is_stl = name
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("stl"));
    detect_with_length(prefix, length).or_else(|| is_stl.then_some(FileKind::Stl))
}

/// Whether the first line that is neither blank nor a comment begins with a Wavefront keyword.
fn looks_like_obj(text: &[u8]) -> bool {
    const KEYWORDS: [&[u8]; 11] = [
        b"v", b"vn", b"vt", b"vp", b"f", b"l", b"o", b"g", b"s", b"mtllib", b"usemtl",
    ];
    text.split(|b| *b == b'\n' || *b == b'\r')
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty() && line[0] != b'#')
        .and_then(|line| {
            let end = line.iter().position(u8::is_ascii_whitespace)?;
            Some(KEYWORDS.contains(&&line[..end]))
        })
        .unwrap_or(false)
}

fn contains(text: &[u8], what: &[u8]) -> bool {
    text.windows(what.len()).any(|window| window == what)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_recognised_by_content() {
        for (begins, kind) in [
            (&b"VOX \x96\0\0\0MAIN"[..], Some(FileKind::Vox)),
            (b"ply\nformat ascii 1.0\n", Some(FileKind::Ply)),
            (b"ply\r\nformat ascii 1.0\r\n", Some(FileKind::Ply)),
            (b"\x93NUMPY\x01\0", Some(FileKind::Npy)),
            (b"\x89VXG\r\n\x1a\n\x01", Some(FileKind::Vxg)),
            (b"glTF\x02\0\0\0", Some(FileKind::Glb)),
            (
                b"  {\n \"asset\": {\"version\": \"2.0\"}}",
                Some(FileKind::Gltf),
            ),
            (b"{\"accessors\": [", Some(FileKind::Gltf)),
            (
                b"# made by hand\n\nmtllib a.mtl\nv 0 0 0\n",
                Some(FileKind::Obj),
            ),
            (b"v 0 0 0\n", Some(FileKind::Obj)),
            (b"solid cube\n facet normal", Some(FileKind::Stl)),
            (b"{\"no\": 1}", None),
            (b"velvet 1 2 3\n", None),
            (b"DOOD\xef\xbf\xbd", None),
            (b"plyform", None),
            (b"", None),
        ] {
            assert_eq!(detect(begins), kind, "{}", begins.escape_ascii());
        }
    }

    #[test]
    fn binary_stl_is_recognised_by_its_length() {
        let mut bytes = vec![b' '; 84 + 50];
        bytes[80..84].copy_from_slice(&1u32.to_le_bytes());
        assert_eq!(detect(&bytes), None);
        assert_eq!(detect_with_length(&bytes, 134), Some(FileKind::Stl));
        assert_eq!(detect_with_length(&bytes, 135), None);
    }
}
