//! Levels of detail: sets of voxels, primitives and surfels.

use std::collections::BTreeSet;

use proptest::prelude::*;
use shiftvox_mesh::textured::levels::surfels;
use shiftvox_mesh::textured::record::CLEAR;
use shiftvox_mesh::textured::{BuildOptions, Element, TexturedFile};

use super::scenes::{balls, built, file_of, mesh_of, random_triangles, rectangle, small_grids};

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

/// Checks all levels of a file's grid against definitions. Returns the number of the last level.
fn check(file: &TexturedFile) -> u32 {
    let grid = file.grid(0);
    let (levels, voxels) = (grid.levels(), grid.voxels());
    let cell = |number: usize| voxels[number].cell.map(i32::from);
    let mut expected: Cells = (0..voxels.len()).map(cell).collect();
    assert_eq!(expected.len(), voxels.len());
    let middle = grid.cell_grid().cells() as i32 / 2;
    for level in 0..=levels.last() {
        let gone = voxels.len() - levels.row(level).voxels as usize;
        let left = gone..voxels.len();
        let cells: Cells = left.clone().map(cell).collect();
        assert_eq!(cells, expected, "level {level}");
        expected = eroded(&expected, grid.element());
        // Primitives of the voxels that are gone.
        let shown: BTreeSet<u32> = (0..gone).flat_map(|v| grid.list(v)).copied().collect();
        let found = levels.primitives(level);
        assert_eq!(found.len(), shown.len());
        assert_eq!(found.iter().copied().collect::<BTreeSet<_>>(), shown);
        // Of each column and half, the first voxel from outside.
        let mut faces = BTreeSet::new();
        for voxel in left.clone() {
            for axis in 0..3 {
                let at = cell(voxel);
                let is_upper = at[axis] >= middle;
                let hides = |other: &[i32; 3]| {
                    let step = other[axis] - at[axis];
                    let is_farther = if is_upper { step > 0 } else { step < 0 };
                    is_farther && (0..3).all(|k| k == axis || other[k] == at[k])
                };
                if !cells.iter().any(hides) && voxels[voxel].textures[axis] < CLEAR {
                    faces.insert((voxel as u32, axis as u8, is_upper));
                }
            }
        }
        let found = levels.surfels(level);
        let found: Vec<_> = found.map(|s| (s.voxel, s.axis, s.is_positive)).collect();
        assert_eq!(found.len(), faces.len());
        assert_eq!(found.into_iter().collect::<BTreeSet<_>>(), faces);
        let row = &levels.rows()[level as usize];
        let numbers = [row.primitives, row.voxels, row.surfels].map(|n| n as usize);
        assert_eq!(numbers, [shown.len(), left.len(), faces.len()]);
        assert_eq!(row.faces, row.primitives + row.surfels);
    }
    assert!(expected.is_empty());
    let last = levels.rows().last().unwrap();
    assert_eq!(last.primitives as usize, file.primitives().len());
    assert_eq!((last.voxels, last.surfels), (0, 0));
    levels.last()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn levels_are_the_rest_after_erosions(
        triangles in random_triangles(),
        (cells, texels, element) in small_grids(),
    ) {
        if let Some(mesh) = mesh_of(&triangles) {
            check(&file_of(&built(&mesh, cells, texels, element)));
        }
    }
}

#[test]
fn a_cloud_of_balls_has_three_levels_or_more() {
    assert_eq!(BuildOptions::default().element, Element::Sides);
    for element in [Element::Cube, Element::Sides] {
        assert!(check(&file_of(&built(&balls(), 16, 2, element))) >= 2);
    }
}

#[test]
fn a_solid_block_loses_one_layer_per_level() {
    // Sheets through 6 x 6 x 6 cells.
    let sheet = |i: u8| rectangle(f32::from(i) * 0.5, [0.0; 2], [6.0; 2]);
    let sheets: Vec<_> = (0..=12).flat_map(sheet).collect();
    let data = built(&mesh_of(&sheets).unwrap(), 6, 1, Element::Cube);
    assert_eq!(check(&file_of(&data)), 3);
    let grid = &data.grids[0];
    let all = surfels(&grid.voxels, grid.cells).len();
    assert_eq!(all, 6 * (36 + 16 + 4));
}
