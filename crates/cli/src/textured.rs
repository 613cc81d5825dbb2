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
    let grids = (0..file.grids()).map(|number| file.grid(number));
    let voxels: u64 = grids.map(|grid| grid.voxels().len() as u64).sum();
    console.note(format!(
        "{}: {} triangles, {} voxels, {} bytes, built in {:.2} s",
        of.output.display(),
        grouped(mesh.triangles().len() as u64),
        grouped(voxels),
        grouped(file.len()),
        build_ms / 1e3
    ));
    of.report(describe(&file, of.input), build_ms, console)
}

/// Checks all of a file and describes it, as JSON and as text.
pub(super) fn info(name: &str, with_levels: bool) -> Result<(Value, String), CliError> {
    let file = TexturedFile::open(&names::path(name))?;
    file.verify()?;
    let described = describe(&file, name);
    let text = text(&described, &file, with_levels);
    Ok((described, text))
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
    let entry = grid.entry();
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
        "listed_primitives": entry.listed,
        "textures": entry.textures,
        "texels_projected": entry.projected,
        "texels_projected_afresh": entry.projected_afresh,
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

fn text(described: &Value, file: &TexturedFile, with_levels: bool) -> String {
    let (low, high) = file.bounds();
    let lines = [
        (
            "scene",
            described["scene"].as_str().unwrap_or_default().to_owned(),
        ),
        ("format", "textured voxels (.tvx)".to_owned()),
        ("box", format!("{low} to {high}")),
        ("triangles", report::figure(&described["triangles"])),
        ("bytes", report::figure(&described["bytes"])),
    ];
    let mut grids = described["grids"].clone();
    for (number, grid) in grids.as_array_mut().into_iter().flatten().enumerate() {
        let bytes = file.grid(number).bytes().iter().sum::<u64>();
        grid["name"] = json!(format!(
            "{} ({})",
            grid["cells"],
            element_name(file.grid(number).element())
        ));
        grid["bytes"] = json!(bytes);
        grid["level_count"] = json!(file.grid(number).levels().rows().len());
    }
    let columns = [
        ("grid", "name"),
        ("texels", "texels"),
        ("voxels", "voxels"),
        ("listed", "listed_primitives"),
        ("sub-textures", "textures"),
        ("bytes", "bytes"),
        ("levels", "level_count"),
    ];
    let mut parts = vec![report::lines(&lines), report::table_of(&grids, &columns)];
    for grid in grids.as_array().into_iter().flatten() {
        parts.push(format!(
            "grid {}: {} texels projected, slice by slice; {} had each volume been projected afresh",
            grid["cells"],
            report::figure(&grid["texels_projected"]),
            report::figure(&grid["texels_projected_afresh"])
        ));
        if with_levels {
            // Tellier and Baroud 2003, Fig. 12 (c).
            let columns =
                ["level", "faces", "primitives", "voxels", "surfels"].map(|key| (key, key));
            parts.push(report::table_of(&grid["levels"], &columns));
        }
    }
    parts.join("\n\n")
}
