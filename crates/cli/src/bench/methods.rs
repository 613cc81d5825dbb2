//! `bench methods`: all ways to draw a mesh, side by side.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use serde_json::json;

use super::error::{MOST_SIDE, reference_size};
use super::meshes::{BUDGETS, Decimated, TRIANGLE_SAMPLES, decimated_of, far_of};
use super::picture_export as pictures;
use crate::args::{CameraArgs, SceneArgs, Size};
use crate::console::Console;
use crate::error::{CliError, Kind};
use crate::experiment::context::Context;
use crate::experiment::export::ExportArgs;
use crate::experiment::export::{self, Results};
use crate::{engines, report, scenes};
use shiftvox::drawing::milliseconds_since;
use shiftvox::graph::Graph;
use shiftvox::project::{Bounds, Coverage, SetupOptions, Up};
use shiftvox::whole;
use shiftvox_lab::bench::Schedule;
use shiftvox_lab::error::{Method, PixelStyle, Refused, voxel_method};
use shiftvox_lab::flicker::Motion;
use shiftvox_lab::methods::{self as experiment, Distance, Facts, MeshMethods, MethodsPlan};
use shiftvox_lab::report::html::Page;
use shiftvox_lab::report::plot::Panel;
use shiftvox_mesh::decimate::compact;
use shiftvox_mesh::drawing::Erosion;
use shiftvox_mesh::far::view::Opacity;
use shiftvox_mesh::far::{BuildOptions, FarFile};
use shiftvox_mesh::textured::{self, TexturedFile};
use shiftvox_mesh::{Mesh, Surface, mesh_box};

/// Pixels a side where nothing is said.
const DEFAULT_SIDE: u32 = 256;
/// Grids of the textured voxels whose level is chosen by distance. Few texels a
/// face: what is shown on a face is off by about a cell, which should not be many pixels.
const GRIDS: [u32; 6] = [4, 8, 16, 32, 64, 128];
/// Texels along a face of those.
const TEXELS: u32 = 4;

/// Ways to draw a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Family {
    /// Triangles with a depth buffer, 1, 4 and 16 samples a pixel.
    Triangles,
    /// The image-order engine on the voxelised mesh.
    Voxels,
    /// Far voxels.
    Far,
    /// Textured voxels.
    Textured,
    /// Decimated triangles, 1, 4 and 16 samples a pixel.
    Decimated,
    /// Decimated triangles, and far voxels for what is thinner than a pixel.
    Hybrid,
}

/// Arguments of `bench methods`.
#[derive(Debug, Args)]
pub(super) struct MethodsArgs {
    /// Meshes: .obj, .ply, .stl, .gltf or .glb
    #[arg(value_name = "MESH", required = true, value_parser = crate::names::parser())]
    meshes: Vec<String>,
    /// Pixels of the nearest picture: 256 for a square, or 640x360 [default: 256]
    #[arg(long, value_name = "N|WxH")]
    size: Option<Size>,
    /// The distance is doubled, and the picture halved, as long as it keeps so many pixels down
    #[arg(long, value_name = "PX", default_value_t = 8,
          value_parser = clap::value_parser!(u32).range(4..=4096))]
    least: u32,
    /// Pixels down the pictures, instead of halves of the first; the width follows
    #[arg(long, value_name = "PX,...", value_delimiter = ',', conflicts_with_all = ["size", "least"],
          value_parser = clap::value_parser!(u32).range(4..=i64::from(MOST_SIDE)))]
    heights: Vec<u32>,
    /// Frames of each method before those that count
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(0..=1000))]
    warmup: u32,
    /// Frames of each method that count; methods take turns
    #[arg(long, value_name = "N", default_value_t = 5,
          value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: u32,
    /// Frames of the film in which flicker is looked for, an eighth of a pixel apart; 0: none
    #[arg(long, value_name = "N", default_value_t = 5,
          value_parser = clap::value_parser!(u32).range(0..=1000))]
    frames: u32,
    /// Methods to measure [default: all]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST")]
    only: Vec<Family>,
    /// Decimated meshes keep one triangle of so many
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_values_t = BUDGETS,
          value_parser = clap::value_parser!(u32).range(1..))]
    budgets: Vec<u32>,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    export: ExportArgs,
    /// One page with tables, plots and pictures, which needs no other file
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    export_html: Option<PathBuf>,
}

