//! `reproduce`: the image-order paper's results in one go, and again.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::args::{CameraArgs, SceneArgs};
use super::console::Console;
use super::engines;
use super::error::{CliError, Kind};
use super::experiment::context::Context;
use super::experiment::subjects;
use super::report;
use crate::bounded;
use crate::lab::bench::{Harness, Subject, ablation};
use crate::lab::reproduce::{
    self, Config, Drawn, Engines, Evidence, ReproduceError, Timed, differences, figures, tables,
};
use crate::picture::{Picture, png};
use crate::project::SetupOptions;
use crate::report::Table;
use crate::report::html::Page;
use crate::report::plot::{self, Panel};
use crate::scene::generate::Spec;
use crate::scene::{OpenError, Source};
use crate::whole;

/// Arguments of `reproduce`.
#[derive(Debug, Args)]
pub(super) struct ReproduceArgs {
    /// A recorded run to draw again from its config.toml: every picture's hash and every count must be the same
    #[arg(value_name = "DIR")]
    recorded: Option<PathBuf>,
    /// Folder for a new run: report.html, config.toml, results.json, pictures and plots
    #[arg(
        long,
        value_name = "DIR",
        default_value = "out/reproduce",
        conflicts_with = "recorded"
    )]
    outdir: PathBuf,
    /// Sides of Table I's pictures, pixels [default: 64,128,256,512,1024]
    #[arg(long, value_name = "LIST", value_delimiter = ',', conflicts_with = "recorded",
          value_parser = clap::value_parser!(u32).range(1..=4096))]
    sides: Vec<u32>,
    /// Side of the pictures in which objects are compared, pixels [default: 512]
    #[arg(long, value_name = "N", conflicts_with = "recorded",
          value_parser = clap::value_parser!(u32).range(1..=4096))]
    object_side: Option<u32>,
    /// Scenes of one kind and growing detail, smallest first [default: gen:terrain of depth 6 to 10]
    #[arg(
        long,
        value_name = "SCENE",
        value_delimiter = ';',
        conflicts_with = "recorded"
    )]
    growing: Vec<String>,
    /// Frames of each contender that count [default: 5]
    #[arg(long, value_name = "N", conflicts_with = "recorded",
          value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: Option<u32>,
    /// Replace files that exist
    #[arg(long)]
    force: bool,
}

const CONFIG: &str = "config.toml";
const RESULTS: &str = "results.json";
const PAGE: &str = "report.html";
/// The viewer's octant of the image-order paper's Figure 2.
const PAPER_OCTANT: u8 = 0b110;

impl From<ReproduceError> for CliError {
    fn from(error: ReproduceError) -> Self {
        match error {
            ReproduceError::Bench(error) => error.into(),
            ReproduceError::Resolve(error) => error.into(),
            ReproduceError::Engine { scene, source } => Self::from(source).at(scene),
        }
    }
}

pub(super) fn run(args: &ReproduceArgs, console: &Console) -> Result<(), CliError> {
    match &args.recorded {
        Some(folder) => again(folder, console),
        None => anew(args, console),
    }
}

fn open(config: &Config, console: &Console) -> Result<Vec<Subject>, CliError> {
    let (camera, scene) = (CameraArgs::default(), SceneArgs::default());
    let side = config.object_side;
    let names = config.scenes();
    // A wrong name is told before any scene is made.
    for name in names.iter().filter(|name| Source::is_generated(name)) {
        Spec::parse(name).map_err(OpenError::from)?;
    }
    names
        .iter()
        .map(|name| subjects::open(name, &camera, &scene, (side, side), console))
        .collect()
}

