//! The points of a voxel's faces that a mesh covers, and the opacities that they come to.
//!
//! Points are stored, not only their number, so two halves of a slanted wall, one before the other, make a whole wall.

use super::touch::{OTHERS, Prepared};
use crate::Triangle;

pub(super) const POINTS: usize = 8;
/// The points of a face that are covered, by axis: bit `v * 8 + u`, with `u` and `v` the axes after it.
pub(super) type Masks = [u64; 3];

pub(super) fn dither(masks: &Masks) -> u32 {
    let mixed = masks.iter().fold(0u64, |hash, &mask| {
        (hash ^ mask)
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .rotate_left(29)
    });
    (mixed.wrapping_mul(0xd6e8_feb8_6659_fd93) >> 32) as u32
}

/// The opacity of a face of so many covered points: in sixteenths, rounded up or down as the dither has it.
pub(super) fn opacity_of(points: u32, dither: u32) -> u8 {
    let sixteenths = ((points * 16 + (dither & 63)) / 64) as u8;
    match sixteenths {
        // Eight sixteenths are between two opacities.
        8 => 7 + (dither >> 6 & 1) as u8,
        0..8 => sixteenths,
        _ => sixteenths - 1,
    }
}

const SPREAD: [i64; POINTS] = [0, 4, 2, 6, 1, 5, 3, 7];

/// The place of point (u, v) in eighths of its cell: in each row and column every eighth once.
fn offsets(u: usize, v: usize) -> [i64; 2] {
    [SPREAD[(v + 3 * u) & 7], SPREAD[(u + 5 * v) & 7]]
}

/// The opacity from which on a point counts: of the 64 points each has its own, and neighbours have unlike ones.
fn least_opacity(u: usize, v: usize) -> f64 {
    (SPREAD[u ^ v] * POINTS as i64 + SPREAD[u]) as f64 / 64.0
}

/// Adds the points that a triangle covers: those whose line along the axis it meets within the voxel. A triangle that
/// lets light through covers a share of the points like its opacity there. It is given with the number of texels along
/// an eighth of the voxel's side.
///
/// Corners and points stay below 2^31, so an edge times a distance is below 2^62.
pub(super) fn cover(
    triangle: &Prepared,
    clear: Option<(&Triangle<'_>, f64)>,
    corner: [i64; 3],
    side: i64,
    masks: &mut Masks,
) {
    let cell = side / POINTS as i64;
    for (k, [u, v]) in OTHERS.into_iter().enumerate() {
        let normal = triangle.normal;
        if normal[k] == 0 || masks[k] == u64::MAX {
            continue;
        }
        let turn = normal[k].signum();
        let flat = triangle
            .corners
            .map(|p| [p[u] - corner[u], p[v] - corner[v]]);
        let cells = |axis: usize| {
            let low = flat.iter().map(|p| p[axis]).min().unwrap_or(0);
            let high = flat.iter().map(|p| p[axis]).max().unwrap_or(0);
            low.max(0) / cell..=high.min(side - 1) / cell
        };
        // Bounds, within the voxel, of the normal's other components times the way from the first corner.
        let [first, ..] = flat;
        let at = i128::from(triangle.corners[0][k] - corner[k]);
        let along = i128::from(normal[k]) * i128::from(turn);
        let whole = along as f64;
        let (low, high) = (-along * at, along * (i128::from(side) - at));
        for j in cells(1) {
            for i in cells(0) {
                let bit = 1u64 << (j * POINTS as i64 + i);
                if masks[k] & bit != 0 {
                    continue;
                }
                let [du, dv] = offsets(i as usize, j as usize);
                let point = [
                    i * cell + (2 * du + 1) * cell / 16,
                    j * cell + (2 * dv + 1) * cell / 16,
                ];
                // Twice the areas between the point and each edge; `whole` is twice that of the triangle.
                let areas = [0, 1, 2].map(|e| {
                    let (a, b) = (flat[e], flat[(e + 1) % 3]);
                    let turned =
                        (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]);
                    turned * turn
                });
                if areas.iter().any(|&area| area < 0) {
                    continue;
                }
                let slope = i128::from(normal[u]) * i128::from(point[0] - first[0])
                    + i128::from(normal[v]) * i128::from(point[1] - first[1]);
                let depth = -slope * i128::from(turn);
                let is_shown = || {
                    clear.is_none_or(|(clear, texels)| {
                        let [c, a, b] = areas.map(|area| area as f64 / whole);
                        let opacity = clear.opacity([a, b, c], texels);
                        opacity > least_opacity(i as usize, j as usize)
                    })
                };
                if (low..=high).contains(&depth) && is_shown() {
                    masks[k] |= bit;
                }
            }
        }
    }
}

/// The coverage of a node's eight children together, by octant. Four points become one. The remainder is carried to the
/// next block with a covered point, so that a face keeps its share.
pub(super) fn joined(children: &[Masks]) -> Masks {
    let mut masks = Masks::default();
    for (k, [u, v]) in OTHERS.into_iter().enumerate() {
        let columns: [u64; 4] = std::array::from_fn(|column| {
            let octant = (column & 1) << (2 - u) | (column >> 1) << (2 - v);
            children[octant][k] | children[octant | 1 << (2 - k)][k]
        });
        // The first remainder is random, so that the last is rounded without bias.
        let mut points = dither(&[columns[0] ^ columns[3], columns[1], columns[2]]) & 3;
        for (column, covered) in columns.into_iter().enumerate() {
            let (cu, cv) = (column & 1, column >> 1);
            for block in 0..16usize {
                let (i, j) = (block & 3, block >> 2);
                let bits = covered >> (16 * j + 2 * i);
                let block = (bits & 0b11 | bits >> 6 & 0b1100).count_ones();
                points += block;
                if block > 0 && points >= 4 {
                    points -= 4;
                    masks[k] |= 1 << ((4 * cv + j) * POINTS + 4 * cu + i);
                }
            }
        }
    }
    masks
}
