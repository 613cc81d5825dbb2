//! `render`: a picture of each scene.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::args::{CameraArgs, EngineArgs, PictureArgs, SceneArgs, bytes, camera_line};
use super::console::{self, Console};
use super::error::{CliError, Kind};
use super::methods::{self, DrawArgs};
use super::{outputs, report, scenes};
use shiftvox::drawing::{DrawError, Shown};
use shiftvox::frame::count_samples;
use shiftvox::picture;
use shiftvox_lab::bench::Summary;

#[derive(Debug, Args)]
pub(super) struct RenderArgs {
    /// Scenes: files, or generators such as gen:terrain,depth=10,seed=1
    #[arg(value_name = "SCENE", required = true)]
    scenes: Vec<String>,
    /// Picture to write, with {stem} in place of the scene's name
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Draw the same frame N times and report the least, middle and greatest time
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Keep at most this much of a .far file's data in memory, such as 512M [default: as the system
    /// decides]
    #[arg(long, value_name = "SIZE", value_parser = bytes)]
    memory: Option<u64>,
    /// Print the picture's hash
    #[arg(long)]
    hash: bool,
    /// Fail with exit code 3 if the picture has another hash
    #[arg(long, value_name = "HASH")]
    expect_hash: Option<String>,
    /// Print the camera as a line of flags to paste
    #[arg(long)]
    print_camera: bool,
    /// Replace existing files
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    picture: PictureArgs,
    #[command(flatten)]
    engine: EngineArgs,
    #[command(flatten)]
    scene: SceneArgs,
}

/// Draws all scenes. A scene that fails is reported and does not stop the others.
pub(super) fn run(args: &RenderArgs, console: &Console) -> Result<(), CliError> {
    let names = &args.scenes;
    check(args)?;
    let mut results = Vec::new();
    let mut failures: Vec<Kind> = Vec::new();
    for name in names {
        match render_one(args, name, console) {
            Ok(result) => results.push(result),
            Err(error) if names.len() == 1 || error.kind == Kind::Pipe => return Err(error),
            Err(error) => {
                console::report_error(&error);
                failures.push(error.kind);
                results.push(json!({ "scene": name, "error": error.message }));
            }
        }
    }
    console.report("render", json!({ "scenes": results }));
    match failures.first() {
        None => Ok(()),
        Some(&first) => {
            let (failed, all) = (failures.len(), names.len());
            let message = format!("{failed} of {all} scenes failed; see above");
            Err(CliError::new(first, message))
        }
    }
}

fn check(args: &RenderArgs) -> Result<(), CliError> {
    args.camera.check().map_err(CliError::usage)?;
    let answers = args.hash || args.expect_hash.is_some() || args.print_camera || args.repeat > 1;
    if args.output.is_none() && !answers {
        return Err(CliError::usage("no output was given").advise(
            "name the picture with -o FILE.png, or ask for --hash, --print-camera or --repeat N",
        ));
    }
    if let Some(expected) = &args.expect_hash
        && !(expected.len() == 32 && expected.bytes().all(|b| b.is_ascii_hexdigit()))
    {
        return Err(CliError::usage("--expect-hash takes 32 hexadecimal digits"));
    }
    let (width, height) = args.picture.size();
    count_samples(width, height, args.picture.aa_log2()).map_err(DrawError::from)?;
    let Some(output) = &args.output else {
        return match args.picture.aov.is_empty() {
            true => Ok(()),
            false => Err(CliError::usage(
                "--aov writes beside the picture: name it with -o FILE.png",
            )),
        };
    };
    outputs::check_picture_name(output)?;
    outputs::check_text(output)?;
    if args.scenes.len() > 1 && !output.to_string_lossy().contains("{stem}") {
        let (all, output) = (args.scenes.len(), output.display());
        let message = format!("{output}: {all} scenes would be written to one file");
        let advice = "put {stem} into the name, for example -o out/{stem}.png";
        return Err(CliError::usage(message).advise(advice));
    }
    let mut taken = HashSet::new();
    for name in &args.scenes {
        let path = output_path(output, name);
        if !taken.insert(path.clone()) {
            let message = format!("two scenes would both be drawn to {}", path.display());
            let advice = "draw them into different folders, one after the other";
            return Err(CliError::usage(message).advise(advice));
        }
    }
    Ok(())
}

