//! `render`: a picture of each scene.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::args::{
    CameraArgs, DataBudget, EngineArgs, EngineName, OutputArgs, PictureArgs, SceneArgs, Setting,
    camera_line, camera_settings,
};
use super::console::Console;
use super::error::{CliError, Kind};
use super::methods::{self, DrawArgs};
use super::{names, outputs, report, scenes};
use shiftvox::drawing::{DrawError, Shown};
use shiftvox::frame::count_samples;
use shiftvox::picture;
use shiftvox::project::Camera;
use shiftvox_lab::bench::Summary;

/// Arguments of `render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// Scenes: files, or generators such as gen:terrain,depth=10,seed=1
    #[arg(value_name = "SCENE", value_parser = crate::names::parser())]
    pub scenes: Vec<String>,
    /// Picture to write; {stem} stands for the scene's name
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the same frame N times and report the least, middle and greatest time
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(1..))]
    pub repeat: u32,
    /// Of .far files: keep at most this much of the nodes' data in memory: 512M, 2G [default: as
    /// the system decides]
    #[arg(long, value_name = "SIZE")]
    pub memory: Option<DataBudget>,
    /// Print the picture's hash
    #[arg(long)]
    pub hash: bool,
    /// Fail with exit code 3 if the picture's hash is another
    #[arg(long, value_name = "HASH")]
    pub expect_hash: Option<String>,
    /// Print the camera as a line of flags to paste
    #[arg(long)]
    pub print_camera: bool,
    /// Camera.
    #[command(flatten)]
    pub camera: CameraArgs,
    /// Picture.
    #[command(flatten)]
    pub picture: PictureArgs,
    /// Engine.
    #[command(flatten)]
    pub engine: EngineArgs,
    /// Scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Output.
    #[command(flatten)]
    pub out: OutputArgs,
}

/// Draws all scenes; a scene that fails is reported and does not stop the others.
///
/// # Errors
/// The first scene's failure, or a wrong command line.
pub(super) fn run(
    args: &RenderArgs,
    from_config: Vec<String>,
    console: &Console,
) -> Result<(), CliError> {
    let names = scenes::choose(&args.scenes, from_config)?;
    check(args, names.len())?;
    check_distinct(args, &names)?;
    let mut results = Vec::new();
    let (mut resolved, mut engines) = (None, Vec::new());
    let mut first_failure: Option<CliError> = None;
    let mut failed = 0;
    for name in &names {
        match render_one(args, name, names.len(), console) {
            Ok((camera, engine, result)) => {
                resolved = Some(camera);
                engines.push(engine);
                results.push(result);
            }
            Err(error) if names.len() == 1 || error.kind == Kind::Pipe => return Err(error),
            Err(error) => {
                console.error(&error);
                failed += 1;
                engines.push(args.engine.engine.unwrap_or_default());
                results.push(json!({ "scene": name, "error": error.message }));
                first_failure.get_or_insert(error);
            }
        }
    }
    let document = report::document("render", json!({ "scenes": results }));
    if console.json {
        console.document(&document)?;
    }
    if let Some(outdir) = &args.out.outdir {
        // Scenes have one camera only where the user gave it or there is one scene.
        let one = resolved.filter(|_| names.len() == 1);
        let settings = settings(args, names.clone(), &engines, one.as_ref());
        outputs::write_record(outdir, settings, &document, args.out.force)?;
    }
    match first_failure {
        None => Ok(()),
        Some(first) => Err(CliError::new(
            first.kind,
            format!("{failed} of {} scenes failed; see above", names.len()),
        )),
    }
}

fn check(args: &RenderArgs, scenes: usize) -> Result<(), CliError> {
    args.camera.check().map_err(CliError::usage)?;
    let answers = args.hash || args.expect_hash.is_some() || args.print_camera || args.repeat > 1;
    if args.output.is_none() && args.out.outdir.is_none() && !answers {
        return Err(CliError::usage("no output was given").advise(
            "name the picture with -o FILE.png, or ask for --hash, --print-camera or --repeat N",
        ));
    }
    if let Some(expected) = &args.expect_hash
        && !(expected.len() == 32 && expected.bytes().all(|b| b.is_ascii_hexdigit()))
    {
        return Err(CliError::usage("--expect-hash takes 32 hexadecimal digits"));
    }
    if args.output.is_none() && args.out.outdir.is_none() && !args.picture.aov.is_empty() {
        return Err(CliError::usage(
            "--aov writes beside the picture: name it with -o FILE.png",
        ));
    }
    if let Some(output) = &args.output {
        outputs::check_picture_name(output)?;
        if scenes > 1 && !output.to_string_lossy().contains("{stem}") {
            return Err(CliError::usage(format!(
                "{}: {scenes} scenes would be written to one file",
                output.display()
            ))
            .advise("put {stem} into the name, for example -o out/{stem}.png"));
        }
    }
    let (width, height) = args.picture.size();
    count_samples(width, height, args.picture.aa_log2()).map_err(DrawError::from)?;
    if let Some(outdir) = &args.out.outdir {
        outputs::check_free(&outputs::record_paths(outdir), args.out.force)?;
    }
    Ok(())
}

