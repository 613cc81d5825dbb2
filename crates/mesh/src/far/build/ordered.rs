//! Triangles in the order of the hierarchy, scaled by a power of two to a size of about 1.

use glam::DVec3;

use super::count::SurfaceSample;
use crate::Surface;
use crate::far::record::LeafTriangle;
use crate::geometry::{barycentric, plane_normal};
use crate::material::to_srgb;
use crate::surface::stops;
use crate::texture::paint::{Paint, Textures};
use shiftvox::graph::PackedNormal;

pub(super) struct Ordered<'s> {
    pub(super) surface: &'s dyn Surface,
    pub(super) order: &'s [u32],
    pub(super) centre: DVec3,
    pub(super) scale: f64,
}

impl Ordered<'_> {
    pub(super) fn place(&self, point: DVec3) -> DVec3 {
        (point - self.centre) * self.scale
    }

    pub(super) fn corners(&self, number: usize) -> [DVec3; 3] {
        let corners = self.surface.corners(self.order[number] as usize);
        corners.map(|p| self.place(p))
    }

    pub(super) fn plane(&self, number: usize) -> DVec3 {
        plane_normal(self.corners(number))
    }

    /// Whether a triangle stops a ray at a point: where it lets light through, by lot.
    pub(super) fn stops(&self, number: usize, point: DVec3) -> bool {
        let number = self.order[number] as usize;
        if self.surface.is_opaque(number) {
            return true;
        }
        let triangle = self.surface.triangle(number);
        let corners = triangle.corners.map(|p| self.place(p));
        let opacity = triangle.opacity(barycentric(&corners, point), 0.0);
        stops(opacity, point)
    }

    /// As they are stored, with `textures` or else with the textures' colours at the corners.
    pub(super) fn stored(
        &self,
        numbers: impl Iterator<Item = usize>,
        textures: Option<&Textures>,
    ) -> Vec<LeafTriangle> {
        let stored = |number: usize| {
            let triangle = self.surface.triangle(self.order[number] as usize);
            let (paint, colors) = match textures {
                Some(textures) => textures.paint(&triangle),
                None => (Paint::NONE, triangle.corner_colors()),
            };
            let corners = triangle
                .corners
                .map(|p| (p - self.centre).as_vec3().to_array());
            LeafTriangle {
                corners,
                normals: triangle.normals.map(|n| PackedNormal::encode(n).0),
                colors: colors.map(to_srgb),
                paint,
            }
        };
        numbers.map(stored).collect()
    }

    /// Normal and colour at a point. The colour is the mean of a square of that side.
    pub(super) fn sample(
        &self,
        number: usize,
        point: DVec3,
        towards_eye: DVec3,
        side: f64,
    ) -> SurfaceSample {
        let mut triangle = self.surface.triangle(self.order[number] as usize);
        triangle.corners = triangle.corners.map(|p| self.place(p));
        let (normal, (color, _)) = triangle.seen_from(point, towards_eye, side);
        SurfaceSample {
            towards_eye,
            normal,
            color,
        }
    }
}
