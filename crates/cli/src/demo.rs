//! The demo: the bundled scene, its picture, and what drawing it took.

use std::path::Path;

use serde_json::json;

use super::args::{CameraArgs, EngineArgs, PictureArgs, SceneArgs, Size, camera_line};
use super::console::Console;
use super::error::{CliError, Kind};
use super::methods::{self, DrawArgs};
use super::{outputs, report, scenes};
use shiftvox::drawing::Drawable;
use shiftvox::picture;
use shiftvox_lab::model::frame;

/// The demo's own picture: the only file that it replaces without --force.
const PICTURE: &str = "out/demo.png";
/// Pixels a side.
const SIDE: u32 = 1024;

pub(super) fn run(console: &Console) -> Result<(), CliError> {
    let scene = scenes::demo(console.progress())?;
    let picture_args = PictureArgs {
        size: Some(Size {
            width: SIDE,
            height: SIDE,
        }),
        ..PictureArgs::default()
    };
    let engine_args = EngineArgs::default();
    let view = CameraArgs {
        azimuth: Some(30.0),
        elevation: Some(14.0),
        ..CameraArgs::default()
    };
    let draw_args = DrawArgs {
        engine: &engine_args,
        picture: &picture_args,
        scene: &SceneArgs::default(),
        memory: None,
        is_hashed: true,
    };
    let mut drawing = methods::of_graph(&scene, &draw_args)?;
    let camera = view.camera(&drawing.bounds(), scene.up, (SIDE, SIDE), 0.0);
    drawing.draw(&camera, 1)?;
    let setup = drawing.setup(&camera)?;
    let shown = drawing.shown()?;
    let shown = shown.ok_or_else(|| CliError::new(Kind::Run, "nothing was drawn"))?;
    let counter =
        frame::count_operations(&scene.graph.view(), &setup, engine_args.rules.overflow())?.1;
    outputs::write(&shown, Path::new(PICTURE), &[], true)?;
    let hash = picture::hash_rows(&shown.buffers)?;
    if console.json {
        let mut result = report::drawn(&scene.source, scene.load_ms, &camera, &shown, Some(&hash));
        result["output"] = json!(PICTURE);
        result["operations"] = json!(counter.ops());
        return console.document(&report::document("demo", result));
    }
    let time = shown.times_ms.first().copied().unwrap_or(0.0);
    console.data(format!(
        "{} voxels in {} nodes, {SIDE} x {SIDE} pixels, drawn in {time:.1} ms\n\n{}\n\n\
         {} operations, none of them a multiplication or a division; widest word {} bits\n\
         camera   {}\n\
         hash     {hash}\n\
         picture  {PICTURE}",
        report::grouped(scene.graph.voxels),
        report::grouped(scene.graph.len() as u64),
        report::counts(&counter),
        report::grouped(counter.ops()),
        counter.widest(),
        camera_line(&camera),
    ))
}
