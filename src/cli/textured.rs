//! Textured voxels on the command line: `convert`, `info` and `render` of `.tvx` files.

use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};

use super::args::{Aov, EngineName, Erosion};
use super::console::Console;
use super::convert::ConvertArgs;
use super::drawing::milliseconds_since;
use super::error::{CliError, Kind};
use super::fit::{Bounds, Up};
use super::mesh_view::{self, Counted, DrawArgs, FileEngine, MeshFile, Use, background, view};
use super::report::{self, grouped};
use crate::lab::mesh_view::{light_of, picture_of_triangles};
use crate::mesh::raster::{Pattern, Samples, View};
use crate::picture::store;
use crate::project::Camera;
use crate::textured::levels::LevelRow;
use crate::textured::record::Primitive;
use crate::textured::store::{Grid, is_textured, write_to};
use crate::textured::view::{Counts, Detail, ViewError, ViewOptions, choose_grid, draw};
use crate::textured::{BuildError, BuildOptions, Element, TexturedFile, build};

impl From<BuildError> for CliError {
    fn from(error: BuildError) -> Self {
        let kind = match error {
            BuildError::Empty | BuildError::Range => Kind::Input,
            BuildError::TooMany(_) => Kind::Limit,
            BuildError::Grid { .. } | BuildError::Grids => Kind::Usage,
        };
        Self::new(kind, error)
    }
}

impl From<ViewError> for CliError {
    fn from(error: ViewError) -> Self {
        match error {
            ViewError::File(error) => error.into(),
            ViewError::Raster(_) | ViewError::Grid(..) | ViewError::TexelSize(_) => {
                Self::usage(error)
            }
        }
    }
}

/// Whether a scene's name is that of a `.tvx` file, told by its content.
pub(super) fn is_textured_file(name: &str) -> bool {
    mesh_view::begins(name, is_textured)
}

/// Builds textured voxels of a mesh and writes them.
pub(super) fn convert(args: &ConvertArgs, console: &Console) -> Result<(), CliError> {
    let defaults = BuildOptions::default();
    let options = BuildOptions {
        grids: if args.grid.is_empty() {
            defaults.grids
        } else {
            args.grid.clone()
        },
        texels: args.texels.unwrap_or(defaults.texels),
        element: args.element.map_or(defaults.element, |e| e.element()),
    };
    let (mesh, up) = mesh_view::open(&args.input, &args.scene, console)?;
    let started = Instant::now();
    let mut data = build(&mesh, &options, console.progress())
        .map_err(|e| CliError::from(e).at(&args.input))?;
    data.y_up = up == Up::Y;
    let build_ms = milliseconds_since(started);
    store::write_with(&args.output, args.force, |file| write_to(&data, file))?;
    let file = TexturedFile::open(&args.output)?;
    let voxels: u64 = (0..file.grids())
        .map(|g| file.grid(g).voxels().len() as u64)
        .sum();
    console.note(format!(
        "{}: {} triangles, {} voxels, {} bytes, built in {:.2} s",
        args.output.display(),
        grouped(mesh.triangles().len() as u64),
        grouped(voxels),
        grouped(file.len()),
        build_ms / 1e3
    ));
    if console.json {
        let mut fields = describe(&file, &args.input);
        fields["input"] = json!(args.input);
        fields["output"] = json!(args.output);
        fields["build_ms"] = json!(build_ms);
        console.document(&report::document("convert", fields))?;
    }
    Ok(())
}

/// Tells what is in a file, all of which is checked; as JSON if that is asked for.
pub(super) fn info(
    name: &str,
    with_levels: bool,
    console: &Console,
) -> Result<Option<Value>, CliError> {
    let file = TexturedFile::open(Path::new(name))?;
    file.verify()?;
    if console.json {
        return Ok(Some(describe(&file, name)));
    }
    console.data(tell(&file, name, with_levels))?;
    Ok(None)
}

fn describe(file: &TexturedFile, name: &str) -> Value {
    let (low, high) = file.bounds();
    let grids: Vec<Value> = (0..file.grids())
        .map(|g| describe_grid(&file.grid(g)))
        .collect();
    json!({
        "scene": name,
        "format": ".tvx",
        "low": low.to_array(),
        "high": high.to_array(),
        "triangles": file.primitives().len(),
        "grids": grids,
        "bytes": file.len(),
    })
}

fn describe_grid(grid: &Grid<'_>) -> Value {
    let lattice = grid.lattice();
    let [voxels, lists, textures] = grid.bytes();
    let [projected, afresh] = grid.projected();
    let row = |row: &LevelRow| {
        json!({
            "level": row.level,
            "faces": row.faces,
            "primitives": row.primitives,
            "voxels": row.voxels,
            "surfels": row.surfels,
        })
    };
    json!({
        "cells": lattice.cells(),
        "texels": lattice.texels(),
        "element": element_name(grid.element()),
        "cell_size_world": lattice.cell_size().to_array(),
        "voxels": grid.voxels().len(),
        "listed_primitives": grid.listed(),
        "textures": grid.textures(),
        "texels_projected": projected,
        "texels_projected_afresh": afresh,
        "voxel_bytes": voxels,
        "list_bytes": lists,
        "texture_bytes": textures,
        "levels": grid.levels().rows().iter().map(row).collect::<Vec<Value>>(),
    })
}

fn element_name(element: Element) -> &'static str {
    match element {
        Element::Cube => "cube",
        Element::Sides => "sides",
    }
}

