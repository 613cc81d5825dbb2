//! `turntable`: many frames around a scene in one process.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::args::bytes;
use super::console::Console;
use super::error::CliError;
use super::methods::{self, DrawFlags};
use super::{outputs, report};
use shiftvox::project::{Camera, Stop};
use shiftvox_lab::bench::Summary;

#[derive(Debug, Args)]
pub(super) struct TurntableArgs {
    /// Scene: a file (also .far and .tvx), or a generator such as gen:terrain,depth=10,seed=1
    #[arg(value_name = "SCENE")]
    scene_name: String,
    /// Pictures to write, with #### in place of the frame's number from 0
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Frames of a full turn
    #[arg(long, value_name = "N", default_value_t = 36,
          value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: u32,
    /// Print each picture's hash
    #[arg(long)]
    hash: bool,
    /// Keep at most this much of the data of a .far file in memory, such as 512M
    #[arg(long, value_name = "SIZE", value_parser = bytes)]
    memory: Option<u64>,
    /// Replace existing files
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    flags: DrawFlags,
}

pub(super) fn run(args: &TurntableArgs, console: &Console) -> Result<(), CliError> {
    args.flags.camera.check().map_err(CliError::usage)?;
    if args.flags.camera.eye.is_some() {
        let advice = "use --view, --azimuth, --elevation and --zoom instead of --eye and --target";
        return Err(CliError::usage("a turntable places its own cameras").advise(advice));
    }
    outputs::check_picture_name(&args.output)?;
    let paths = frame_paths(&args.output, args.frames)?;
    let (buffers, size) = (&args.flags.picture.aov, args.flags.picture.size());
    for path in &paths {
        outputs::check_free(&outputs::paths(path, buffers), args.force)?;
    }
    outputs::check_room(&args.output, buffers, size, paths.len())?;
    let is_hashed = args.hash || console.json;
    let draw_args = args.flags.draw_args(args.memory, is_hashed);
    let name = &args.scene_name;
    let opened = methods::open(name, &draw_args, console)?;
    let drawable = opened.drawable(&draw_args, &Stop::default());
    let mut drawable = drawable.map_err(|e| e.at(name))?;
    let up = args.flags.scene.up_or(drawable.up());
    // One distance for all frames, so that the object keeps its size.
    let bounds = drawable.bounds().revolved(up);
    let mut times_ms = Vec::new();
    let mut draw = |camera: &Camera, path: &Path| -> Result<Value, CliError> {
        let shown = methods::frame(&mut *drawable, camera, 1)?;
        outputs::write(&shown, path, buffers, args.force)?;
        let hash = methods::hash(&shown, is_hashed)?;
        if let Some(hash) = hash.as_deref().filter(|_| !console.json) {
            console.data(format!("{hash}  {}", path.display()))?;
        }
        times_ms.extend(shown.times_ms);
        let mut result = report::drawn(name, opened.load_ms, camera, &shown, hash.as_deref());
        result["output"] = json!(path.display().to_string());
        Ok(result)
    };
    let mut results = Vec::new();
    console.progress().begin("drawing", u64::from(args.frames));
    for (frame, path) in paths.iter().enumerate() {
        let degrees = 360.0 * frame as f64 / f64::from(args.frames);
        let result = draw(&args.flags.camera.camera(&bounds, up, size, degrees), path);
        results.push(result.map_err(|e| e.at(format!("{name}, frame {frame}")))?);
        console.progress().advance(1);
    }
    console.progress().end();
    let times = Summary::of(&times_ms);
    let (min, median, max) = (times.min_ms, times.median_ms, times.max_ms);
    let times = json!({ "min": min, "median": median, "max": max });
    console.report(
        "turntable",
        json!({ "frames": results, "render_ms": times }),
    );
    let frames = args.frames;
    console.note(format!(
        "{frames} frames drawn, {median:.1} ms each ({min:.1} to {max:.1})"
    ));
    Ok(())
}

/// The pattern with its run of `#` replaced by each frame's number.
fn frame_paths(pattern: &Path, frames: u32) -> Result<Vec<PathBuf>, CliError> {
    let text = outputs::check_text(pattern)?;
    let wrong = || {
        CliError::usage(format!("{text}: the frames need different names"))
            .advise("put one run of # into the name, for example -o out/####.png")
    };
    let start = text.find('#').ok_or_else(wrong)?;
    let width = text[start..].bytes().take_while(|&b| b == b'#').count();
    let (before, after) = (&text[..start], &text[start + width..]);
    if after.contains('#') {
        return Err(wrong());
    }
    let path = |frame| format!("{before}{frame:0width$}{after}").into();
    Ok((0..frames).map(path).collect())
}
