//! The voxels that triangles touch, and sample points in each, drawn by lot in proportion to area.

use glam::{DVec3, IVec3};

use super::grid::Grid;
use crate::geometry::{Polygon, area};
use shiftvox::split_mix::SplitMix;

pub(super) const POINTS: usize = 4;
const LEAST_AREA: f64 = 1e-9;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Touched {
    pub(super) number: u32,
    pub(super) points: [(DVec3, u32); POINTS],
    pub(super) area: f64,
}

pub(super) fn touched(
    grid: &Grid,
    triangles: impl Iterator<Item = (usize, [DVec3; 3])>,
    chance: &mut SplitMix,
) -> Vec<Touched> {
    let mut slot = vec![u32::MAX; grid.len()];
    let mut all: Vec<Touched> = Vec::new();
    for (triangle, corners) in triangles {
        let corners = corners.map(|p| grid.local(p));
        parts(grid, &corners, |number, cut| {
            let part = cut();
            let area = part.area();
            if area < LEAST_AREA {
                return;
            }
            let place = &mut slot[number as usize];
            if *place == u32::MAX {
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
                    *point = (part.point(chance), triangle as u32);
                }
            }
        });
    }
    all.sort_unstable_by_key(|voxel| voxel.number);
    all
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Touches {
    pub(super) voxels: u32,
    /// The area of all triangles, in faces of a voxel.
    pub(super) faces: f64,
}

pub(super) fn count(grid: &Grid, triangles: impl Iterator<Item = [DVec3; 3]>) -> Touches {
    let mut is_touched = vec![false; grid.len()];
    let (mut voxels, mut faces) = (0, 0.0);
    for corners in triangles {
        let corners = corners.map(|p| grid.local(p));
        faces += area(corners);
        parts(grid, &corners, |number, cut| {
            let mark = &mut is_touched[number as usize];
            if !*mark && cut().area() >= LEAST_AREA {
                *mark = true;
                voxels += 1;
            }
        });
    }
    Touches { voxels, faces }
}

/// Calls `visit` with each voxel that a triangle may touch, and with what cuts the triangle to it.
fn parts(grid: &Grid, corners: &[DVec3; 3], mut visit: impl FnMut(u32, &dyn Fn() -> Polygon)) {
    let [a, b, c] = *corners;
    let most = IVec3::from_array(grid.cells.map(|n| i32::from(n) - 1));
    let place = |p: DVec3| p.floor().as_ivec3().clamp(IVec3::ZERO, most);
    let (low, high) = (place(a.min(b).min(c)), place(a.max(b).max(c)));
    let number = |at: IVec3| grid.number(at.to_array().map(|c| c as u8)) as u32;
    let whole = Polygon::of(corners);
    if low == high {
        visit(number(low), &|| whole);
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
                    visit(number(at), &|| whole.within(corner));
                }
            }
        }
    }
}

impl Polygon {
    fn fan(&self) -> impl Iterator<Item = [DVec3; 3]> {
        let corners = self.corners();
        (1..corners.len().max(1) - 1).map(|i| [corners[0], corners[i], corners[i + 1]])
    }

    fn area(&self) -> f64 {
        self.fan().map(area).sum()
    }

    fn point(&self, chance: &mut SplitMix) -> DVec3 {
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
