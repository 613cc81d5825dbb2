//! The table of file formats: recognition, names and contents. Every list of formats comes from it.
//!
//! To add a voxel format, write its reader beside this file, add a [`FileKind`] and a row of [`FORMATS`], and describe
//! the format in `spec/input.md`.

mod binvox;
mod cloud;
mod minecraft;
mod npy;
mod pcd;
mod ply;
mod ply_write;
mod qb;
mod vox;
mod xyz;

use std::fmt;

use super::emit::Emitter;
use super::fault::Problem;
use super::input::Input;
use crate::graph::vxg;

pub use ply_write::write_ply;
pub use vox::{VoxWriter, VoxWritten};
use xyz::is_xyz;

pub(super) const DETECT_BYTES: usize = 4096;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FileKind {
    Vox,
    /// A cloud. [`detect`] returns this for a mesh, too.
    /// [`SceneFile`](super::SceneFile) reads the header and distinguishes the two.
    Ply,
    Npy,
    Binvox,
    Vxg,
    Obj,
    PlyMesh,
    Gltf,
    Glb,
    Stl,
    Far,
    Tvx,
    Xyz,
    Pcd,
    Qb,
    Schem,
    /// Recognised as [`Schem`](Self::Schem), which has the same beginning, and by the ending of its name.
    Litematic,
}

pub(super) type Reader = fn(&mut Input<'_>, &mut Emitter<'_>) -> Result<(), Problem>;

#[derive(Debug, Clone, Copy)]
pub(super) enum Contents {
    Voxels(Reader),
    Graph,
    Mesh,
    /// Data built of a mesh for one method, which alone draws it.
    BuiltOfMesh,
}

#[derive(Debug)]
pub struct Format {
    kind: FileKind,
    pub ending: &'static str,
    pub name: &'static str,
    marks: &'static [&'static [u8]],
    /// Tells files without a mark by their first bytes and length.
    accepts: fn(&[u8], u64) -> bool,
    contents: Contents,
}

/// All formats, in the order of [`FileKind`].
#[rustfmt::skip]
pub static FORMATS: [Format; 17] = {
    use Contents::{BuiltOfMesh, Graph, Mesh, Voxels};
    use FileKind::*;
    type Marks = &'static [&'static [u8]];
    type Accepts = fn(&[u8], u64) -> bool;
    const fn row(
        kind: FileKind, ending: &'static str, name: &'static str, marks: Marks, accepts: Accepts, contents: Contents,
    ) -> Format {
        Format { kind, ending, name, marks, accepts, contents }
    }
    [
        row(Vox,     ".vox",    "MagicaVoxel or VoxelShop scene",   &[b"VOX "],              no,      Voxels(vox::read)),
        row(Ply,     ".ply",    "cloud of points",                  &[b"ply\n", b"ply\r"],   no,      Voxels(ply::read)),
        row(Npy,     ".npy",    "NumPy array of points",            &[b"\x93NUMPY"],         no,      Voxels(npy::read)),
        row(Binvox,  ".binvox", "grid of the program binvox",       &[b"#binvox "],          no,      Voxels(binvox::read)),
        row(Vxg,     ".vxg",    "voxel graph of this program",      &[&vxg::MAGIC],          no,      Graph),
        row(Obj,     ".obj",    "Wavefront mesh",                   &[],                     is_obj,  Mesh),
        row(PlyMesh, ".ply",    "mesh (PLY with faces)",            &[],                     no,      Mesh),
        row(Gltf,    ".gltf",   "glTF mesh",                        &[],                     is_gltf, Mesh),
        row(Glb,     ".glb",    "binary glTF mesh",                 &[b"glTF"],              no,      Mesh),
        row(Stl,     ".stl",    "stereolithography mesh",           &[],                     is_stl,  Mesh),
        // The crate of meshes writes these two, and its tests compare their marks.
        row(Far,     ".far",    "far voxels, built of a mesh",      &[b"\x89FAR\r\n\x1a\n"], no,      BuiltOfMesh),
        row(Tvx,     ".tvx",    "textured voxels, built of a mesh", &[b"\x89TVX\r\n\x1a\n"], no,      BuiltOfMesh),
        row(Xyz,     ".xyz",    "text with a point per line",       &[],                     is_xyz,  Voxels(xyz::read)),
        row(Pcd,     ".pcd",    "cloud of the Point Cloud Library", &[b"# .PCD", b"VERSION "], no,      Voxels(pcd::read)),
        row(Qb,      ".qb",     "Qubicle Binary scene",             &[b"\x01\x01\0\0"],     no,      Voxels(qb::read)),
        row(Schem,   ".schem",  "Minecraft schematic of Sponge",    &[b"\x1f\x8b", b"\x0a\0"], no,   Voxels(minecraft::read)),
        row(Litematic, ".litematic", "Minecraft schematic of Litematica", &[],                 no,      Voxels(minecraft::read)),
    ]
};

impl Format {
    pub fn voxel_marks(&self) -> &'static [&'static [u8]] {
        match self.contents {
            Contents::Voxels(_) => self.marks,
            _ => &[],
        }
    }
}

const _: () = {
    let mut row = 0;
    while row < FORMATS.len() {
        assert!(
            FORMATS[row].kind as usize == row,
            "the table is in the order of FileKind"
        );
        row += 1;
    }
};

impl FileKind {
    fn format(self) -> &'static Format {
        &FORMATS[self as usize]
    }

    pub(super) fn contents(self) -> Contents {
        self.format().contents
    }

    pub fn is_mesh(self) -> bool {
        matches!(self.contents(), Contents::Mesh)
    }
}

