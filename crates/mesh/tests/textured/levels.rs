//! Levels of detail: sets of voxels, primitives, surfels; up and down without rebuilding.

use std::collections::BTreeSet;

use proptest::prelude::*;
use shiftvox_mesh::textured::levels::surfels;
use shiftvox_mesh::textured::record::CLEAR;
use shiftvox_mesh::textured::{Element, TexturedFile};

use super::scenes::{balls, built, file_of, mesh_of, random_triangles, small_grids};

type Cells = BTreeSet<[i32; 3]>;

/// The voxels that a level leaves.
fn left(file: &TexturedFile, level: u32) -> Cells {
    let grid = file.grid(0);
    let voxels = &grid.voxels()[grid.levels().eroded(level)..];
    voxels.iter().map(|v| v.cell.map(i32::from)).collect()
}

/// One erosion, by the definition: cells go that have an empty one beside them.
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

/// Checks all levels of a grid against definitions.
fn check(file: &TexturedFile) {
    let grid = file.grid(0);
    let (levels, voxels) = (grid.levels(), grid.voxels());
    let mut expected = left(file, 0);
    assert_eq!(expected.len(), voxels.len());
    for level in 0..=levels.last() {
        assert_eq!(left(file, level), expected, "level {level}");
        expected = eroded(&expected, grid.element());
        let row = &levels.rows()[level as usize];
        // Primitives of the voxels that are gone.
        let gone = 0..levels.eroded(level);
        let shown: BTreeSet<u32> = gone.flat_map(|v| grid.list(v)).copied().collect();
        let found: BTreeSet<u32> = levels.primitives(level).iter().copied().collect();
        assert_eq!(found, shown, "level {level}");
        assert_eq!(found.len(), levels.primitives(level).len());
        // Of each column and half, the first voxel from outside.
        let cells = grid.cell_grid().cells();
        let mut faces = BTreeSet::new();
        for voxel in levels.eroded(level)..voxels.len() {
            for axis in 0..3 {
                let at = voxels[voxel].cell;
                let half = |slice: u16| u32::from(slice) >= cells / 2;
                let hides = |other: &[u16; 3]| {
                    let same = (0..3).all(|k| k == axis || other[k] == at[k]);
                    let farther = if half(at[axis]) {
                        other[axis] > at[axis]
                    } else {
                        other[axis] < at[axis]
                    };
                    same && farther
                };
                let mut rest = voxels[levels.eroded(level)..].iter();
                if !rest.any(|v| hides(&v.cell)) && voxels[voxel].textures[axis] < CLEAR {
                    faces.insert((voxel as u32, axis as u8, half(at[axis])));
                }
            }
        }
        let found = levels.surfels(level);
        let found: Vec<_> = found.map(|s| (s.voxel, s.axis, s.is_positive)).collect();
        assert_eq!(found.len(), faces.len());
        assert_eq!(found.into_iter().collect::<BTreeSet<_>>(), faces);
        let numbers = [row.primitives, row.voxels, row.surfels].map(|n| n as usize);
        let left = voxels.len() - levels.eroded(level);
        assert_eq!(numbers, [shown.len(), left, faces.len()]);
        assert_eq!(row.faces, row.primitives + row.surfels);
    }
    assert!(expected.is_empty());
    let last = levels.rows().last().unwrap();
    assert_eq!(last.primitives as usize, file.primitives().len());
    assert_eq!((last.voxels, last.surfels), (0, 0));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn levels_are_what_erosions_leave(
        triangles in random_triangles(),
        (cells, texels, element) in small_grids(),
    ) {
        if let Some(mesh) = mesh_of(&triangles) {
            check(&file_of(&built(&mesh, cells, texels, element)));
        }
    }
}

#[test]
fn up_and_down_are_the_same_levels() {
    for element in [Element::Cube, Element::Sides] {
        let file = file_of(&built(&balls(), 16, 2, element));
        let levels = file.grid(0).levels();
        let last = levels.last();
        // Three levels with voxels or two, and the one without.
        assert!(last >= 2, "{last}");
        let mut downwards = vec![left(&file, 0)];
        for level in 1..=last {
            downwards.push(left(&file, level));
        }
        for level in (0..=last).rev() {
            let before = (level < last).then(|| left(&file, level + 1));
            let here = left(&file, level);
            assert_eq!(here, downwards[level as usize]);
            // A dilation brings back what the erosion took, and nothing else.
            if let Some(before) = before {
                let returned: Cells = here.difference(&before).copied().collect();
                let taken: Cells = here.difference(&eroded(&here, element)).copied().collect();
                assert_eq!(returned, taken);
            }
        }
        check(&file);
    }
}

#[test]
fn a_solid_block_loses_a_layer_at_a_time() {
    // A block of 6 x 6 x 6 cells in its own grid of 6: 216, 64, 8, 0.
    let mut triangles = Vec::new();
    for i in 0..=12 {
        let z = i as f32 * 0.5;
        let corners = [[0.0, 0.0, z], [6.0, 0.0, z], [6.0, 6.0, z], [0.0, 6.0, z]];
        triangles.push([corners[0], corners[1], corners[2]]);
        triangles.push([corners[0], corners[2], corners[3]]);
    }
    let data = built(&mesh_of(&triangles).unwrap(), 6, 1, Element::Cube);
    let file = file_of(&data);
    let rows = file.grid(0).levels().rows();
    let voxels: Vec<u64> = rows.iter().map(|row| row.voxels).collect();
    assert_eq!(voxels, [216, 64, 8, 0]);
    // Two faces of each column; plates are seen edge on from four sides.
    let surfels: Vec<u64> = rows.iter().map(|row| row.surfels).collect();
    assert_eq!(surfels, [72, 32, 8, 0]);
    assert_eq!(surfels_of_all(&data), 6 * (36 + 16 + 4));
}

fn surfels_of_all(data: &shiftvox_mesh::textured::TexturedData) -> usize {
    surfels(&data.grids[0].voxels, data.grids[0].cells).len()
}
