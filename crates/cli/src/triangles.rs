//! `triangles`: a mesh drawn as triangles, with a depth buffer.

use std::fs::File;
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use serde_json::json;

use super::args::{CameraArgs, SceneArgs, Size};
use super::console::Console;
use super::error::CliError;
use super::{methods, outputs, report, scenes};
use shiftvox::drawing::{Drawable, milliseconds_since};
use shiftvox::picture::npy::{self, Array, Values};
use shiftvox::picture::{Background, Buffer, Shading};
use shiftvox::whole;
use shiftvox_mesh::drawing::{TrianglesStyle, of_triangles};
use shiftvox_mesh::raster::{Pattern, Samples};

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum BufferName {
    /// View-axis depth, world units; inf where nothing is seen.
    Depth,
    /// Share of the pixel's samples that see a triangle.
    Coverage,
}

#[derive(Debug, Args)]
pub(super) struct TrianglesArgs {
    /// Mesh, whose format is recognised by its content (`shiftvox --help` lists the formats)
    #[arg(value_name = "MESH")]
    mesh: String,
    /// Picture to write, .png
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Samples per pixel, in the middles of equal squares
    #[arg(long, value_name = "N", default_value = "16",
          value_parser = PossibleValuesParser::new(["1", "4", "16", "256"]))]
    samples: String,
    /// Pixels, such as 512 (square) or 640x360 [default: 512]
    #[arg(long, value_name = "N|WxH")]
    size: Option<Size>,
    /// Shading
    #[arg(long, value_enum, default_value_t)]
    shade: Shading,
    /// Background in sRGB, 0 to 255 each, or none (transparent) [default: 236,239,244]
    #[arg(long, value_name = "R,G,B|none")]
    background: Option<Background>,
    /// Buffers to write beside the picture, as {out stem}.{aov}.npy
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST")]
    aov: Vec<BufferName>,
    /// Replace existing files
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    scene: SceneArgs,
}

pub(super) fn run(args: &TrianglesArgs, console: &Console) -> Result<(), CliError> {
    outputs::check_picture_name(&args.output)?;
    args.camera.check().map_err(CliError::usage)?;
    let coverage = args.output.with_extension("coverage.npy");
    let of_picture: &[Buffer] = match args.aov.contains(&BufferName::Depth) {
        true => &[Buffer::Depth],
        false => &[],
    };
    outputs::check_free(&outputs::paths(&args.output, of_picture), args.force)?;
    if args.aov.contains(&BufferName::Coverage) {
        whole::check_free(&coverage, args.force)?;
    }
    let started = Instant::now();
    let (mesh, up) = scenes::open_mesh(&args.mesh, &args.scene, None, console)?;
    let load_ms = milliseconds_since(started);
    let size = args.size.unwrap_or(Size::square(512)).pair();
    let style = args.style();
    let mut drawing = of_triangles(&mesh, up, style, console.progress());
    let camera = args.camera.camera(&drawing.bounds(), up, size, 0.0);
    let shown = methods::frame(&mut drawing, &camera, 1);
    let shown = shown.map_err(|error| error.at(args.output.display()))?;
    let draw_ms = shown.times_ms[0];
    let mut files = outputs::prepare(&shown, &args.output, of_picture, args.force)?;
    if args.aov.contains(&BufferName::Coverage) {
        let array = Array {
            shape: vec![size.1 as usize, size.0 as usize],
            values: Values::F32(shown.coverage.to_vec()),
        };
        let write = |file: &mut File| file.write_all(&npy::encode(&array));
        files.push(whole::prepare(&coverage, args.force, write)?);
    }
    whole::keep(files)?;
    console.note(format!(
        "{}: {} triangles, {} samples per pixel, read in {load_ms:.1} ms, drawn in {draw_ms:.1} ms",
        args.output.display(),
        report::grouped(mesh.triangles().len() as u64),
        args.samples
    ));
    let fields = json!({
        "mesh": args.mesh,
        "output": args.output.display().to_string(),
        "triangles": mesh.triangles().len(),
        "samples": style.samples.per_pixel(),
        "camera": camera.flags(),
        "load_ms": load_ms,
        "draw_ms": draw_ms,
        "warnings": mesh.warnings(),
    });
    console.report("triangles", fields);
    Ok(())
}

impl TrianglesArgs {
    fn style(&self) -> TrianglesStyle {
        let samples: u32 = self.samples.parse().unwrap_or(16);
        TrianglesStyle {
            samples: Samples::new(samples.ilog2() / 2, Pattern::Regular),
            shading: self.shade,
            background: self.background.unwrap_or_default(),
        }
    }
}
