//! `bench error`: run time against error.

use clap::Args;
use serde_json::json;

use super::args::check_sizes;
use super::meshes::MeshMethodArgs;
use super::picture_export::{self as pictures, PagesArgs, StripsArgs};
use crate::cli::args::{CameraArgs, RuleArgs, SceneArgs, Size, Tolerance};
use crate::cli::console::Console;
use crate::cli::error::{CliError, Kind};
use crate::cli::experiment::context::Context;
use crate::cli::experiment::export::ExportArgs;
use crate::cli::experiment::export::{self, Results};
use crate::cli::experiment::subjects;
use crate::cli::{engines, report};
use crate::lab::bench::{Schedule, Subject};
use crate::lab::error::{
    self as experiment, DrawingMethod, ErrorPlan, PixelStyle, SceneErrors, VoxelMethod,
};
use crate::project::{CageKind, Coverage, SetupOptions};
use crate::report::html::Page;

/// Scenes where none is named: a model, a landscape, a sponge, thin things.
pub(super) const SCENES: [&str; 5] = [
    subjects::BUNDLED,
    "gen:terrain,depth=9",
    "gen:menger,depth=5",
    "gen:wires,depth=8",
    "gen:truss,depth=8",
];

/// Pixels a side where nothing is said.
const DEFAULT_SIDE: u32 = 256;
/// Most pixels a side: references are 512 times the work of a picture.
const MOST_SIDE: u32 = 4096;

/// Arguments of `bench error`.
#[derive(Debug, Args)]
pub(super) struct ErrorArgs {
    /// Scenes: files, generators, or `bundled` [default: bundled gen:terrain,depth=9
    /// gen:menger,depth=5 gen:wires,depth=8 gen:truss,depth=8]
    #[arg(value_name = "SCENE", value_parser = crate::cli::names::parser())]
    scenes: Vec<String>,
    #[command(flatten)]
    select: SelectArgs,
    #[command(flatten)]
    meshes: MeshMethodArgs,
    /// Pixels: 512 for a square, or 640x360 [default: 256]
    #[arg(long, value_name = "N|WxH")]
    size: Option<Size>,
    /// Frames of each method before those that count
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(0..=1000))]
    warmup: u32,
    /// Frames of each method that count; methods take turns
    #[arg(long, value_name = "N", default_value_t = 3,
          value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: u32,
    #[command(flatten)]
    reference: ReferenceArgs,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    export: ExportArgs,
    #[command(flatten)]
    page: PagesArgs,
    #[command(flatten)]
    strips: StripsArgs,
}

/// How references are sampled.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Measurement")]
pub(super) struct ReferenceArgs {
    /// Exact rays of the reference along each axis of a pixel
    #[arg(long, value_name = "N", default_value = "16",
          value_parser = clap::builder::PossibleValuesParser::new(["2", "4", "8", "16"]))]
    reference_samples: String,
}

impl ReferenceArgs {
    /// Strata of a pixel and axis, as a power of two.
    pub(super) fn strata_log2(&self) -> u32 {
        match self.reference_samples.as_str() {
            "2" => 1,
            "4" => 2,
            "8" => 3,
            _ => 4,
        }
    }
}

/// Which settings are measured. Any list makes it all combinations of what is
/// listed, with the default for what is not.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Settings that are measured")]
struct SelectArgs {
    /// All combinations of all values: thousands, hours
    #[arg(long)]
    full: bool,
    /// Drawing rules
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST")]
    coverages: Vec<Coverage>,
    /// Tolerances, pixels, of the rules any and center; exact has 0 alone
    #[arg(long, value_delimiter = ',', value_name = "PX|inf,...")]
    tolerances: Vec<Tolerance>,
    /// Cages
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST")]
    cages: Vec<CageKind>,
    /// Widths of a word, bits, 16 to 64
    #[arg(long, value_delimiter = ',', value_name = "BITS,...",
          value_parser = clap::value_parser!(u32).range(16..=64))]
    bits: Vec<u32>,
    /// Levels of detail, pixels; 0: only leaves
    #[arg(long, value_delimiter = ',', value_name = "PX,...")]
    lods: Vec<f64>,
    /// Samples a pixel and axis: 1, 2, 4
    #[arg(long, value_delimiter = ',', value_name = "N,...", value_parser = samples)]
    aas: Vec<u32>,
    /// Engines that draw and are timed; counters are always the machine's [default: fast]
    #[arg(long, value_delimiter = ',', value_name = "LIST",
          value_parser = clap::builder::PossibleValuesParser::new(["fast", "machine"]))]
    engines: Vec<String>,
}