pub(super) fn run(args: &MethodsArgs, console: &Console) -> Result<(), CliError> {
    export::check_with(&args.export, &args.export_html)?;
    pictures::check(&args.export, &args.meshes)?;
    args.camera.check().map_err(CliError::usage)?;
    let first = args.heights.first().copied().unwrap_or(DEFAULT_SIDE);
    let size = reference_size(args.size, first)?;
    if args.heights.is_empty() && size.0.min(size.1) < args.least {
        return Err(CliError::usage(format!(
            "a picture of {}x{} has less than --least {} pixels",
            size.0, size.1, args.least
        )));
    }
    let context = Context::now();
    context.warn(console);
    let plan = MethodsPlan {
        heights: args.heights(size),
        schedule: Schedule {
            warmup: args.warmup,
            runs: args.runs,
        },
        frames: args.frames,
        motion: Motion::Pan { pixels: 0.125 },
        style: PixelStyle::default(),
    };
    let mut meshes = Vec::new();
    for name in &args.meshes {
        meshes.push(measure(args, name, size, &plan, console)?);
    }
    write(args, &meshes, &context, plan.schedule, console)
}

impl MethodsArgs {
    /// Pixels down the pictures: those asked for, or halved again and again.
    fn heights(&self, size: (u32, u32)) -> Vec<u32> {
        if !self.heights.is_empty() {
            return self.heights.clone();
        }
        let halvings = (size.0.min(size.1) / self.least).ilog2();
        (0..=halvings).map(|times| size.1 >> times).collect()
    }

    fn takes(&self, family: Family) -> bool {
        self.only.is_empty() || self.only.contains(&family)
    }
}

/// What is made of a mesh for the methods, and how many milliseconds that took.
struct Made {
    /// Without opacities, and with.
    voxels: Vec<(Graph, f64)>,
    far: Option<(FarFile, f64)>,
    /// The image-order paper's grid, and those that a level is chosen from by distance.
    textured: Option<[(TexturedFile, f64); 2]>,
    decimated: Vec<Decimated>,
    hybrid: Option<(FarFile, f64)>,
}

impl Made {
    fn of(
        args: &MethodsArgs,
        name: &str,
        mesh: &Mesh,
        console: &Console,
    ) -> Result<Self, CliError> {
        let mut made = Self {
            voxels: Vec::new(),
            far: None,
            textured: None,
            decimated: Vec::new(),
            hybrid: None,
        };
        if args.takes(Family::Decimated) {
            made.decimated = decimated_of(mesh, &args.budgets)?;
        }
        if args.takes(Family::Hybrid) {
            let options = BuildOptions {
                hybrid: true,
                ..BuildOptions::default()
            };
            made.hybrid = Some(far_of(mesh, &options, console)?);
        }
        if args.takes(Family::Voxels) {
            // Opaque, as the other rules want them, and with opacities.
            for opacities in [false, true] {
                let scene_args = SceneArgs {
                    opacities,
                    ..args.scene.clone()
                };
                let scene = scenes::open(name, &scene_args, console)?;
                let read_ms = scene.mesh.as_ref().map_or(0.0, |mesh| mesh.load_ms);
                made.voxels.push((scene.graph, scene.load_ms - read_ms));
            }
        }
        if args.takes(Family::Far) {
            made.far = Some(far_of(mesh, &BuildOptions::default(), console)?);
        }
        if args.takes(Family::Textured) {
            let by_distance = textured::BuildOptions {
                grids: GRIDS.to_vec(),
                texels: TEXELS,
                ..textured::BuildOptions::default()
            };
            made.textured = Some([
                textured_of(mesh, &textured::BuildOptions::default(), console)?,
                textured_of(mesh, &by_distance, console)?,
            ]);
        }
        Ok(made)
    }
}

