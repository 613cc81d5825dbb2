//! Opacities of a mesh's voxels at every level: a thin bar keeps its width, a wall stays whole.

use shiftvox::graph::{BuildOptions, Builder, Graph, Silent, sixteenths};
use shiftvox_mesh::Mesh;
use shiftvox_mesh::voxelize::{Grid, opacities};
use xxhash_rust::xxh3::xxh3_64;

use super::shared::{ball, one_box, quad, shape};
use super::voxels::{random, voxels};

/// The graph of a mesh's voxels, with opacities.
pub(super) fn graph_of(mesh: &Mesh, depth: u32) -> (Graph, Grid) {
    let grid = Grid::around(mesh, depth).unwrap();
    let mut builder = Builder::new(BuildOptions::default());
    let voxels = voxels(mesh, depth).into_iter();
    voxels.for_each(|voxel| builder.push(voxel));
    let mut graph = builder.finish(grid.placement(), &Silent).unwrap();
    graph.opacity = opacities(mesh, &grid, &graph, &Silent).into();
    graph.validate().unwrap();
    (graph, grid)
}

#[test]
fn opacities_are_as_recorded() {
    let recorded = [(random(3, 12), 5), (random(4, 60), 3), (ball(12), 6)].map(|(mesh, depth)| {
        let graph = graph_of(&mesh, depth).0;
        let bytes: Vec<u8> = graph.opacity.iter().flat_map(|opacity| opacity.0).collect();
        xxh3_64(&bytes)
    });
    let expected = [
        0xfc0d_7efe_8e95_0c25,
        0xf201_91bb_bcb7_9d89,
        0x3472_e6aa_92d8_deae,
    ];
    assert_eq!(recorded, expected, "{recorded:#x?}");
}

/// By level, the area of all nodes' faces seen along an axis from its high side, as a part of an area in world units. All
/// nodes of a column count.
fn covered(graph: &Graph, axis: usize, of: f64) -> impl Iterator<Item = (usize, f64)> {
    let levels = graph.level_start.windows(2).enumerate();
    levels.map(move |(level, nodes)| {
        let parts = f64::from(1u32 << (graph.depth as usize - level));
        let side = graph.placement.voxel_size * parts;
        let share = |node: u32| {
            let opacity = graph.opacity[node as usize];
            f64::from(sixteenths(opacity.from_side(axis, true))) / 16.0
        };
        let area = (nodes[0]..nodes[1]).map(share).sum::<f64>() * side * side;
        (level, area / of)
    })
}

#[test]
fn a_thin_bar_keeps_its_width_at_every_level() {
    // A hundred long, a third wide. At 1024 voxels it is three wide; at 32, a tenth of one, one and a half of the
    // sixteenths that opacities distinguish. Coarser, it is one or none.
    let bar = one_box([0.0, 0.1, 0.2], [100.0, 0.4, 0.5]);
    let (graph, _) = graph_of(&bar, 10);
    for axis in [1, 2] {
        for (level, share) in covered(&graph, axis, 100.0 * 0.3).skip(5) {
            // The back, behind the front, counts only where both are whole.
            let most = if level > 8 { 2.2 } else { 1.5 };
            assert!((0.6..most).contains(&share), "{level}, {axis}: {share}");
        }
    }
}

#[test]
fn slanted_walls_stay_whole() {
    let corners = [[0.0, 0.0], [64.0, 0.0], [64.0, 64.0], [0.0, 64.0]];
    let corners = corners.map(|[x, z]| [x, x * 37.0 / 64.0, z]);
    let (graph, _) = graph_of(&shape(|builder| quad(builder, corners, 0)), 6);
    // All but the outermost columns are covered in full, by both parts of the wall where a node border cuts it.
    for (level, share) in covered(&graph, 1, 64.0 * 64.0).skip(2) {
        assert!((0.9..1.9).contains(&share), "level {level}: {share}");
    }
    let whole = graph.opacity.iter().filter(|o| o.from_side(1, true) == 15);
    assert!(whole.count() > graph.len() / 4);
}
