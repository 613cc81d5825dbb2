//! The levels of a leafy tree and a kitchen, in the form of the image-order paper's table.

use shiftvox::graph::Silent;
use shiftvox_mesh::LoadOptions;
use shiftvox_mesh::open::read_mesh;
use shiftvox_mesh::textured::{BuildOptions, Element, build};

use super::scenes::file_of;
use super::shared::model;

#[test]
#[ignore = "needs the shared data"]
fn the_tree_and_the_kitchen_have_the_papers_table_in_kind() {
    // Faces, voxels and surfels of each level.
    let tables: [(&str, &[[u64; 3]]); 2] = [
        (
            "tree_Oak_Large.obj",
            &[
                [791, 1099, 791],
                [6715, 468, 467],
                [16820, 152, 195],
                [21286, 32, 52],
                [22493, 3, 7],
                [22566, 0, 0],
            ],
        ),
        (
            "kitchen.obj",
            &[[1473, 1958, 1473], [50952, 110, 184], [56913, 0, 0]],
        ),
    ];
    for (name, expected) in tables {
        let (mesh, _) = read_mesh(&model(name), &LoadOptions::default(), &Silent).unwrap();
        let file = file_of(&build(&mesh, &BuildOptions::default(), &Silent).unwrap());
        file.verify().unwrap();
        let rows = file.grid(0).levels().rows().iter();
        let table: Vec<_> = rows.map(|r| [r.faces, r.voxels, r.surfels]).collect();
        assert_eq!(table, expected, "{name}");
    }
}

/// Why the default is the element of six sides: the volume that the image-order paper's table has is too small for
/// the neighbours of all voxels that erosion by a cube of 3 x 3 x 3 leaves.
#[test]
fn the_papers_table_is_not_of_the_cube() {
    let voxels: [f64; 6] = [1481.0, 883.0, 485.0, 214.0, 61.0, 4.0];
    let has_room = |pair: &[f64]| (pair[1].cbrt() + 2.0).powi(3) <= pair[0];
    let rooms: Vec<bool> = voxels.windows(2).map(has_room).collect();
    assert_eq!(rooms, [false, false, false, true, true]);
    assert_eq!(BuildOptions::default().element, Element::Sides);
}
