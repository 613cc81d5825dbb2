//! `turntable`: many frames around a scene in one process.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::args::{CameraArgs, EngineArgs, OutputArgs, PictureArgs, SceneArgs, Setting};
use super::console::Console;
use super::drawing::{Drawing, min_median_max};
use super::error::CliError;
use super::fit::Bounds;
use super::render::{choose_scenes, open};
use super::{outputs, report};
use crate::picture;

/// Arguments of `turntable`.
#[derive(Debug, Args)]
pub struct TurntableArgs {
    /// Scene: a file, or a generator such as gen:terrain,depth=10,seed=1
    #[arg(value_name = "SCENE")]
    pub scene_name: Option<String>,
    /// Pictures to write; #### stands for the frame's number, from 0
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Frames of a full turn
    #[arg(long, value_name = "N", default_value_t = 36,
          value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: u32,
    /// Print each picture's hash
    #[arg(long)]
    pub hash: bool,
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

/// Draws all frames; the first failure stops.
///
/// # Errors
/// A wrong command line, a bad scene, or a frame that fails.
pub(super) fn run(
    args: &TurntableArgs,
    from_config: Vec<String>,
    console: &Console,
) -> Result<(), CliError> {
    let given: Vec<String> = args.scene_name.iter().cloned().collect();
    let names = choose_scenes(&given, from_config)?;
    let [name] = names.as_slice() else {
        return Err(CliError::usage("a turntable shows one scene"));
    };
    args.camera.check().map_err(CliError::usage)?;
    if args.camera.eye.is_some() {
        return Err(
            CliError::usage("a turntable places its own cameras").advise(
                "use --view, --azimuth, --elevation and --zoom instead of --eye and --target",
            ),
        );
    }
    outputs::check_picture_name(&args.output)?;
    let paths = frame_paths(&args.output, args.frames)?;
    for path in &paths {
        outputs::check_free(&outputs::paths(path, &args.picture.aov), args.out.force)?;
    }
    if let Some(outdir) = &args.out.outdir {
        outputs::check_free(&outputs::record_paths(outdir), args.out.force)?;
    }
    let scene = open(name, &args.scene, console)?;
    // One distance for all frames, so that the object does not breathe.
    let bounds = Bounds::of(&scene.graph).revolved(scene.up);
    let mut drawing = Drawing::new(&scene, &args.engine, &args.picture).map_err(|e| e.at(name))?;
    let mut times = Vec::new();
    let mut results = Vec::new();
    console.progress().begin("drawing", u64::from(args.frames));
    for (frame, path) in paths.iter().enumerate() {
        let turn = 360.0 * frame as f64 / f64::from(args.frames);
        let camera = args
            .camera
            .camera(&bounds, scene.up, args.picture.size(), turn);
        let drawn = drawing
            .draw(&camera)
            .map_err(|e| e.at(format!("{name}, frame {frame}")))?;
        outputs::write(&drawn.picture, path, &args.picture.aov, args.out.force)?;
        let hash = (args.hash || console.json).then(|| picture::hash(&drawn.picture));
        if let (true, false, Some(hash)) = (args.hash, console.json, &hash) {
            console.data(format!("{hash}  {}", path.display()))?;
        }
        times.extend(&drawn.times_ms);
        let mut result = report::drawn(&scene, &camera, drawn, hash.as_deref());
        result["output"] = json!(path);
        results.push(result);
        console.progress().advance(1);
    }
    console.progress().end();
    let (min, median, max) = min_median_max(&times);
    let document = report::document(
        "turntable",
        json!({ "frames": results, "render_ms": { "min": min, "median": median, "max": max } }),
    );
    if console.json {
        console.document(&document)?;
    }
    console.note(format!(
        "{} frames drawn, {median:.1} ms each ({min:.1} to {max:.1})",
        args.frames
    ));
    if let Some(outdir) = &args.out.outdir {
        outputs::write_record(outdir, settings(args, names), &document, args.out.force)?;
    }
    Ok(())
}

fn settings(args: &TurntableArgs, names: Vec<String>) -> Vec<Setting> {
    let output = args.output.to_string_lossy().into_owned();
    let mut settings: Vec<Setting> = vec![
        ("scene", names.into()),
        ("output", output.into()),
        ("frames", i64::from(args.frames).into()),
    ];
    settings.extend(args.camera.settings());
    settings.extend(args.picture.settings());
    settings.extend(args.engine.settings());
    settings.extend(args.scene.settings());
    settings
}

/// The pattern with its run of `#` replaced by each frame's number.
fn frame_paths(pattern: &std::path::Path, frames: u32) -> Result<Vec<PathBuf>, CliError> {
    let text = pattern.to_string_lossy();
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
    Ok((0..frames)
        .map(|frame| format!("{before}{frame:0width$}{after}").into())
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn numbered_names() {
        let paths = frame_paths(Path::new("out/f##.png"), 11).unwrap();
        assert_eq!(paths[0], Path::new("out/f00.png"));
        assert_eq!(paths[10], Path::new("out/f10.png"));
        for bad in ["out/f.png", "#/a#.png"] {
            assert!(frame_paths(Path::new(bad), 2).is_err());
        }
    }
}
