//! The primitives of each cell, and the erosion depth of the cell.

use rayon::prelude::*;

use crate::textured::{CellGrid, Element};
use crate::voxelize::{Prepared, child};

/// Cells that are not empty, with the primitives that touch them.
#[derive(Debug, Default)]
pub(super) struct Filled {
    /// Numbers of cells, `(z * cells + y) * cells + x`, rising.
    pub(super) cells: Vec<u32>,
    /// The first of each cell's entries in `lists`; one more than cells.
    pub(super) firsts: Vec<usize>,
    /// Primitives of each cell, rising.
    pub(super) lists: Vec<u32>,
}

impl Filled {
    /// The primitives of a cell by its place among those that are not empty.
    pub(super) fn list(&self, place: usize) -> &[u32] {
        &self.lists[self.firsts[place]..self.firsts[place + 1]]
    }
}

pub(super) fn cell_of(number: u32, cells: u32) -> [u32; 3] {
    [
        number % cells,
        number / cells % cells,
        number / (cells * cells),
    ]
}

/// Finds the cells that triangles touch: closed cells, decided exactly on the lattice.
pub(super) fn fill(corners: &[[[i64; 3]; 3]], lattice: &CellGrid) -> Filled {
    let mut pairs: Vec<u64> = corners
        .par_iter()
        .enumerate()
        .flat_map_iter(|(primitive, &corners)| {
            let mut touched = Vec::new();
            let descent = Descent {
                prepared: Prepared::new(corners),
                cells: i64::from(lattice.cells()),
                step: lattice.cell_steps(),
            };
            let side = lattice.cells().next_power_of_two();
            descent.node([0; 3], i64::from(side), &mut touched);
            touched
                .into_iter()
                .map(move |cell| u64::from(cell) << 32 | primitive as u64)
        })
        .collect();
    pairs.par_sort_unstable();
    let mut filled = Filled::default();
    for (place, pair) in pairs.iter().enumerate() {
        let cell = (pair >> 32) as u32;
        if filled.cells.last() != Some(&cell) {
            filled.cells.push(cell);
            filled.firsts.push(place);
        }
        filled.lists.push(*pair as u32);
    }
    filled.firsts.push(pairs.len());
    filled
}

struct Descent {
    prepared: Prepared,
    cells: i64,
    step: i64,
}

impl Descent {
    /// A cube of `side` cells, a power of two, that the triangle may touch.
    fn node(&self, corner: [i64; 3], side: i64, touched: &mut Vec<u32>) {
        if corner.iter().any(|&c| c >= self.cells) {
            return;
        }
        let at = corner.map(|c| c * self.step);
        if !self.prepared.touches(at, side * self.step) {
            return;
        }
        if side == 1 {
            let [x, y, z] = corner;
            // Below 2^21.
            touched.push(((z * self.cells + y) * self.cells + x) as u32);
            return;
        }
        for octant in 0..8 {
            self.node(child(corner, side / 2, octant), side / 2, touched);
        }
    }
}

/// Erosions that each of some cells survives. Beyond the grid all is empty.
///
/// A cell survives as many erosions as it is steps away from the nearest empty
/// cell, less one, in the steps of the structuring element. Two passes over
/// the grid find that exactly, for this element as for that.
pub(super) fn depths(filled: &[u32], cells: u32, element: Element) -> Vec<u16> {
    // A border of empty cells on every side.
    let side = cells as usize + 2;
    let at = |number: u32| {
        let [x, y, z] = cell_of(number, cells).map(|c| c as usize + 1);
        (z * side + y) * side + x
    };
    let mut steps = vec![0u16; side * side * side];
    for &number in filled {
        steps[at(number)] = u16::MAX;
    }
    let offsets = preceding(element).map(|[x, y, z]| (z * side as i64 + y) * side as i64 + x);
    let offsets: Vec<usize> = offsets.map(|offset| (-offset) as usize).collect();
    for &number in filled {
        let here = at(number);
        let least = offsets.iter().map(|&back| steps[here - back]).min();
        steps[here] = least.unwrap_or(0).saturating_add(1).min(steps[here]);
    }
    for &number in filled.iter().rev() {
        let here = at(number);
        let least = offsets.iter().map(|&ahead| steps[here + ahead]).min();
        steps[here] = least.unwrap_or(0).saturating_add(1).min(steps[here]);
    }
    filled.iter().map(|&number| steps[at(number)] - 1).collect()
}

/// The neighbours of a cell that come before it in the order of numbers.
fn preceding(element: Element) -> impl Iterator<Item = [i64; 3]> {
    (0..13i64)
        .map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1])
        .filter(move |offset| {
            let axes = offset.iter().filter(|&&c| c != 0).count();
            element == Element::Cube || axes == 1
        })
}
