//! Textures computed slice by slice against each volume projected afresh, with
//! arithmetic of the test's own.

use proptest::prelude::*;
use shiftvox::graph::PackedNormal;
use shiftvox_mesh::Mesh;
use shiftvox_mesh::textured::record::{CLEAR, NEVER, Texel};
use shiftvox_mesh::textured::{CellGrid, Element, TexturedData};

use super::scenes::{balls, built, color_of, mesh_of, random_triangles, small_grids};

/// The axes across and down a face that stands on an axis.
const FACE: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

/// Whether a triangle covers a point of the plane: as if the point were moved
/// to the right by next to nothing, and down by next to nothing of that.
fn covers(points: [[i128; 2]; 3], p: [i128; 2]) -> bool {
    let sides = [0, 1, 2].map(|i| {
        let (a, b) = (points[i], points[(i + 1) % 3]);
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let at = dx * (p[1] - a[1]) - dy * (p[0] - a[0]);
        // First the value, then what a step right and a step down add to it.
        [at, -dy, dx]
            .into_iter()
            .map(i128::signum)
            .find(|&s| s != 0)
    });
    sides[0].is_some() && sides[0] == sides[1] && sides[1] == sides[2]
}

/// How far along the axis a triangle is at a point within it, rounded down.
fn along(points: [[i128; 2]; 3], depths: [i128; 3], p: [i128; 2]) -> i128 {
    let area = |a: [i128; 2], b: [i128; 2], c: [i128; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let [a, b, c] = points;
    let weights = [area(p, b, c), area(a, p, c), area(a, b, p)];
    let sum: i128 = (0..3).map(|i| weights[i] * depths[i]).sum();
    sum.div_euclid(area(a, b, c))
}

/// The primitive that a texel sees in the slices from the middle of the grid to `slice`.
fn seen(
    corners: &[[[i64; 3]; 3]],
    lattice: &CellGrid,
    axis: usize,
    slice: u32,
    texel: [u32; 2],
) -> Option<usize> {
    let (step, half) = (lattice.texel_steps() as i128, lattice.cells() / 2);
    let is_positive = slice >= half;
    let p = texel.map(|t| i128::from(t) * step + step / 2);
    let mut best: Option<(i128, usize)> = None;
    for (number, corners) in corners.iter().enumerate() {
        let points = corners.map(|c| FACE[axis].map(|k| i128::from(c[k])));
        if !covers(points, p) {
            continue;
        }
        let depth = along(points, corners.map(|c| i128::from(c[axis])), p);
        let at = (depth / i128::from(lattice.cell_steps())).min(i128::from(lattice.cells()) - 1);
        let volume = if is_positive {
            i128::from(half)..=i128::from(slice)
        } else {
            i128::from(slice)..=i128::from(half - 1)
        };
        if !volume.contains(&at) {
            continue;
        }
        let is_farther_out = best.is_none_or(|(most, _)| {
            if is_positive {
                depth > most
            } else {
                depth < most
            }
        });
        if is_farther_out {
            best = Some((depth, number));
        }
    }
    best.map(|(_, number)| number)
}

/// Compares all sub-textures of a grid with volumes projected afresh. Returns
/// how many texels were compared, and how many see something.
fn compare(mesh: &Mesh, data: &TexturedData) -> [u64; 2] {
    let grid = &data.grids[0];
    let lattice = CellGrid::around(data.low, data.high, grid.cells, grid.texels);
    let corners: Vec<[[i64; 3]; 3]> = data
        .primitives
        .iter()
        .map(|primitive| primitive.positions().map(|p| lattice.point(p)))
        .collect();
    assert_eq!(corners.len(), mesh.triangles().len());
    let side = grid.texels;
    let mut compared = [0; 2];
    for voxel in &grid.voxels {
        for axis in 0..3 {
            let number = voxel.textures[axis];
            if number == NEVER {
                continue;
            }
            let slice = u32::from(voxel.cell[axis]);
            let [across, down] = FACE[axis].map(|k| u32::from(voxel.cell[k]) * side);
            for texel in 0..side * side {
                let place = [across + texel % side, down + texel / side];
                let expected = seen(&corners, &lattice, axis, slice, place);
                let found = match number {
                    CLEAR => Texel::default(),
                    _ => grid.textures[(number * side * side + texel) as usize],
                };
                compared[0] += 1;
                let Some(primitive) = expected else {
                    assert!(found.is_clear(), "{voxel:?} axis {axis} texel {texel}");
                    continue;
                };
                compared[1] += 1;
                let color = color_of(primitive as u32);
                assert_eq!(found.color, color, "{voxel:?} axis {axis} texel {texel}");
                assert_eq!(found.opacity, 255);
                let normal = PackedNormal(found.normal).decode().unwrap();
                let outwards = if slice >= grid.cells / 2 { 1.0 } else { -1.0 };
                assert!(normal[axis] * outwards > -0.02, "{normal} on axis {axis}");
                let [a, b, c] = data.primitives[primitive].positions();
                let plane = (b - a).cross(c - a).normalize();
                assert!(normal.dot(plane).abs() > 0.999, "{normal} {plane}");
            }
        }
    }
    compared
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn slice_by_slice_is_as_projected_afresh(
        triangles in random_triangles(),
        (cells, texels, element) in small_grids(),
    ) {
        if let Some(mesh) = mesh_of(&triangles) {
            compare(&mesh, &built(&mesh, cells, texels, element));
        }
    }
}

#[test]
fn textures_of_balls_are_as_projected_afresh() {
    let mesh = balls();
    let data = built(&mesh, 8, 3, Element::Cube);
    let [compared, seeing] = compare(&mesh, &data);
    assert!(
        compared > 2000 && seeing > compared / 3,
        "{compared} {seeing}"
    );
    let grid = &data.grids[0];
    assert!(grid.projected_afresh > 2 * grid.projected);
}

#[test]
fn equal_sub_textures_are_stored_once() {
    // A wall of one colour: most of its faces are alike.
    let wall = [
        [[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 8.0, 0.0]],
        [[0.0, 0.0, 0.0], [8.0, 8.0, 0.0], [0.0, 8.0, 0.0]],
    ];
    let data = built(&mesh_of(&wall).unwrap(), 16, 4, Element::Cube);
    let grid = &data.grids[0];
    let shown = grid.voxels.iter().flat_map(|v| v.textures);
    let shown = shown.filter(|&t| t < CLEAR).count();
    let stored = grid.textures.len() / 16;
    // One of each triangle, and those along the line between them.
    assert!(shown >= 256 && stored <= 4, "{shown} {stored}");
}
