//! Levels of detail: sets of voxels, primitives and surfels.

use std::collections::BTreeSet;

use proptest::prelude::*;
use shiftvox::graph::Silent;
use shiftvox_mesh::LoadOptions;
use shiftvox_mesh::open::read_mesh;
use shiftvox_mesh::textured::levels::surfels;
use shiftvox_mesh::textured::record::CLEAR;
use shiftvox_mesh::textured::{BuildOptions, Element, TexturedFile, build};

use super::scenes::{balls, built, file_of, mesh_of, random_triangles, rectangle, small_grids};
use super::shared::model;

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
fn check(file: &TexturedFile) -> u32 {
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
fn blocks_and_clouds_have_levels() {
    assert_eq!(BuildOptions::default().element, Element::Sides);
    for element in [Element::Cube, Element::Sides] {
        assert!(check(&file_of(&built(&balls(), 16, 2, element))) >= 2);
    }
    // Sheets through 6 x 6 x 6 cells: a solid block that loses one layer per level.
    let sheet = |i: u8| rectangle(f32::from(i) * 0.5, [0.0; 2], [6.0; 2]);
    let sheets: Vec<_> = (0..=12).flat_map(sheet).collect();
    let data = built(&mesh_of(&sheets).unwrap(), 6, 1, Element::Cube);
    assert_eq!(check(&file_of(&data)), 3);
    let all = surfels(&data.grids[0].voxels, 6).len();
    assert_eq!(all, 6 * (36 + 16 + 4));
}

/// Faces, voxels and surfels of each level of a leafy tree, as in the image-order paper's table, and of a kitchen.
#[test]
#[ignore = "needs the shared data"]
fn the_tree_and_the_kitchen_have_known_levels() {
    const TREE: [[u64; 3]; 6] = [
        [791, 1099, 791],
        [6715, 468, 467],
        [16820, 152, 195],
        [21286, 32, 52],
        [22493, 3, 7],
        [22566, 0, 0],
    ];
    const KITCHEN: [[u64; 3]; 3] = [[1473, 1958, 1473], [50952, 110, 184], [56913, 0, 0]];
    for (name, expected) in [("tree_Oak_Large.obj", &TREE[..]), ("kitchen.obj", &KITCHEN)] {
        let (mesh, _) = read_mesh(&model(name), &LoadOptions::default(), &Silent).unwrap();
        let file = file_of(&build(&mesh, &BuildOptions::default(), &Silent).unwrap());
        file.verify().unwrap();
        let rows = file.grid(0).levels().rows().iter();
        let table: Vec<_> = rows.map(|r| [r.faces, r.voxels, r.surfels]).collect();
        assert_eq!(table, expected, "{name}");
    }
}
