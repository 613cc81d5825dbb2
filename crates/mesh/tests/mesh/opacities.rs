//! Opacities of a mesh's voxels at every level: a thin bar keeps its width.

use shiftvox::graph::{Builder, Graph, Silent, sixteenths};
use shiftvox_mesh::Mesh;
use shiftvox_mesh::voxelize::{Grid, opacities, voxelize};
use xxhash_rust::xxh3::xxh3_64;

use super::shared::{ball, one_box};
use super::voxels::random;

/// The graph of a mesh's voxels, with opacities.
pub(super) fn graph_of(mesh: &Mesh, depth: u32) -> (Graph, Grid) {
    let grid = Grid::around(mesh, depth).unwrap();
    let mut builder = Builder::default();
    let mut push = |voxel| builder.push(voxel);
    voxelize(mesh, &grid, true, &mut push, &Silent);
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
        0x3419_ac21_1a10_80ea,
        0x5ce5_731c_5815_533f,
        0xe85f_12bf_e09d_7f81,
    ];
    assert_eq!(recorded, expected, "{recorded:#x?}");
}

#[test]
fn a_thin_bar_keeps_its_width_at_every_level() {
    // A hundred long, a third wide. At 1024 voxels it is three wide; at 32, a tenth of one, one and a half of the
    // sixteenths that opacities distinguish. Coarser, it is one or none.
    let bar = one_box([0.0, 0.1, 0.2], [100.0, 0.4, 0.5]);
    let (graph, _) = graph_of(&bar, 10);
    for (level, axis) in (5..=10).flat_map(|level| [(level, 1), (level, 2)]) {
        // The area of all faces seen from the high side of the axis. All nodes of a column count.
        let side = graph.placement.voxel_size * f64::from(1u32 << (10 - level));
        let share = |node: u32| {
            let opacity = graph.opacity[node as usize];
            f64::from(sixteenths(opacity.from_side(axis, true))) / 16.0
        };
        let nodes = graph.level_start[level]..graph.level_start[level + 1];
        let share = nodes.map(share).sum::<f64>() * side * side / (100.0 * 0.3);
        // The back, behind the front, counts only where both are whole.
        let most = if level > 8 { 2.2 } else { 1.5 };
        assert!((0.6..most).contains(&share), "{level}, {axis}: {share}");
    }
}
