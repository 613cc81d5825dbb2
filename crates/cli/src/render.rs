//! `render`: a picture of each scene.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::args::bytes;
use super::batch::{self, Job, Part};
use super::console::Console;
use super::error::{CliError, Kind};
use super::methods::{self, DrawFlags};
use super::{outputs, report};
use shiftvox::drawing::{DrawError, Shown};
use shiftvox::frame::count_samples;
use shiftvox::project::Stop;
use shiftvox::whole;
use shiftvox_lab::bench::Summary;

#[derive(Debug, Args)]
pub(super) struct RenderArgs {
    /// Scenes: files, folders of files, or generators such as gen:terrain,depth=10,seed=1
    #[arg(value_name = "SCENE", required = true)]
    scenes: Vec<String>,
    /// Picture to write, with {stem} in place of the scene's name, or a folder [default: {stem}.png, but
    /// none with --hash, --expect-hash, --print-camera or --repeat]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write only files that do not exist, and leave out scenes that have them all
    #[arg(long, conflicts_with_all = ["force", "hash", "expect_hash"])]
    resume: bool,
    /// Draw part K of N of the scenes, to share a batch among computers
    #[arg(long, value_name = "K/N", value_parser = batch::part)]
    part: Option<Part>,
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
    flags: DrawFlags,
}

/// Samples of a picture that is drawn before a second thread has started.
const FEW_SAMPLES: u64 = 1 << 14;

impl RenderArgs {
    /// Whether more threads would cost time: a small picture of a file that is not read whole.
    pub(super) fn is_small(&self) -> bool {
        let (width, height) = self.flags.picture.size();
        let samples = (u64::from(width) * u64::from(height)) << (2 * self.flags.picture.aa_log2());
        let is_mapped = matches!(&self.scenes[..], [scene] if scene.ends_with(".vxg"));
        is_mapped && samples <= FEW_SAMPLES
    }
}

pub(super) fn run(args: &RenderArgs, console: &Console) -> Result<(), CliError> {
    check(args)?;
    let answers = args.hash || args.expect_hash.is_some() || args.print_camera || args.repeat > 1;
    let is_needed = !answers || !args.flags.picture.aov.is_empty() || args.resume;
    let jobs = batch::jobs(&args.scenes, args.output.as_deref(), is_needed, args.part)?;
    let is_batch = jobs.len() > 1 || args.part.is_some();
    let draw = |job: &Job| render_one(args, job, is_batch, console);
    batch::each("render", &jobs, |job| &job.scene, console, draw)
}

fn check(args: &RenderArgs) -> Result<(), CliError> {
    args.flags.camera.check().map_err(CliError::usage)?;
    if let Some(expected) = &args.expect_hash
        && !(expected.len() == 32 && expected.bytes().all(|b| b.is_ascii_hexdigit()))
    {
        return Err(CliError::usage("--expect-hash takes 32 hexadecimal digits"));
    }
    let (width, height) = args.flags.picture.size();
    count_samples(width, height, args.flags.picture.aa_log2()).map_err(DrawError::from)?;
    Ok(())
}

fn render_one(
    args: &RenderArgs,
    job: &Job,
    is_one_of_many: bool,
    console: &Console,
) -> Result<Value, CliError> {
    let name = &job.scene;
    let files = job.picture.as_deref();
    let files = files.map_or_else(Vec::new, |path| {
        outputs::paths(path, &args.flags.picture.aov)
    });
    let mut missing = files.clone();
    missing.retain(|path| !(args.resume && path.is_file()));
    if args.resume && missing.is_empty() {
        console.detail(format!("{}: exists, left out", files[0].display()));
        return Ok(json!({ "scene": name, "output": job.picture, "is_left_out": true }));
    }
    let is_hashed = args.hash || args.expect_hash.is_some() || console.json;
    let draw_args = args.flags.draw_args(args.memory, is_hashed);
    let size = args.flags.picture.size();
    let output = &job.picture;
    if let Some(path) = output {
        outputs::check_free(&missing, args.force)?;
        outputs::check_room(path, &args.flags.picture.aov, size, 1)?;
    }
    let opened = methods::open(name, &draw_args, console)?;
    let drawable = opened.drawable(&draw_args, &Stop::default());
    let mut drawable = drawable.map_err(|e| e.at(name))?;
    let up = args.flags.scene.up_or(drawable.up());
    let camera = args.flags.camera.camera(&drawable.bounds(), up, size, 0.0);
    if args.print_camera && !console.json {
        console.data(camera.flags())?;
    }
    let shown = methods::frame(&mut *drawable, &camera, args.repeat).map_err(|e| e.at(name))?;
    let hash = methods::hash(&shown, is_hashed).map_err(|e| e.at(name))?;
    if let Some(hash) = hash.as_deref().filter(|_| args.hash && !console.json) {
        console.data(match is_one_of_many {
            false => hash.to_owned(),
            true => format!("{hash}  {name}"),
        })?;
    }
    if let Some(path) = output {
        let replace = args.force || args.resume;
        let mut made = outputs::prepare(&shown, path, &args.flags.picture.aov, replace)?;
        made.retain(|file| !(args.resume && file.path().is_file()));
        whole::keep(made)?;
    }
    print_times(name, &shown, output.as_deref(), args.repeat, console)?;
    if let (Some(expected), Some(found)) = (&args.expect_hash, &hash)
        && !expected.eq_ignore_ascii_case(found)
    {
        let message = format!("{name}: the picture's hash is {found}, expected {expected}");
        return Err(CliError::new(Kind::Failed, message));
    }
    let mut result = report::drawn(name, opened.load_ms, &camera, &shown, hash.as_deref());
    result["output"] = json!(output);
    result["is_verified"] = json!(opened.is_verified);
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
        let table = report::table(&["", "one_frame"], &rows);
        console.data(format!("{name}\n{table}"))?;
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
