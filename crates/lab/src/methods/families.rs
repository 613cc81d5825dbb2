//! The methods of meshes: triangles, which the others have to beat, and decimated; far voxels,
//! textured voxels, the hybrid.

use crate::error::{Examined, Method, PixelStyle, Refused, Sum, drawn, sums};
use shiftvox::drawing::Shown;
use shiftvox::graph::Silent;
use shiftvox::picture::Background;
use shiftvox::project::{Camera, Up};
use shiftvox_mesh::Mesh;
use shiftvox_mesh::drawing::mesh_view::view_of;
use shiftvox_mesh::drawing::{
    Erosion, FarDrawing, FarStyle, TexturedDrawing, TexturedStyle, TrianglesDrawing, TrianglesStyle,
};
use shiftvox_mesh::far::FarFile;
use shiftvox_mesh::far::view::{FarViewer, Opacity};
use shiftvox_mesh::raster::{Pattern, Samples};
use shiftvox_mesh::textured::TexturedFile;
use shiftvox_mesh::textured::view::choose;

/// What was counted. `solid`: parts in whose place there are triangles where there is none of them.
fn examined(shown: &Shown<'_>, counters: &[Sum], solid: &'static [&'static str]) -> Examined {
    let of_solids = sums(&shown.counters, &[("", solid)])[0].1;
    Examined {
        shares: shown.coverage.to_vec(),
        counters: sums(&shown.counters, counters),
        remark: (!solid.is_empty() && of_solids == 0).then(|| "triangles alone".to_owned()),
        ..Examined::default()
    }
}

/// Triangles at 1, 4, 16 or 256 samples a pixel, in the middles of equal squares.
///
/// # Errors
/// With another number.
pub fn triangles(mesh: &Mesh, per_pixel: u32, style: PixelStyle) -> Result<Method<'_>, Refused> {
    of_triangles(
        ("triangles", "triangles".to_owned()),
        mesh,
        per_pixel,
        style,
    )
}

/// Triangles of a decimated mesh, of which one was left of so many.
///
/// # Errors
/// As [`triangles`].
pub fn decimated(
    mesh: &Mesh,
    one_of: u32,
    per_pixel: u32,
    style: PixelStyle,
) -> Result<Method<'_>, Refused> {
    of_triangles(
        ("decimated", format!("decimated 1/{one_of},")),
        mesh,
        per_pixel,
        style,
    )
}

fn of_triangles<'m>(
    (family, name): (&'static str, String),
    mesh: &'m Mesh,
    per_pixel: u32,
    style: PixelStyle,
) -> Result<Method<'m>, Refused> {
    let style = TrianglesStyle {
        samples: Samples::new(per_pixel, Pattern::Regular).map_err(Refused::because)?,
        shading: style.shading,
        background: Background::Color(style.background),
    };
    let counters: &[Sum] = &[("triangles", &["triangles"]), ("samples", &["samples"])];
    Ok(Method {
        family,
        name: format!("{name} {per_pixel}"),
        settings: vec![("samples", per_pixel.to_string())],
        kind: family.to_owned(),
        // Which axis is up matters to fitted cameras alone.
        drawing: Box::new(move || Box::new(TrianglesDrawing::new(mesh, Up::Z, style, &Silent))),
        examine: Box::new(|shown, _| Ok(examined(shown, counters, &[]))),
        with_cut_of: None,
    })
}

/// The name of an opacity, as the command line has it.
#[must_use]
pub fn opacity_in_words(opacity: Opacity) -> &'static str {
    match opacity {
        Opacity::None => "none",
        Opacity::Scalar => "scalar",
        Opacity::Six => "six",
    }
}

/// A hybrid of voxels of at most so many pixels, with `4^aa_log2` samples a pixel.
#[must_use]
pub fn hybrid(file: &FarFile, voxel_px: f64, aa_log2: u32, style: PixelStyle) -> Method<'_> {
    let samples = 1 << (2 * aa_log2);
    let mut name = format!("hybrid {samples}");
    if voxel_px != 1.0 {
        name += &format!(" lod {voxel_px}");
    }
    Method {
        family: "hybrid",
        name,
        kind: "hybrid".to_owned(),
        ..far(file, Opacity::Six, voxel_px, aa_log2, style)
    }
}

/// Far voxels of at most so many pixels, with `4^aa_log2` samples a pixel.
#[must_use]
pub fn far(
    file: &FarFile,
    opacity: Opacity,
    voxel_px: f64,
    aa_log2: u32,
    style: PixelStyle,
) -> Method<'_> {
    let words = opacity_in_words(opacity);
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
        shading: style.shading,
        background: Background::Color(style.background),
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
        ("nodes_hidden", &["nodes_hidden"]),
        ("bytes", &["bytes"]),
    ];
    let solid = &["opaque_voxels", "transparent_voxels"];
    Method {
        family: "far voxels",
        name,
        settings: vec![
            ("opacity", words.to_owned()),
            ("lod", voxel_px.to_string()),
            ("aa", (1 << aa_log2).to_string()),
        ],
        kind,
        drawing: Box::new(move || Box::new(FarDrawing::new(file, style))),
        examine: Box::new(move |shown, _| Ok(examined(shown, counters, solid))),
        with_cut_of: Some(Box::new(move |camera, other| {
            let view = |camera: &Camera| view_of(camera, file.bounds()).map_err(Refused::because);
            let (view, other) = (view(camera)?, view(other)?);
            let drawn = FarViewer::new(file).draw_with_cut_of(&view, &other, &style.options(&view));
            Ok(drawn.map_err(Refused::because)?.0.rgba)
        })),
    }
}

/// Textured voxels at a level of detail, with `4^aa_log2` samples a pixel.
#[must_use]
pub fn textured(
    file: &TexturedFile,
    erosion: Erosion,
    aa_log2: u32,
    style: PixelStyle,
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
        shading: style.shading,
        background: Background::Color(style.background),
    };
    let counters: &[Sum] = &[
        ("triangles", &["primitives", "surfels", "surfels"]),
        ("primitives", &["primitives"]),
        ("surfels", &["surfels"]),
        ("voxels", &["voxels"]),
        ("grid", &["grid"]),
        ("erosion", &["erosion"]),
    ];
    let with_cut_of = move |texel_px: f64, camera: &Camera, other: &Camera| {
        let view = view_of(other, file.bounds()).map_err(Refused::because)?;
        let choice = choose(file, &view, texel_px);
        let style = TexturedStyle {
            erosion: Erosion::Level {
                level: choice.level,
                cells: Some(file.grid(choice.grid).cell_grid().cells()),
            },
            ..style
        };
        let mut drawing = TexturedDrawing::new(file, style);
        Ok(drawn(&mut drawing, camera)?.pixels.rgba())
    };
    Method {
        family: "textured voxels",
        name,
        settings: vec![("detail", detail), ("samples", samples.to_string())],
        kind: "textured voxels".to_owned(),
        drawing: Box::new(move || Box::new(TexturedDrawing::new(file, style))),
        examine: Box::new(move |shown, _| Ok(examined(shown, counters, &["surfels"]))),
        with_cut_of: match erosion {
            Erosion::Auto { texel_px } => Some(Box::new(move |camera: &Camera, other: &Camera| {
                with_cut_of(texel_px, camera, other)
            })),
            Erosion::Level { .. } => None,
        },
    }
}
