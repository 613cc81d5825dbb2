//! Colour and normal of a voxel, from the parts of the triangles within it.
//!
//! The weight of a triangle is its opacity times the area of its part within the cube, plus 2^-20 of a face, so that
//! triangles that only touch the cube count, too. A texture is averaged over a square as large as the part. A part whose
//! texture has less than a quarter of opacity is a hole, and a cube with holes alone is no voxel. Where voxels have
//! opacities, only what is all but clear is a hole.

use glam::DVec3;

use super::touch::Prepared;
use crate::Triangle;
use crate::geometry::{Polygon, barycentric, blend};
use crate::material::to_srgb;
use shiftvox::graph::PackedNormal;

const TOUCH: f64 = 1.0 / (1u32 << 20) as f64;
const CANCELLED: f64 = 0.25;
pub(super) const HOLE: f64 = 0.25;
pub(super) const HOLE_OF_OPACITIES: f64 = 1.0 / 64.0;

#[derive(Debug, Default)]
pub(super) struct Mix {
    weight: f64,
    light: DVec3,
    normal: DVec3,
    /// The normals once more, each turned to the side of the sum so far.
    turned: DVec3,
    /// The greatest opacity of a texture.
    greatest: f64,
}

impl Mix {
    /// Adds the part of a triangle that lies in the cube. The order of adding counts, in the last bit.
    pub(super) fn add(
        &mut self,
        triangle: &Triangle<'_>,
        prepared: &Prepared,
        corner: [i64; 3],
        side: i64,
        voxel_size: f64,
    ) {
        // Exact: differences on the lattice are below 2^31, the side a power of two.
        let scale = 1.0 / side as f64;
        let points = prepared
            .corners
            .map(|p| DVec3::from_array(std::array::from_fn(|k| (p[k] - corner[k]) as f64 * scale)));
        let (area, centre) = if prepared.is_inside(corner, side) {
            (area_of(&points), (points[0] + points[1] + points[2]) / 3.0)
        } else {
            part_in_unit_cube(&points)
        };
        let share = barycentric(&points, centre);
        let (color, opacity) = triangle.at(share, area.sqrt() * voxel_size);
        // Also what is all but invisible is drawn, unless its picture has a hole.
        self.greatest = self.greatest.max(opacity / triangle.alpha);
        let weight = (area + TOUCH) * opacity;
        let normal = blend(&triangle.normals, share).normalize_or(triangle.normals[0]) * weight;
        self.weight += weight;
        self.light += color * weight;
        self.normal += normal;
        let is_turned = self.turned.dot(normal) < 0.0;
        self.turned += if is_turned { -normal } else { normal };
    }

    pub(super) fn is_shown(&self, hole: f64) -> bool {
        self.greatest >= hole
    }

    /// The voxel's colour (sRGB) and normal: the average, or where normals cancel, as in a thin wall with both its
    /// sides, that of the first triangle's side.
    pub(super) fn finish(&self) -> ([u8; 3], Option<PackedNormal>) {
        let light = self.light / self.weight.max(f64::MIN_POSITIVE);
        let color = to_srgb(light);
        let is_clear = self.normal.length() >= CANCELLED * self.weight;
        let normal = if is_clear { self.normal } else { self.turned };
        let packed = PackedNormal::encode(normal);
        (color, (!packed.is_none()).then_some(packed))
    }
}

fn area_of(corners: &[DVec3]) -> f64 {
    let mut twice = DVec3::ZERO;
    for pair in corners.windows(2).skip(1) {
        twice += (pair[0] - corners[0]).cross(pair[1] - corners[0]);
    }
    twice.length() / 2.0
}

/// Area of the part of a triangle in the unit cube, and the mean of its corners; where they only touch, 0 and a point
/// of the cube nearby.
fn part_in_unit_cube(triangle: &[DVec3; 3]) -> (f64, DVec3) {
    let part = Polygon::of(triangle).within(DVec3::ZERO);
    let corners = part.corners();
    if corners.is_empty() {
        let middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
        return (0.0, middle.clamp(DVec3::ZERO, DVec3::ONE));
    }
    let mean = corners.iter().copied().sum::<DVec3>() / corners.len() as f64;
    (area_of(corners), mean)
}
