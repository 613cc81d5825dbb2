//! The only place of the command line that opens, makes and converts scenes.

use std::io::Read;
use std::path::Path;
use std::time::Instant;

use super::args::{ColorName, OutOfBoundsName, SceneArgs, UpName};
use super::error::{CliError, Kind};
use super::fit::Up;
use super::mesh_view;
use crate::graph::{
    ExternalError, ExternalOptions, ExternalReport, Graph, MergeBy, Progress, Silent, Voxel, merge,
    vxg,
};
use crate::mesh::{ColorSpace, LoadOptions, Mesh, MeshError};
use crate::picture::store;
use crate::scene::{
    self, DETECT_BYTES, FileKind, MeshOptions, MeshSummary, OpenError, OpenOptions, Opened,
    OutOfBounds, ReadOptions, SceneError, detect_with_length,
};

/// The scene that the demo draws: a tree, see `assets/ATTRIBUTION.md`.
const DEMO: &[u8] = include_bytes!("../../assets/tree.vox");
/// Most voxels that are written to a voxel file.
const MAX_WRITTEN: u64 = 1 << 28;

/// A scene that is ready to be drawn.
#[derive(Debug)]
pub(super) struct Scene {
    /// What to draw.
    pub(super) graph: Graph,
    /// What the user called it.
    pub(super) source: String,
    /// Its name without folder and ending, for `{stem}`.
    pub(super) stem: String,
    /// The format, in words.
    pub(super) format: String,
    /// Which axis is up.
    pub(super) up: Up,
    /// What the mesh was, where it was one.
    pub(super) mesh: Option<MeshSummary>,
    /// Entries of the file's palette, if it has one.
    pub(super) palette: Option<usize>,
    /// What the user should know although the scene could be read.
    pub(super) warnings: Vec<String>,
    /// Time to read and build, milliseconds.
    pub(super) load_ms: f64,
}

/// What a conversion wrote.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Written {
    /// Voxels in the scene.
    pub(super) voxels: u64,
    /// Bytes written.
    pub(super) bytes: u64,
    /// What the user should know.
    pub(super) warnings: Vec<String>,
}

/// Whether a scene's name is a generator's specification.
#[must_use]
pub(super) fn is_spec(scene: &str) -> bool {
    scene.starts_with(scene::generate::PREFIX)
}

/// Opens a file or makes a `gen:` scene.
///
/// # Errors
/// A bad input with file, offset, what was expected and what to do.
pub(super) fn open(
    source: &str,
    args: &SceneArgs,
    progress: &dyn Progress,
) -> Result<Scene, CliError> {
    let started = Instant::now();
    let opened = scene::open(source, &options(args), progress)
        .map_err(|error| mesh_view::or_own_file(source, error.into()))?;
    Ok(ready(opened, source, stem(source), args.mesh_up, started))
}

/// Whether a scene is a file of triangles, told by its content; a `.ply` by its faces.
#[must_use]
pub(super) fn is_mesh_file(source: &str) -> bool {
    let mut beginning = Vec::new();
    let read = std::fs::File::open(source).and_then(|file| {
        let length = file.metadata()?.len();
        file.take(DETECT_BYTES as u64).read_to_end(&mut beginning)?;
        Ok(length)
    });
    match read.map(|length| detect_with_length(&beginning, length)) {
        Ok(Some(FileKind::Ply)) => beginning.windows(12).any(|w| w == b"element face"),
        Ok(Some(kind)) => kind.is_mesh(),
        _ => false,
    }
}

/// Reads a mesh for its triangles, and says which axis is up.
///
/// # Errors
/// A bad input with file, place, what was expected and what to do.
pub(super) fn open_mesh(
    source: &str,
    args: &SceneArgs,
    progress: &dyn Progress,
) -> Result<(Mesh, Up), CliError> {
    let (mesh, y_up) = scene::read_mesh(Path::new(source), &load_options(args), progress)
        .map_err(|error| mesh_view::or_own_file(source, error.into()))?;
    let y_up = args.mesh_up.map_or(y_up, |up| up == UpName::Y);
    Ok((mesh, if y_up { Up::Y } else { Up::Z }))
}

