//! Triangles to voxels: known answers, an exact oracle, no holes, nothing lost.

use std::collections::{HashMap, HashSet, VecDeque};

use glam::{DAffine3, DVec3};
use num_bigint::BigInt;
use num_rational::BigRational;
use proptest::prelude::*;
use shiftvox::graph::{Silent, Voxel};
use shiftvox::split_mix::SplitMix;
use shiftvox_mesh::voxelize::{Grid, GridError, voxelize};
use shiftvox_mesh::{Instances, Material, Mesh, MeshBuilder, Surface};

use super::shapes::{ball, cuboid, mesh_of, point, soup, turned};
use super::shared::on_threads;

fn voxels<S: Surface + ?Sized>(surface: &S, depth: u32) -> Vec<Voxel> {
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

#[test]
fn a_square_is_one_layer() {
    let square = mesh_of(
        &[
            [0.0, 0.0, 5.0],
            [1.0, 0.0, 5.0],
            [1.0, 1.0, 5.0],
            [0.0, 1.0, 5.0],
        ],
        &[[0, 1, 2], [0, 2, 3]],
    );
    for depth in 1..=7 {
        let found = voxels(&square, depth);
        let side = 1 << depth;
        assert_eq!(found.len(), side * side);
        for voxel in &found {
            assert_eq!(voxel.index[2], 0);
            assert_eq!(voxel.color, [90, 120, 150]);
            assert_eq!(voxel.normal.unwrap().decode(), Some(DVec3::Z));
        }
        let grid = Grid::around(&square, depth).unwrap();
        let layer = (5.0 - grid.origin().z) / grid.voxel_size();
        assert!((layer - 0.5).abs() < 1e-9);
    }
}

#[test]
fn a_cube_is_a_shell_with_its_normals() {
    let found = voxels(&cuboid([-1.0; 3], [1.0; 3]), 5);
    assert_eq!(found.len(), 32 * 32 * 32 - 30 * 30 * 30);
    for voxel in found {
        let normal = voxel.normal.unwrap().decode().unwrap();
        let expected = DVec3::from_array(voxel.index.map(|c| match c {
            0 => -1.0,
            31 => 1.0,
            _ => 0.0,
        }));
        assert!(
            normal.dot(expected.normalize()) > 0.999,
            "{:?} {normal}",
            voxel.index
        );
    }
}

#[test]
fn a_ball_is_near_its_radius_all_over() {
    let depth = 6;
    let mesh = ball(24);
    let grid = Grid::around(&mesh, depth).unwrap();
    let found = voxels(&mesh, depth);
    // Half a diagonal, and the mesh's own distance from the ball.
    let slack = grid.voxel_size() * 0.87 + 0.01;
    for voxel in &found {
        let centre = grid.origin()
            + (DVec3::from_array(voxel.index.map(f64::from)) + 0.5) * grid.voxel_size();
        assert!((centre.length() - 1.0).abs() < slack, "{:?}", voxel.index);
        let normal = voxel.normal.unwrap().decode().unwrap();
        assert!(
            normal.dot(centre.normalize()) > 0.97,
            "{:?}: {normal}",
            voxel.index
        );
    }
    // Area over the face of a voxel, times the mean of |x| + |y| + |z| over
    // directions, 3/2, is what a thin surface crosses; edges touched add to it.
    let faces = 4.0 * std::f64::consts::PI / grid.voxel_size().powi(2);
    let share = found.len() as f64 / faces;
    assert!(share > 1.4 && share < 2.2, "{share}");
}

/// Whether the empty cells are two regions that do not meet even in a corner,
/// and the full ones one region that hangs together by faces.
fn is_closed_shell(full: &HashSet<[i32; 3]>, side: i32, within: [i32; 3]) {
    assert!(!full.contains(&within));
    let steps = |far: bool| {
        (0..27i32)
            .map(|i| [i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1])
            .filter(move |s| {
                let moved = s.iter().filter(|c| **c != 0).count();
                if far { moved > 0 } else { moved == 1 }
            })
            .collect::<Vec<_>>()
    };
    let flood = |from: [i32; 3], far: bool, open: &dyn Fn(&[i32; 3]) -> bool| {
        let steps = steps(far);
        let mut seen = HashSet::from([from]);
        let mut queue = VecDeque::from([from]);
        while let Some(at) = queue.pop_front() {
            for step in &steps {
                let next = [0, 1, 2].map(|k| at[k] + step[k]);
                if next.iter().all(|c| (-1..=side).contains(c)) && open(&next) && seen.insert(next)
                {
                    queue.push_back(next);
                }
            }
        }
        seen
    };
    let outside = flood([-1; 3], true, &|cell| !full.contains(cell));
    assert!(!outside.contains(&within), "there is a hole");
    let first = *full.iter().next().unwrap();
    let shell = flood(first, false, &|cell| full.contains(cell));
    assert_eq!(shell.len(), full.len(), "the shell is in pieces");
}

#[test]
fn closed_meshes_are_closed_shells() {
    for depth in [3, 4, 5, 6] {
        let side = 1 << depth;
        let middle = [side / 2; 3];
        is_closed_shell(&cells(&voxels(&ball(9), depth)), side, middle);
        is_closed_shell(
            &cells(&voxels(&cuboid([0.0; 3], [1.0; 3]), depth)),
            side,
            middle,
        );
    }
    // A turned body with a waist, in a skew place.
    let vase = turned(
        &[
            (-2.0, 0.0),
            (-1.5, 1.0),
            (0.0, 0.45),
            (1.0, 1.3),
            (1.3, 0.0),
        ],
        7,
    );
    let skew = DAffine3::from_mat3(glam::DMat3::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, -0.7));
    let vase = Instances::new(vase, vec![skew]);
    let grid = Grid::around(&vase, 6).unwrap();
    let centre = ((DVec3::ZERO - grid.origin()) / grid.voxel_size()).floor();
    let within = [centre.x as i32, centre.y as i32, centre.z as i32];
    is_closed_shell(&cells(&voxels(&vase, 6)), 64, within);
}