/// Draws a recorded run again and compares all that does not depend on the machine.
fn again(folder: &Path, console: &Console) -> Result<(), CliError> {
    let read = |name: &str| {
        let path = folder.join(name);
        let place = path.display().to_string();
        bounded::read_settings(&path)
            .map_err(|e| {
                CliError::input(format!("cannot read the file: {e}"))
                    .at(&place)
                    .advise("name a folder that `shiftvox reproduce --outdir` made")
            })
            .map(|text| (text, place))
    };
    let (text, place) = read(CONFIG)?;
    let config: Config = toml::from_str(&text)
        .map_err(|e| CliError::input(format!("not a recorded configuration: {e}")).at(&place))?;
    config.check().map_err(|e| CliError::input(e).at(&place))?;
    let (text, place) = read(RESULTS)?;
    let results: Value = serde_json::from_str(&text)
        .map_err(|e| CliError::input(format!("not JSON: {e}")).at(&place))?;
    let recorded: Vec<Evidence> =
        serde_json::from_value(results["evidence"].clone()).map_err(|e| {
            CliError::input(format!("`evidence` is not a list of frames: {e}")).at(&place)
        })?;
    let subjects = open(&config, console)?;
    let drawn = reproduce::evidence(&config, &subjects, console.progress())?;
    let found: Vec<Evidence> = drawn.into_iter().map(|d| d.evidence).collect();
    let differing = differences(&recorded, &found);
    if console.json {
        let fields = json!({ "frames": found.len(), "differences": differing, "evidence": found });
        console.document(&report::document("reproduce again", fields))?;
    }
    if differing.is_empty() {
        if !console.json {
            console.data(format!(
                "{}: {} frames, all hashes and counts as recorded",
                folder.display(),
                found.len()
            ))?;
        }
        return Ok(());
    }
    for difference in &differing {
        console.note(difference);
    }
    Err(CliError::new(
        Kind::Failed,
        format!("{}: {} differences", folder.display(), differing.len()),
    ))
}

