//! Triangles to voxels: an oracle over all cubes in exact integers, recorded colours and normals, known answers.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use glam::{DAffine3, DMat3};
use proptest::prelude::*;
use shiftvox::graph::{Silent, Voxel};
use shiftvox::split_mix::SplitMix;
use shiftvox_mesh::textured::{BuildOptions, build};
use shiftvox_mesh::voxelize::{Grid, GridError, voxelize};
use shiftvox_mesh::{ColorSpace, Instances, Material, Mesh, MeshBuilder, MeshFormat, Surface};
use xxhash_rust::xxh3::xxh3_64;

use super::shapes::load;
use super::shared::{ball, mesh_of, on_threads, soup};

pub(super) fn voxels(surface: &dyn Surface, depth: u32) -> Vec<Voxel> {
    let grid = Grid::around(surface, depth).unwrap();
    let mut found = Vec::new();
    let report = voxelize(
        surface,
        &grid,
        false,
        &mut |voxel| found.push(voxel),
        &Silent,
    );
    assert_eq!(report.voxels, found.len() as u64);
    found
}

/// Random triangles with colours, normals and opacities.
pub(super) fn random(seed: u64, count: usize) -> Mesh {
    let mut dice = SplitMix::new(seed);
    let mut builder = MeshBuilder::new();
    for alpha in [1.0, 0.3] {
        let color = [0.9, 0.5, 0.7];
        builder.material(Material::of_numbers("m", color, ColorSpace::Linear, alpha));
    }
    for number in 0..count as u32 {
        let mut three = || [0; 3].map(|_| dice.unit() as f32);
        let corners = [0; 3].map(|_| {
            let color = three().map(|c| (c * 256.0) as u8);
            builder.colored_position(three(), color)
        });
        let normals = [0; 3].map(|_| three().map(|c| c - 0.3));
        let normals = (number % 4 > 0).then_some(normals);
        builder.triangle(corners, normals, number % 2).unwrap();
    }
    builder.finish("random").unwrap()
}

#[test]
fn colours_and_normals_are_as_recorded() {
    let skew = DMat3::from_cols_array(&[1.0, 0.2, 0.0, 0.0, -2.0, 0.5, 0.3, 0.0, 1.0]);
    let places = [DMat3::IDENTITY, skew].map(DAffine3::from_mat3);
    let recorded = [
        voxels(&random(12, 12), 2),
        voxels(&random(40, 40), 4),
        voxels(&random(7, 7), 6),
        voxels(&Instances::new(random(9, 9), places.to_vec()), 5),
    ]
    .map(|found| xxh3_64(format!("{found:?}").as_bytes()));
    let expected = [
        0x8d37_7528_aa34_aee9,
        0xed23_f6bb_ff3e_1f95,
        0x5e35_dacd_6a8a_a056,
        0x4725_1bc9_47c9_848d,
    ];
    assert_eq!(recorded, expected, "{recorded:#x?}");
    let [one, three] = [1, 3].map(|threads| on_threads(threads, || voxels(&ball(12), 7)));
    assert!(one == three);
}

#[test]
fn flat_meshes_lie_in_the_middle_of_a_layer_and_invalid_grids_are_refused() {
    let flat = mesh_of([[[0.0, 0.0, 5.0], [1.0, 0.0, 5.0], [0.0, 1.0, 5.0]]]);
    let (origin, voxel_size) = Grid::around(&flat, 4).unwrap().placement();
    assert!(((5.0 - origin[2]) / voxel_size - 0.5).abs() < 1e-9);
    let mesh = ball(4);
    for depth in [0, 21, 1000] {
        assert_eq!(Grid::around(&mesh, depth), Err(GridError::Depth(depth)));
    }
    let nowhere = Instances::new(mesh, Vec::new());
    assert_eq!(Grid::around(&nowhere, 4), Err(GridError::Empty));
    let far = mesh_of([[[3e38, 0.0, 0.0], [3e38, 1e-30, 0.0], [3e38, 0.0, 1e-30]]]);
    let refused = Grid::around(&far, 4);
    assert!(matches!(refused, Err(GridError::Coordinates { .. })));
}

