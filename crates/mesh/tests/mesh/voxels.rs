//! Triangles to voxels: known answers, and an oracle over all cubes in exact integers.

use std::collections::{HashMap, HashSet};

use glam::{DAffine3, DMat3, DVec3, EulerRot};
use proptest::prelude::*;
use shiftvox::graph::{Silent, Voxel};
use shiftvox_mesh::voxelize::{Grid, GridError, voxelize};
use shiftvox_mesh::{Instances, Material, Mesh, Surface};

use super::shared::{
    Corners, ball, indexed, on_any_threads, one_box, quad, shape, sheet, triangle, turned,
};

pub(super) fn voxels<S: Surface + ?Sized>(surface: &S, depth: u32) -> Vec<Voxel> {
    let grid = Grid::around(surface, depth).unwrap();
    let mut found = Vec::new();
    let report = voxelize(surface, &grid, &mut |voxel| found.push(voxel), &Silent);
    assert_eq!(report.voxels, found.len() as u64);
    found
}

fn rectangle([left, right]: [f32; 2]) -> [[f32; 3]; 4] {
    [[left, 0.0], [right, 0.0], [right, 1.0], [left, 1.0]].map(|[x, y]| [x, y, 5.0])
}

#[test]
fn voxels_have_the_normals_of_their_surface() {
    let square = shape(|builder| quad(builder, rectangle([0.0, 1.0]), 0));
    // A flat mesh lies in the middle of its layer.
    let (origin, voxel_size) = Grid::around(&square, 4).unwrap().placement();
    let layer = (5.0 - origin[2]) / voxel_size;
    assert!((layer - 0.5).abs() < 1e-9);
    let wall = indexed(
        &rectangle([0.0, 1.0]),
        &[[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]],
    );
    let outwards = |index: [i32; 3]| {
        let side = |c| f64::from(i32::from(c == 31) - i32::from(c == 0));
        DVec3::from_array(index.map(side))
    };
    let from_middle =
        |index: [i32; 3]| DVec3::from_array(index.map(f64::from)) - DVec3::splat(31.5);
    // Mesh, depth, a direction along the normal and its least cosine.
    type Normal<'n> = &'n dyn Fn([i32; 3]) -> DVec3;
    let cases: [(Mesh, u32, Normal<'_>, f64); 4] = [
        (square, 7, &|_| DVec3::Z, 1.0 - 1e-9),
        // Of two sides one is kept.
        (wall, 3, &|_| DVec3::Z, 1.0 - 1e-9),
        (one_box([-1.0; 3], [1.0; 3]), 5, &outwards, 0.999),
        (ball(24), 6, &from_middle, 0.97),
    ];
    for (mesh, depth, normal, least) in cases {
        for voxel in voxels(&mesh, depth) {
            assert_eq!(voxel.color, [90, 120, 150]);
            let found = voxel.normal.unwrap().decode().unwrap();
            let cosine = found.dot(normal(voxel.index).normalize());
            assert!(cosine > least, "{voxel:?}: {found}");
        }
    }
}

#[test]
fn colours_are_weighted_by_area_in_linear_light() {
    // Three quarters of the square are white, the rest is black.
    let mesh = shape(|builder| {
        for (byte, range) in [(255, [0.0, 0.75]), (0, [0.75, 1.0])] {
            let material = builder.material(Material::of_srgb("m", [byte; 3]));
            quad(builder, rectangle(range), material);
        }
    });
    let found = voxels(&mesh, 1);
    let colors: HashMap<[i32; 3], [u8; 3]> = found.iter().map(|v| (v.index, v.color)).collect();
    // Voxel 0 holds x from 0 to 0.5, which is white. Voxel 1 holds half of each.
    assert_eq!(colors[&[0, 0, 0]], [255; 3]);
    assert_eq!(colors[&[1, 1, 0]], [188; 3]);
}

#[test]
fn threads_change_nothing_and_instances_are_moved_meshes() {
    let mesh = ball(12);
    on_any_threads(|| voxels(&mesh, 7));
    let turn = DMat3::from_euler(EulerRot::XYZ, 0.3, 1.1, -0.7);
    let places = [1.0, 2.0].map(|x| DAffine3::from_mat3_translation(turn * x, DVec3::X * x));
    let instances = Instances::new(mesh.clone(), places.to_vec());
    let moved = |place: DAffine3| {
        let corners = (0..mesh.len()).map(|number| Surface::corners(&mesh, number));
        corners.map(move |corners| corners.map(|corner| place.transform_point3(corner)))
    };
    let expected = places.into_iter().flat_map(moved);
    let found = (0..instances.len()).map(|number| Surface::corners(&instances, number));
    assert!(found.eq(expected));
}

#[test]
fn invalid_grids_are_refused() {
    let mesh = ball(4);
    for depth in [0, 21, 1000] {
        assert_eq!(Grid::around(&mesh, depth), Err(GridError::Depth(depth)));
    }
    let nowhere = Instances::new(mesh, Vec::new());
    assert_eq!(Grid::around(&nowhere, 4), Err(GridError::Empty));
    let corners = [[3e38, 0.0, 0.0], [3e38, 1e-30, 0.0], [3e38, 0.0, 1e-30]];
    let far = shape(|builder| triangle(builder, corners, 0));
    let refused = Grid::around(&far, 4);
    assert!(matches!(refused, Err(GridError::Coordinates { .. })));
}

type Exact = [i128; 3];

fn subtract(a: Exact, b: Exact) -> Exact {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn cross(a: Exact, b: Exact) -> Exact {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i] * b[j] - a[j] * b[i])
}