#[test]
fn slivers_and_needles_never_vanish() {
    // Two far corners hold the box; needles of no width to speak of are within.
    let mut dice = SplitMix::new(7);
    let mut random = || dice.unit() as f32;
    for _ in 0..40 {
        let (a, b) = (
            [random(), random(), random()],
            [random(), random(), random()],
        );
        let c = [0, 1, 2].map(|k| (a[k] + b[k]) / 2.0 + 1e-6 * random());
        let mesh = mesh_of(
            &[
                [0.0; 3],
                [0.0, 1e-4, 0.0],
                [1.0; 3],
                [1.0, 1.0, 0.999],
                a,
                b,
                c,
            ],
            &[[0, 1, 4], [2, 3, 4], [4, 5, 6]],
        );
        for depth in [3, 6, 9] {
            let grid = Grid::around(&mesh, depth).unwrap();
            let full = cells(&voxels(&mesh, depth));
            for i in 0..=2000 {
                let at = point(a).lerp(point(b), f64::from(i) / 2000.0);
                let inside = (at - grid.origin()) / grid.voxel_size();
                // Rounding to the lattice moves a corner by less than this.
                let hit = [-1e-5, 1e-5].iter().any(|&shift| {
                    full.contains(&(inside + shift).to_array().map(|c| c.floor() as i32))
                });
                assert!(hit, "depth {depth}: {at} of {a:?} to {b:?}");
            }
        }
    }
}