/// Samples along an axis, as their logarithm.
fn samples(text: &str) -> Result<u32, String> {
    match text.trim() {
        "1" => Ok(0),
        "2" => Ok(1),
        "4" => Ok(2),
        _ => Err("expected 1, 2 or 4".to_owned()),
    }
}

const COVERAGES: [Coverage; 3] = [Coverage::Exact, Coverage::Center, Coverage::Any];
const CAGES: [CageKind; 2] = [CageKind::Frame, CageKind::Corners];

/// One setting of each kind.
#[derive(Clone, Copy)]
struct Choice {
    coverage: Coverage,
    tolerance: f64,
    cage: CageKind,
    bits: u32,
    lod: f64,
    aa_log2: u32,
}

impl Choice {
    fn default_with(coverage: Coverage) -> Self {
        let rule = RuleArgs {
            coverage: Some(coverage),
            ..RuleArgs::default()
        };
        let options = rule.options(0);
        Self {
            coverage,
            tolerance: options.tolerance_px,
            cage: CageKind::Frame,
            bits: options.bits,
            lod: options.lod_px,
            aa_log2: 0,
        }
    }

    fn options(self) -> SetupOptions {
        let engine = RuleArgs {
            coverage: Some(self.coverage),
            tolerance: Some(Tolerance(self.tolerance)),
            cage: Some(self.cage),
            bits: Some(self.bits),
            lod: Some(self.lod),
            ..RuleArgs::default()
        };
        engine.options(self.aa_log2)
    }
}

impl SelectArgs {
    /// The settings that are measured, the default first if it is among them.
    fn options(&self) -> Vec<SetupOptions> {
        let listed = !(self.coverages.is_empty()
            && self.tolerances.is_empty()
            && self.cages.is_empty()
            && self.bits.is_empty()
            && self.lods.is_empty()
            && self.aas.is_empty());
        let choices = if self.full || listed {
            self.combinations()
        } else {
            standard()
        };
        choices.into_iter().map(Choice::options).collect()
    }

    fn combinations(&self) -> Vec<Choice> {
        /// What was listed; else, with `--full`, everything; else the default alone.
        fn list<T: Copy>(given: &[T], full: bool, all: &[T]) -> Vec<T> {
            match (given, full) {
                ([], true) => all.to_vec(),
                ([], false) => all[..1].to_vec(),
                (given, _) => given.to_vec(),
            }
        }
        let tolerances: Vec<f64> = self.tolerances.iter().map(|t| t.0).collect();
        let inf = f64::INFINITY;
        let all = [0.125, 0.0, 1.0 / 256.0, 1.0 / 64.0, 1.0 / 16.0, 0.5, inf];
        let mut choices = Vec::new();
        for coverage in list(&self.coverages, self.full, &COVERAGES) {
            let tolerances = match has_tolerances(coverage) {
                true => list(&tolerances, self.full, &all),
                false => vec![0.0],
            };
            // The rule's own default first.
            let default = Choice::default_with(coverage).lod;
            let mut lods = vec![default];
            lods.extend(
                [0.0, 0.5, 1.0, 2.0]
                    .into_iter()
                    .filter(|&lod| lod != default),
            );
            let lods = list(&self.lods, self.full, &lods);
            for cage in list(&self.cages, self.full, &CAGES) {
                for bits in list(&self.bits, self.full, &[64, 48, 32, 24, 20, 16]) {
                    for &lod in &lods {
                        for aa_log2 in list(&self.aas, self.full, &[0, 1, 2]) {
                            choices.extend(tolerances.iter().map(|&tolerance| Choice {
                                coverage,
                                tolerance,
                                cage,
                                bits,
                                lod,
                                aa_log2,
                            }));
                        }
                    }
                }
            }
        }
        choices
    }
}

/// Whether a rule takes other tolerances than 0.
fn has_tolerances(coverage: Coverage) -> bool {
    matches!(coverage, Coverage::Any | Coverage::Center)
}

/// Around the default settings: every drawing rule with every tolerance it has and
/// both cages; and each rule with other levels of detail, formats, and samples a pixel.
fn standard() -> Vec<Choice> {
    let mut choices = Vec::new();
    for coverage in COVERAGES {
        let default = Choice::default_with(coverage);
        let tolerances: &[f64] = match has_tolerances(coverage) {
            true => &[0.125, 0.0, 1.0 / 64.0, f64::INFINITY],
            false => &[0.0],
        };
        for cage in CAGES {
            choices.extend(tolerances.iter().map(|&tolerance| Choice {
                cage,
                tolerance,
                ..default
            }));
        }
        // The other rules take seconds for a frame of 16 samples a pixel.
        let exact = matches!(coverage, Coverage::Exact);
        let most = if exact { 2 } else { 1 };
        choices.extend((1..=most).map(|aa_log2| Choice { aa_log2, ..default }));
        let lods = [0.0, 0.5, 1.0, 2.0].into_iter();
        let lods = lods.filter(|&lod| lod != default.lod);
        choices.extend(lods.map(|lod| Choice { lod, ..default }));
        choices.extend([48, 32, 24, 20, 16].map(|bits| Choice { bits, ..default }));
    }
    choices
}

