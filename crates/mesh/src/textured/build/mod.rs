//! Triangles into textured voxels: cells, erosion depths, textures.
//!
//! The same triangles and options give the same bytes on any number of threads.

mod project;
mod voxels;

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use super::cell_grid::{ACROSS, MOST_ACROSS, MOST_CELLS, MOST_TEXELS};
use super::levels::surfels;
use super::record::{CLEAR, NEVER, Primitive, Texel, VoxelRecord};
use super::{CellGrid, Element, GridData, TexturedData};
use crate::{Surface, geometry, mesh_box};
use project::{Column, Projected, project};
use shiftvox::graph::Progress;
use voxels::{Filled, cell_of, depths, fill};

/// How textured voxels are built.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BuildOptions {
    /// Cells along each axis, one number for each grid: even, 2 to [`MOST_CELLS`].
    pub grids: Vec<u32>,
    /// Texels along the side of a voxel's face, 1 to [`MOST_TEXELS`].
    pub texels: u32,
    /// The structuring element of the erosion.
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

/// Most grids of a file.
pub const MOST_GRIDS: usize = 16;

/// Why nothing was built.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum BuildError {
    /// No triangles.
    #[error("there are no triangles to build textured voxels of")]
    Empty,
    /// More than 32 bits number.
    #[error("{0} are more than 32 bits can number")]
    TooMany(&'static str),
    /// Numbers of cells or texels that there are not.
    #[error(
        "a grid has an even number of cells from 2 to {MOST_CELLS}, since its middle plane parts \
         it into halves, 1 to {MOST_TEXELS} texels a cell and at most {MOST_ACROSS} texels in all; \
         not {cells} cells of {texels} texels"
    )]
    Grid {
        /// Cells along each axis.
        cells: u32,
        /// Texels along a face.
        texels: u32,
    },
    /// No grids, too many, or one twice.
    #[error("there are 1 to {MOST_GRIDS} grids, each of another number of cells")]
    Grids,
    /// Coordinates that single precision does not hold.
    #[error("the mesh is too large or too small for numbers of single precision")]
    Range,
}

/// Builds textured voxels of a surface.
///
/// # Errors
/// See [`BuildError`].
pub fn build<S: Surface + ?Sized>(
    surface: &S,
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
    let primitives: Vec<Primitive> = (0..surface.len())
        .into_par_iter()
        .map(|number| Primitive::of(&surface.triangle(number)))
        .collect();
    let (rounded_low, rounded_high) = bounds(&primitives);
    if !(rounded_low.is_finite() && rounded_high.is_finite()) {
        return Err(BuildError::Range);
    }
    // The mesh's own box: what is made of a mesh is seen from one place.
    let (low, high) = surface.bounds();
    let extent = (high - low).max_element();
    if !(low.is_finite() && high.is_finite() && extent > 0.0) {
        return Err(BuildError::Range);
    }
    let grids = grids.into_iter().map(|cells| {
        let lattice = CellGrid::around(low, high, cells, texels);
        build_grid(surface, &primitives, &lattice, options.element, progress)
    });
    let grids = grids.collect::<Result<Vec<GridData>, BuildError>>()?;
    Ok(TexturedData {
        low,
        high,
        y_up: false,
        bevels: mesh_box(surface, false).bevels,
        primitives,
        grids,
    })
}

/// The box around the corners as they are stored.
pub(super) fn bounds(primitives: &[Primitive]) -> (DVec3, DVec3) {
    geometry::bounds(primitives.iter().flat_map(Primitive::positions))
}

fn build_grid<S: Surface + ?Sized>(
    surface: &S,
    primitives: &[Primitive],
    lattice: &CellGrid,
    element: Element,
    progress: &dyn Progress,
) -> Result<GridData, BuildError> {
    progress.begin("find voxels", 0);
    let corners: Vec<[[i64; 3]; 3]> = primitives
        .par_iter()
        .map(|primitive| primitive.positions().map(|p| lattice.point(p)))
        .collect();
    let filled = fill(&corners, lattice);
    let depths = depths(&filled.cells, lattice.cells(), element);
    progress.end();
    if filled.lists.len() >= NEVER as usize {
        return Err(BuildError::TooMany("primitives of all voxels"));
    }
    let (mut voxels, lists) = sorted(&filled, &depths, lattice.cells());
    let columns = columns(&voxels, &lists, lattice.cells());
    progress.begin("project textures", columns.len() as u64);
    let projected: Vec<Projected> = columns
        .par_iter()
        .map(|(axis, column)| {
            debug_assert_eq!(*axis, column.axis);
            let projected = project(column, surface, &corners, lattice);
            progress.advance(1);
            projected
        })
        .collect();
    progress.end();
    let mut grid = GridData {
        cells: lattice.cells(),
        texels: lattice.texels(),
        element,
        voxels: Vec::new(),
        lists,
        textures: Vec::new(),
        projected: projected.iter().map(|p| p.texels).sum(),
        projected_afresh: projected.iter().map(|p| p.texels_afresh).sum(),
    };
    let mut pool = Pool::default();
    for ((axis, _), projected) in columns.iter().zip(projected) {
        for (voxel, texture) in projected.textures {
            voxels[voxel as usize].textures[*axis] = match texture {
                Some(texture) => pool.number(texture, &mut grid.textures)?,
                None => CLEAR,
            };
        }
    }
    grid.voxels = voxels;
    Ok(grid)
}