#[test]
fn colours_are_weighted_by_area_in_linear_light() {
    // A square of four voxels' width, three quarters of it white, the rest black.
    let mut builder = MeshBuilder::new();
    let white = builder.material(Material::of_srgb("white", [255; 3]));
    let black = builder.material(Material::of_srgb("black", [0; 3]));
    // At depth 1 a voxel is one unit and the grid begins half a unit lower.
    for corner in [
        [0.0, 0.0],
        [0.75, 0.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [0.75, 1.0],
        [1.0, 1.0],
    ] {
        builder.position([corner[0], corner[1], 0.0]);
    }
    for (triangle, material) in [
        ([0, 1, 4], white),
        ([0, 4, 3], white),
        ([1, 2, 5], black),
        ([1, 5, 4], black),
    ] {
        builder.triangle(triangle, None, material).unwrap();
    }
    let mesh = builder.finish("a").unwrap();
    let found: HashMap<[i32; 3], [u8; 3]> = voxels(&mesh, 1)
        .iter()
        .map(|v| (v.index, v.color))
        .collect();
    // Voxel 0 holds x from 0 to 0.5: white; voxel 1 from 0.5 to 1: half of each.
    assert_eq!(found[&[0, 0, 0]], [255; 3]);
    assert_eq!(found[&[1, 1, 0]], [188; 3]);
}

#[test]
fn a_wall_with_two_sides_keeps_one_normal() {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let wall = mesh_of(&corners, &[[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]]);
    for voxel in voxels(&wall, 3) {
        assert_eq!(voxel.normal.unwrap().decode(), Some(DVec3::Z));
    }
}

#[test]
fn threads_and_instances_change_nothing() {
    let mesh = ball(12);
    let [one, two, three] = [1, 2, 3].map(|n| on_threads(n, || voxels(&mesh, 7)));
    assert!(one == two && two == three);
    // The same places as one mesh.
    let places: Vec<DAffine3> = (0..5)
        .map(|i| DAffine3::from_translation(DVec3::X * f64::from(3 * i)))
        .collect();
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..5u8 {
        let base = positions.len() as u32;
        positions.extend(
            mesh.positions()
                .iter()
                .map(|p| [p[0] + 3.0 * f64::from(i), p[1], p[2]].map(|c| c as f32)),
        );
        triangles.extend(mesh.triangles().iter().map(|t| t.map(|c| c + base)));
    }
    let flat = mesh_of(&positions, &triangles);
    let instances = Instances::new(mesh, places);
    assert_eq!(instances.len(), Surface::len(&flat));
    let (a, b) = (cells(&voxels(&instances, 7)), cells(&voxels(&flat, 7)));
    // Positions in f32 differ in the last bit from those moved in f64.
    let differing = a.symmetric_difference(&b).count();
    assert!(differing * 100 < a.len(), "{differing} of {}", a.len());
}

#[test]
fn what_cannot_be_voxelised_is_refused() {
    let mesh = ball(4);
    for depth in [0, 21, 1000] {
        assert_eq!(Grid::around(&mesh, depth), Err(GridError::Depth(depth)));
    }
    let nowhere = Instances::new(mesh, Vec::new());
    assert_eq!(Grid::around(&nowhere, 4), Err(GridError::Empty));
    let far = mesh_of(
        &[[3e38, 0.0, 0.0], [3e38, 1e-30, 0.0], [3e38, 0.0, 1e-30]],
        &[[0, 1, 2]],
    );
    assert!(matches!(
        Grid::around(&far, 4),
        Err(GridError::Coordinates { .. })
    ));
}

type Exact = [BigRational; 3];

/// Whether a triangle meets a closed cube: cut at its six planes in rational
/// numbers, something is left.
fn meets(triangle: [[i64; 3]; 3], corner: [i64; 3], side: i64) -> bool {
    let whole = |value: i64| BigRational::from_integer(BigInt::from(value));
    let mut polygon: Vec<Exact> = triangle.iter().map(|p| p.map(whole)).collect();
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
                    kept.push(std::array::from_fn(|k| {
                        here[k].clone() + (next[k].clone() - here[k].clone()) * t.clone()
                    }));
                }
            }
            polygon = kept;
        }
    }
    !polygon.is_empty()
}

/// The voxels of a mesh by trying all of them with rational numbers.
fn by_force(mesh: &Mesh, depth: u32) -> HashSet<[i32; 3]> {
    let grid = Grid::around(mesh, depth).unwrap();
    let side = 1i64 << (30 - depth);
    let count = 1i32 << depth;
    let mut found = HashSet::new();
    for number in 0..mesh.triangles().len() as u32 {
        let corners = grid.corners(mesh, number);
        for x in 0..count {
            for y in 0..count {
                for z in 0..count {
                    let index = [x, y, z];
                    if !found.contains(&index)
                        && meets(corners, index.map(|c| i64::from(c) * side), side)
                    {
                        found.insert(index);
                    }
                }
            }
        }
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Corners on quarters of a voxel, so that faces, edges and corners of
    /// cubes are met exactly, and anywhere.
    #[test]
    fn voxels_are_those_of_exact_arithmetic(
        quarters in prop::collection::vec(prop::array::uniform3(0u8..=28), 3..9),
        is_even in any::<bool>(),
        shift in prop::collection::vec(prop::array::uniform3(-0.1f32..0.1), 9),
    ) {
        // At depth 3 a voxel has side 1 where the box has 7.
        let mut positions: Vec<[f32; 3]> = vec![[0.0; 3], [7.0; 3], [7.0, 0.0, 7.0]];
        for (at, by) in quarters.iter().zip(&shift) {
            positions.push([0, 1, 2].map(|k| {
                let exact = f32::from(at[k]) / 4.0;
                if is_even { exact } else { (exact + by[k]).clamp(0.0, 7.0) }
            }));
        }
        let mut builder = MeshBuilder::new();
        for &position in &positions {
            builder.position(position);
        }
        builder.triangle([0, 1, 2], None, 0).unwrap();
        for i in 3..positions.len() as u32 - 2 {
            builder.triangle([i, i + 1, i + 2], None, 0).unwrap();
        }
        let mesh = builder.finish("random").unwrap();
        prop_assert!(!soup(&mesh).is_empty());
        let found = cells(&voxels(&mesh, 3));
        let expected = by_force(&mesh, 3);
        prop_assert_eq!(found, expected);
    }
}
