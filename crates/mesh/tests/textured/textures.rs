//! Textures computed slice by slice, against each volume projected afresh with the test's own arithmetic.

use proptest::prelude::*;
use shiftvox::graph::PackedNormal;
use shiftvox_mesh::textured::record::{CLEAR, NEVER, Texel};
use shiftvox_mesh::textured::{CellGrid, TexturedData};

use super::levels::check;
use super::scenes::{built, color_of, file_of, mesh_of, random_triangles, small_grids};

type Point = [i128; 2];

const FACE: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

fn area([a, b, c]: [Point; 3]) -> i128 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// As if the point were moved to the right by almost nothing, and down by almost nothing of that.
fn covers(points: [Point; 3], p: Point) -> bool {
    let sides = [0, 1, 2].map(|i| {
        let (a, b) = (points[i], points[(i + 1) % 3]);
        // First the value, then the change of a step right and of a step down.
        let values = [area([a, b, p]), a[1] - b[1], b[0] - a[0]];
        values.map(i128::signum).into_iter().find(|&s| s != 0)
    });
    sides[0].is_some() && sides[0] == sides[1] && sides[1] == sides[2]
}

/// The coordinate along the axis of a triangle at a point within it, rounded down.
fn along(points: [Point; 3], depths: [i128; 3], p: Point) -> i128 {
    let weights = [0, 1, 2].map(|i| area([p, points[(i + 1) % 3], points[(i + 2) % 3]]));
    let sum: i128 = (0..3).map(|i| weights[i] * depths[i]).sum();
    sum.div_euclid(area(points))
}

/// The primitive that a texel sees in the slices from the middle of the grid to `slice`.
fn seen(
    corners: &[[[i64; 3]; 3]],
    lattice: &CellGrid,
    axis: usize,
    slice: u32,
    texel: [u32; 2],
) -> Option<usize> {
    let (step, half) = (lattice.texel_steps as i128, lattice.cells / 2);
    let outwards = if slice >= half { 1 } else { -1 };
    let volume = slice.min(half)..=slice.max(half - 1);
    let p = texel.map(|t| i128::from(t) * step + step / 2);
    let depths = corners.iter().enumerate().filter_map(|(number, corners)| {
        let points = corners.map(|c| FACE[axis].map(|k| i128::from(c[k])));
        if !covers(points, p) {
            return None;
        }
        let depth = along(points, corners.map(|c| i128::from(c[axis])), p);
        let at = (depth / i128::from(lattice.cell_steps())) as u32;
        let is_there = volume.contains(&at.min(lattice.cells - 1));
        is_there.then_some((depth * outwards, number))
    });
    let best = depths.max_by_key(|&(depth, number)| (depth, std::cmp::Reverse(number)));
    best.map(|(_, number)| number)
}

/// Compares all sub-textures of a grid with volumes projected afresh.
fn compare(data: &TexturedData) {
    let grid = &data.grids[0];
    let lattice = CellGrid::around(data.low, data.high, grid.cells, grid.texels);
    let primitives = data.primitives.iter();
    let corners = primitives.map(|p| p.positions().map(|p| lattice.point(p)));
    let corners: Vec<[[i64; 3]; 3]> = corners.collect();
    let side = grid.texels;
    let voxels = grid.voxels.iter();
    let faces = voxels.flat_map(|v| [0, 1, 2].map(|axis| (v, axis)));
    for (voxel, axis) in faces.filter(|(voxel, axis)| voxel.textures[*axis] != NEVER) {
        let number = voxel.textures[axis];
        let slice = u32::from(voxel.cell[axis]);
        let [across, down] = FACE[axis].map(|k| u32::from(voxel.cell[k]) * side);
        for texel in 0..side * side {
            let place = [across + texel % side, down + texel / side];
            let found = match number {
                CLEAR => Texel::default(),
                _ => grid.textures[(number * side * side + texel) as usize],
            };
            let primitive = seen(&corners, &lattice, axis, slice, place);
            let expected = primitive.map_or(([0; 3], 0), |p| (color_of(p as u32), 255));
            let values = (found.color, found.opacity);
            assert_eq!(values, expected, "{voxel:?} axis {axis} texel {texel}");
            let Some(primitive) = primitive else { continue };
            let normal = PackedNormal(found.normal).decode().unwrap();
            let outwards = if slice >= grid.cells / 2 { 1.0 } else { -1.0 };
            assert!(normal[axis] * outwards > -0.02, "{normal} on axis {axis}");
            let [a, b, c] = data.primitives[primitive].positions();
            let plane = (b - a).cross(c - a).normalize();
            assert!(normal.dot(plane).abs() > 0.999, "{normal} {plane}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn textures_are_the_same_as_projected_afresh_and_levels_the_rest_after_erosions(
        triangles in random_triangles(),
        (cells, texels, element) in small_grids(),
    ) {
        if let Some(mesh) = mesh_of(&triangles) {
            let data = built(&mesh, cells, texels, element);
            assert_eq!(data.primitives.len(), mesh.triangles().len());
            compare(&data);
            check(&file_of(&data));
        }
    }
}