/// The erosion depths of voxels, computed from their cells alone.
pub(super) fn depths_of(voxels: &[VoxelRecord], cells: u32, element: Element) -> Vec<u16> {
    let number = |voxel: &VoxelRecord| {
        let [x, y, z] = voxel.cell.map(u32::from);
        (z * cells + y) * cells + x
    };
    let mut places: Vec<(u32, usize)> = voxels.iter().map(number).zip(0..).collect();
    places.sort_unstable();
    let filled: Vec<u32> = places.iter().map(|(number, _)| *number).collect();
    let mut found = vec![0; voxels.len()];
    for ((_, place), depth) in places.iter().zip(depths(&filled, cells, element)) {
        found[*place] = depth;
    }
    found
}

/// Voxels by depth and then by cell, without textures yet, and their lists.
fn sorted(filled: &Filled, depths: &[u16], cells: u32) -> (Vec<VoxelRecord>, Vec<u32>) {
    let mut places: Vec<usize> = (0..filled.cells.len()).collect();
    places.sort_by_key(|&place| depths[place]);
    let mut lists = Vec::with_capacity(filled.lists.len());
    let voxels = places
        .into_iter()
        .map(|place| {
            // Fewer than 2^32: the caller made sure.
            let first = lists.len() as u32;
            lists.extend_from_slice(filled.list(place));
            VoxelRecord {
                cell: cell_of(filled.cells[place], cells).map(|c| c as u16),
                depth: depths[place],
                first,
                textures: [NEVER; 3],
            }
        })
        .collect();
    (voxels, lists)
}

/// The columns of which levels show faces, in one order.
fn columns(voxels: &[VoxelRecord], lists: &[u32], cells: u32) -> Vec<(usize, Column)> {
    let list = |number: usize| {
        let end = voxels
            .get(number + 1)
            .map_or(lists.len(), |v| v.first as usize);
        &lists[voxels[number].first as usize..end]
    };
    let column_of = |voxel: &VoxelRecord, axis: usize| {
        let [across, down] = ACROSS[axis];
        [voxel.cell[across], voxel.cell[down]].map(u32::from)
    };
    let mut columns: Vec<(usize, Column)> = Vec::new();
    let mut places: HashMap<(usize, [u32; 2]), usize> = HashMap::new();
    for surfel in surfels(voxels, cells) {
        let axis = usize::from(surfel.axis);
        let voxel = &voxels[surfel.voxel as usize];
        let at = column_of(voxel, axis);
        let place = *places.entry((axis, at)).or_insert_with(|| {
            let column = Column {
                axis,
                at,
                primitives: Vec::new(),
                wanted: Vec::new(),
            };
            columns.push((axis, column));
            columns.len() - 1
        });
        let wanted = &mut columns[place].1.wanted;
        wanted.push((u32::from(voxel.cell[axis]), surfel.voxel));
    }
    for number in 0..voxels.len() {
        for axis in 0..3 {
            if let Some(&place) = places.get(&(axis, column_of(&voxels[number], axis))) {
                columns[place].1.primitives.extend_from_slice(list(number));
            }
        }
    }
    columns.par_iter_mut().for_each(|(_, column)| {
        column.primitives.sort_unstable();
        column.primitives.dedup();
    });
    columns
}

/// Gives equal sub-textures one number.
#[derive(Default)]
struct Pool {
    numbers: HashMap<Vec<Texel>, u32>,
}

impl Pool {
    fn number(&mut self, texture: Vec<Texel>, all: &mut Vec<Texel>) -> Result<u32, BuildError> {
        let next = self.numbers.len();
        if next >= CLEAR as usize {
            return Err(BuildError::TooMany("sub-textures"));
        }
        if let Some(&number) = self.numbers.get(&texture) {
            return Ok(number);
        }
        all.extend_from_slice(&texture);
        // Below `CLEAR`.
        self.numbers.insert(texture, next as u32);
        Ok(next as u32)
    }
}
