//! `render`: a picture of each scene.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::args::{
    CameraArgs, DataBudget, EngineArgs, OutputArgs, PictureArgs, SceneArgs, Setting, camera_line,
    camera_settings,
};
use super::console::Console;
use super::drawing::{Drawn, draw, min_median_max};
use super::error::{CliError, Kind};
use super::fit::Bounds;
use super::scenes::Scene;
use super::{mesh_view, outputs, report, scenes};
use crate::picture;
use crate::project::Camera;

/// Arguments of `render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// Scenes: files, or generators such as gen:terrain,depth=10,seed=1
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// Picture to write; {stem} stands for the scene's name
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the same frame N times and report the least, middle and greatest time
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(1..))]
    pub repeat: u32,
    /// Of .far files: keep at most this much of the nodes' data in memory: 512M, 2G [default: as the system decides]
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

/// Draws all scenes; a scene that fails is told and does not stop the others.
///
/// # Errors
/// The first scene's failure, or a wrong command line.
pub(super) fn run(
    args: &RenderArgs,
    from_config: Vec<String>,
    console: &Console,
) -> Result<(), CliError> {
    let names = choose_scenes(&args.scenes, from_config)?;
    check(args, names.len())?;
    check_distinct(args, &names)?;
    let mut results = Vec::new();
    let mut resolved = None;
    let mut first_failure: Option<CliError> = None;
    let mut failed = 0;
    for name in &names {
        match render_one(args, name, names.len(), console) {
            Ok((camera, result)) => {
                resolved = Some(camera);
                results.push(result);
            }
            Err(error) if names.len() == 1 || error.kind == Kind::Pipe => return Err(error),
            Err(error) => {
                console.error(&error);
                failed += 1;
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
        let settings = settings(args, names.clone(), one.as_ref());
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

/// Scenes of the command line, or else of the configuration file.
pub(super) fn choose_scenes(
    given: &[String],
    from_config: Vec<String>,
) -> Result<Vec<String>, CliError> {
    let names = if given.is_empty() {
        from_config
    } else {
        given.to_vec()
    };
    if names.is_empty() {
        return Err(CliError::usage("no scene was given")
            .advise("name a file or a generator such as gen:terrain,depth=10,seed=1"));
    }
    Ok(names)
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
        (Some(output), _) => Some(output.to_string_lossy().replace("{stem}", stem).into()),
        (None, Some(outdir)) => Some(outdir.join(format!("{stem}.png"))),
        (None, None) => None,
    }
}

fn render_one(
    args: &RenderArgs,
    name: &str,
    of: usize,
    console: &Console,
) -> Result<(Camera, Value), CliError> {
    if let Some(engine) = mesh_view::engine_of(name, args.engine.engine) {
        let output = output_path(args, &scenes::stem(name));
        return engine.render_one(args, name, of, output.as_deref(), console);
    }
    if args.memory.is_some() {
        return Err(CliError::usage("--memory is for .far files"));
    }
    args.engine.check_of_voxels().map_err(CliError::usage)?;
    let scene = open(name, &args.engine.rules.scene_args(&args.scene), console)?;
    let output = output_path(args, &scene.stem);
    if let Some(path) = &output {
        outputs::check_free(&outputs::paths(path, &args.picture.aov), args.out.force)?;
    }
    let bounds = Bounds::of(&scene.graph);
    let camera = args
        .camera
        .camera(&bounds, scene.up, args.picture.size(), 0.0);
    if args.print_camera && !console.json {
        console.data(camera_line(&camera))?;
    }
    let is_hashed = args.hash || args.expect_hash.is_some() || console.json;
    let drawing = draw(
        &scene,
        &camera,
        &args.engine,
        &args.picture,
        args.repeat,
        is_hashed,
    )
    .map_err(|e| e.at(name))?;
    let (drawn, rows) = drawing.shown()?;
    let hash = match is_hashed {
        true => Some(picture::hash_rows(&rows).map_err(|e| CliError::from(e).at(name))?),
        false => None,
    };
    if args.hash && !console.json {
        let hash = hash.as_deref().unwrap_or_default();
        let line = if of > 1 {
            format!("{hash}  {name}")
        } else {
            hash.to_owned()
        };
        console.data(line)?;
    }
    if let Some(path) = &output {
        outputs::write(
            &drawn.pixels,
            &rows,
            path,
            &args.picture.aov,
            args.out.force,
        )?;
    }
    tell(&scene, drawn, output.as_deref(), args.repeat, console)?;
    if let (Some(expected), Some(found)) = (&args.expect_hash, &hash)
        && !expected.eq_ignore_ascii_case(found)
    {
        return Err(CliError::new(
            Kind::Failed,
            format!("{name}: the picture's hash is {found}, expected {expected}"),
        ));
    }
    let mut result = report::drawn(&scene, &camera, drawn, hash.as_deref());
    result["output"] = json!(output);
    Ok((camera, result))
}

/// Opens a scene and tells its warnings.
pub(super) fn open(name: &str, args: &SceneArgs, console: &Console) -> Result<Scene, CliError> {
    let scene = scenes::open(name, args, console.progress())?;
    for warning in &scene.warnings {
        console.note(format!("{name}: {warning}"));
    }
    if let Some(mesh) = &scene.mesh {
        let said = if args.depth.is_some() {
            ""
        } else {
            ", the default; --depth says another"
        };
        console.note(format!(
            "{name}: {} triangles voxelised with {} levels{said}: {} voxels in {:.1} ms",
            report::grouped(mesh.triangles),
            mesh.depth,
            report::grouped(scene.graph.voxels),
            mesh.voxelize_ms
        ));
    }
    console.detail(format!(
        "{name}: {} voxels, {} nodes, {} levels, read and built in {:.1} ms",
        report::grouped(scene.graph.voxels),
        report::grouped(scene.graph.len() as u64),
        scene.graph.depth,
        scene.load_ms
    ));
    Ok(scene)
}

fn tell(
    scene: &Scene,
    drawn: &Drawn,
    output: Option<&Path>,
    repeat: u32,
    console: &Console,
) -> Result<(), CliError> {
    let (min, median, max) = min_median_max(&drawn.times_ms);
    if repeat > 1 && !console.json {
        let mut rows = vec![
            vec!["runs".to_owned(), repeat.to_string()],
            vec!["min ms".to_owned(), format!("{min:.3}")],
            vec!["median ms".to_owned(), format!("{median:.3}")],
            vec!["max ms".to_owned(), format!("{max:.3}")],
        ];
        let pages = report::page_counters(scene);
        let counters = drawn.stats.iter().chain(&pages);
        rows.extend(counters.map(|&(name, count)| vec![name.to_owned(), report::grouped(count)]));
        let head = vec![scene.source.clone(), "one frame".to_owned()];
        console.data(report::table(head, rows))?;
    }
    if let Some(path) = output {
        console.note(format!("{}: drawn in {median:.1} ms", path.display()));
    }
    for (name, count) in drawn.stats.iter().chain(&report::page_counters(scene)) {
        console.detail(format!("  {name}: {}", report::grouped(*count)));
    }
    Ok(())
}

/// The resolved settings of a run.
fn settings(args: &RenderArgs, names: Vec<String>, camera: Option<&Camera>) -> Vec<Setting> {
    let engine = mesh_view::one_engine(&names, args.engine.engine);
    let mut settings = vec![("scene", names.into())];
    if let Some(output) = &args.output {
        settings.push(("output", output.to_string_lossy().into_owned().into()));
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