fn tell(file: &TexturedFile, name: &str, with_levels: bool) -> String {
    let (low, high) = file.bounds();
    let mut parts = vec![format!(
        "scene     {name}\nformat    textured voxels (.tvx)\nbox       {low} to {high}\ntriangles {}\nbytes     {}",
        grouped(file.primitives().len() as u64),
        grouped(file.len())
    )];
    let head = [
        "grid",
        "texels",
        "voxels",
        "listed",
        "sub-textures",
        "bytes",
        "levels",
    ];
    let head = head.map(String::from).to_vec();
    let rows = (0..file.grids()).map(|number| {
        let grid = file.grid(number);
        let lattice = grid.lattice();
        vec![
            format!("{} ({})", lattice.cells(), element_name(grid.element())),
            lattice.texels().to_string(),
            grouped(grid.voxels().len() as u64),
            grouped(grid.listed()),
            grouped(grid.textures()),
            grouped(grid.bytes().iter().sum::<u64>()),
            grid.levels().rows().len().to_string(),
        ]
    });
    parts.push(report::table(head, rows.collect()));
    for number in 0..file.grids() {
        let grid = file.grid(number);
        let [projected, afresh] = grid.projected();
        parts.push(format!(
            "grid {}: {} texels projected, slice by slice; {} had each volume been projected afresh",
            grid.lattice().cells(),
            grouped(projected),
            grouped(afresh)
        ));
        if with_levels {
            parts.push(level_table(&grid));
        }
    }
    parts.join("\n\n")
}

/// The paper's Fig. 12 (c): what each level shows.
fn level_table(grid: &Grid<'_>) -> String {
    let head = ["level", "faces", "primitives", "voxels", "surfels"];
    let rows = grid.levels().rows().iter().map(|row| {
        let numbers = [
            u64::from(row.level),
            row.faces,
            row.primitives,
            row.voxels,
            row.surfels,
        ];
        numbers.map(grouped).to_vec()
    });
    report::table(head.map(String::from).to_vec(), rows.collect())
}

pub(super) const ENGINE: FileEngine = FileEngine {
    engine: EngineName::Textured,
    name: "textured",
    ending: ".tvx",
    buffers: &[Aov::Depth, Aov::Color],
    flags: &["erosion", "erosion-grid"],
    is_file: is_textured_file,
    with_file,
};

fn with_file(path: &Path, args: DrawArgs<'_>, then: Use<'_>) -> Result<(), CliError> {
    if args.memory.is_some() {
        return Err(CliError::usage("--memory is for .far files"));
    }
    let file = TexturedFile::open(path)?;
    then(&mut Open { file: &file, args })
}

/// An open `.tvx` file.
struct Open<'f> {
    file: &'f TexturedFile,
    args: DrawArgs<'f>,
}

impl MeshFile for Open<'_> {
    /// The box and the corners of all primitives: the camera is the one that the mesh's triangles get.
    fn bounds(&self) -> Bounds {
        let (low, high) = self.file.bounds();
        let hull = self.file.primitives().iter().flat_map(Primitive::positions);
        Bounds {
            low,
            high,
            hull: hull.collect(),
        }
    }

    fn up(&self) -> Up {
        if self.file.y_up() { Up::Y } else { Up::Z }
    }

    fn draw(&mut self, camera: &Camera) -> Result<Counted, CliError> {
        let view = view(camera, self.file.bounds())?;
        let options = options(&self.args, self.file, &view)?;
        let (drawn, counts) = draw(self.file, &view, &options)?;
        Ok((picture_of_triangles(drawn), counters(self.file, &counts)))
    }

    fn memory(&self) -> Option<Value> {
        None
    }
}

fn options(args: &DrawArgs<'_>, file: &TexturedFile, view: &View) -> Result<ViewOptions, CliError> {
    let number_of = |cells: u32| {
        let found = (0..file.grids()).find(|&g| file.grid(g).lattice().cells() == cells);
        found.ok_or_else(|| {
            let all = (0..file.grids()).map(|g| file.grid(g).lattice().cells().to_string());
            let all = all.collect::<Vec<String>>().join(", ");
            CliError::usage(format!("the file has no grid of {cells} cells"))
                .advise(format!("it has grids of {all}"))
        })
    };
    let grid = args.engine.erosion_grid.map(number_of).transpose()?;
    let detail = match args.engine.erosion.unwrap_or_default() {
        Erosion::Auto if grid.is_some() => {
            return Err(CliError::usage(
                "--erosion-grid needs --erosion K; auto chooses the grid too",
            ));
        }
        Erosion::Auto => Detail::Auto {
            texel_px: args.engine.rules.mesh_lod(),
        },
        Erosion::Level(_) if args.engine.rules.lod.is_some() => {
            return Err(CliError::usage(
                "--lod says how large texels are with --erosion auto, not with a number of erosions",
            ));
        }
        Erosion::Level(level) => Detail::Level {
            grid: grid.unwrap_or_else(|| choose_grid(file, view, level)),
            level,
        },
    };
    let per_pixel = 1 << (2 * args.picture.aa_log2());
    Ok(ViewOptions {
        detail,
        samples: Samples::new(per_pixel, Pattern::Regular).map_err(CliError::usage)?,
        light: light_of(view, args.picture.shading()),
        background: background(args.picture.background),
    })
}

fn counters(file: &TexturedFile, counts: &Counts) -> Vec<(&'static str, Value)> {
    let choice = &counts.choice;
    let cells = file.grid(choice.grid).lattice().cells();
    vec![
        ("grid", json!(cells)),
        ("erosion", json!(choice.level)),
        // None where the eye is among the voxels.
        ("texel_px", json!((choice.texel_px * 1e3).round() / 1e3)),
        ("primitives", json!(counts.primitives)),
        ("voxels", json!(counts.voxels)),
        ("surfels", json!(counts.surfels)),
    ]
}
