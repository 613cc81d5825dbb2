//! Triangles in the order of the hierarchy, scaled by a power of two to a size of about 1.

use glam::DVec3;

use super::count::SurfaceSample;
use crate::Surface;
use crate::geometry::{barycentric, plane_normal};
use crate::surface::stops;

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
        let (_, opacity) = triangle.at(barycentric(&corners, point), 0.0);
        stops(opacity, point)
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