impl fmt::Display for FileKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.format().ending)
    }
}

fn endings(are_meant: fn(&Contents) -> bool) -> String {
    let meant = FORMATS.iter().filter(|format| are_meant(&format.contents));
    let endings: Vec<_> = meant.map(|format| format.ending).collect();
    endings.join(", ")
}

pub(super) fn mesh_endings() -> String {
    endings(|contents| matches!(contents, Contents::Mesh))
}

pub(super) fn all_endings() -> String {
    format!(
        "voxels ({}), a voxel graph ({}), a mesh ({}) or a file built of a mesh ({})",
        endings(|contents| matches!(contents, Contents::Voxels(_))),
        endings(|contents| matches!(contents, Contents::Graph)),
        mesh_endings(),
        endings(|contents| matches!(contents, Contents::BuiltOfMesh)),
    )
}

/// The end of a message about a mesh in another format, by its ending.
pub(super) fn advice(file: &str) -> &'static str {
    const OTHERS: [&str; 8] = ["fbx", "dae", "usd", "usdz", "off", "3ds", "blend", "3mf"];
    let ending = file.rsplit('.').next().unwrap_or_default();
    let ending = ending.to_ascii_lowercase();
    match &ending[..] {
        "step" | "stp" => "; FreeCAD exports it as glTF",
        "las" | "laz" | "e57" => "; convert these points: pdal translate IN OUT.ply",
        other if OTHERS.contains(&other) => {
            "; convert this one to glTF: Blender exports it, or assimp export IN OUT.glb"
        }
        _ => "",
    }
}

/// Recognises a format by the first 4096 bytes of a file (all of a shorter one) and its length in bytes.
pub fn detect(beginning: &[u8], length: u64) -> Option<FileKind> {
    let begins = |mark: &&[u8]| beginning.starts_with(mark);
    let marked = FORMATS.iter().find(|f| f.marks.iter().any(begins));
    let found = marked.or_else(|| FORMATS.iter().find(|f| (f.accepts)(beginning, length)));
    found.map(|format| format.kind)
}

fn no(_: &[u8], _: u64) -> bool {
    false
}

fn is_stl(beginning: &[u8], length: u64) -> bool {
    is_text_stl(beginning) || is_binary_stl(beginning, length)
}

/// Begins with `solid` in letters of any case, behind blanks or not.
pub fn is_text_stl(beginning: &[u8]) -> bool {
    let word = text(beginning).trim_ascii_start().get(..5);
    word.is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

/// 84 bytes of header, of which the last four count the triangles, and 50 bytes per triangle.
pub fn is_binary_stl(beginning: &[u8], length: u64) -> bool {
    let count = beginning
        .get(80..84)
        .and_then(|count| count.try_into().ok());
    count.is_some_and(|count| length == 84 + 50 * u64::from(u32::from_le_bytes(count)))
}

fn text(beginning: &[u8]) -> &[u8] {
    beginning.strip_prefix(b"\xef\xbb\xbf").unwrap_or(beginning)
}

/// JSON with a key of glTF. Some exporters write the longer lists before `asset`.
fn is_gltf(beginning: &[u8], _: u64) -> bool {
    let text = text(beginning);
    let has = |key: &&[u8]| text.windows(key.len()).any(|window| window == *key);
    let keys = [&b"\"asset\""[..], b"\"accessors\"", b"\"bufferViews\""];
    text.trim_ascii_start().starts_with(b"{") && keys.iter().any(has)
}

/// The first line that is neither blank nor a comment begins with a Wavefront keyword.
fn is_obj(beginning: &[u8], _: u64) -> bool {
    const KEYWORDS: [&[u8]; 11] = [
        b"v", b"vn", b"vt", b"vp", b"f", b"l", b"o", b"g", b"s", b"mtllib", b"usemtl",
    ];
    text(beginning)
        .split(|b| *b == b'\n' || *b == b'\r')
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty() && line[0] != b'#')
        .and_then(|line| {
            let end = line.iter().position(u8::is_ascii_whitespace)?;
            Some(KEYWORDS.contains(&&line[..end]))
        })
        .unwrap_or(false)
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
            (b"plyform", None),
            (b"\x93NUMPY\x01\0", Some(FileKind::Npy)),
            (b"\x89VXG\r\n\x1a\n\x01", Some(FileKind::Vxg)),
            (b"#binvox 1\n", Some(FileKind::Binvox)),
            (b"#binvoxel\n", None),
            (b"glTF\x02\0\0\0", Some(FileKind::Glb)),
            (b"  {\n \"asset\": {}}", Some(FileKind::Gltf)),
            (b"{\"accessors\": [", Some(FileKind::Gltf)),
            (b"{\"no\": 1}", None),
            (b"# a\n\nmtllib a.mtl\nv 0 0 0\n", Some(FileKind::Obj)),
            (b"v 0 0 0\n", Some(FileKind::Obj)),
            (b"velvet 1 2 3\n", None),
            (b"solid cube\n facet normal", Some(FileKind::Stl)),
            (b"\xef\xbb\xbf\n SOLID cube\n", Some(FileKind::Stl)),
            (b"", None),
        ] {
            assert_eq!(detect(begins, 0), kind, "{}", begins.escape_ascii());
        }
        let mut stl = [b' '; 84 + 50];
        stl[80..84].copy_from_slice(&1u32.to_le_bytes());
        let by_length = [0, 134, 135].map(|length| detect(&stl, length));
        assert_eq!(by_length, [None, Some(FileKind::Stl), None]);
    }
}