fn output_path(output: &Path, scene: &str) -> PathBuf {
    match output.to_str() {
        Some(text) => text.replace("{stem}", &scenes::stem(scene)).into(),
        None => output.to_owned(),
    }
}

fn render_one(args: &RenderArgs, name: &str, console: &Console) -> Result<Value, CliError> {
    let is_hashed = args.hash || args.expect_hash.is_some() || console.json;
    let draw_args = DrawArgs {
        engine: &args.engine,
        picture: &args.picture,
        scene: &args.scene,
        memory: args.memory,
        is_hashed,
    };
    let size = args.picture.size();
    let output = args
        .output
        .as_deref()
        .map(|output| output_path(output, name));
    if let Some(path) = &output {
        outputs::check_free(&outputs::paths(path, &args.picture.aov), args.force)?;
        outputs::check_room(path, &args.picture.aov, size, 1)?;
    }
    let opened = methods::open(name, &draw_args, console)?;
    let mut drawable = opened.drawable(&draw_args).map_err(|e| e.at(name))?;
    let up = args.scene.up_or(drawable.up());
    let camera = args.camera.camera(&drawable.bounds(), up, size, 0.0);
    if args.print_camera && !console.json {
        console.data(camera_line(&camera))?;
    }
    let shown = methods::frame(&mut *drawable, &camera, args.repeat).map_err(|e| e.at(name))?;
    let hash = is_hashed.then(|| picture::hash_rows(&shown.buffers));
    let hash = hash.transpose().map_err(|e| CliError::from(e).at(name))?;
    if let Some(hash) = hash.as_deref().filter(|_| args.hash && !console.json) {
        console.data(match args.scenes.len() {
            1 => hash.to_owned(),
            _ => format!("{hash}  {name}"),
        })?;
    }
    if let Some(path) = &output {
        outputs::write(&shown, path, &args.picture.aov, args.force)?;
    }
    print_times(name, &shown, output.as_deref(), args.repeat, console)?;
    if let (Some(expected), Some(found)) = (&args.expect_hash, &hash)
        && !expected.eq_ignore_ascii_case(found)
    {
        let message = format!("{name}: the picture's hash is {found}, expected {expected}");
        return Err(CliError::new(Kind::Failed, message));
    }
    let mut result = report::drawn(name, opened.load_ms, &camera, &shown, hash.as_deref());
    result["output"] = json!(output.map(|path| path.display().to_string()));
    result["is_verified"] = json!(opened.is_verified());
    Ok(result)
}

fn print_times(
    name: &str,
    shown: &Shown<'_>,
    output: Option<&Path>,
    repeat: u32,
    console: &Console,
) -> Result<(), CliError> {
    let times = Summary::of(shown.times_ms);
    let counters = shown.counters.iter();
    let counters = counters.map(|(name, count)| vec![(*name).to_owned(), report::figure(count)]);
    if repeat > 1 && !console.json {
        let ms = |name: &str, ms: f64| vec![name.to_owned(), format!("{ms:.3}")];
        let mut rows = vec![
            vec!["runs".to_owned(), repeat.to_string()],
            ms("min ms", times.min_ms),
            ms("median ms", times.median_ms),
            ms("max ms", times.max_ms),
        ];
        rows.extend(counters.clone());
        console.data(report::table(&[name, "one frame"], rows))?;
    }
    if let Some(path) = output {
        let (path, ms) = (path.display(), times.median_ms);
        console.note(format!("{path}: drawn in {ms:.1} ms"));
    }
    for counter in counters {
        console.detail(format!("  {}", counter.join(": ")));
    }
    Ok(())
}
