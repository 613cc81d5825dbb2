//! The work of voxelising grows with the mesh, or the mesh is refused: counted in pairs of a triangle and a voxel.

use shiftvox::graph::{Silent, Voxel};
use shiftvox::split_mix::SplitMix;
use shiftvox_mesh::open::{MeshOptions, OpenOptions, open_bytes};
use shiftvox_mesh::voxelize::{
    Grid, MOST_LOOKED_AT, VoxelizeReport, least_looked_at, opacities, voxelize,
};
use shiftvox_mesh::{Material, Mesh, MeshBuilder};

use super::shapes::{ball, cuboid, mesh_of};

fn work(mesh: &Mesh, depth: u32) -> (Vec<Voxel>, VoxelizeReport) {
    let grid = Grid::around(mesh, depth).unwrap();
    let mut found = Vec::new();
    let report = voxelize(mesh, &grid, &mut |voxel| found.push(voxel), &Silent);
    assert!(least_looked_at(mesh, &grid) <= report.touches);
    (found, report)
}

/// Triangles anywhere in a cube.
fn soup(seed: u64, triangles: u32) -> Mesh {
    let mut dice = SplitMix::new(seed);
    let positions: Vec<[f32; 3]> = (0..3 * triangles)
        .map(|_| [0; 3].map(|_| dice.unit() as f32))
        .collect();
    let triangles: Vec<[u32; 3]> = (0..triangles)
        .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
        .collect();
    mesh_of(&positions, &triangles)
}

/// A mesh with all its triangles so many times, one mesh after the other, each triangle in one material after the other.
fn repeated(mesh: &Mesh, times: usize, colors: &[[u8; 3]]) -> Mesh {
    let mut builder = MeshBuilder::new();
    for &color in colors {
        builder.material(Material::of_srgb("a colour", color));
    }
    for &position in mesh.positions() {
        builder.position(position);
    }
    for time in 0..times {
        for &triangle in mesh.triangles() {
            let material = (time % colors.len()) as u32;
            builder.triangle(triangle, None, material).unwrap();
        }
    }
    builder.finish("a repeated shape").unwrap()
}

#[test]
fn equal_triangles_are_looked_at_once_and_count_each() {
    for mesh in [cuboid([0.0; 3], [1.0, 2.0, 3.0]), soup(7, 20)] {
        let grey = [[90, 120, 150]];
        let (once, few) = work(&repeated(&mesh, 1, &grey), 5);
        // Powers of two, so that averages are the same to the bit.
        for times in [2, 64] {
            let (found, report) = work(&repeated(&mesh, times, &grey), 5);
            assert!(found == once, "{times} times is not the same as once");
            assert_eq!(report.looked_at, few.looked_at);
            assert_eq!(report.touches, few.touches * times as u64);
        }
        // Of black and white, in turn, in linear light.
        let (found, report) = work(&repeated(&mesh, 40, &[[0; 3], [255; 3]]), 5);
        assert_eq!(report.looked_at, few.looked_at);
        assert!(found.iter().all(|voxel| voxel.color == [188; 3]));
    }
    // Twice as often, in one of the places: as if it were drawn twice.
    let square = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mut builder = MeshBuilder::new();
    builder.material(Material::of_srgb("red", [255, 0, 0]));
    builder.material(Material::of_srgb("blue", [0, 0, 255]));
    for position in square {
        builder.position(position);
    }
    for (triangle, material) in [
        ([0, 1, 2], 0),
        ([0, 2, 3], 1),
        ([0, 1, 2], 1),
        ([0, 1, 2], 1),
    ] {
        builder.triangle(triangle, None, material).unwrap();
    }
    let (found, report) = work(&builder.finish("a square").unwrap(), 4);
    let at = |index| found.iter().find(|v| v.index == index).unwrap().color;
    assert_eq!(at([14, 2, 0]), [156, 0, 213]);
    assert_eq!(at([2, 14, 0]), [0, 0, 255]);
    assert!(report.looked_at * 2 <= report.touches);
}

#[test]
fn opacities_of_equal_triangles_are_those_of_one() {
    let mesh = soup(3, 12);
    let of = |mesh: &Mesh| {
        let options = OpenOptions::default();
        let text: String = mesh
            .positions()
            .iter()
            .map(|[x, y, z]| format!("v {x} {y} {z}\n"))
            .chain(
                mesh.triangles()
                    .iter()
                    .map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1)),
            )
            .collect();
        let options = OpenOptions {
            mesh: MeshOptions {
                depth: 5,
                ..options.mesh
            },
            ..options
        };
        let graph = open_bytes(text.as_bytes(), "a.obj", &options, &Silent)
            .unwrap()
            .graph;
        opacities(mesh, &Grid::around(mesh, 5).unwrap(), &graph, &Silent)
    };
    assert_eq!(of(&mesh), of(&repeated(&mesh, 9, &[[1, 2, 3], [4, 5, 6]])));
}

/// A polygon around the origin, cut into a fan.
fn polygon(corners: u32) -> Mesh {
    let positions: Vec<[f32; 3]> = (0..corners)
        .map(|k| f64::from(k) / f64::from(corners) * std::f64::consts::TAU)
        .map(|angle| [angle.cos() as f32, angle.sin() as f32, 0.0])
        .collect();
    let fan: Vec<[u32; 3]> = (1..corners - 1).map(|k| [0, k, k + 1]).collect();
    mesh_of(&positions, &fan)
}

#[test]
fn a_fan_of_slivers_takes_as_much_more_as_it_has_corners() {
    let looked_at = |corners| work(&polygon(corners), 6).1.looked_at as f64;
    let growth = looked_at(8000) / looked_at(4000);
    assert!((1.8..2.2).contains(&growth), "{growth}");
}

#[test]
fn work_is_told_before_it_is_done() {
    for mesh in [
        ball(12),
        polygon(100),
        soup(5, 40),
        cuboid([0.0; 3], [1.0; 3]),
    ] {
        // It is compared there with what is done.
        work(&mesh, 6);
    }
    let options = |depth| OpenOptions {
        mesh: MeshOptions {
            depth,
            ..MeshOptions::default()
        },
        ..OpenOptions::default()
    };
    // Sheets, one close above the other, that have no triangles in common.
    let mut sheets = String::new();
    for k in 0..100 {
        sheets += &format!("v 0 0 {k}e-6\nv 1 0 {k}e-6\nv 0 1 {k}e-6\nf -3 -2 -1\n");
    }
    for (text, depth) in [
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 18),
        (&sheets[..], 16),
    ] {
        let told = open_bytes(text.as_bytes(), "a.obj", &options(depth), &Silent);
        let told = told
            .err()
            .filter(|error| error.is_limit())
            .unwrap()
            .to_string();
        let reason = format!("a.obj: at {depth} levels its triangles cross voxels ");
        assert!(told.starts_with(&reason), "{told}");
        assert!(told.contains(&MOST_LOOKED_AT.to_string()), "{told}");
    }
    // Equal ones are one.
    let same = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned() + &"f 1 2 3\n".repeat(200_000);
    open_bytes(same.as_bytes(), "a.obj", &options(9), &Silent).unwrap();
}
