//! `info`: what is in a scene.

use std::time::Instant;

use clap::Args;
use serde_json::{Value, json};

use super::args::{CameraArgs, SceneArgs, camera_line};
use super::console::Console;
use super::error::{CliError, Kind};
use super::report::{self, grouped};
use super::scenes::{self, Scene};
use super::{far, names, textured};
use shiftvox::budget;
use shiftvox::graph::{Graph, MergeBy, Opacity, Silent, merge, sixteenths};
use shiftvox::project::Bounds;
use shiftvox::scene::{FileKind, Source};

/// Arguments of `info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// Scenes: files, or generators such as gen:terrain,depth=10,seed=1
    #[arg(value_name = "SCENE", value_parser = crate::names::parser())]
    scenes: Vec<String>,
    /// Of .tvx: the table of faces, voxels and surfels of each level of detail
    #[arg(long)]
    levels: bool,
    #[command(flatten)]
    scene: SceneArgs,
}

/// Describes all scenes; a scene that fails is reported and does not stop the others.
pub(super) fn run(
    args: &InfoArgs,
    from_config: Vec<String>,
    console: &Console,
) -> Result<(), CliError> {
    let names = scenes::choose(&args.scenes, from_config)?;
    let mut results = Vec::new();
    let mut first_failure = None;
    for name in &names {
        match of_one(name, args, names.len() > 1, console) {
            Ok(Some(described)) => results.push(described),
            Ok(None) => {}
            Err(error) if names.len() == 1 || error.kind == Kind::Pipe => return Err(error),
            Err(error) => {
                console.error(&error);
                results.push(json!({ "scene": name, "error": error.message }));
                first_failure.get_or_insert(error.kind);
            }
        }
    }
    if console.json {
        console.document(&report::document("info", json!({ "scenes": results })))?;
    }
    match first_failure {
        None => Ok(()),
        Some(kind) => Err(CliError::new(
            kind,
            "not all scenes could be read; see above",
        )),
    }
}

/// Describes a scene: prints it, or with `--json` returns it, to be printed with the others.
fn of_one(
    name: &str,
    args: &InfoArgs,
    several: bool,
    console: &Console,
) -> Result<Option<Value>, CliError> {
    let started = Instant::now();
    let source = Source::find(names::path(name))?;
    let (described, text) = match source.kind() {
        Some(FileKind::Far) => far::info(name)?,
        Some(FileKind::Tvx) => textured::info(name, args.levels)?,
        _ => {
            let verify = scenes::Verify::All;
            let scene = scenes::open_source(source, name, &args.scene, verify, started, console)?;
            let described = describe(&scene);
            let gap = if several { "\n" } else { "" };
            let text = text(&described, &scene) + gap;
            (described, text)
        }
    };
    if console.json {
        return Ok(Some(described));
    }
    console.data(text)?;
    Ok(None)
}

fn describe(scene: &Scene) -> Value {
    let graph = &scene.graph;
    let bounds = Bounds::in_voxels(graph).unwrap_or(([0; 3], [0; 3]));
    let origin = graph.placement.origin_index;
    let [low, high] = [bounds.0, bounds.1].map(|corner| [0, 1, 2].map(|k| corner[k] + origin[k]));
    let size = [0, 1, 2].map(|k| high[k] - low[k]);
    let camera = CameraArgs::default().camera(&Bounds::of(graph), scene.up, (512, 512), 0.0);
    let gains = merge_gains(graph);
    let levels = levels(graph)
        .into_iter()
        .enumerate()
        .map(|(level, (nodes, in_tree))| {
            let in_tree = u64::try_from(in_tree).unwrap_or(u64::MAX);
            json!({ "level": level, "nodes": nodes, "nodes_in_tree": in_tree })
        });
    json!({
        "scene": scene.source,
        "format": scene.format,
        "index_low": low,
        "index_high": high,
        "opacities": opacities(graph),
        "size": size,
        "voxel_size_world": graph.placement.voxel_size,
        "depth": graph.depth,
        "voxels": graph.voxels,
        "nodes": graph.len(),
        "levels": levels.collect::<Vec<Value>>(),
        "bytes": graph.bytes(),
        "bytes_per_voxel": graph.bytes() as f64 / graph.voxels.max(1) as f64,
        "dag_gain": gains.map(|gains| gains[0]),
        "dag_gain_by_shape": gains.map(|gains| gains[1]),
        "palette_entries": scene.palette,
        "colors": distinct_leaf_colors(graph),
        "camera": camera_line(&camera),
        "mesh": scene.mesh.as_ref().map(|mesh| json!({
            "triangles": mesh.triangles,
            "positions": mesh.positions,
            "materials": mesh.materials,
            "low": mesh.bounds.0.to_array(),
            "high": mesh.bounds.1.to_array(),
            "bytes": mesh.bytes,
            "touches": mesh.touches,
            "load_ms": mesh.load_ms,
            "voxelize_ms": mesh.voxelize_ms,
        })),
        "warnings": scene.warnings,
        "load_ms": scene.load_ms,
    })
}

