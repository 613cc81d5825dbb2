//! `.tvx` files on the command line: `convert` and `info`.

use std::time::Instant;

use serde_json::{Value, json};

use super::console::Console;
use super::error::CliError;
use super::names;
use super::report::{self, grouped};
use super::scene_files::Conversion;
use super::scenes;
use shiftvox::drawing::milliseconds_since;
use shiftvox::project::Up;
use shiftvox::whole;
use shiftvox_mesh::textured::levels::LevelRow;
use shiftvox_mesh::textured::store::{Grid, write_to};
use shiftvox_mesh::textured::{BuildOptions, Element, TexturedFile, build};

/// Builds textured voxels of a mesh and writes them.
pub(super) fn convert(
    of: &Conversion<'_>,
    options: &BuildOptions,
    console: &Console,
) -> Result<(), CliError> {
    let (mesh, up) = scenes::open_mesh(of.input, of.scene, console)?;
    let started = Instant::now();
    let mut data =
        build(&mesh, options, console.progress()).map_err(|e| CliError::from(e).at(of.input))?;
    data.y_up = up == Up::Y;
    let build_ms = milliseconds_since(started);
    whole::write_with(of.output, of.force, |file| write_to(&data, file))?;
    let file = TexturedFile::open(of.output)?;
    let voxels: u64 = (0..file.grids())
        .map(|g| file.grid(g).voxels().len() as u64)
        .sum();
    console.note(format!(
        "{}: {} triangles, {} voxels, {} bytes, built in {:.2} s",
        of.output.display(),
        grouped(mesh.triangles().len() as u64),
        grouped(voxels),
        grouped(file.len()),
        build_ms / 1e3
    ));
    if console.json {
        let mut fields = describe(&file, of.input);
        fields["input"] = json!(of.input);
        fields["output"] = json!(names::of_path(of.output));
        fields["build_ms"] = json!(build_ms);
        console.document(&report::document("convert", fields))?;
    }
    Ok(())
}

/// Checks all of a file and describes it: prints that, or with `--json` returns it.
pub(super) fn info(
    name: &str,
    with_levels: bool,
    console: &Console,
) -> Result<Option<Value>, CliError> {
    let file = TexturedFile::open(&names::path(name))?;
    file.verify()?;
    if console.json {
        return Ok(Some(describe(&file, name)));
    }
    console.data(description(&file, name, with_levels))?;
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
    let lattice = grid.cell_grid();
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

fn description(file: &TexturedFile, name: &str, with_levels: bool) -> String {
    let (low, high) = file.bounds();
    let mut parts = vec![format!(
        "scene     {name}\nformat    textured voxels (.tvx)\nbox       {low} to {high}\ntriangles \
         {}\nbytes     {}",
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
        let lattice = grid.cell_grid();
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
            "grid {}: {} texels projected, slice by slice; {} had each volume been projected \
             afresh",
            grid.cell_grid().cells(),
            grouped(projected),
            grouped(afresh)
        ));
        if with_levels {
            parts.push(level_table(&grid));
        }
    }
    parts.join("\n\n")
}

/// Tellier and Baroud 2003, Fig. 12 (c): what each level shows.
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
