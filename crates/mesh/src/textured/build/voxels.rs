//! Which primitives are in which cell, and how deep a cell lies.

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

/// The cell of a number.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_are_what_erosions_leave() {
        let cells = 8u32;
        let mut state = 7u32;
        for round in 0..60 {
            let filled: Vec<u32> = (0..cells.pow(3))
                .filter(|_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    state >> 24 > round * 2
                })
                .collect();
            for element in [Element::Cube, Element::Sides] {
                let found = depths(&filled, cells, element);
                let mut left: Vec<bool> = (0..cells.pow(3))
                    .map(|n| filled.binary_search(&n).is_ok())
                    .collect();
                for level in 0..5u16 {
                    for (number, is_left) in left.iter().enumerate() {
                        let survives = filled
                            .binary_search(&(number as u32))
                            .is_ok_and(|place| found[place] >= level);
                        assert_eq!(*is_left, survives, "{number} at {level}");
                    }
                    left = eroded(&left, cells as i64, element);
                }
            }
        }
    }

    /// One erosion, by the definition.
    fn eroded(cells: &[bool], side: i64, element: Element) -> Vec<bool> {
        let is_full = |[x, y, z]: [i64; 3]| {
            let inside = [x, y, z].iter().all(|c| (0..side).contains(c));
            inside && cells[((z * side + y) * side + x) as usize]
        };
        (0..side * side * side)
            .map(|n| {
                let cell = [n % side, n / side % side, n / side / side];
                (0..27).all(|i| {
                    let step = [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1];
                    let length: i64 = step.iter().map(|c: &i64| c.abs()).sum();
                    let counts = element == Element::Cube || length <= 1;
                    !counts || is_full([0, 1, 2].map(|k| cell[k] + step[k]))
                })
            })
            .collect()
    }
}
