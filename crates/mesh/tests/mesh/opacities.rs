//! Opacities of a mesh's voxels, at every level: a thin bar stays as wide as
//! it is, a wall stays whole.

use shiftvox::graph::{BuildOptions, Builder, Graph, Silent, sixteenths};
use shiftvox_mesh::Mesh;
use shiftvox_mesh::voxelize::{Grid, opacities, voxelize};

use super::shapes::{cuboid, mesh_of};

fn graph_of(mesh: &Mesh, depth: u32) -> (Graph, Grid) {
    let grid = Grid::around(mesh, depth).unwrap();
    let mut builder = Builder::new(BuildOptions::default());
    voxelize(mesh, &grid, &mut |voxel| builder.push(voxel), &Silent);
    let mut graph = builder.finish(grid.placement(), &Silent).unwrap();
    graph.opacity = opacities(mesh, &grid, &graph, &Silent).into();
    graph.validate().unwrap();
    (graph, grid)
}

/// By level and axis, what the nodes' faces cover together in world units, seen from the high side: a
/// column of nodes counts once for each of them.
fn covered(graph: &Graph) -> Vec<[f64; 3]> {
    let levels = graph.level_start.windows(2).enumerate();
    levels
        .map(|(level, nodes)| {
            let side =
                graph.placement.voxel_size * f64::from(1u32 << (graph.depth as usize - level));
            let mut sum = [0.0; 3];
            for node in nodes[0]..nodes[1] {
                let opacity = graph.opacity[node as usize];
                for (k, sum) in sum.iter_mut().enumerate() {
                    *sum += f64::from(sixteenths(opacity.from_side(k, true))) / 16.0 * side * side;
                }
            }
            sum
        })
        .collect()
}

#[test]
fn a_thin_bar_keeps_its_width_at_every_level() {
    // A hundred long, a third wide. At 1024 voxels it is three wide; at 32, a tenth of one, one
    // and a half of the sixteenths that opacities distinguish. Coarser, it is one or none.
    let bar = cuboid([0.0, 0.1, 0.2], [100.0, 0.4, 0.5]);
    let (graph, _) = graph_of(&bar, 10);
    for (level, [_, y, z]) in covered(&graph).into_iter().enumerate().skip(5) {
        for (axis, area) in [('y', y), ('z', z)] {
            let share = area / (100.0 * 0.3);
            // The back is behind the front and does not count, but where both are whole.
            let most = if level > 8 { 2.2 } else { 1.5 };
            assert!(
                (0.6..most).contains(&share),
                "level {level}, {axis}: {share}"
            );
        }
    }
}

#[test]
fn slanted_walls_stay_whole() {
    let wall = mesh_of(
        &[
            [0.0, 0.0, 0.0],
            [64.0, 37.0, 0.0],
            [64.0, 37.0, 64.0],
            [0.0, 0.0, 64.0],
        ],
        &[[0, 1, 2], [0, 2, 3]],
    );
    let (graph, _) = graph_of(&wall, 6);
    // Seen along y, all but the outermost columns are covered in full; where the wall is cut into two, by both parts.
    let sums = covered(&graph);
    for (level, [_, y, _]) in sums.iter().enumerate().skip(2) {
        let share = y / (64.0 * 64.0);
        assert!((0.9..1.9).contains(&share), "level {level}: {share}");
    }
    let whole = graph.opacity.iter().filter(|o| o.from_side(1, true) == 15);
    assert!(whole.count() > graph.len() / 4);
}
