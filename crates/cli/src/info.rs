//! `info`: the contents of a scene.

use clap::Args;
use serde_json::{Value, json};

use super::args::{CameraArgs, SceneArgs};
use super::console::Console;
use super::error::CliError;
use super::scenes::{self, Scene};
use super::{batch, far, report, textured};
use shiftvox::graph::{Graph, Opacity, sixteenths};
use shiftvox::project::Bounds;
use shiftvox::scene::{FileKind, Source};

#[derive(Debug, Args)]
pub(super) struct InfoArgs {
    /// Scenes: files, or generators such as gen:terrain,depth=10,seed=1
    #[arg(value_name = "SCENE", required = true)]
    scenes: Vec<String>,
    /// Print the faces, voxels and surfels of each level of detail of .tvx files
    #[arg(long)]
    levels: bool,
    #[command(flatten)]
    scene: SceneArgs,
}

pub(super) fn run(args: &InfoArgs, console: &Console) -> Result<(), CliError> {
    let show = |name: &String| {
        let described = of_one(name, args, console)?;
        if !console.json {
            let gap = if args.scenes.len() > 1 { "\n" } else { "" };
            console.data(text(described.clone(), args.levels) + gap)?;
        }
        Ok(described)
    };
    batch::each("info", &args.scenes, String::as_str, console, show)
}

fn of_one(name: &str, args: &InfoArgs, console: &Console) -> Result<Value, CliError> {
    match Source::find(name)?.kind() {
        Some(FileKind::Far) => far::info(name),
        Some(FileKind::Tvx) => textured::info(name),
        _ => {
            let scene = scenes::open(name, &args.scene, console)?;
            Ok(describe(&scene))
        }
    }
}

fn text(mut described: Value, with_levels: bool) -> String {
    let grids = described.get_mut("grids").and_then(Value::as_array_mut);
    for grid in grids.into_iter().flatten().filter_map(Value::as_object_mut) {
        if !with_levels {
            grid.remove("levels");
        }
    }
    report::description(&described)
}

fn describe(scene: &Scene) -> Value {
    let graph = &scene.graph;
    let [low, high] = Bounds::in_file(graph).unwrap_or_default();
    let size = [0, 1, 2].map(|k| high[k] - low[k]);
    let camera = CameraArgs::default().camera(&Bounds::of(graph), scene.up, (512, 512), 0.0);
    let levels = graph.nodes_per_level().into_iter().enumerate();
    let levels = levels.map(|(level, nodes)| json!({ "level": level, "nodes": nodes }));
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
        "palette_entries": scene.palette,
        "colors": distinct_leaf_colors(graph),
        "camera": camera.flags(),
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

/// The share of leaves that let light through, and the mean opacity of their faces.
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
        "six per voxel; {:.1} % of the voxels are not opaque from all sides; mean {:.1} %",
        100.0 * airy as f64 / all.max(1) as f64,
        100.0 * covered as f64 / (96 * all.max(1)) as f64
    )
}

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