/// The directions of which one separates a triangle from any cube apart from it.
fn directions(corners: [Exact; 3]) -> Vec<Exact> {
    let edges = [0, 1, 2].map(|i| subtract(corners[(i + 1) % 3], corners[i]));
    let axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    let between = edges.map(|edge| axes.map(|axis| cross(edge, axis)));
    let normal = cross(edges[0], edges[1]);
    [&axes[..], between.as_flattened(), &[normal]].concat()
}

fn range(points: &[Exact], direction: Exact) -> [i128; 2] {
    let values = points
        .iter()
        .map(|p| (0..3).map(|k| p[k] * direction[k]).sum::<i128>());
    values.fold([i128::MAX, i128::MIN], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

/// Adds the voxels that a triangle meets, cube by cube.
fn add(
    corners: [Exact; 3],
    directions: &[Exact],
    index: [i32; 3],
    levels: u32,
    found: &mut HashSet<[i32; 3]>,
    depth: u32,
) {
    let side = 1i128 << (30 - depth + levels);
    let cube = [0, 1, 2, 3, 4, 5, 6, 7]
        .map(|i: i128| [0, 1, 2].map(|k| (i128::from(index[k]) + (i >> k & 1)) * side));
    let is_apart = directions.iter().any(|&direction| {
        let [a, b] = [&corners[..], &cube].map(|points| range(points, direction));
        a[1] < b[0] || b[1] < a[0]
    });
    if is_apart {
        return;
    }
    if levels == 0 {
        found.insert(index);
        return;
    }
    for octant in 0..8 {
        let child = [0, 1, 2].map(|k| 2 * index[k] + (octant >> k & 1));
        add(corners, directions, child, levels - 1, found, depth);
    }
}

/// Compares the voxels of a surface with those of the oracle.
fn check<S: Surface>(surface: &S, depth: u32) {
    let grid = Grid::around(surface, depth).unwrap();
    let mut expected = HashSet::new();
    for number in 0..surface.len() as u32 {
        let corners = grid.corners(surface, number).map(|p| p.map(i128::from));
        let directions = directions(corners);
        add(corners, &directions, [0; 3], depth, &mut expected, depth);
    }
    let voxels = voxels(surface, depth);
    let found: HashSet<[i32; 3]> = voxels.iter().map(|voxel| voxel.index).collect();
    assert_eq!(found.len(), voxels.len(), "each voxel once");
    assert_eq!(found, expected, "depth {depth}");
}

#[test]
fn voxels_of_large_surfaces_are_exact() {
    check(&one_box([0.0; 3], [1.0; 3]), 4);
    // A turned body with a waist, in a skew place.
    let profile = [
        (2.0, 0.0),
        (1.5, 1.0),
        (0.0, 0.45),
        (-1.0, 1.3),
        (-1.3, 0.0),
    ];
    let vase = shape(|builder| turned(builder, DVec3::ZERO, &profile, 7, 0));
    let skew = DAffine3::from_mat3(DMat3::from_euler(EulerRot::XYZ, 0.3, 1.1, -0.7));
    check(&Instances::new(vase, vec![skew]), 6);
    // A surface that bends across all octants.
    let bent = shape(|builder| {
        sheet(builder, [12, 12], 0, |i, j| {
            let [x, y] = [i, j].map(|c| f64::from(c) / 12.0);
            DVec3::new(x, y, 0.5 + (5.0 * x).sin() * (4.0 * y).cos() / 3.0)
        });
    });
    check(&bent, 6);
}

/// Corners in a voxel's quarters at depth 3, so that faces, edges and corners of cubes are met exactly; or anywhere.
fn corners() -> impl Strategy<Value = Vec<[f32; 3]>> {
    let quarters = (0u8..=28).prop_map(|n| f32::from(n) / 4.0);
    let list = |coordinate: BoxedStrategy<f32>| {
        prop::collection::vec(prop::array::uniform3(coordinate), 3..9)
    };
    prop_oneof![list(quarters.boxed()), list((0f32..=7.0).boxed())]
}

fn mesh_of(triangles: impl IntoIterator<Item = Corners>) -> Mesh {
    shape(|builder| {
        for corners in triangles {
            triangle(builder, corners, 0);
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn voxels_of_random_triangles_are_exact(corners in corners()) {
        // At depth 3 a voxel has side 1 where the box has 7.
        let outer = [[0.0; 3], [7.0; 3], [7.0, 0.0, 7.0]];
        let strip = corners.windows(3).map(|w| [w[0], w[1], w[2]]);
        check(&mesh_of([outer].into_iter().chain(strip)), 3);
    }

    /// A triangle of almost no width loses no voxel.
    #[test]
    fn voxels_of_needles_are_exact(
        [a, b, off] in prop::array::uniform3(prop::array::uniform3(0f32..1.0)),
        depth in 3u32..9,
    ) {
        let c = [0, 1, 2].map(|k| (a[k] + b[k]) / 2.0 + 1e-6 * off[k]);
        // Two far corners hold the box.
        let low = [[0.0; 3], [0.0, 1e-4, 0.0], a];
        let high = [[1.0; 3], [1.0, 1.0, 0.999], a];
        check(&mesh_of([low, high, [a, b, c]]), depth);
    }
}