/// Refuses two scenes whose pictures would have one name.
fn check_distinct(args: &RenderArgs, names: &[String]) -> Result<(), CliError> {
    let mut taken = std::collections::HashMap::new();
    for name in names {
        let Some(path) = output_path(args, &scenes::stem(name)) else {
            continue;
        };
        if let Some(other) = taken.insert(path.clone(), name) {
            return Err(CliError::usage(format!(
                "{other} and {name} would both be drawn to {}",
                path.display()
            ))
            .advise("draw them into different folders, one after the other"));
        }
    }
    Ok(())
}

fn output_path(args: &RenderArgs, stem: &str) -> Option<PathBuf> {
    match (&args.output, &args.out.outdir) {
        (Some(output), _) => Some(names::replace(output, "{stem}", stem)),
        (None, Some(outdir)) => Some(outdir.join(names::path(&format!("{stem}.png")))),
        (None, None) => None,
    }
}

/// Draws a scene, writes its picture and prints what the flags ask for. `of`: number of scenes.
fn render_one(
    args: &RenderArgs,
    name: &str,
    of: usize,
    console: &Console,
) -> Result<(Camera, EngineName, Value), CliError> {
    // Records include the hash.
    let expects = args.expect_hash.is_some() || args.out.outdir.is_some();
    let is_hashed = args.hash || expects || console.json;
    let draw_args = DrawArgs {
        engine: &args.engine,
        picture: &args.picture,
        scene: &args.scene,
        memory: args.memory,
        is_hashed,
    };
    let output = output_path(args, &scenes::stem(name));
    if let Some(path) = &output {
        outputs::check_free(&outputs::paths(path, &args.picture.aov), args.out.force)?;
        outputs::check_room(path, &args.picture.aov, args.picture.size(), 1)?;
    }
    let opened = methods::open(name, &draw_args, console)?;
    let mut drawable = opened.drawable(&draw_args).map_err(|e| e.at(name))?;
    let up = args.scene.up_or(drawable.up());
    let size = args.picture.size();
    let camera = args.camera.camera(&drawable.bounds(), up, size, 0.0);
    if args.print_camera && !console.json {
        console.data(camera_line(&camera))?;
    }
    let shown = methods::frame(&mut *drawable, &camera, args.repeat).map_err(|e| e.at(name))?;
    let hash = match is_hashed {
        true => Some(picture::hash_rows(&shown.buffers).map_err(|e| CliError::from(e).at(name))?),
        false => None,
    };
    if let Some(hash) = hash.as_deref().filter(|_| args.hash && !console.json) {
        console.data(if of > 1 {
            format!("{hash}  {name}")
        } else {
            hash.to_owned()
        })?;
    }
    if let Some(path) = &output {
        outputs::write(&shown, path, &args.picture.aov, args.out.force)?;
    }
    print_times(name, &shown, output.as_deref(), args.repeat, console)?;
    if let (Some(expected), Some(found)) = (&args.expect_hash, &hash)
        && !expected.eq_ignore_ascii_case(found)
    {
        return Err(CliError::new(
            Kind::Failed,
            format!("{name}: the picture's hash is {found}, expected {expected}"),
        ));
    }
    let mut result = report::drawn(name, opened.load_ms, &camera, &shown, hash.as_deref());
    result["output"] = json!(output.as_deref().map(names::of_path));
    result["is_verified"] = json!(opened.is_verified());
    Ok((camera, opened.engine, result))
}

/// Prints how long drawing took, and with `--verbose` what was counted.
fn print_times(
    name: &str,
    shown: &Shown<'_>,
    output: Option<&Path>,
    repeat: u32,
    console: &Console,
) -> Result<(), CliError> {
    let times = Summary::of(shown.times_ms);
    let counters = shown.counters.iter();
    let counters = counters.map(|(name, count)| [(*name).to_owned(), report::figure(count)]);
    if repeat > 1 && !console.json {
        let ms = |name: &str, ms: f64| [name.to_owned(), format!("{ms:.3}")];
        let times = [
            ["runs".to_owned(), repeat.to_string()],
            ms("min ms", times.min_ms),
            ms("median ms", times.median_ms),
            ms("max ms", times.max_ms),
        ];
        let rows = times.into_iter().chain(counters.clone()).map(Vec::from);
        let head = vec![name.to_owned(), "one frame".to_owned()];
        console.data(report::table(head, rows.collect()))?;
    }
    if let Some(path) = output {
        console.note(format!(
            "{}: drawn in {:.1} ms",
            path.display(),
            times.median_ms
        ));
    }
    for [name, count] in counters {
        console.detail(format!("  {name}: {count}"));
    }
    Ok(())
}

/// The resolved settings of a run.
fn settings(
    args: &RenderArgs,
    names: Vec<String>,
    engines: &[EngineName],
    camera: Option<&Camera>,
) -> Vec<Setting> {
    // One for all scenes, or none.
    let engine = engines.first().copied();
    let engine = engine.filter(|first| engines.iter().all(|engine| engine == first));
    let mut settings = vec![("scene", names.into())];
    if let Some(output) = &args.output {
        settings.push(("output", names::of_path(output).into()));
    }
    settings.extend(camera.map_or_else(|| args.camera.settings(), camera_settings));
    settings.extend(args.picture.settings());
    settings.extend(args.engine.settings(engine));
    settings.extend(args.scene.settings());
    if args.repeat > 1 {
        settings.push(("repeat", i64::from(args.repeat).into()));
    }
    settings
}