/// A ball read from a text in whole thousandths, which loses no digits.
fn scaled(scale: f64, moved: f64) -> Mesh {
    let mut text = String::new();
    for corners in soup(&ball(20)) {
        for [x, y, z] in corners.map(|p| p.map(|c| (f64::from(c) * 1000.0).round())) {
            let [x, y, z] = [x, y * 0.7, z * 0.4].map(|c| c.round() * 0.015 * scale + moved);
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
        text += "f -3 -2 -1\n";
    }
    load(text.as_bytes(), MeshFormat::Obj).unwrap()
}

#[test]
fn meshes_of_any_size_anywhere_have_the_same_voxels() {
    let textured = |mesh: &Mesh| {
        let data = build(mesh, &BuildOptions::default(), &Silent).unwrap();
        let voxels = data.grids[0].voxels.iter();
        voxels.map(|v| (v.cell, v.depth)).collect::<Vec<_>>()
    };
    let mesh = scaled(1.0, 0.0);
    let expected = (voxels(&mesh, 6), textured(&mesh));
    assert!(expected.0.len() > 3000 && expected.1.len() > 300);
    for scale in [1e-12, 1e-5, 1e6] {
        let mesh = scaled(scale, 0.0);
        assert!(voxels(&mesh, 6) == expected.0, "{scale}");
        assert!(scale < 1e-5 || textured(&mesh) == expected.1, "{scale}");
    }
    // 30 m at the coordinates of a country's grid, and 1 m at 1000 km. Single precision has steps of 50 and 6 cm there,
    // doubles of a billionth of a metre: two voxels in a thousand may differ.
    for (scale, moved) in [(1.0, 5.4e6), (1.0 / 30.0, 1e6)] {
        let [near, far] = [0.0, moved].map(|moved| {
            let found = voxels(&scaled(scale, moved), 6);
            found.iter().map(|v| v.index).collect::<BTreeSet<_>>()
        });
        let differing = far.symmetric_difference(&near).count();
        assert!(differing * 500 <= near.len(), "{moved}: {differing}");
    }
}

type Exact = [i128; 3];

fn cross(a: Exact, b: Exact) -> Exact {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i] * b[j] - a[j] * b[i])
}

/// The directions of which one separates a triangle from any cube apart from it.
fn directions(corners: [Exact; 3]) -> Vec<Exact> {
    let edge = |i: usize| [0, 1, 2].map(|k| corners[(i + 1) % 3][k] - corners[i][k]);
    let edges = [0, 1, 2].map(edge);
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
    found: &mut BTreeSet<[i32; 3]>,
    depth: u32,
) {
    let side = 1i128 << (30 - depth + levels);
    let cube = [0, 1, 2, 3, 4, 5, 6, 7]
        .map(|i: i128| [0, 1, 2].map(|k| (i128::from(index[k]) + (i >> k & 1)) * side));
    let is_apart = directions.iter().any(|&direction| {
        let [a, b] = [&corners[..], &cube].map(|points| range(points, direction));
        a[1] < b[0] || b[1] < a[0]
    });
    match levels {
        _ if is_apart => {}
        0 => drop(found.insert(index)),
        _ => (0..8).for_each(|octant| {
            let child = [0, 1, 2].map(|k| 2 * index[k] + (octant >> k & 1));
            add(corners, directions, child, levels - 1, found, depth);
        }),
    }
}

/// Compares the voxels of a surface with those of the oracle.
fn check(surface: &dyn Surface, depth: u32) {
    let grid = Grid::around(surface, depth).unwrap();
    let mut expected = BTreeSet::new();
    for number in 0..surface.len() as u32 {
        let corners = grid.corners(surface, number).map(|p| p.map(i128::from));
        let directions = directions(corners);
        add(corners, &directions, [0; 3], depth, &mut expected, depth);
    }
    let voxels = voxels(surface, depth);
    let found: BTreeSet<[i32; 3]> = voxels.iter().map(|voxel| voxel.index).collect();
    assert_eq!(found.len(), voxels.len(), "each voxel once");
    assert_eq!(found, expected, "depth {depth}");
}

/// Corners in a voxel's quarters at depth 3, so that faces, edges and corners of cubes are met exactly; or anywhere.
fn corners() -> impl Strategy<Value = Vec<[f32; 3]>> {
    let quarters = (0u8..=28).prop_map(|n| f32::from(n) / 4.0);
    let list = |coordinate: BoxedStrategy<f32>| {
        prop::collection::vec(prop::array::uniform3(coordinate), 3..9)
    };
    prop_oneof![list(quarters.boxed()), list((0f32..=7.0).boxed())]
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

    /// Triangles of almost no width, or a segment or a point on the lattice, lose no voxel.
    #[test]
    fn voxels_of_needles_are_exact(
        [a, b, off] in prop::array::uniform3(prop::array::uniform3(0f32..1.0)),
        depth in 3u32..9,
    ) {
        let c = [0, 1, 2].map(|k| (a[k] + b[k]) / 2.0 + 1e-6 * off[k]);
        // Two far corners hold the box.
        let low = [[0.0; 3], [0.0, 1e-4, 0.0], a];
        let high = [[1.0; 3], [1.0, 1.0, 0.999], a];
        let [x, y, _] = a;
        let segment = [[x, 0.0, 0.0], [x, y, 0.0], [x, 0.0, 1e-20]];
        let point = [[1e-20, 0.0, 0.0], [0.0, 1e-20, 0.0], [0.0, 0.0, 1e-20]];
        check(&mesh_of([low, high, segment, point, [a, b, c]]), depth);
    }
}