/// The bundled scene of the demo.
///
/// # Errors
/// None: the tests open it.
pub(super) fn demo(progress: &dyn Progress) -> Result<Scene, CliError> {
    let started = Instant::now();
    let name = "the bundled scene";
    let opened = scene::open_bytes(DEMO, name, &OpenOptions::default(), progress)?;
    Ok(ready(opened, name, "demo".to_owned(), None, started))
}

fn options(args: &SceneArgs) -> OpenOptions {
    let oob = match args.oob {
        OutOfBoundsName::Wrap => OutOfBounds::Wrap,
        OutOfBoundsName::Keep => OutOfBounds::Keep,
        OutOfBoundsName::Drop => OutOfBounds::Drop,
        OutOfBoundsName::Error => OutOfBounds::Error,
    };
    OpenOptions {
        read: ReadOptions {
            oob,
            ..ReadOptions::default()
        },
        mesh: MeshOptions {
            depth: args.mesh_depth(),
            load: load_options(args),
            opacities: args.opacities,
        },
    }
}

fn load_options(args: &SceneArgs) -> LoadOptions {
    LoadOptions {
        mtl_colors: match args.mesh_colors {
            ColorName::Srgb => ColorSpace::Srgb,
            ColorName::Linear => ColorSpace::Linear,
        },
        ..LoadOptions::default()
    }
}

fn ready(
    opened: Opened,
    source: &str,
    stem: String,
    mesh_up: Option<UpName>,
    started: Instant,
) -> Scene {
    let info = opened.info.as_ref();
    let y_up = match mesh_up {
        Some(up) => up == UpName::Y,
        None => opened.mesh.as_ref().is_some_and(|mesh| mesh.y_up),
    };
    Scene {
        source: source.to_owned(),
        stem,
        format: opened.format,
        up: if y_up { Up::Y } else { Up::Z },
        mesh: opened.mesh,
        palette: info.map(|i| i.palette.len()).filter(|&entries| entries > 0),
        warnings: info.map(|i| i.warnings.clone()).unwrap_or_default(),
        graph: opened.graph,
        load_ms: started.elapsed().as_secs_f64() * 1e3,
    }
}

impl From<OpenError> for CliError {
    fn from(error: OpenError) -> Self {
        let written = matches!(
            error,
            OpenError::External {
                error: ExternalError::Temporary { .. } | ExternalError::Write(_),
                ..
            }
        );
        let kind = if error.is_limit() {
            Kind::Limit
        } else if written {
            Kind::Run
        } else {
            Kind::Input
        };
        let failure = Self::new(kind, &error);
        match error {
            OpenError::Mesh(MeshError::Io { .. }) | OpenError::Scene(SceneError::Io { .. }) => {
                failure.advise("scenes are files or generators such as gen:terrain,depth=10,seed=1")
            }
            OpenError::TooMany { voxels, .. } if voxels >= u64::from(u32::MAX) => {
                failure.advise("ask for fewer levels: a graph has less than 2^32 nodes")
            }
            OpenError::TooMany { .. } => failure.advise(
                "build it outside memory: shiftvox convert SCENE OUT.vxg --memory 2G; then draw OUT.vxg",
            ),
            OpenError::External {
                error: ExternalError::Temporary { .. },
                ..
            } => failure.advise("choose a folder with more room with --temp"),
            _ => failure,
        }
    }
}

/// Writes a scene in the format that the output's ending names.
///
/// # Errors
/// An unknown format (usage), a file that exists, or a failed write.
pub(super) fn write(
    scene: &Scene,
    output: &Path,
    force: bool,
    progress: &dyn Progress,
) -> Result<Written, CliError> {
    let graph = &scene.graph;
    let mut warnings = Vec::new();
    let ending = output.extension().and_then(|e| e.to_str()).unwrap_or("");
    progress.begin("writing", 0);
    match ending {
        "vxg" => store::write_with(output, force, |file| {
            vxg::write_to(graph, file).map_err(std::io::Error::other)
        })?,
        "vox" => {
            let mut writer = scene::VoxWriter::new();
            for voxel in voxels(graph)? {
                writer.add(voxel);
            }
            store::write_with(output, force, |file| {
                let written = writer.write(file)?;
                if written.colors_given > written.colors_kept {
                    warnings.push(format!(
                        "{} colours were reduced to the {} that a .vox holds",
                        written.colors_given, written.colors_kept
                    ));
                }
                Ok(())
            })?;
        }
        "ply" => {
            let all = voxels(graph)?;
            store::write_with(output, force, |file| {
                scene::write_ply(file, all, true).map(|_| ())
            })?;
        }
        _ => {
            return Err(CliError::usage(format!(
                "{}: cannot tell the format to write from the ending",
                output.display()
            ))
            .advise("end the name in .vxg, .vox or .ply; of a mesh also in .far or .tvx"));
        }
    }
    progress.end();
    let bytes = std::fs::metadata(output).map_or(0, |m| m.len());
    Ok(Written {
        voxels: graph.voxels,
        bytes,
        warnings,
    })
}

