//! The methods of meshes: triangles, decimated or not, far voxels, textured voxels, and hybrids.

use super::method::{Examined, Method, Sum, sums};
use crate::report::Cell;
use shiftvox::drawing::Shown;
use shiftvox::graph::Silent;
use shiftvox::picture::{Background, Shading};
use shiftvox::project::Up;
use shiftvox_mesh::Mesh;
use shiftvox_mesh::drawing::{
    FarStyle, TexturedStyle, TrianglesStyle, of_far, of_textured, of_triangles,
};
use shiftvox_mesh::far::FarFile;
use shiftvox_mesh::far::view::Opacity;
use shiftvox_mesh::raster::{Pattern, Samples};
use shiftvox_mesh::textured::TexturedFile;
use shiftvox_mesh::textured::view::Erosion;

/// Share and counters of a frame. `solid`: parts without which triangles are drawn alone.
fn examined(shown: &Shown<'_>, counters: &[Sum], solid: &'static [&'static str]) -> Examined {
    let of_solids = sums(&shown.counters, &[("", solid)])[0].1;
    Examined {
        shares: shown.coverage.to_vec(),
        counters: sums(&shown.counters, counters),
        remark: (!solid.is_empty() && of_solids == 0).then(|| "triangles alone".to_owned()),
        ..Examined::default()
    }
}

/// A mesh, whole or decimated, as a method draws it.
#[derive(Debug, Clone, Copy)]
pub struct Triangles<'m> {
    pub mesh: &'m Mesh,
    /// Original triangles per triangle: 1 if the mesh is whole.
    pub one_of: u32,
    /// Bytes of the mesh in compact form.
    pub bytes: u64,
    /// Time to decimate it, milliseconds.
    pub build_ms: f64,
}

/// Triangles with `4^aa_log2` samples per pixel, in the middles of equal squares.
pub fn triangles(of: Triangles<'_>, aa_log2: u32) -> Method<'_> {
    let per_pixel = 1u32 << (2 * aa_log2);
    let style = TrianglesStyle {
        samples: Samples::new(aa_log2, Pattern::Regular),
        shading: Shading::default(),
        background: Background::default(),
    };
    let (family, name) = match of.one_of {
        1 => ("triangles", "triangles".to_owned()),
        one_of => ("decimated", format!("decimated 1/{one_of},")),
    };
    let counters: &[Sum] = &[("triangles", &["triangles"]), ("samples", &["samples"])];
    Method {
        family,
        name: format!("{name} {per_pixel}"),
        settings: vec![("aa", Cell::Count(1 << aa_log2))],
        kind: family.to_owned(),
        graph: None,
        bytes: of.bytes,
        build_ms: Some(of.build_ms),
        // Only fitted cameras use the up axis.
        drawing: Box::new(move || Box::new(of_triangles(of.mesh, Up::Z, style, &Silent))),
        examine: Box::new(|shown, _| Ok(examined(shown, counters, &[]))),
    }
}

/// A hybrid with voxels of at most so many pixels and `4^aa_log2` samples per pixel, made in so many
/// milliseconds.
pub fn hybrid((file, build_ms): (&FarFile, f64), voxel_px: f64, aa_log2: u32) -> Method<'_> {
    let mut name = format!("hybrid {}", 1 << (2 * aa_log2));
    if voxel_px != 1.0 {
        name += &format!(" lod {voxel_px}");
    }
    Method {
        family: "hybrid",
        name,
        kind: "hybrid".to_owned(),
        ..far((file, build_ms), Opacity::Six, voxel_px, aa_log2)
    }
}

/// Far voxels of at most so many pixels with `4^aa_log2` samples per pixel, made in so many
/// milliseconds.
pub fn far(
    (file, build_ms): (&FarFile, f64),
    opacity: Opacity,
    voxel_px: f64,
    aa_log2: u32,
) -> Method<'_> {
    let words = match opacity {
        Opacity::None => "none",
        Opacity::Scalar => "scalar",
        Opacity::Six => "six",
    };
    let kind = format!("far {words}");
    let mut name = kind.clone();
    if voxel_px != 1.0 {
        name += &format!(" lod {voxel_px}");
    }
    if aa_log2 > 0 {
        name += &format!(" aa {}", 1 << aa_log2);
    }
    let style = FarStyle {
        voxel_px,
        aa_log2,
        opacity,
        shading: Shading::default(),
        background: Background::default(),
    };
    let counters: &[Sum] = &[
        (
            "voxels_and_triangles",
            &["opaque_voxels", "transparent_voxels", "triangles"],
        ),
        ("opaque_voxels", &["opaque_voxels"]),
        ("transparent_voxels", &["transparent_voxels"]),
        ("triangles", &["triangles"]),
        ("nodes_visited", &["nodes_visited"]),
        ("bytes", &["bytes"]),
    ];
    let solid = &["opaque_voxels", "transparent_voxels"];
    Method {
        family: "far voxels",
        name,
        settings: vec![
            ("opacity", words.into()),
            ("lod", voxel_px.to_string().into()),
            ("aa", Cell::Count(1 << aa_log2)),
        ],
        kind,
        graph: None,
        bytes: file.file_bytes(),
        build_ms: Some(build_ms),
        drawing: Box::new(move || Box::new(of_far(file, style))),
        examine: Box::new(move |shown, _| Ok(examined(shown, counters, solid))),
    }
}

/// Textured voxels at a level of detail with `4^aa_log2` samples per pixel, made in so many
/// milliseconds.
pub fn textured(
    (file, build_ms): (&TexturedFile, f64),
    erosion: Erosion,
    aa_log2: u32,
) -> Method<'_> {
    let detail = match erosion {
        Erosion::Auto { .. } => "auto".to_owned(),
        Erosion::Level { level, cells: None } => format!("eroded {level}"),
        Erosion::Level {
            level,
            cells: Some(cells),
        } => format!("{cells} eroded {level}"),
    };
    let samples = 1 << (2 * aa_log2);
    let mut name = format!("textured {detail}");
    if samples > 1 {
        name += &format!(", {samples} samples");
    }
    let style = TexturedStyle {
        erosion,
        aa_log2,
        shading: Shading::default(),
        background: Background::default(),
    };
    let counters: &[Sum] = &[
        ("triangles", &["primitives", "surfels", "surfels"]),
        ("primitives", &["primitives"]),
        ("surfels", &["surfels"]),
        ("voxels", &["voxels"]),
        ("grid", &["grid"]),
        ("erosion", &["erosion"]),
    ];
    Method {
        family: "textured voxels",
        name,
        settings: vec![("detail", detail.into()), ("aa", Cell::Count(1 << aa_log2))],
        kind: "textured voxels".to_owned(),
        graph: None,
        bytes: file.file_bytes(),
        build_ms: Some(build_ms),
        drawing: Box::new(move || Box::new(of_textured(file, style))),
        examine: Box::new(move |shown, _| Ok(examined(shown, counters, &["surfels"]))),
    }
}
