//! The demo: the bundled scene, its picture, and the cost of drawing it.

use std::path::Path;

use serde_json::json;

use super::args::{CameraArgs, PictureArgs, Size};
use super::console::Console;
use super::error::CliError;
use super::methods::{self, DrawFlags};
use super::report::{self, grouped};
use super::{outputs, scenes};
use shiftvox::drawing::Drawable;
use shiftvox::frame::Frame;
use shiftvox::machine::{Machine, MachineOptions};
use shiftvox::picture;
use shiftvox::project::Stop;

/// The only file that is replaced without --force.
const PICTURE: &str = "out/demo.png";
const SIDE: u32 = 1024;

pub(super) fn run(console: &Console) -> Result<(), CliError> {
    let scene = scenes::demo(console.progress())?;
    let flags = DrawFlags {
        camera: CameraArgs {
            azimuth: Some(30.0),
            elevation: Some(14.0),
            ..CameraArgs::default()
        },
        picture: PictureArgs {
            size: Some(Size::square(SIDE)),
            ..PictureArgs::default()
        },
        ..DrawFlags::default()
    };
    let draw_args = flags.draw_args(None, true);
    let mut drawing = methods::of_graph(&scene.graph, scene.up, &draw_args, &Stop::default())?;
    let camera = flags
        .camera
        .camera(&drawing.bounds(), scene.up, (SIDE, SIDE), 0.0);
    let (graph, setup) = (&scene.graph, drawing.setup(&camera)?);
    let overflow = draw_args.engine.rules.overflow();
    let mut machine = Machine::new(MachineOptions {
        overflow,
        ..MachineOptions::default()
    });
    let mut counted = Frame::nodes_only(SIDE, SIDE);
    let (_, counter) = machine.count(&graph.view(), &setup, &mut counted)?;
    let shown = methods::frame(&mut drawing, &camera, 1)?;
    outputs::write(&shown, Path::new(PICTURE), &[], true)?;
    let hash = picture::hash_rows(&shown.buffers)?;
    let mut result = report::drawn(&scene.source, scene.load_ms, &camera, &shown, Some(&hash));
    result["output"] = json!(PICTURE);
    result["operations"] = json!(counter.ops());
    console.report("demo", result);
    if console.json {
        return Ok(());
    }
    console.data(format!(
        "{} voxels in {} nodes, {SIDE} x {SIDE} pixels, drawn in {:.1} ms\n\
         {} operations, none of them a multiplication or a division; widest word {} bits\n\
         camera   {}\n\
         hash     {hash}\n\
         picture  {PICTURE}",
        grouped(graph.voxels),
        grouped(graph.len() as u64),
        shown.times_ms[0],
        grouped(counter.ops()),
        counter.widest(),
        camera.flags(),
    ))
}
