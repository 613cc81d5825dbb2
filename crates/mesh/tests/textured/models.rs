//! The levels of a leafy tree and a kitchen, in the form of the image-order paper's table.

use shiftvox::graph::Silent;
use shiftvox_mesh::LoadOptions;
use shiftvox_mesh::open::read_mesh;
use shiftvox_mesh::textured::{BuildOptions, build};

use super::scenes::file_of;
use super::shared::model;

/// Faces, voxels and surfels of each level.
const TREE: [[u64; 3]; 6] = [
    [791, 1099, 791],
    [6715, 468, 467],
    [16820, 152, 195],
    [21286, 32, 52],
    [22493, 3, 7],
    [22566, 0, 0],
];
const KITCHEN: [[u64; 3]; 3] = [[1473, 1958, 1473], [50952, 110, 184], [56913, 0, 0]];

#[test]
#[ignore = "needs the shared data"]
fn the_tree_and_the_kitchen_have_known_levels() {
    for (name, expected) in [("tree_Oak_Large.obj", &TREE[..]), ("kitchen.obj", &KITCHEN)] {
        let (mesh, _) = read_mesh(&model(name), &LoadOptions::default(), &Silent).unwrap();
        let file = file_of(&build(&mesh, &BuildOptions::default(), &Silent).unwrap());
        file.verify().unwrap();
        let rows = file.grid(0).levels().rows().iter();
        let table: Vec<_> = rows.map(|r| [r.faces, r.voxels, r.surfels]).collect();
        assert_eq!(table, expected, "{name}");
    }
}