fn textured_of(
    mesh: &Mesh,
    options: &textured::BuildOptions,
    console: &Console,
) -> Result<(TexturedFile, f64), CliError> {
    let started = Instant::now();
    let data = textured::build(mesh, options, console.progress())?;
    let ms = milliseconds_since(started);
    let bytes = textured::store::encode(&data).map_err(|e| CliError::new(Kind::Run, e))?;
    Ok((TexturedFile::from_bytes(&bytes)?, ms))
}

/// A method, and what is known of it.
type Candidate<'m> = (Facts, Method<'m>);

fn candidate<'m>(
    label: impl Into<String>,
    bytes: u64,
    build_ms: f64,
    method: Method<'m>,
) -> Candidate<'m> {
    let facts = Facts {
        label: label.into(),
        bytes,
        build_ms,
    };
    (facts, method)
}

/// All methods that take part. Another one joins here.
fn methods<'m>(
    args: &MethodsArgs,
    mesh: &'m Mesh,
    made: &'m Made,
    style: PixelStyle,
) -> Result<Vec<Candidate<'m>>, Refused> {
    let mut all = Vec::new();
    if args.takes(Family::Triangles) {
        let (_, bytes) = compact(mesh);
        for samples in TRIANGLE_SAMPLES {
            let method = experiment::triangles(mesh, samples, style)?;
            let label = format!("triangles, {samples}");
            all.push(candidate(label, bytes, 0.0, method));
        }
    }
    for decimated in &made.decimated {
        let Decimated {
            mesh,
            one_of,
            bytes,
            ms,
        } = decimated;
        for samples in TRIANGLE_SAMPLES {
            let method = experiment::decimated(mesh, *one_of, samples, style)?;
            let label = format!("decimated 1/{one_of}, {samples}");
            all.push(candidate(label, *bytes, *ms, method));
        }
    }
    if let Some((hybrid, ms)) = &made.hybrid {
        for aa_log2 in 0..3 {
            let method = experiment::hybrid(hybrid, 1.0, aa_log2, style);
            let label = format!("hybrid, {}", 1 << (2 * aa_log2));
            all.push(candidate(label, hybrid.len(), *ms, method));
        }
        let method = experiment::hybrid(hybrid, 2.0, 1, style);
        all.push(candidate("hybrid, 4, lod 2", hybrid.len(), *ms, method));
    }
    if let [opaque, airy] = made.voxels.as_slice() {
        let rules = [
            ("voxels center", Coverage::Center, None, 0),
            ("voxels exact", Coverage::Exact, None, 0),
            ("voxels exact, 16", Coverage::Exact, None, 2),
            ("voxels alpha", Coverage::Alpha, None, 0),
            ("voxels alpha, lod 2", Coverage::Alpha, Some(2.0), 0),
            ("voxels alpha, 4", Coverage::Alpha, None, 1),
        ];
        for (label, coverage, lod_px, aa_log2) in rules {
            let options = SetupOptions {
                lod_px: lod_px.unwrap_or(coverage.default_lod()),
                aa_log2,
                ..SetupOptions::of(coverage)
            };
            let (graph, ms) = if coverage.blends() { airy } else { opaque };
            let engine = (engines::FAST.name, engines::FAST.make);
            let method = voxel_method(graph, engine, options, style);
            all.push(candidate(label, graph.bytes(), *ms, method));
        }
    }
    if let Some((file, ms)) = &made.far {
        let opacities = [
            ("far none", Opacity::None, 0),
            ("far scalar", Opacity::Scalar, 0),
            ("far scalar aa 2", Opacity::Scalar, 1),
            ("far six", Opacity::Six, 0),
            ("far six aa 2", Opacity::Six, 1),
            ("far six aa 4", Opacity::Six, 2),
        ];
        for (label, opacity, aa_log2) in opacities {
            let method = experiment::far(file, opacity, 1.0, aa_log2, style);
            all.push(candidate(label, file.len(), *ms, method));
        }
    }
    if let Some([(paper, paper_ms), (file, ms)]) = &made.textured {
        for level in 0..2 {
            let erosion = Erosion::Level {
                level,
                cells: Some(paper.grid(0).cell_grid().cells()),
            };
            let method = experiment::textured(paper, erosion, 0, style);
            let label = format!("textured 16, eroded {level}");
            all.push(candidate(label, paper.len(), *paper_ms, method));
        }
        for (aa_log2, samples) in [(0, 1), (1, 4)] {
            let erosion = Erosion::Auto { texel_px: 1.0 };
            let method = experiment::textured(file, erosion, aa_log2, style);
            let label = format!("textured auto, {samples}");
            all.push(candidate(label, file.len(), *ms, method));
        }
    }
    Ok(all)
}

