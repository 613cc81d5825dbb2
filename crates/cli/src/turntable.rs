//! `turntable`: many frames around a scene in one process.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::args::{
    CameraArgs, EngineArgs, EngineName, OutputArgs, PictureArgs, SceneArgs, Setting,
};
use super::console::Console;
use super::error::CliError;
use super::methods::{self, DrawArgs};
use super::{names, outputs, report, scenes};
use shiftvox::drawing::Shown;
use shiftvox::picture;
use shiftvox_lab::bench::Summary;

/// Arguments of `turntable`.
#[derive(Debug, Args)]
pub struct TurntableArgs {
    /// Scene: a file (also .far and .tvx), or a generator such as gen:terrain,depth=10,seed=1
    #[arg(value_name = "SCENE", value_parser = crate::names::parser())]
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
    let names = scenes::choose(&given, from_config)?;
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
    let (buffers, size) = (&args.picture.aov, args.picture.size());
    outputs::check_room(&args.output, buffers, size, paths.len())?;
    if let Some(outdir) = &args.out.outdir {
        outputs::check_free(&outputs::record_paths(outdir), args.out.force)?;
    }
    let Turn {
        engine,
        times_ms,
        results,
    } = draw(args, name, &paths, console)?;
    let Summary {
        min_ms: min,
        median_ms: median,
        max_ms: max,
        ..
    } = Summary::of(&times_ms);
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
        outputs::write_record(
            outdir,
            settings(args, names, engine),
            &document,
            args.out.force,
        )?;
    }
    Ok(())
}

/// The frames of a turn, drawn.
struct Turn {
    engine: EngineName,
    times_ms: Vec<f64>,
    results: Vec<Value>,
}

/// Draws all frames and writes them.
fn draw(
    args: &TurntableArgs,
    name: &str,
    paths: &[PathBuf],
    console: &Console,
) -> Result<Turn, CliError> {
    let draw_args = DrawArgs {
        engine: &args.engine,
        picture: &args.picture,
        scene: &args.scene,
        memory: None,
        is_hashed: args.hash || console.json,
    };
    let opened = methods::open(name, &draw_args, console)?;
    let mut drawable = opened.drawable(&draw_args).map_err(|e| e.at(name))?;
    let up = args.scene.up_or(drawable.up());
    // One distance for all frames, so that the object does not breathe.
    let bounds = drawable.bounds().revolved(up);
    let mut turn = Turn {
        engine: opened.engine,
        times_ms: Vec::new(),
        results: Vec::new(),
    };
    console.progress().begin("drawing", u64::from(args.frames));
    for (frame, path) in paths.iter().enumerate() {
        let degrees = 360.0 * frame as f64 / f64::from(args.frames);
        let size = args.picture.size();
        let camera = args.camera.camera(&bounds, up, size, degrees);
        let result = (|| {
            let shown = methods::frame(&mut *drawable, &camera, 1)?;
            let hash = keep(args, &shown, path, console)?;
            turn.times_ms.extend(shown.times_ms);
            let load_ms = opened.load_ms;
            Ok::<_, CliError>(report::drawn(
                name,
                load_ms,
                &camera,
                &shown,
                hash.as_deref(),
            ))
        })();
        let mut result = result.map_err(|e| e.at(format!("{name}, frame {frame}")))?;
        result["output"] = json!(names::of_path(path));
        turn.results.push(result);
        console.progress().advance(1);
    }
    console.progress().end();
    Ok(turn)
}

/// Writes a frame's picture; gives its hash where that is wanted.
fn keep(
    args: &TurntableArgs,
    shown: &Shown<'_>,
    path: &Path,
    console: &Console,
) -> Result<Option<String>, CliError> {
    outputs::write(shown, path, &args.picture.aov, args.out.force)?;
    if !args.hash && !console.json {
        return Ok(None);
    }
    let hash = picture::hash_rows(&shown.buffers)?;
    if args.hash && !console.json {
        console.data(format!("{hash}  {}", path.display()))?;
    }
    Ok(Some(hash))
}

fn settings(args: &TurntableArgs, scenes: Vec<String>, engine: EngineName) -> Vec<Setting> {
    let output = names::of_path(&args.output);
    let mut settings: Vec<Setting> = vec![
        ("scene", scenes.into()),
        ("output", output.into()),
        ("frames", i64::from(args.frames).into()),
    ];
    settings.extend(args.camera.settings());
    settings.extend(args.picture.settings());
    settings.extend(args.engine.settings(Some(engine)));
    settings.extend(args.scene.settings());
    settings
}

/// The pattern with its run of `#` replaced by each frame's number.
fn frame_paths(pattern: &Path, frames: u32) -> Result<Vec<PathBuf>, CliError> {
    let text = names::of_path(pattern);
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
        .map(|frame| names::path(&format!("{before}{frame:0width$}{after}")))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

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
