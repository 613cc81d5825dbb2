//! What a ray meets first.

use std::time::Duration;

use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle as BvhTriangle;

/// Share of an edge by which triangles reach beyond it, so that no ray slips
/// between two that share it.
const EDGE: f32 = 1e-5;

/// Triangles, ready for rays. Coordinates are those that it was given.
pub(super) struct Occluders {
    bvh: CwBvh,
    /// In the order of the hierarchy's indices.
    triangles: Vec<BvhTriangle>,
}

/// A triangle that a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TriangleHit {
    /// Distance along the ray.
    pub(super) distance: f64,
    /// Number of the triangle, as they were given.
    pub(super) triangle: usize,
}

impl Occluders {
    pub(super) fn new(corners: impl Iterator<Item = [DVec3; 3]>) -> Self {
        let triangles: Vec<BvhTriangle> = corners
            .map(|corners| {
                let [v0, v1, v2] = corners.map(|p| p.as_vec3a());
                BvhTriangle { v0, v1, v2 }
            })
            .collect();
        let bvh = build_cwbvh_from_tris(
            &triangles,
            BvhBuildParams::slow_build(),
            &mut Duration::default(),
        );
        // In the order of the hierarchy: those that a ray tests one after the other lie together.
        let indices = bvh.primitive_indices.iter();
        let triangles = indices.map(|&number| triangles[number as usize]).collect();
        Self { bvh, triangles }
    }

    /// The nearest triangle along a unit direction, not farther than `most`.
    pub(super) fn nearest(
        &self,
        origin: DVec3,
        direction: DVec3,
        most: f64,
    ) -> Option<TriangleHit> {
        let ray = Ray::new(origin.as_vec3a(), direction.as_vec3a(), 0.0, most as f32);
        let mut hit = RayHit::none();
        self.bvh.ray_traverse(ray, &mut hit, |ray, place| {
            meet(&self.triangles[place], ray)
        });
        if !hit.t.is_finite() || hit.primitive_id == u32::MAX {
            return None;
        }
        Some(TriangleHit {
            distance: f64::from(hit.t),
            triangle: self.bvh.primitive_indices[hit.primitive_id as usize] as usize,
        })
    }
}

/// Distance along the ray; infinite where they do not meet. Möller and
/// Trumbore's test, from both sides, a little beyond the edges.
fn meet(triangle: &BvhTriangle, ray: &Ray) -> f32 {
    let along: [Vec3A; 2] = [triangle.v1 - triangle.v0, triangle.v2 - triangle.v0];
    let across = ray.direction.cross(along[1]);
    let signed = along[0].dot(across);
    // All is compared times this, so that nothing is divided that does not meet.
    let scale = signed.abs();
    let sign = 1f32.copysign(signed);
    let from = ray.origin - triangle.v0;
    let u = from.dot(across) * sign;
    let over = from.cross(along[0]);
    let v = ray.direction.dot(over) * sign;
    if scale == 0.0 || u.min(v).min(scale - u - v) < -EDGE * scale {
        return f32::INFINITY;
    }
    let t = along[1].dot(over) * sign / scale;
    if t >= ray.tmin && t <= ray.tmax {
        t
    } else {
        f32::INFINITY
    }
}
