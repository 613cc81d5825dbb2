//! Triangles to voxels: known answers, and an oracle with rational numbers.

use std::collections::{HashMap, HashSet};

use glam::{DAffine3, DMat3, DVec3, EulerRot};
use num_bigint::BigInt;
use num_rational::BigRational;
use proptest::prelude::*;
use shiftvox::graph::{Silent, Voxel};
use shiftvox_mesh::voxelize::{Grid, GridError, voxelize};
use shiftvox_mesh::{Instances, Material, Mesh, Surface};

use super::shared::{
    ball, indexed, on_any_threads, one_box, quad, shape, sheet, soup, triangle, turned,
};

pub(super) fn voxels<S: Surface + ?Sized>(surface: &S, depth: u32) -> Vec<Voxel> {
    let grid = Grid::around(surface, depth).unwrap();
    let mut found = Vec::new();
    let report = voxelize(surface, &grid, &mut |voxel| found.push(voxel), &Silent);
    assert_eq!(report.voxels, found.len() as u64);
    found
}

fn cells(voxels: &[Voxel]) -> HashSet<[i32; 3]> {
    let set: HashSet<[i32; 3]> = voxels.iter().map(|voxel| voxel.index).collect();
    assert_eq!(set.len(), voxels.len(), "each voxel once");
    set
}

fn square(z: f32) -> Mesh {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    shape(|builder| quad(builder, corners.map(|[x, y]| [x, y, z]), 0))
}

