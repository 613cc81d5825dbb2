//! Triangles into textured voxels, with the same bytes on any number of threads.

mod project;
mod voxels;

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use super::cell_grid::{MOST_ACROSS, MOST_CELLS, MOST_TEXELS};
use super::levels::surfels;
use super::record::{CLEAR, NEVER, Primitive, Texel, VoxelRecord, list_of};
use super::{CellGrid, Element, GridData, TexturedData};
use crate::texture::paint::{Paint, Textures};
use crate::voxelize::OTHERS;
use crate::{Surface, geometry, mesh_box};
use project::{Column, Projected, project};
use shiftvox::graph::Progress;
pub(super) use voxels::depths;
use voxels::{cell_of, fill};

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BuildOptions {
    /// Cells along each axis, of each grid: even, 2 to [`MOST_CELLS`].
    pub grids: Vec<u32>,
    /// Texels along the side of a voxel's face, 1 to [`MOST_TEXELS`].
    pub texels: u32,
    pub element: Element,
}

impl Default for BuildOptions {
    /// As in Tellier and Baroud 2003: one grid of 16 cells, 16 texels.
    fn default() -> Self {
        Self {
            grids: vec![16],
            texels: 16,
            element: Element::default(),
        }
    }
}

pub const MOST_GRIDS: usize = 16;

/// From the origin, in lengths of the mesh: corners are then rounded by at most a 4,096th of it.
const MOST_DISTANCE: f64 = 4096.0;

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BuildError {
    #[error("there are no triangles to build textured voxels of")]
    Empty,
    #[error("{0} are more than 32 bits can number")]
    TooMany(&'static str),
    #[error(
        "a grid has an even number of cells from 2 to {MOST_CELLS}, since its middle plane parts \
         it into halves, 1 to {MOST_TEXELS} texels a cell and at most {MOST_ACROSS} texels in all; \
         not {cells} cells of {texels} texels"
    )]
    Grid { cells: u32, texels: u32 },
    #[error("there are 1 to {MOST_GRIDS} grids, each of another number of cells")]
    Grids,
    #[error("the mesh is too large or too small for numbers of single precision")]
    Range,
    #[error(
        "the mesh spans {extent} units {distance} units from the origin: too little for numbers of single precision; \
         move it to the origin"
    )]
    FarAway { extent: f64, distance: f64 },
}

pub fn build(
    surface: &dyn Surface,
    options: &BuildOptions,
    progress: &dyn Progress,
) -> Result<TexturedData, BuildError> {
    let mut grids = options.grids.clone();
    grids.sort_unstable();
    grids.dedup();
    if !(1..=MOST_GRIDS).contains(&grids.len()) || grids.len() < options.grids.len() {
        return Err(BuildError::Grids);
    }
    let texels = options.texels;
    if let Some(&cells) = grids.iter().find(|&&c| !CellGrid::is_possible(c, texels)) {
        return Err(BuildError::Grid { cells, texels });
    }
    if surface.is_empty() {
        return Err(BuildError::Empty);
    }
    if surface.len() >= NEVER as usize {
        return Err(BuildError::TooMany("triangles"));
    }
    let textures = Textures::new(surface.textures());
    let (primitives, mut paints): (Vec<Primitive>, Vec<Paint>) = (0..surface.len())
        .into_par_iter()
        .map(|number| {
            let triangle = surface.triangle(number);
            let (paint, colors) = textures.paint(&triangle);
            (Primitive::of(&triangle, colors), paint)
        })
        .unzip();
    if paints.iter().all(|&paint| paint == Paint::NONE) {
        paints = Vec::new();
    }
    let (rounded_low, rounded_high) = bounds(&primitives);
    if !(rounded_low.is_finite() && rounded_high.is_finite()) {
        return Err(BuildError::Range);
    }
    // Of the mesh and not of the rounded corners: all that is made of a mesh is seen from one place.
    let (low, high) = surface.bounds();
    let extent = (high - low).max_element();
    if !(low.is_finite() && high.is_finite() && extent > 0.0) {
        return Err(BuildError::Range);
    }
    let distance = low.abs().max(high.abs()).max_element();
    if distance > MOST_DISTANCE * extent {
        return Err(BuildError::FarAway { extent, distance });
    }
    let grids = grids.into_iter().map(|cells| {
        let lattice = CellGrid::around(low, high, cells, texels);
        build_grid(surface, &primitives, &lattice, options.element, progress)
    });
    let grids = grids.collect::<Result<_, _>>()?;
    Ok(TexturedData {
        low,
        high,
        y_up: false,
        bevels: mesh_box(surface, false).bevels,
        primitives,
        paints,
        textures: textures.list,
        grids,
    })
}

