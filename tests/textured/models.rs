//! The leafy tree and the kitchen: the paper's Fig. 12 and its office, in kind.

use shiftvox::graph::Silent;
use shiftvox::mesh::LoadOptions;
use shiftvox::scene;
use shiftvox::textured::levels::LevelRow;
use shiftvox::textured::{BuildOptions, build};

use super::scenes::{file_of, model};

fn rows(name: &str) -> Option<Vec<LevelRow>> {
    let path = model(name)?;
    let (mesh, _) = scene::read_mesh(&path, &LoadOptions::default(), &Silent).unwrap();
    let data = build(&mesh, &BuildOptions::default(), &Silent).unwrap();
    let file = file_of(&data);
    file.verify().unwrap();
    Some(file.grid(0).levels().rows().to_vec())
}

#[test]
fn the_tree_and_the_kitchen_have_the_papers_table_in_kind() {
    if let Some(rows) = rows("tree_Oak_Large.obj") {
        let table: Vec<[u64; 3]> = rows
            .iter()
            .map(|r| [r.faces, r.voxels, r.surfels])
            .collect();
        let expected = [
            [791, 1099, 791],
            [15520, 178, 220],
            [22384, 5, 10],
            [22566, 0, 0],
        ];
        assert_eq!(table, expected);
    }
    if let Some(rows) = rows("kitchen.obj") {
        let table: Vec<[u64; 3]> = rows
            .iter()
            .map(|r| [r.faces, r.voxels, r.surfels])
            .collect();
        assert_eq!(table, [[1473, 1958, 1473], [54695, 14, 26], [56914, 0, 0]]);
    }
}
