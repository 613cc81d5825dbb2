//! The leafy tree and the kitchen: the image-order paper's Fig. 12 and its office, in kind.

use shiftvox::graph::Silent;
use shiftvox_mesh::LoadOptions;
use shiftvox_mesh::textured::levels::LevelRow;
use shiftvox_mesh::textured::{BuildOptions, Element, build};

use super::scenes::{file_of, model};

fn rows(name: &str) -> Vec<[u64; 3]> {
    let (mesh, _) =
        shiftvox_mesh::open::read_mesh(&model(name), &LoadOptions::default(), &Silent).unwrap();
    let data = build(&mesh, &BuildOptions::default(), &Silent).unwrap();
    let file = file_of(&data);
    file.verify().unwrap();
    let of = |row: &LevelRow| [row.faces, row.voxels, row.surfels];
    file.grid(0).levels().rows().iter().map(of).collect()
}

#[test]
#[ignore = "needs the folder SHIFTVOX_DATA"]
fn the_tree_and_the_kitchen_have_the_papers_table_in_kind() {
    let tree = [
        [791, 1099, 791],
        [6715, 468, 467],
        [16820, 152, 195],
        [21286, 32, 52],
        [22493, 3, 7],
        [22566, 0, 0],
    ];
    assert_eq!(rows("tree_Oak_Large.obj"), tree);
    let kitchen = [[1473, 1958, 1473], [50952, 110, 184], [56913, 0, 0]];
    assert_eq!(rows("kitchen.obj"), kitchen);
}

/// Why the default is the element of six sides: what a cube of 3 x 3 x 3 leaves
/// has, with all its neighbours, a volume that the image-order paper's table has no room for.
#[test]
fn the_papers_table_is_not_of_the_cube() {
    let voxels: [f64; 6] = [1481.0, 883.0, 485.0, 214.0, 61.0, 4.0];
    let has_room = |pair: &[f64]| (pair[1].cbrt() + 2.0).powi(3) <= pair[0];
    let rooms: Vec<bool> = voxels.windows(2).map(has_room).collect();
    assert_eq!(rooms, [false, false, false, true, true]);
    assert_eq!(BuildOptions::default().element, Element::Sides);
}