pub(super) fn run(
    args: &ErrorArgs,
    from_config: Vec<String>,
    console: &Console,
) -> Result<(), CliError> {
    let names = subjects::names_or(&args.scenes, from_config, &SCENES);
    let scene_args = SceneArgs {
        opacities: args.scene.opacities || args.select.coverages.contains(&Coverage::Alpha),
        ..args.scene.clone()
    };
    export::check(&args.export)?;
    pictures::check(&args.page, &args.export, &names)?;
    let size = reference_size(args.size, DEFAULT_SIDE)?;
    let context = Context::now();
    context.warn(console);
    let plan = ErrorPlan {
        size,
        schedule: Schedule {
            warmup: args.warmup,
            runs: args.runs,
        },
        strata_log2: args.reference.strata_log2(),
        style: PixelStyle::default(),
    };
    let options = args.select.options();
    let mut scenes = Vec::new();
    for name in &names {
        let subject = subjects::open(name, &args.camera, &scene_args, size, console)?;
        let mesh = args.meshes.open(name, &args.scene, console)?;
        let mut methods = if args.meshes.has_voxels(mesh.is_some()) {
            methods(&args.select, &options, &subject, plan.style)
        } else {
            Vec::new()
        };
        let mut references = experiment::References::default();
        if let Some(mesh) = &mesh {
            methods.extend(args.meshes.methods(mesh, plan.style)?);
            references = experiment::References::of_triangles(&mesh.mesh);
        }
        let progress = console.progress();
        let measured =
            experiment::measure(&subject, &mut methods, &plan, &mut references, progress)?;
        scenes.push(measured);
    }
    write(args, &scenes, &context, plan.schedule, console)
}

/// The size that `--size` says, else a square; refuses what is too large for a reference.
pub(super) fn reference_size(
    given: Option<Size>,
    default_side: u32,
) -> Result<(u32, u32), CliError> {
    let square = (default_side, default_side);
    let size = given.map_or(square, |size| (size.width, size.height));
    check_sizes(&[size])?;
    if size.0.max(size.1) <= MOST_SIDE {
        return Ok(size);
    }
    let message = format!("a picture of {}x{} has no reference", size.0, size.1);
    Err(CliError::new(Kind::Limit, message).advise(format!("the most is {MOST_SIDE} a side")))
}

/// The image-order engines with all settings. Renderers of meshes join in `meshes`.
fn methods<'s>(
    select: &SelectArgs,
    options: &[SetupOptions],
    subject: &'s Subject,
    style: PixelStyle,
) -> Vec<Box<dyn DrawingMethod + 's>> {
    let asked = |name: &str| match select.engines.as_slice() {
        [] => name == engines::FAST.name,
        given => given.iter().any(|given| given == name),
    };
    let chosen = engines::CANDIDATES.iter().filter(|c| asked(c.name));
    let mut methods: Vec<Box<dyn DrawingMethod + 's>> = Vec::new();
    for engine in chosen {
        for &options in options {
            let engine = (engine.name, engine.make);
            methods.push(Box::new(VoxelMethod::new(
                &subject.graph,
                engine,
                options,
                style,
            )));
        }
    }
    methods
}

/// What pages and folders show pictures of: the default, the image-order paper, other
/// rules, more samples; and whatever nothing beats.
fn is_shown(method: &str) -> bool {
    const SHOWN: [&str; 5] = [
        "exact frame",
        "any inf corners",
        "any 1/8 frame",
        "center 1/8 frame",
        "exact frame aa 4",
    ];
    SHOWN.contains(&method)
}

fn write(
    args: &ErrorArgs,
    scenes: &[SceneErrors],
    context: &Context,
    schedule: Schedule,
    console: &Console,
) -> Result<(), CliError> {
    let mut fields = context.json(schedule, &SetupOptions::default());
    fields["scenes"] = json!(scenes);
    let mut tables: Vec<_> = scenes.iter().map(experiment::table).collect();
    let shown = |method: &str| is_shown(method);
    let vertices = scenes.iter().map(|s| experiment::vertex_table(s, &shown));
    tables.extend(vertices.filter(|table| !table.rows.is_empty()));
    let panels: Vec<_> = scenes
        .iter()
        .map(|scene| (scene.scene.clone(), experiment::panels(scene)))
        .collect();
    if let Some(folder) = &args.strips.strips {
        write_strips(folder, scenes, args.export.force)?;
        console.note(format!("{}: strips written", folder.display()));
    }
    pictures::write_plots(&args.export, &panels, console)?;
    let preface = context.markdown(schedule);
    let page = || page(scenes, &preface);
    pictures::write_page(&args.page, &args.export, page, console)?;
    let results = Results {
        more_tables: Vec::new(),
        document: report::document("bench error", fields),
        rows: experiment::rows(scenes),
        tables,
        preface: preface.clone(),
        panels: Vec::new(),
    };
    export::write_without_plots(&results, &args.export, console)
}

