//! Opening of scenes, for every command.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use super::args::SceneArgs;
use super::console::Console;
use super::error::{CliError, Kind};
use super::fatal_signals;
use shiftvox::drawing::milliseconds_since;
use shiftvox::graph::{BuildError, Crop, Graph, Progress};
use shiftvox::project::Up;
use shiftvox::scene::{self, FileKind, MeshSummary, NoMeshes, Opened, ReadOptions, Source};
use shiftvox_lab::report::grouped;
use shiftvox_mesh::open::{MeshOptions, OpenOptions, read_mesh};
use shiftvox_mesh::{ListFolder, Mesh};

/// Most voxels of a file that is dropped on a page: a small one may have runs without end.
const MOST_DROPPED_VOXELS: u64 = 1 << 26;

#[derive(Debug)]
pub(super) struct Scene {
    pub(super) graph: Graph,
    pub(super) source: String,
    pub(super) format: String,
    pub(super) up: Up,
    pub(super) mesh: Option<MeshSummary>,
    pub(super) palette: Option<usize>,
    pub(super) warnings: Vec<String>,
    pub(super) is_verified: bool,
    pub(super) load_ms: f64,
}

/// A scene of an experiment or a model: all of it is verified.
pub(super) fn open(name: &str, args: &SceneArgs, console: &Console) -> Result<Scene, CliError> {
    let (started, source) = (Instant::now(), Source::find(name)?);
    open_source(source, name, args, u64::MAX, started, console)
}

/// As [`open`], for a source that was found at `started`. Only the header of a graph file of more than `verify_up_to`
/// bytes is verified.
pub(super) fn open_source(
    source: Source,
    name: &str,
    args: &SceneArgs,
    verify_up_to: u64,
    started: Instant,
    console: &Console,
) -> Result<Scene, CliError> {
    fatal_signals::reads(name);
    let mut options = options(args);
    options.voxels.verify_up_to = verify_up_to;
    let opened = scene::open_source(source, &options.voxels, &options.mesh, console.progress())?;
    let mut scene = ready(opened, name, args.mesh_up, started);
    if let Some(crop) = &args.crop {
        scene.graph = cropped(&scene.graph, name, crop, console.progress())?;
    }
    if !scene.is_verified {
        console.note(format!(
            "{name}: not verified, so that only what is seen is read; `shiftvox info` checks it all"
        ));
    }
    for warning in &scene.warnings {
        console.note(format!("{name}: {warning}"));
    }
    if let Some(mesh) = &scene.mesh {
        let said = match args.depth {
            Some(_) => "",
            None => ", the default; --depth sets another",
        };
        console.note(format!(
            "{name}: {} triangles voxelised with {} levels{said}: {} voxels in {:.1} ms",
            grouped(mesh.triangles),
            mesh.depth,
            grouped(scene.graph.voxels),
            mesh.voxelize_ms
        ));
    }
    console.detail(format!(
        "{name}: {} voxels, {} nodes, {} levels, read and built in {:.1} ms",
        grouped(scene.graph.voxels),
        grouped(scene.graph.len() as u64),
        scene.graph.depth,
        scene.load_ms
    ));
    Ok(scene)
}

/// The part of a scene within a box.
pub(super) fn cropped(
    graph: &Graph,
    name: &str,
    crop: &Crop,
    progress: &dyn Progress,
) -> Result<Graph, CliError> {
    if !graph.opacity.is_empty() {
        let reason = "--crop keeps no opacities: leave out --opacities, or alpha";
        return Err(CliError::usage(reason));
    }
    graph.cropped(crop, progress).map_err(|error| match error {
        BuildError::Empty => CliError::usage(format!("{name}: --crop leaves no voxel")),
        error => CliError::new(Kind::Limit, format!("{name}: {error}")),
    })
}

/// As [`open_source`], of voxels in memory.
pub(super) fn open_bytes(name: &str, bytes: &[u8], args: &SceneArgs) -> Result<Scene, CliError> {
    let started = Instant::now();
    let (mut options, silent) = (options(args).voxels, shiftvox::graph::Silent);
    options.read.most_voxels = MOST_DROPPED_VOXELS;
    let opened = scene::open_bytes(bytes, name, &options, &NoMeshes, &silent);
    let opened = opened.map_err(|error| match error {
        scene::OpenError::NoMeshes(name) => CliError::input(format!(
            "{name}: this is a mesh, and a page takes files of voxels; start `shiftvox view` with it"
        )),
        error => error.into(),
    })?;
    Ok(ready(opened, name, args.mesh_up, started))
}

pub(super) fn is_mesh(name: &str) -> Result<bool, CliError> {
    Ok(Source::find(name)?.kind().is_some_and(FileKind::is_mesh))
}

pub(super) fn open_mesh(
    source: &str,
    args: &SceneArgs,
    within: Option<&Arc<ListFolder>>,
    console: &Console,
) -> Result<(Mesh, Up), CliError> {
    if source.starts_with("gen:") {
        return Err(CliError::input(format!(
            "{source}: a generator makes voxels, and a mesh is needed here"
        )));
    }
    if args.crop.is_some() {
        return Err(CliError::usage(
            "--crop is for voxels, and triangles are needed here",
        ));
    }
    fatal_signals::reads(source);
    let colors = args.mesh_colors;
    let (mesh, y_up) = read_mesh(Path::new(source), colors, within, console.progress())?;
    for warning in mesh.warnings() {
        console.note(format!("{source}: {warning}"));
    }
    Ok((mesh, args.up_or(Up::y_or_z(y_up))))
}

/// The bundled scene: a tree, see `assets/ATTRIBUTION.md`.
pub(super) fn demo(progress: &dyn Progress) -> Result<Scene, CliError> {
    let started = Instant::now();
    let name = "the bundled scene";
    let options = scene::OpenOptions::default();
    let opened = scene::open_bytes(scene::BUNDLED_TREE, name, &options, &NoMeshes, progress)?;
    Ok(ready(opened, name, None, started))
}

pub(super) fn options(args: &SceneArgs) -> OpenOptions {
    OpenOptions {
        voxels: scene::OpenOptions {
            read: ReadOptions {
                voxel_size: args.voxel_size,
                ..ReadOptions::default()
            },
            ..scene::OpenOptions::default()
        },
        mesh: MeshOptions {
            depth: args.mesh_depth(),
            mtl_colors: args.mesh_colors,
            opacities: args.opacities,
            y_up: args.mesh_up.map(|up| up == Up::Y),
        },
    }
}

fn ready(mut opened: Opened, source: &str, mesh_up: Option<Up>, started: Instant) -> Scene {
    let palette = opened.info.palette.len();
    if let (Some(up), Some(mesh)) = (mesh_up, &mut opened.graph.placement.mesh) {
        mesh.y_up = up == Up::Y;
    }
    Scene {
        source: source.to_owned(),
        format: opened.format,
        up: mesh_up.unwrap_or(Up::of(&opened.graph)),
        mesh: opened.mesh,
        palette: Some(palette).filter(|&entries| entries > 0),
        warnings: opened.info.warnings,
        graph: opened.graph,
        is_verified: opened.is_verified,
        load_ms: milliseconds_since(started),
    }
}

/// A scene's name without folder and ending, for `{stem}`.
pub(super) fn stem(source: &str) -> String {
    if Source::is_generated(source) {
        let name = source.trim_start_matches(scene::generate::PREFIX);
        return name.replace([',', '=', '/', '\\'], "-");
    }
    Path::new(source)
        .file_stem()
        .map_or_else(|| "scene".to_owned(), |s| s.to_string_lossy().into_owned())
}