#[test]
fn simple_shapes_have_known_voxels_and_normals() {
    let outwards = |voxel: &Voxel| {
        let side = |c| f64::from(i32::from(c == 31) - i32::from(c == 0));
        DVec3::from_array(voxel.index.map(side)).normalize()
    };
    let from_middle = |voxel: &Voxel| {
        let offset = DVec3::from_array(voxel.index.map(f64::from)) - DVec3::splat(31.5);
        offset.normalize()
    };
    type Normal<'n> = &'n dyn Fn(&Voxel) -> DVec3;
    // Mesh, depth, number of voxels where it is known, the normal of a voxel and its least cosine.
    let cases: [(Mesh, u32, Option<usize>, Normal<'_>, f64); 4] = [
        (square(5.0), 1, Some(4), &|_| DVec3::Z, 1.0 - 1e-9),
        (square(5.0), 7, Some(1 << 14), &|_| DVec3::Z, 1.0 - 1e-9),
        (
            one_box([-1.0; 3], [1.0; 3]),
            5,
            Some(32 * 32 * 32 - 30 * 30 * 30),
            &outwards,
            0.999,
        ),
        (ball(24), 6, None, &from_middle, 0.97),
    ];
    for (mesh, depth, count, normal, least) in cases {
        let found = voxels(&mesh, depth);
        assert!(count.is_none_or(|count| count == found.len()));
        for voxel in found {
            assert_eq!(voxel.color, [90, 120, 150]);
            let found = voxel.normal.unwrap().decode().unwrap();
            assert!(found.dot(normal(&voxel)) > least, "{voxel:?}: {found}");
        }
    }
    // A flat mesh lies in the middle of its layer.
    let (origin, voxel_size) = Grid::around(&square(5.0), 4).unwrap().placement();
    let layer = (5.0 - origin[2]) / voxel_size;
    assert!((layer - 0.5).abs() < 1e-9);
}

#[test]
fn colours_are_weighted_by_area_in_linear_light() {
    // Three quarters of the square are white, the rest is black.
    let mesh = shape(|builder| {
        for (byte, low, high) in [(255, 0.0, 0.75), (0, 0.75, 1.0)] {
            let material = builder.material(Material::of_srgb("m", [byte; 3]));
            let corners = [[low, 0.0], [high, 0.0], [high, 1.0], [low, 1.0]];
            quad(builder, corners.map(|[x, y]| [x, y, 0.0]), material);
        }
    });
    let found = voxels(&mesh, 1);
    let colors: HashMap<[i32; 3], [u8; 3]> = found.iter().map(|v| (v.index, v.color)).collect();
    // Voxel 0 holds x from 0 to 0.5, which is white. Voxel 1 holds half of each.
    assert_eq!(colors[&[0, 0, 0]], [255; 3]);
    assert_eq!(colors[&[1, 1, 0]], [188; 3]);
}

#[test]
fn a_wall_with_two_sides_keeps_one_normal() {
    let [a, b] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    let [c, d] = [[1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let wall = indexed(&[a, b, c, d], &[[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]]);
    for voxel in voxels(&wall, 3) {
        assert_eq!(voxel.normal.unwrap().decode(), Some(DVec3::Z));
    }
}

#[test]
fn threads_and_instances_change_nothing() {
    let mesh = ball(12);
    on_any_threads(|| voxels(&mesh, 7));
    // Five balls as instances, and as one mesh.
    let flat = shape(|builder| {
        for i in 0..5u8 {
            for corners in soup(&mesh) {
                let moved = corners.map(|[x, y, z]| [x + 3.0 * f32::from(i), y, z]);
                triangle(builder, moved, 0);
            }
        }
    });
    let places = (0..5).map(|i| DAffine3::from_translation(DVec3::X * f64::from(3 * i)));
    let instances = Instances::new(mesh, places.collect());
    assert_eq!(instances.len(), Surface::len(&flat));
    let (a, b) = (cells(&voxels(&instances, 7)), cells(&voxels(&flat, 7)));
    // Single precision rounds the positions of the mesh.
    let differing = a.symmetric_difference(&b).count();
    assert!(differing * 100 < a.len(), "{differing} of {}", a.len());
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

type Exact = [BigRational; 3];

/// The part of a polygon in a closed cube: cut at six planes in rational numbers.
fn cut(mut polygon: Vec<Exact>, corner: [i64; 3], side: i64) -> Vec<Exact> {
    let whole = |value: i64| BigRational::from_integer(BigInt::from(value));
    for axis in 0..3 {
        for (plane, sign) in [(corner[axis], 1), (corner[axis] + side, -1)] {
            let zero = whole(0);
            let inside = |p: &Exact| (p[axis].clone() - whole(plane)) * whole(sign);
            let mut kept = Vec::new();
            for (i, here) in polygon.iter().enumerate() {
                let next = &polygon[(i + 1) % polygon.len()];
                let (a, b) = (inside(here), inside(next));
                if a >= zero {
                    kept.push(here.clone());
                }
                if (a >= zero) != (b >= zero) {
                    let t = a.clone() / (a - b);
                    let between = |k: usize| &here[k] + (&next[k] - &here[k]) * &t;
                    kept.push([0, 1, 2].map(between));
                }
            }
            polygon = kept;
        }
    }
    polygon
}

/// Adds the voxels that a polygon meets, cube by cube.
fn add(
    polygon: Vec<Exact>,
    index: [i32; 3],
    level: u32,
    depth: u32,
    found: &mut HashSet<[i32; 3]>,
) {
    let side = 1i64 << (30 - level);
    let polygon = cut(polygon, index.map(|c| i64::from(c) * side), side);
    if polygon.is_empty() {
        return;
    }
    if level == depth {
        found.insert(index);
        return;
    }
    for octant in 0..8 {
        let child = [0, 1, 2].map(|k| 2 * index[k] + (octant >> k & 1));
        add(polygon.clone(), child, level + 1, depth, found);
    }
}

/// Compares the voxels of a surface with those of rational arithmetic.
fn check<S: Surface>(surface: &S, depth: u32) {
    let grid = Grid::around(surface, depth).unwrap();
    let mut expected = HashSet::new();
    for number in 0..surface.len() as u32 {
        let corners = grid.corners(surface, number);
        let exact = corners.map(|p| p.map(|c| BigRational::from_integer(c.into())));
        add(exact.to_vec(), [0; 3], 0, depth, &mut expected);
    }
    assert_eq!(cells(&voxels(surface, depth)), expected, "depth {depth}");
}

#[test]
fn voxels_of_closed_surfaces_are_exact() {
    check(&ball(9), 5);
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

/// Coordinates in a voxel's quarters at depth 3, so that faces, edges and corners of cubes are met exactly; or anywhere.
fn corners() -> impl Strategy<Value = Vec<[f32; 3]>> {
    let quarters = (0u8..=28).prop_map(|n| f32::from(n) / 4.0);
    let anywhere = 0f32..=7.0;
    let list = |coordinate: BoxedStrategy<f32>| {
        prop::collection::vec(prop::array::uniform3(coordinate), 3..9)
    };
    prop_oneof![list(quarters.boxed()), list(anywhere.boxed())]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn voxels_of_random_triangles_are_exact(corners in corners()) {
        // At depth 3 a voxel has side 1 where the box has 7.
        let box_corners = [[0.0; 3], [7.0; 3], [7.0, 0.0, 7.0]];
        let mesh = shape(|builder| {
            triangle(builder, box_corners, 0);
            for corners in corners.windows(3) {
                triangle(builder, [corners[0], corners[1], corners[2]], 0);
            }
        });
        check(&mesh, 3);
    }

    /// A triangle of almost no width loses no voxel.
    #[test]
    fn voxels_of_needles_are_exact(
        [a, b, off] in prop::array::uniform3(prop::array::uniform3(0f32..1.0)),
        depth in 3u32..9,
    ) {
        let c = [0, 1, 2].map(|k| (a[k] + b[k]) / 2.0 + 1e-6 * off[k]);
        let mesh = shape(|builder| {
            // Two far corners hold the box.
            triangle(builder, [[0.0; 3], [0.0, 1e-4, 0.0], a], 0);
            triangle(builder, [[1.0; 3], [1.0, 1.0, 0.999], a], 0);
            triangle(builder, [a, b, c], 0);
        });
        check(&mesh, depth);
    }
}
