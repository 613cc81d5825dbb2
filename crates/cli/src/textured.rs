//! `.tvx` files on the command line: `convert` and `info`.

use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};

use super::console::Console;
use super::convert::ConvertArgs;
use super::error::CliError;
use super::report::grouped;
use super::scenes;
use shiftvox::drawing::milliseconds_since;
use shiftvox::project::Up;
use shiftvox::whole;
use shiftvox_mesh::textured::levels::LevelRow;
use shiftvox_mesh::textured::store::{Grid, write_to};
use shiftvox_mesh::textured::{Element, TexturedFile, build};

pub(super) fn convert(args: &ConvertArgs, console: &Console) -> Result<(), CliError> {
    let ConvertArgs { input, output, .. } = args;
    let (mesh, up) = scenes::open_mesh(input, &args.scene, None, console)?;
    let started = Instant::now();
    let built = build(&mesh, &args.textured_options(), console.progress());
    let mut data = built.map_err(|e| CliError::from(e).at(input))?;
    data.y_up = up == Up::Y;
    let build_ms = milliseconds_since(started);
    whole::write_with(output, args.force, |file| write_to(&data, file))?;
    let file = TexturedFile::open(output)?;
    let grids = (0..file.grids()).map(|number| file.grid(number));
    let voxels: u64 = grids.map(|grid| grid.voxels().len() as u64).sum();
    console.note(format!(
        "{}: {} triangles, {} voxels, {} bytes, built in {:.2} s",
        output.display(),
        grouped(mesh.triangles().len() as u64),
        grouped(voxels),
        grouped(file.file_bytes()),
        build_ms / 1e3
    ));
    args.report(describe(&file, input), build_ms, console);
    Ok(())
}

pub(super) fn info(name: &str) -> Result<Value, CliError> {
    let file = TexturedFile::open(Path::new(name))?;
    file.verify()?;
    Ok(describe(&file, name))
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
        "bytes": file.file_bytes(),
        "texture_bytes": file.texture_bytes(),
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
        "cells": lattice.cells,
        "texels": lattice.texels,
        "element": match grid.element() {
            Element::Cube => "cube",
            Element::Sides => "sides",
        },
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
