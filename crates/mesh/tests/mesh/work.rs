//! The work of voxelising grows with the mesh, or the mesh is refused: counted in pairs of a triangle and a voxel.

use shiftvox::graph::{Silent, Voxel};
use shiftvox_mesh::open::{OpenOptions, open_bytes};
use shiftvox_mesh::voxelize::{
    Grid, MOST_LOOKED_AT, VoxelizeReport, least_looked_at, opacities, voxelize,
};
use shiftvox_mesh::{Material, Mesh, MeshBuilder};

use super::opacities::graph_of;
use super::shared::{has, mesh_of, one_box, soup, triangle};
use super::voxels::random;

/// Voxels and work, of which the estimate is at most all.
fn work(mesh: &Mesh, depth: u32) -> (Vec<Voxel>, VoxelizeReport) {
    let grid = Grid::around(mesh, depth).unwrap();
    let mut found = Vec::new();
    let report = voxelize(mesh, &grid, false, &mut |voxel| found.push(voxel), &Silent);
    assert!(least_looked_at(mesh, &grid) <= report.touches);
    (found, report)
}

/// All triangles of a mesh so many times, each time in the next colour.
fn repeated(mesh: &Mesh, times: usize, colors: &[[u8; 3]]) -> Mesh {
    let mut builder = MeshBuilder::new();
    for color in colors {
        builder.material(Material::of_srgb("a", *color));
    }
    for time in 0..times {
        for corners in soup(mesh) {
            triangle(&mut builder, corners, (time % colors.len()) as u32);
        }
    }
    builder.finish("repeated").unwrap()
}

#[test]
fn equal_triangles_are_looked_at_once_and_all_count() {
    for mesh in [one_box([0.0; 3], [1.0, 2.0, 3.0]), random(7, 20)] {
        let grey = [[90, 120, 150]];
        let (once, few) = work(&repeated(&mesh, 1, &grey), 5);
        // A power of two, so that averages are the same to the bit.
        let (found, report) = work(&repeated(&mesh, 64, &grey), 5);
        assert!(found == once);
        assert_eq!(report.looked_at, few.looked_at);
        assert_eq!(report.touches, few.touches * 64);
        // Colours in turn, averaged in linear light.
        let colors = [[255, 0, 0], [0, 0, 255], [0, 0, 255]];
        let (found, _) = work(&repeated(&mesh, 39, &colors), 5);
        assert!(found.iter().all(|voxel| voxel.color == [156, 0, 213]));
    }
    // They have the opacities of one.
    let mesh = repeated(&random(3, 12), 1, &[[1, 2, 3]]);
    let (graph, grid) = graph_of(&mesh, 5);
    let again = repeated(&mesh, 9, &[[1, 2, 3], [4, 5, 6]]);
    assert_eq!(opacities(&again, &grid, &graph, &Silent), *graph.opacity);
}

/// A fan of slivers: a polygon around the origin.
fn fan(corners: u32) -> Mesh {
    let point = |k: u32| {
        let angle = f64::from(k) / f64::from(corners) * std::f64::consts::TAU;
        [angle.cos() as f32, angle.sin() as f32, 0.0]
    };
    mesh_of((1..corners - 1).map(|k| [point(0), point(k), point(k + 1)]))
}

#[test]
fn too_much_work_is_refused_before_it_is_done() {
    let looked_at = |corners| work(&fan(corners), 6).1.looked_at as f64;
    let growth = looked_at(8000) / looked_at(4000);
    assert!((1.8..2.2).contains(&growth), "{growth}");
    let open = |text: &str, depth| {
        let mut options = OpenOptions::default();
        options.mesh.depth = depth;
        open_bytes(text.as_bytes(), "a.obj", &options, &Silent)
    };
    let one = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    // Sheets, one close above the other, that have no triangles in common.
    let sheet = |k| format!("v 0 0 {k}e-6\nv 1 0 {k}e-6\nv 0 1 {k}e-6\nf -3 -2 -1\n");
    let sheets: String = (0..100).map(sheet).collect();
    for (text, depth) in [(one, 18), (&sheets, 16)] {
        let error = open(text, depth).err().unwrap();
        assert!(error.is_limit(), "{error}");
        let reason = format!("a.obj: at {depth} levels its triangles cross voxels ");
        has(error.to_string(), &[&reason, &MOST_LOOKED_AT.to_string()]);
    }
    // Equal triangles count as one.
    open(&(one.to_owned() + &"f 1 2 3\n".repeat(200_000)), 9).unwrap();
}