fn measure(
    args: &MethodsArgs,
    name: &str,
    size: (u32, u32),
    plan: &MethodsPlan,
    console: &Console,
) -> Result<MeshMethods, CliError> {
    let (mesh, up) = scenes::read_mesh(name, &args.scene, console.progress())?;
    let bounds = Bounds::of_mesh(&mesh_box(&mesh, up == Up::Y));
    let camera = args.camera.camera(&bounds, up, size, 0.0);
    let made = Made::of(args, name, &mesh, console)?;
    let all = methods(args, &mesh, &made, plan.style).map_err(|e| CliError::new(Kind::Run, e))?;
    let (facts, methods): (Vec<_>, Vec<_>) = all.into_iter().unzip();
    let surface: &dyn Surface = &mesh;
    let progress = console.progress();
    let short = Path::new(name).file_stem().map(|s| s.to_string_lossy());
    let short = short.as_deref().unwrap_or(name);
    Ok(experiment::measure(
        (short, surface),
        &camera,
        &methods,
        facts,
        plan,
        progress,
    )?)
}

fn write(
    args: &MethodsArgs,
    meshes: &[MeshMethods],
    context: &Context,
    schedule: Schedule,
    console: &Console,
) -> Result<(), CliError> {
    let panels: Vec<(String, Vec<Panel>)> = meshes
        .iter()
        .map(|mesh| (mesh.mesh.clone(), experiment::panels(mesh)))
        .collect();
    pictures::write_plots(&args.export, &panels, console)?;
    let preface = context.markdown(schedule);
    if let Some(path) = &args.export_html {
        let page = page(meshes, &panels, &preface)?.finish();
        whole::write(path, page.as_bytes(), args.export.force)?;
        console.note(format!("{}: written", path.display()));
    }
    let mut fields = context.json(schedule, &SetupOptions::default());
    fields["meshes"] = json!(meshes);
    for (mesh, of) in meshes.iter().enumerate() {
        for (distance, at) in of.distances.iter().enumerate() {
            let field = &mut fields["meshes"][mesh]["distances"][distance];
            field["answers"] = json!(experiment::answers(&of.facts, at));
            field["rivals"] = json!(experiment::rivals(&of.facts, at));
        }
    }
    let tables = all(meshes).flat_map(|(mesh, distance)| {
        let whole = std::iter::once(experiment::table(mesh, distance));
        whole.chain(experiment::answer_tables(mesh, distance))
    });
    let results = Results {
        document: report::document("bench methods", fields),
        rows: experiment::rows(meshes),
        tables: tables.collect(),
        more_tables: Vec::new(),
        preface,
        panels: Vec::new(),
    };
    export::write_without_plots(&results, &args.export, console)
}

/// Every mesh at every distance.
fn all(meshes: &[MeshMethods]) -> impl Iterator<Item = (&MeshMethods, &Distance)> {
    meshes
        .iter()
        .flat_map(|mesh| mesh.distances.iter().map(move |distance| (mesh, distance)))
}