pub(super) fn bounds(primitives: &[Primitive]) -> (DVec3, DVec3) {
    geometry::bounds(primitives.iter().flat_map(Primitive::positions))
}

fn build_grid(
    surface: &dyn Surface,
    primitives: &[Primitive],
    lattice: &CellGrid,
    element: Element,
    progress: &dyn Progress,
) -> Result<GridData, BuildError> {
    let (cells, texels) = (lattice.cells, lattice.texels);
    progress.begin("find voxels", 0);
    let corners: Vec<[[i64; 3]; 3]> = primitives
        .par_iter()
        .map(|primitive| primitive.positions().map(|p| lattice.point(p)))
        .collect();
    let pairs = fill(&corners, lattice);
    if pairs.len() >= NEVER as usize {
        progress.end();
        return Err(BuildError::TooMany("primitives of all voxels"));
    }
    let mut grid = GridData {
        cells,
        texels,
        element,
        voxels: Vec::new(),
        lists: Vec::with_capacity(pairs.len()),
        textures: Vec::new(),
        projected: 0,
        projected_afresh: 0,
    };
    let filled: Vec<&[u64]> = pairs.chunk_by(|a, b| a >> 32 == b >> 32).collect();
    let cell = |pairs: &[u64]| cell_of((pairs[0] >> 32) as u32, cells);
    let depths = depths(filled.iter().map(|pairs| cell(pairs)), cells, element);
    let mut sorted: Vec<(u16, &[u64])> = depths.into_iter().zip(filled).collect();
    sorted.sort_by_key(|(depth, _)| *depth);
    for (depth, pairs) in sorted {
        grid.voxels.push(VoxelRecord {
            cell: cell(pairs).map(|c| c as u16),
            depth,
            first: grid.lists.len() as u32,
            textures: [NEVER; 3],
        });
        grid.lists.extend(pairs.iter().map(|&pair| pair as u32));
    }
    drop(pairs);
    progress.end();
    let columns = columns(&grid.voxels, &grid.lists, cells);
    progress.begin("project textures", columns.len() as u64);
    let projected: Vec<Projected> = columns
        .par_iter()
        .map(|column| {
            let projected = project(column, surface, &corners, lattice);
            progress.advance(1);
            projected
        })
        .collect();
    progress.end();
    // Equal sub-textures have one number.
    let mut numbers: HashMap<Vec<Texel>, u32> = HashMap::new();
    for (column, projected) in columns.iter().zip(projected) {
        grid.projected += projected.texels;
        grid.projected_afresh += projected.texels_afresh;
        for (voxel, texture) in projected.textures {
            // No more than three faces of each of 2^21 cells.
            let next = numbers.len() as u32;
            grid.voxels[voxel as usize].textures[column.axis] = match texture {
                None => CLEAR,
                Some(texture) => *numbers.entry(texture).or_insert_with_key(|texture| {
                    grid.textures.extend_from_slice(texture);
                    next
                }),
            };
        }
    }
    Ok(grid)
}

/// The columns of which levels show faces.
fn columns(voxels: &[VoxelRecord], lists: &[u32], cells: u32) -> Vec<Column> {
    let mut columns: Vec<Column> = Vec::new();
    let mut places: HashMap<(usize, [u16; 2]), usize> = HashMap::new();
    let key = |voxel: &VoxelRecord, axis: usize| (axis, OTHERS[axis].map(|k| voxel.cell[k]));
    for surfel in surfels(voxels, cells) {
        let axis = usize::from(surfel.axis);
        let voxel = &voxels[surfel.voxel as usize];
        let key = key(voxel, axis);
        let place = *places.entry(key).or_insert(columns.len());
        if place == columns.len() {
            columns.push(Column {
                axis,
                at: key.1.map(u32::from),
                primitives: Vec::new(),
                wanted: Vec::new(),
            });
        }
        let slice = u32::from(voxel.cell[axis]);
        columns[place].wanted.push((slice, surfel.voxel));
    }
    for (number, voxel) in voxels.iter().enumerate() {
        for axis in 0..3 {
            if let Some(&place) = places.get(&key(voxel, axis)) {
                let list = list_of(voxels, lists, number);
                columns[place].primitives.extend_from_slice(list);
            }
        }
    }
    columns.par_iter_mut().for_each(|column| {
        column.primitives.sort_unstable();
        column.primitives.dedup();
    });
    columns
}