fn text(described: &Value, scene: &Scene) -> String {
    let n = |key: &str| report::figure(&described[key]);
    let real = |key: &str| described[key].as_f64();
    let text = |key: &str| described[key].as_str().unwrap_or_default().to_owned();
    let size = [0, 1, 2].map(|k| described["size"][k].to_string());
    let index = |key: &str| described[key].to_string().replace(',', ", ");
    let gain = match (real("dag_gain"), real("dag_gain_by_shape")) {
        (Some(all), Some(shape)) => {
            format!("{all:.2} when equal subtrees are merged, {shape:.2} by shape alone")
        }
        _ => "not found out: merging takes more memory than is free".to_owned(),
    };
    let palette = scene
        .palette
        .map_or_else(|| "none".to_owned(), |n| format!("{n} entries"));
    let mut lines = vec![
        ("scene", text("scene")),
        ("format", text("format")),
        ("size", format!("{} voxels", size.join(" x "))),
        (
            "indices",
            format!(
                "{} up to, not including, {}",
                index("index_low"),
                index("index_high")
            ),
        ),
        (
            "depth",
            format!("{} levels below the root", described["depth"]),
        ),
        ("voxels", n("voxels")),
        ("nodes", n("nodes")),
        (
            "memory",
            format!(
                "{} bytes, {:.2} a voxel",
                n("bytes"),
                real("bytes_per_voxel").unwrap_or_default()
            ),
        ),
        ("DAG gain", gain),
        ("palette", palette),
        ("opacities", text("opacities")),
        ("colours", format!("{} different", n("colors"))),
        ("camera", text("camera")),
    ];
    if let Some(mesh) = &scene.mesh {
        let (low, high) = mesh.bounds;
        lines.push((
            "mesh",
            format!(
                "{} triangles, {} positions, {} materials, {low} to {high}\n{:<9} read in {:.1} ms, \
                 voxelised in {:.1} ms",
                grouped(mesh.triangles),
                grouped(mesh.positions),
                grouped(mesh.materials),
                "",
                mesh.load_ms,
                mesh.voxelize_ms
            ),
        ));
    }
    let columns = [
        ("level", "level"),
        ("nodes", "nodes"),
        ("in a tree", "nodes_in_tree"),
    ];
    let levels = report::table_of(&described["levels"], &columns);
    format!("{}\n\n{levels}", report::lines(&lines))
}

/// How many of the nodes without children let light through, and how much
/// they cover of their faces on the average.
fn opacities(graph: &Graph) -> String {
    if graph.opacity.is_empty() {
        return "none: all voxels are opaque".to_owned();
    }
    let view = graph.view();
    let leaves = (0..graph.len() as u32).filter(|&node| view.mask(node) == 0);
    let (mut all, mut airy, mut covered) = (0u64, 0u64, 0u64);
    for opacity in leaves.map(|node| view.opacity_of(node)) {
        all += 1;
        airy += u64::from(opacity != Opacity::OPAQUE);
        for side in 0..6 {
            covered += u64::from(sixteenths(opacity.from_side(side / 2, side % 2 == 1)));
        }
    }
    format!(
        "six a voxel; {:.1} % of the voxels are not opaque from all sides; mean {:.1} %",
        100.0 * airy as f64 / all.max(1) as f64,
        100.0 * covered as f64 / (96 * all.max(1)) as f64
    )
}

/// Different colours of the nodes without children.
fn distinct_leaf_colors(graph: &Graph) -> usize {
    let view = graph.view();
    let mut seen = vec![0u64; (1 << 24) / 64];
    for (node, &[r, g, b]) in graph.color.iter().enumerate() {
        if view.mask(node as u32) == 0 {
            let color = usize::from(r) << 16 | usize::from(g) << 8 | usize::from(b);
            seen[color / 64] |= 1 << (color % 64);
        }
    }
    seen.iter().map(|word| word.count_ones() as usize).sum()
}

/// Nodes of each level: stored ones, and how many a plain tree would have.
fn levels(graph: &Graph) -> Vec<(u64, u128)> {
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

/// Bytes a node that merging takes at the least.
const MERGE_BYTES: u64 = 16;

/// How much smaller the graph gets when equal subtrees are merged: all nodes
/// over those left, with attributes and by shape alone.
fn merge_gains(graph: &Graph) -> Option<[f64; 2]> {
    budget::check("merging", graph.len() as u64 * MERGE_BYTES).ok()?;
    Some([MergeBy::ShapeAndAttributes, MergeBy::Shape].map(|by| merge(graph, by, &Silent).1.gain()))
}
