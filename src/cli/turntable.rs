//! `turntable`: many frames around a scene in one process.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use serde_json::{Value, json};

use super::args::{CameraArgs, EngineArgs, OutputArgs, PictureArgs, SceneArgs, Setting};
use super::console::Console;
use super::drawing::{Drawing, milliseconds_since, min_median_max};
use super::error::CliError;
use super::fit::{Bounds, Up};
use super::mesh_view::{self, DrawArgs, FileEngine, MeshDrawn};
use super::render::{choose_scenes, open};
use super::{outputs, report};
use crate::picture::png::Pixels;
use crate::picture::{self, Rows};
use crate::project::Camera;

/// Arguments of `turntable`.
#[derive(Debug, Args)]
pub struct TurntableArgs {
    /// Scene: a file (also .far and .tvx), or a generator such as gen:terrain,depth=10,seed=1
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
    let mut turn = Turn {
        args,
        name,
        paths: &paths,
        times_ms: Vec::new(),
        results: Vec::new(),
    };
    match mesh_view::engine_of(name, args.engine.engine) {
        Some(engine) => turn.file(engine, console)?,
        None => turn.scene(console)?,
    }
    let (min, median, max) = min_median_max(&turn.times_ms);
    let document = report::document(
        "turntable",
        json!({ "frames": turn.results, "render_ms": { "min": min, "median": median, "max": max } }),
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

/// The frames of a turn, as they are drawn.
struct Turn<'t> {
    args: &'t TurntableArgs,
    name: &'t str,
    paths: &'t [PathBuf],
    times_ms: Vec<f64>,
    results: Vec<Value>,
}

impl Turn<'_> {
    /// Draws a voxel scene.
    fn scene(&mut self, console: &Console) -> Result<(), CliError> {
        let args = self.args;
        args.engine.check_of_voxels().map_err(CliError::usage)?;
        let scene = open(
            self.name,
            &args.engine.rules.scene_args(&args.scene),
            console,
        )?;
        let mut drawing = Drawing::new(
            &scene,
            &args.engine,
            &args.picture,
            args.hash || console.json,
        )
        .map_err(|e| e.at(self.name))?;
        let bounds = Bounds::of(&scene.graph);
        self.frames(&bounds, scene.up, console, |camera, keeper| {
            drawing.draw(camera)?;
            let (drawn, rows) = drawing.shown()?;
            let hash = keeper.keep(&drawn.pixels, &rows)?;
            let times_ms = drawn.times_ms.clone();
            Ok((
                times_ms,
                report::drawn(&scene, camera, drawn, hash.as_deref()),
            ))
        })
    }

    /// Draws a file that an engine of its own draws.
    fn file(&mut self, engine: &FileEngine, console: &Console) -> Result<(), CliError> {
        let args = self.args;
        let draw_args = DrawArgs {
            engine: &args.engine,
            picture: &args.picture,
            scene: &args.scene,
            memory: None,
        };
        let started = Instant::now();
        let name = self.name;
        engine.open(name, draw_args, &mut |file| {
            let load_ms = milliseconds_since(started);
            let up = args.scene.up_or(file.up());
            self.frames(&file.bounds(), up, console, |camera, keeper| {
                let started = Instant::now();
                let (picture, counters) = file.draw(camera)?;
                let times_ms = vec![milliseconds_since(started)];
                let pixels = Pixels::new(picture.width, picture.height, picture.rgba.clone());
                let hash = keeper.keep(&pixels, &picture)?;
                let drawn = MeshDrawn {
                    name,
                    engine: engine.name,
                    camera,
                    picture: &picture,
                    load_ms,
                    times_ms: &times_ms,
                    counters,
                    memory: file.memory(),
                };
                let result = drawn.describe(hash.as_deref());
                Ok((times_ms, result))
            })
        })
    }

    /// Has all frames drawn by `draw`, which is handed a camera and what keeps a picture.
    /// It gives times and what to say of the frame.
    fn frames(
        &mut self,
        bounds: &Bounds,
        up: Up,
        console: &Console,
        mut draw: impl FnMut(&Camera, &Keeper<'_>) -> Result<(Vec<f64>, Value), CliError>,
    ) -> Result<(), CliError> {
        let args = self.args;
        // One distance for all frames, so that the object does not breathe.
        let bounds = bounds.revolved(up);
        console.progress().begin("drawing", u64::from(args.frames));
        for (frame, path) in self.paths.iter().enumerate() {
            let turn = 360.0 * frame as f64 / f64::from(args.frames);
            let size = args.picture.size();
            let camera = args.camera.camera(&bounds, up, size, turn);
            let keeper = Keeper {
                args,
                path,
                console,
            };
            let (times_ms, mut result) = draw(&camera, &keeper)
                .map_err(|e| e.at(format!("{}, frame {frame}", self.name)))?;
            self.times_ms.extend(times_ms);
            result["output"] = json!(path);
            self.results.push(result);
            console.progress().advance(1);
        }
        console.progress().end();
        Ok(())
    }
}

/// Keeps a frame's picture.
struct Keeper<'k> {
    args: &'k TurntableArgs,
    path: &'k Path,
    console: &'k Console,
}

impl Keeper<'_> {
    /// Writes a picture; gives its hash where that is wanted.
    fn keep<R: Rows>(&self, pixels: &Pixels, picture: &R) -> Result<Option<String>, CliError>
    where
        CliError: From<R::Error>,
    {
        let Self {
            args,
            path,
            console,
        } = self;
        outputs::write(pixels, picture, path, &args.picture.aov, args.out.force)?;
        if !args.hash && !console.json {
            return Ok(None);
        }
        let hash = picture::hash_rows(picture)?;
        if args.hash && !console.json {
            console.data(format!("{hash}  {}", path.display()))?;
        }
        Ok(Some(hash))
    }
}

fn settings(args: &TurntableArgs, names: Vec<String>) -> Vec<Setting> {
    let output = args.output.to_string_lossy().into_owned();
    let engine = mesh_view::one_engine(&names, args.engine.engine);
    let mut settings: Vec<Setting> = vec![
        ("scene", names.into()),
        ("output", output.into()),
        ("frames", i64::from(args.frames).into()),
    ];
    settings.extend(args.camera.settings());
    settings.extend(args.picture.settings());
    settings.extend(args.engine.settings(engine));
    settings.extend(args.scene.settings());
    settings
}

/// The pattern with its run of `#` replaced by each frame's number.
fn frame_paths(pattern: &Path, frames: u32) -> Result<Vec<PathBuf>, CliError> {
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
