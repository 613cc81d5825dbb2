//! The voxels that triangles touch, and sample points in each voxel.
//!
//! A triangle is cut to the voxel's cube. If an area is left, the voxel is
//! touched, and the points of that area are what visibility rays are aimed at. Of all that is in a
//! voxel a few points are kept, drawn by lot in proportion to area, in one pass over the triangles.

use glam::{DVec3, IVec3};

use super::chance::Chance;
use super::grid::Grid;
use crate::geometry::{Polygon, area};

/// Points that are kept of a voxel.
pub(super) const POINTS: usize = 4;
/// Area, of a voxel's face, below which a triangle only brushes a voxel.
const LEAST_AREA: f64 = 1e-9;

/// A voxel that triangles touch.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Touched {
    /// Its number in the grid.
    pub(super) number: u32,
    /// Points of its contents, in voxels from the grid's origin, and the number of the triangle of each.
    pub(super) points: [(DVec3, u32); POINTS],
    /// Area of its contents, in faces of a voxel.
    pub(super) area: f64,
}

/// The voxels that triangles touch, in the grid's order.
pub(super) fn touched(
    grid: &Grid,
    triangles: impl Iterator<Item = (usize, [DVec3; 3])>,
    chance: &mut Chance,
) -> Vec<Touched> {
    let mut slot = vec![u32::MAX; grid.len()];
    let mut all: Vec<Touched> = Vec::new();
    for (triangle, corners) in triangles {
        let corners = corners.map(|p| grid.local(p));
        parts(grid, &corners, |number, piece| {
            let part = piece.cut();
            let area = part.area();
            if area < LEAST_AREA {
                return;
            }
            let place = &mut slot[number as usize];
            if *place == u32::MAX {
                // Fewer than 2^24 voxels in a grid.
                *place = all.len() as u32;
                all.push(Touched {
                    number,
                    points: [(DVec3::ZERO, 0); POINTS],
                    area: 0.0,
                });
            }
            let voxel = &mut all[*place as usize];
            voxel.area += area;
            for point in &mut voxel.points {
                if chance.unit() * voxel.area < area {
                    // Fewer than 2^32 triangles.
                    *point = (part.point(chance), triangle as u32);
                }
            }
        });
    }
    all.sort_unstable_by_key(|voxel| voxel.number);
    all
}

/// How many voxels triangles touch.
pub(super) fn count(grid: &Grid, triangles: impl Iterator<Item = [DVec3; 3]>) -> u32 {
    let mut is_touched = vec![false; grid.len()];
    let mut count = 0;
    for corners in triangles {
        let corners = corners.map(|p| grid.local(p));
        parts(grid, &corners, |number, piece| {
            let mark = &mut is_touched[number as usize];
            if !*mark && piece.cut().area() >= LEAST_AREA {
                *mark = true;
                count += 1;
            }
        });
    }
    count
}

/// A triangle, and the voxel that it is to be cut to.
struct Piece<'t> {
    triangle: &'t Polygon,
    /// The voxel's lowest corner; `None` where all of the triangle is in it.
    voxel: Option<DVec3>,
}

impl Piece<'_> {
    fn cut(&self) -> Polygon {
        self.voxel
            .map_or(*self.triangle, |corner| self.triangle.within(corner))
    }
}

/// Calls back with the piece of a triangle (in voxels) in each voxel of a grid.
fn parts(grid: &Grid, corners: &[DVec3; 3], mut visit: impl FnMut(u32, &Piece<'_>)) {
    let [a, b, c] = *corners;
    let most = IVec3::from_array(grid.cells.map(|n| i32::from(n) - 1));
    let place = |p: DVec3| p.floor().as_ivec3().clamp(IVec3::ZERO, most);
    let (low, high) = (place(a.min(b).min(c)), place(a.max(b).max(c)));
    let number = |at: IVec3| {
        // Within the cells, so within a byte.
        grid.number(at.to_array().map(|c| c as u8)) as u32
    };
    let whole = Polygon::of(corners);
    if low == high {
        let piece = Piece {
            triangle: &whole,
            voxel: None,
        };
        visit(number(low), &piece);
        return;
    }
    let normal = (b - a).cross(c - a);
    let reach = normal.abs().element_sum() * (0.5 + 1e-9);
    for z in low.z..=high.z {
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let at = IVec3::new(x, y, z);
                let corner = at.as_dvec3();
                let middle = corner + DVec3::splat(0.5);
                if (middle - a).dot(normal).abs() <= reach {
                    let piece = Piece {
                        triangle: &whole,
                        voxel: Some(corner),
                    };
                    visit(number(at), &piece);
                }
            }
        }
    }
}

