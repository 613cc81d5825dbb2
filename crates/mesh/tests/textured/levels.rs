//! Levels of detail: sets of voxels, primitives and surfels.

use std::collections::BTreeSet;

use shiftvox_mesh::textured::record::CLEAR;
use shiftvox_mesh::textured::{Element, TexturedFile};

use super::scenes::{balls, built, file_of};

type Cells = BTreeSet<[i32; 3]>;

/// One erosion, by the definition: cells with an empty neighbour vanish.
fn eroded(cells: &Cells, element: Element) -> Cells {
    let keeps = |cell: &&[i32; 3]| {
        (0..27).all(|i| {
            let step = [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1];
            let axes = step.iter().filter(|&&c| c != 0).count();
            let counts = element == Element::Cube || axes <= 1;
            !counts || cells.contains(&[0, 1, 2].map(|k| cell[k] + step[k]))
        })
    };
    cells.iter().filter(keeps).copied().collect()
}

/// Checks all levels against definitions. Returns the last.
pub(super) fn check(file: &TexturedFile) -> u32 {
    let grid = file.grid(0);
    let (levels, voxels) = (grid.levels(), grid.voxels());
    let cell = |number: usize| voxels[number].cell.map(i32::from);
    let mut expected: Cells = (0..voxels.len()).map(cell).collect();
    assert_eq!(expected.len(), voxels.len());
    let middle = grid.cell_grid().cells as i32 / 2;
    for row in levels.rows() {
        let left = voxels.len() - row.voxels as usize..voxels.len();
        let cells: Cells = left.clone().map(cell).collect();
        assert_eq!(cells, expected, "level {}", row.level);
        expected = eroded(&expected, grid.element());
        let gone = (0..left.start).flat_map(|v| grid.list(v)).copied();
        let gone: BTreeSet<u32> = gone.collect();
        let mut found = levels.primitives(row.level).to_vec();
        found.sort_unstable();
        assert!(found.iter().eq(&gone));
        // Of each column and half, the first voxel from outside.
        let mut faces = Vec::new();
        for (voxel, axis) in left.flat_map(|voxel| [0, 1, 2].map(|axis| (voxel, axis))) {
            let at = cell(voxel);
            let is_upper = at[axis] >= middle;
            let hides = |other: &[i32; 3]| {
                let step = other[axis] - at[axis];
                let is_farther = if is_upper { step > 0 } else { step < 0 };
                is_farther && (0..3).all(|k| k == axis || other[k] == at[k])
            };
            if !cells.iter().any(hides) && voxels[voxel].textures[axis] < CLEAR {
                faces.push((voxel as u32, axis as u8, is_upper));
            }
        }
        let found = levels.surfels(row.level);
        let mut found: Vec<_> = found.map(|s| (s.voxel, s.axis, s.is_positive)).collect();
        found.sort_unstable();
        assert_eq!(found, faces);
        let numbers = [row.primitives, row.surfels, row.faces];
        let [primitives, surfels] = [gone.len() as u64, faces.len() as u64];
        assert_eq!(numbers, [primitives, surfels, primitives + surfels]);
    }
    assert!(expected.is_empty());
    let last = levels.rows().last().unwrap();
    assert_eq!(last.primitives as usize, file.primitives().len());
    assert_eq!((last.voxels, last.surfels), (0, 0));
    levels.last()
}

#[test]
fn clouds_have_levels() {
    for element in [Element::Cube, Element::Sides] {
        assert!(check(&file_of(&built(&balls(), 16, 2, element))) >= 2);
    }
}
