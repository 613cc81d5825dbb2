//! The primitives of each cell, and the erosion depth of the cell.

use rayon::prelude::*;

use crate::textured::{CellGrid, Element};
use crate::voxelize::{Prepared, child};

pub(super) fn cell_of(number: u32, cells: u32) -> [u32; 3] {
    [
        number % cells,
        number / cells % cells,
        number / (cells * cells),
    ]
}

/// Pairs of a cell, `(z * cells + y) * cells + x`, in the upper half, and a primitive that touches it when closed, in the
/// lower half; rising.
pub(super) fn fill(corners: &[[[i64; 3]; 3]], lattice: &CellGrid) -> Vec<u64> {
    let mut pairs: Vec<u64> = corners
        .par_iter()
        .enumerate()
        .flat_map_iter(|(primitive, &corners)| {
            let side = i64::from(lattice.cells.next_power_of_two());
            let mut touched = Vec::new();
            descend(&Prepared::new(corners), lattice, [0; 3], side, &mut touched);
            let pair = move |cell| u64::from(cell) << 32 | primitive as u64;
            touched.into_iter().map(pair)
        })
        .collect();
    pairs.par_sort_unstable();
    pairs
}

/// Finds the cells that a triangle touches in a cube of `side` cells, a power of two.
fn descend(
    triangle: &Prepared,
    lattice: &CellGrid,
    corner: [i64; 3],
    side: i64,
    touched: &mut Vec<u32>,
) {
    let (cells, step) = (i64::from(lattice.cells), lattice.cell_steps());
    let is_beyond = corner.iter().any(|&c| c >= cells);
    if is_beyond || !triangle.touches(corner.map(|c| c * step), side * step) {
        return;
    }
    if side == 1 {
        let [x, y, z] = corner;
        touched.push(((z * cells + y) * cells + x) as u32);
        return;
    }
    for octant in 0..8 {
        let corner = child(corner, side / 2, octant);
        descend(triangle, lattice, corner, side / 2, touched);
    }
}

/// Erosions that each of some cells survives. Beyond the grid all is empty.
///
/// A cell survives as many as it is steps of the structuring element away from the nearest empty cell, less one. Two
/// passes over the grid find that exactly, for both elements.
pub(in crate::textured) fn depths(
    filled: impl Iterator<Item = [u32; 3]>,
    cells: u32,
    element: Element,
) -> Vec<u16> {
    let side = cells as usize + 2;
    let at = |cell: [u32; 3]| {
        let [x, y, z] = cell.map(|c| c as usize + 1);
        (z * side + y) * side + x
    };
    let places: Vec<usize> = filled.map(at).collect();
    let mut steps = vec![0u16; side * side * side];
    for &here in &places {
        steps[here] = u16::MAX;
    }
    // Of the neighbours before a cell, how far before.
    let offsets: Vec<usize> = (0..13usize)
        .map(|i| [i % 3, i / 3 % 3, i / 9])
        .filter(|cell| {
            let axes = cell.iter().filter(|&&c| c != 1).count();
            element == Element::Cube || axes == 1
        })
        .map(|[x, y, z]| at([0; 3]) - ((z * side + y) * side + x))
        .collect();
    let mut rising = places.clone();
    rising.sort_unstable();
    for &here in &rising {
        let least = offsets.iter().map(|&back| steps[here - back]).min();
        steps[here] = least.unwrap_or(0).saturating_add(1).min(steps[here]);
    }
    for &here in rising.iter().rev() {
        let least = offsets.iter().map(|&ahead| steps[here + ahead]).min();
        steps[here] = least.unwrap_or(0).saturating_add(1).min(steps[here]);
    }
    places.into_iter().map(|here| steps[here] - 1).collect()
}