impl Polygon {
    /// The part in the unit cube from a corner on.
    fn within(&self, corner: DVec3) -> Self {
        let mut part = *self;
        for axis in 0..3 {
            let along = part.corners().iter().map(|p| p[axis]);
            let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
                (low.min(at), high.max(at))
            });
            if low < corner[axis] {
                part = part.cut_in_order(|p| p[axis] - corner[axis]);
            }
            if high > corner[axis] + 1.0 {
                part = part.cut_in_order(|p| corner[axis] + 1.0 - p[axis]);
            }
        }
        part
    }

    /// The triangles of a fan.
    fn fan(&self) -> impl Iterator<Item = [DVec3; 3]> {
        let corners = self.corners();
        (1..corners.len().max(1) - 1).map(|i| [corners[0], corners[i], corners[i + 1]])
    }

    fn area(&self) -> f64 {
        self.fan().map(area).sum()
    }

    /// A random point of it. It has an area.
    fn point(&self, chance: &mut Chance) -> DVec3 {
        let mut rest = chance.unit() * self.area();
        let (mut u, mut v) = (chance.unit(), chance.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let mut found = self.corners()[0];
        for triangle in self.fan() {
            let [a, b, c] = triangle;
            found = a + (b - a) * u + (c - a) * v;
            rest -= area(triangle);
            if rest < 0.0 {
                break;
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 8 x 8 x 8 unit voxels from the origin.
    const UNIT: Grid = Grid {
        origin: DVec3::ZERO,
        voxel: 1.0,
        cells: [8; 3],
    };

    #[test]
    fn parts_lie_in_their_voxels_and_make_up_the_triangle() {
        let mut chance = Chance::new(3);
        let mut random = || DVec3::new(chance.unit(), chance.unit(), chance.unit()) * 8.0;
        for _ in 0..200 {
            let corners = [random(), random(), random()];
            let mut sum = 0.0;
            parts(&UNIT, &corners, |number, piece| {
                let part = piece.cut();
                sum += part.area();
                let low = DVec3::from_array(UNIT.place(number as usize).map(f64::from));
                for &corner in part.corners() {
                    let inside = corner - low;
                    assert!(inside.min_element() > -1e-9 && inside.max_element() < 1.0 + 1e-9);
                }
            });
            assert!((sum - area(corners)).abs() < 1e-9 * sum.max(1.0), "{sum}");
        }
    }

    #[test]
    fn points_are_drawn_by_area_in_touched_voxels() {
        // A large and a small triangle in one voxel, and one beside it.
        let triangles = [(0.1, 0.8, 0.5), (0.1, 0.4, 0.2), (1.3, 0.5, 0.5)].map(|(x, side, z)| {
            let low = DVec3::new(x, 0.1, z);
            [low, low + DVec3::X * side, low + DVec3::Y * side]
        });
        assert_eq!(count(&UNIT, triangles.into_iter()), 2);
        let mut low = 0;
        for seed in 0..500 {
            let numbered = triangles.into_iter().enumerate();
            let voxels = touched(&UNIT, numbered, &mut Chance::new(seed));
            assert!(voxels.iter().map(|voxel| voxel.number).eq([0, 1]));
            // Each is on the triangle that it names.
            for (point, triangle) in voxels.iter().flat_map(|voxel| voxel.points) {
                assert_eq!(point.z, triangles[triangle as usize][0].z);
            }
            low += voxels[0].points.iter().filter(|p| p.0.z < 0.3).count();
        }
        // A fifth of the area.
        let share = low as f64 / (500 * POINTS) as f64;
        assert!((share - 0.2).abs() < 0.04, "{share}");
    }
}