/// Pixels a side that small pictures are enlarged to, about.
const SHOWN_SIDE: u32 = 192;

/// The reference, then each method's picture, enlarged by a whole number.
fn enlarged(distance: &Distance) -> impl Iterator<Item = (usize, Vec<[u8; 4]>)> {
    let factor = (SHOWN_SIDE / distance.size.1.max(1)).max(1) as usize;
    let (width, height) = (distance.size.0 as usize, distance.size.1 as usize);
    let pictures = std::iter::once(&distance.reference.rgba).chain(&distance.pictures);
    pictures.map(move |picture| {
        let row =
            move |y: usize| (0..width * factor).map(move |x| (y / factor) * width + x / factor);
        let pixels = (0..height * factor).flat_map(row);
        // Of a method that refused there is no picture.
        let pixel = |at: usize| picture.get(at).copied().unwrap_or([255; 4]);
        (width * factor, pixels.map(pixel).collect())
    })
}

fn encode(width: usize, height: usize, pixels: &[[u8; 4]]) -> Result<Vec<u8>, CliError> {
    let png = shiftvox::picture::png::encode(width as u32, height as u32, pixels);
    png.map_err(|e| CliError::new(Kind::Run, e))
}

fn page(
    meshes: &[MeshMethods],
    panels: &[(String, Vec<Panel>)],
    preface: &str,
) -> Result<Page, CliError> {
    let mut page = Page::new("All methods on meshes");
    page.lines(preface.trim());
    page.text(
        "Triangles with 1, 4 and 16 samples a pixel; the image-order engine on the voxelised mesh \
         by its rules center and exact, and exact with 16 samples; far voxels opaque, with one \
         opacity and with six, at 1, 4 and 16 samples; textured voxels, level of detail chosen by \
         texels of a pixel or given; decimated triangles, one of so many left; the hybrid of both. \
         Read bytes: what the frame is made of, without other levels of detail; meshes as they would \
         be stored, with indices and rounded. Each distance is twice the one before, and the picture half as large, so that the \
         mesh always fills it. ms: processor time of one thread; a frame of voxels is clear, \
         traverse, colours without light, that of other methods has the light in it. Error: \
         against the triangles with 256 samples; bias: area covered too much; wrong share: too \
         much and too little together. Flicker: over a film whose camera moves an eighth of a \
         pixel a frame; pop: what changes by level of detail alone. Work is what a method counts \
         first, comparable within its family. The machine is a shared one: times say which is \
         faster where they are far apart.",
    );
    for (mesh, (_, panels)) in meshes.iter().zip(panels) {
        page.chapter(&format!("{}, {} triangles", mesh.mesh, mesh.triangles));
        // The last ones are over all distances.
        let (by_distance, over_all) = panels.split_at(mesh.distances.len());
        pictures::plots(
            &mut page,
            over_all,
            "Of each family the method with the least error over all distances.",
        )?;
        for (distance, panel) in mesh.distances.iter().zip(by_distance) {
            let (width, height) = distance.size;
            page.section(&format!("{width} x {height} pixels"));
            pictures::plots(
                &mut page,
                std::slice::from_ref(panel),
                "Grey: dominated. The line joins what is not. Numbers are those of the table below.",
            )?;
            for table in experiment::answer_tables(mesh, distance) {
                page.table(&table);
            }
            let labels = std::iter::once("reference, 256 samples");
            let labels = labels.chain(mesh.facts.iter().map(|facts| facts.label.as_str()));
            let mut shown = Vec::new();
            for ((width, picture), label) in enlarged(distance).zip(labels) {
                shown.push((encode(width, picture.len() / width, &picture)?, label));
            }
            let shown: Vec<(&[u8], &str)> = shown.iter().map(|(p, l)| (p.as_slice(), *l)).collect();
            page.pictures(&shown);
            page.table(&experiment::table(mesh, distance));
        }
    }
    Ok(page)
}