/// The methods of a scene that are worth a look: those named, and those that nothing beats.
fn worth_a_look(scene: &SceneErrors) -> impl Iterator<Item = (&str, &[[u8; 4]])> {
    let beaten_by = experiment::beaten_by(&scene.rows);
    let rows = scene.rows.iter().zip(&scene.pictures).zip(beaten_by);
    rows.filter(|((row, picture), beaten_by)| {
        !picture.is_empty() && (beaten_by.is_none() || is_shown(&row.method))
    })
    .map(|((row, picture), _)| (row.method.as_str(), picture.as_slice()))
}

fn write_strips(
    folder: &std::path::Path,
    scenes: &[SceneErrors],
    force: bool,
) -> Result<(), CliError> {
    for scene in scenes {
        let size = (scene.width, scene.height);
        for (method, picture) in worth_a_look(scene) {
            let png = pictures::strip(size, picture, &scene.reference.rgba)?;
            pictures::write_strip(folder, &scene.scene, method, &png, force)?;
        }
    }
    Ok(())
}

fn page(scenes: &[SceneErrors], preface: &str) -> Result<Page, CliError> {
    let mut page = Page::new("Run time against error");
    page.lines(preface.trim());
    page.text(
        "Times are of one thread, and only as good as the machine was idle; operations are those of the machine \
         with the same settings, and the same in every run. Extra and missing are samples against \
         exact rays through the same points; elsewhere: samples that show a voxel which neither is nor holds \
         the right one; coarser: a voxel that holds it, by level of detail. The reference has many exact rays \
         a pixel, so one sample a pixel cannot come near it, however exact. Bias: area covered too much, \
         thin: on pixels of things thinner than a pixel. A mesh's reference has 256 samples of its triangles a pixel. Beaten by: a method with no more operations, no more \
         wrong coverage and no greater error, and less of one.",
    );
    for scene in scenes {
        page.chapter(&format!("{}, {} voxels", scene.scene, scene.voxels));
        let size = (scene.width, scene.height);
        page.section("Result, reference, difference (four times as bright)");
        let mut strips = Vec::new();
        for (method, picture) in worth_a_look(scene).filter(|(method, _)| is_shown(method)) {
            let png = pictures::strip(size, picture, &scene.reference.rgba)?;
            strips.push((png, method));
        }
        let strips: Vec<(&[u8], &str)> = strips.iter().map(|(p, m)| (p.as_slice(), *m)).collect();
        for strip in strips {
            page.pictures(&[strip]);
        }
        page.section("What is worth having");
        pictures::plots(
            &mut page,
            &experiment::panels(scene),
            "Grey: dominated. The line joins what is not.",
        )?;
        page.section("Numbers");
        page.table(&experiment::table(scene));
        let vertices = experiment::vertex_table(scene, &is_shown);
        if !vertices.rows.is_empty() {
            page.table(&vertices);
        }
    }
    Ok(page)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_standard_settings_are_unlike_each_other_and_begin_with_the_default() {
        let none = SelectArgs {
            full: false,
            coverages: Vec::new(),
            tolerances: Vec::new(),
            cages: Vec::new(),
            bits: Vec::new(),
            lods: Vec::new(),
            aas: Vec::new(),
            engines: Vec::new(),
        };
        let standard = none.options();
        assert_eq!(standard[0], SetupOptions::default());
        assert_eq!(standard.len(), 2 + 2 * 8 + 3 * (1 + 3 + 5) + 1);
        for (place, options) in standard.iter().enumerate() {
            assert!(!standard[..place].contains(options), "{options:?}");
        }
        let full = SelectArgs {
            full: true,
            ..none.clone()
        };
        assert_eq!(full.options().len(), (1 + 2 * 7) * 2 * 6 * 4 * 3);
        let some = SelectArgs {
            bits: vec![24, 32],
            aas: vec![1],
            ..none
        };
        let some = some.options();
        assert_eq!(some.len(), 2);
        assert_eq!(
            (some[0].bits, some[0].aa_log2, some[0].lod_px),
            (24, 1, 0.5)
        );
    }
}