/// Builds a `.vxg` file of a scene within a limit of memory.
///
/// # Errors
/// A bad input, a file that exists, or a failed write.
pub(super) fn build_file(
    source: &str,
    args: &SceneArgs,
    external: ExternalOptions,
    output: &Path,
    force: bool,
    progress: &dyn Progress,
) -> Result<(Written, Option<ExternalReport>), CliError> {
    let options = options(args);
    let built = scene::build_file(source, &options, external, output, force, progress)?;
    let written = Written {
        voxels: built.voxels,
        bytes: built.bytes,
        warnings: built.info.map(|info| info.warnings).unwrap_or_default(),
    };
    Ok((written, built.report))
}

/// The finest voxels of a graph at their file indices; a large leaf is many.
fn voxels(graph: &Graph) -> Result<impl Iterator<Item = Voxel> + '_, CliError> {
    if graph.voxels > MAX_WRITTEN {
        return Err(CliError::new(
            Kind::Limit,
            format!("a voxel file of {} voxels is too large", graph.voxels),
        )
        .advise("write a .vxg, or convert a scene of fewer levels"));
    }
    Ok(graph.voxels().flat_map(move |cell| {
        let corner = graph.file_index(&cell);
        let side = 1i64 << (graph.depth - cell.level);
        let color = graph.color_of(cell.node);
        let normal = graph.normal_of(cell.node);
        (0..side * side * side).map(move |i| {
            let offset = [i / (side * side), i / side % side, i % side];
            Voxel {
                // Within `i32`, as the builder made sure.
                index: std::array::from_fn(|k| (corner[k] + offset[k]) as i32),
                color,
                normal: Some(normal).filter(|n| !n.is_none()),
            }
        })
    }))
}

/// Nodes of each level: stored ones, and how many a plain tree would have.
#[must_use]
pub(super) fn levels(graph: &Graph) -> Vec<(u64, u128)> {
    use std::collections::HashMap;
    let view = graph.view();
    if graph.is_level_ordered() && graph.links.is_empty() {
        let nodes = graph.nodes_per_level();
        return nodes.into_iter().map(|n| (n, u128::from(n))).collect();
    }
    let mut current = HashMap::from([(graph.root, 1u128)]);
    let mut levels = Vec::new();
    for _ in 0..=graph.depth {
        if graph.is_empty() || current.is_empty() {
            break;
        }
        let times = current
            .values()
            .fold(0u128, |sum, &n| sum.saturating_add(n));
        levels.push((current.len() as u64, times));
        let mut below: HashMap<u32, u128> = HashMap::new();
        for (&node, &times) in &current {
            for child in (0..8).filter_map(|octant| view.child(node, octant)) {
                let sum = below.entry(child).or_default();
                *sum = sum.saturating_add(times);
            }
        }
        current = below;
    }
    levels
}

/// How much smaller the graph gets when equal subtrees are merged: all nodes
/// over those left, with attributes and by shape alone.
#[must_use]
pub(super) fn merge_gains(graph: &Graph) -> [f64; 2] {
    [MergeBy::ShapeAndAttributes, MergeBy::Shape].map(|by| merge(graph, by, &Silent).1.gain())
}

/// A scene's name without folder and ending, for `{stem}`.
#[must_use]
pub(super) fn stem(source: &str) -> String {
    if is_spec(source) {
        let name = source.trim_start_matches(scene::generate::PREFIX);
        return name.replace([',', '=', '/', '\\'], "-");
    }
    Path::new(source)
        .file_stem()
        .map_or_else(|| "scene".to_owned(), |s| s.to_string_lossy().into_owned())
}