/// All that a run found.
struct Results {
    config: Config,
    drawn: Vec<Drawn>,
    evidence: Vec<Evidence>,
    table_one: Vec<Timed>,
    objects: Vec<Timed>,
    order: Vec<(&'static str, ablation::AblationRow)>,
    /// Names, captions and pictures.
    pictures: Vec<(String, String, Vec<u8>)>,
}

fn config(args: &ReproduceArgs) -> Config {
    let mut config = Config::default();
    if !args.sides.is_empty() {
        config.sides.clone_from(&args.sides);
        config.sides.sort_unstable();
        config.sides.dedup();
    }
    if let Some(side) = args.object_side {
        config.object_side = side;
    }
    if !args.growing.is_empty() {
        config.growing.clone_from(&args.growing);
    }
    if let Some(runs) = args.runs {
        config.runs = runs;
    }
    config
}

fn anew(args: &ReproduceArgs, console: &Console) -> Result<(), CliError> {
    let config = config(args);
    config.check().map_err(CliError::usage)?;
    for name in [CONFIG, RESULTS, PAGE] {
        whole::check_free(&args.outdir.join(name), args.force)?;
    }
    let context = Context::now();
    context.warn(console);
    let found = find(config, console)?;
    let table_one = tables::table_one(&found.table_one, &found.evidence);
    let laws = tables::laws(&found.table_one);
    let plots = [
        ("figure-2.svg", figures::order_diagram(PAPER_OCTANT)),
        (
            "figure-5.svg",
            one_plot(tables::figure_five(&found.table_one))?,
        ),
        (
            "objects.svg",
            one_plot(tables::object_chart(&found.objects))?,
        ),
        ("order.svg", one_plot(tables::order_bars(&found.order))?),
    ];
    let write = |name: &str, bytes: &[u8]| whole::write(&args.outdir.join(name), bytes, args.force);
    for (name, _, bytes) in &found.pictures {
        write(name, bytes)?;
    }
    for (name, svg) in &plots {
        write(name, svg.as_bytes())?;
    }
    let toml = toml::to_string(&found.config)
        .map_err(|e| CliError::new(Kind::Run, format!("cannot write the configuration: {e}")))?;
    write(CONFIG, toml.as_bytes())?;
    let document = document(&found, &context);
    write(RESULTS, format!("{document:#}\n").as_bytes())?;
    write(PAGE, page(&found, &context, &plots).as_bytes())?;
    console.note(format!("{}: written", args.outdir.join(PAGE).display()));
    if console.json {
        return console.document(&document);
    }
    let text: Vec<String> = [
        &table_one,
        &laws,
        &tables::independence(&found.objects, &found.config.growing),
    ]
    .into_iter()
    .map(Table::markdown)
    .collect();
    console.data(text.join("\n"))
}

fn one_plot(panel: Panel) -> Result<String, CliError> {
    Ok(plot::svg(&[panel])?)
}

fn find(config: Config, console: &Console) -> Result<Results, CliError> {
    let subjects = open(&config, console)?;
    let (family, order_alone) = (engines::order_family(2), engines::order_family(1));
    let all = Engines {
        machine: &family.whole,
        fast: &engines::FAST,
        reference: &engines::REFERENCE,
        family: &family,
        order_alone: &order_alone,
    };
    let progress = console.progress();
    let drawn = reproduce::evidence(&config, &subjects, progress)?;
    let mut harness = Harness::new(config.schedule(), progress);
    let first = subjects.get(..1).unwrap_or_default();
    let table_one = reproduce::times(first, &config.sides, &all, &mut harness)?;
    let objects = reproduce::times(&subjects, &[config.object_side], &all, &mut harness)?;
    let compared: Vec<&Subject> = subjects
        .iter()
        .filter(|s| config.simple.first() == Some(&s.name) || config.complex.contains(&s.name))
        .collect();
    let order = reproduce::order(&compared, config.object_side, &all, &mut harness)?;
    let pictures = pictures(&config, &subjects, &drawn)?;
    Ok(Results {
        evidence: drawn.iter().map(|d| d.evidence.clone()).collect(),
        drawn,
        config,
        table_one,
        objects,
        order,
        pictures,
    })
}

fn encoded(picture: &Picture) -> Result<Vec<u8>, CliError> {
    png::encode(picture.width, picture.height, &picture.rgba)
        .map_err(|error| CliError::new(Kind::Run, error))
}

/// Figures 3 and 4 in kind: each object by the machine under the image-order paper's
/// settings, by default, and by the exact ray caster in place of the editor's picture.
fn pictures(
    config: &Config,
    subjects: &[Subject],
    drawn: &[Drawn],
) -> Result<Vec<(String, String, Vec<u8>)>, CliError> {
    let mut all = Vec::new();
    let shown = config.complex.iter().map(|name| (3, name));
    for (figure, name) in shown.chain(config.simple.iter().map(|name| (4, name))) {
        let Some(subject) = subjects.iter().find(|s| s.name == *name) else {
            continue;
        };
        let stem = format!("figure-{figure}-{}", super::scenes::stem(name));
        for (settings, _) in reproduce::settings() {
            let is_it = |d: &&Drawn| {
                let e = &d.evidence;
                e.scene == *name && e.settings == settings && e.side == config.object_side
            };
            if let Some(frame) = drawn.iter().find(is_it) {
                let caption = format!("{name}, the machine, {settings} settings");
                let file = format!("{stem}-{settings}.png");
                all.push((file, caption, encoded(&frame.picture)?));
            }
        }
        let exact = reproduce::picture_by(
            &engines::REFERENCE,
            subject,
            config.object_side,
            &SetupOptions::default(),
        )?;
        let caption = format!("{name}, exact rays");
        all.push((format!("{stem}-exact.png"), caption, encoded(&exact)?));
    }
    Ok(all)
}

fn document(found: &Results, context: &Context) -> Value {
    let options = SetupOptions::default();
    let mut fields = context.json(found.config.schedule(), &options);
    let order: Vec<Value> = found
        .order
        .iter()
        .map(|(settings, row)| json!({ "settings": settings, "row": row }))
        .collect();
    fields["config"] = json!(found.config);
    fields["evidence"] = json!(found.evidence);
    fields["table_1"] = json!(found.table_one);
    fields["objects"] = json!(found.objects);
    fields["occlusion_order"] = json!(order);
    fields["paper_law"] = json!(tables::paper_law());
    report::document("reproduce", fields)
}

fn page(found: &Results, context: &Context, plots: &[(&str, String)]) -> String {
    let mut page = Page::new("The paper's results, reproduced");
    page.lines(&context.command_line());
    page.text(
        "The paper is \"voxel rendering for a light hardware\". Its numbers were taken on an Intel Pentium dual core with its own \
         scenes, which are not published; ours are stand-ins of the same kinds. So times can be compared by their growth, not one by one. \
         \"Paper settings\" are eight corners, screen space at once, coverage any; \"default settings\" are a corner and three edges, \
         exact coverage, which never leaves clip space.",
    );
    page.lines(&context.markdown(found.config.schedule()));
    page.key_figures(&key_figures(found));
    let plot = |page: &mut Page, name: &str, caption: &str| {
        if let Some((_, svg)) = plots.iter().find(|(n, _)| *n == name) {
            page.plot(svg, caption);
        }
    };
    page.chapter("Table I: time by the picture's size");
    page.table(&tables::table_one(&found.table_one, &found.evidence));
    page.table(&tables::laws(&found.table_one));
    page.text(
        "The paper says that time is of the order of the image: an exponent of 1 in pixels. A fill-vector hierarchy does better than that \
         where large parts of the picture are one solid or empty: the border grows with the side, not the area.",
    );
    page.chapter("Figure 5: render time against pixels");
    plot(
        &mut page,
        "figure-5.svg",
        "Both axes logarithmic; the paper's 64 x 64 is given as below 1 ms and left out.",
    );
    page.chapter("Time and the object");
    page.text(
        "The paper: 119 ms for a complex object, 110 and 60 ms for two simple ones, at a size that it does not state; \"this shows that the rendering \
         algorithm doesn't depend on the complexity of image\".",
    );
    page.table(&tables::independence(&found.objects, &found.config.growing));
    plot(
        &mut page,
        "objects.svg",
        "All scenes at one size: 64 voxels to millions.",
    );
    page.table(&tables::objects(&found.objects, &found.evidence));
    page.chapter("Occlusion order: with and without");
    page.text(
        "The paper says that without occlusion sort \"the time required to draw is significantly larger\" and gives no number. Its loop needs the order: \
         the first record to reach a pixel draws it, so with children in a fixed order the picture is wrong, however long it takes. What the order buys \
         is that hidden records can be rejected at once; the rows \"fill-vector rejection off\" keep the order and reject nothing, \
         and draw the same picture. Under the paper's settings there are no such rows: without rejection its loop takes every solid \
         apart along the bisectors down to the last bit, which nobody can wait for.",
    );
    page.table(&tables::order(&found.order));
    plot(
        &mut page,
        "order.svg",
        "1 is no difference. A wrong picture may well take less time.",
    );
    page.chapter("Figures 1 and 2: children and their order");
    plot(
        &mut page,
        "figure-2.svg",
        "The paper's example, octant 110: the viewer is at high x and y and low z.",
    );
    for (figure, title) in [
        (3, "Figure 3: complex objects"),
        (4, "Figure 4: simple objects"),
    ] {
        page.chapter(title);
        let prefix = format!("figure-{figure}-");
        let shown: Vec<(&[u8], &str)> = found
            .pictures
            .iter()
            .filter(|(name, ..)| name.starts_with(&prefix))
            .map(|(_, caption, bytes)| (bytes.as_slice(), caption.as_str()))
            .collect();
        for three in shown.chunks(3) {
            page.pictures(three);
        }
    }
    page.chapter("Frames and their hashes");
    page.text("shiftvox reproduce DIR draws them all again and fails with exit code 3 if one of these differs.");
    page.table(&tables::hashes(&found.evidence));
    page.finish()
}

fn key_figures(found: &Results) -> Vec<(String, String)> {
    let mut figures = Vec::new();
    if let Some(law) = tables::paper_law() {
        figures.push((
            format!("{:.2}", law.exponent),
            "exponent of the paper's Table I".to_owned(),
        ));
    }
    let largest = found.config.sides.iter().max();
    for timed in &found.table_one {
        if Some(&timed.timing.width) == largest {
            figures.push((
                format!("{:.1} ms", timed.timing.best_median_ms()),
                format!(
                    "{}, {} settings, {}",
                    timed.timing.engine,
                    timed.settings,
                    timed.timing.size()
                ),
            ));
        }
    }
    let operations = found.drawn.iter().map(|d| d.counter.ops()).max();
    figures.push((
        report::grouped(operations.unwrap_or(0)),
        "operations of the largest frame, none a multiplication".to_owned(),
    ));
    figures
}
