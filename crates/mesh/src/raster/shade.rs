//! Depth and colour of a sample, from the triangle's plane.

use glam::DVec3;

use super::RasterCamera;
use super::samples::SUBPIXELS;
use crate::Triangle;
use crate::geometry::{barycentric, blend, plane_normal};

/// Lambert's law under one distant light, over an ambient floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Unit vector towards the light.
    pub towards: DVec3,
    /// Light that comes from everywhere, 0 to 256 of 256.
    pub ambient: u32,
}

impl Light {
    /// The share of its colour that a surface shows, in steps of 1/256 as
    /// voxels are shaded too.
    pub fn on(&self, normal: DVec3) -> f64 {
        let cosine = normal.dot(self.towards).clamp(0.0, 1.0);
        let lit = f64::from(256 - self.ambient.min(256));
        let steps = self.ambient.min(256) + (cosine * lit + 0.5) as u32;
        f64::from(steps) / 256.0
    }
}

/// One over the depth of a triangle's plane, affine over the picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearness {
    at: f64,
    right: f64,
    down: f64,
    low: f64,
    high: f64,
}

impl Nearness {
    pub(super) fn of(view: &RasterCamera, corners: &[DVec3; 3]) -> Self {
        let [a, b, c] = corners.map(|corner| view.seen(corner));
        let nearest = a.z.min(b.z).min(c.z).max(view.near);
        let farthest = a.z.max(b.z).max(c.z).max(view.near);
        let normal = (b - a).cross(c - a);
        // Points p with normal . p = offset; a sample's ray is (x, y, 1) times its depth.
        let offset = normal.dot(a);
        let step = 1.0 / (view.focal_px * SUBPIXELS as f64);
        let (x, y) = (normal.x / offset * step, -normal.y / offset * step);
        let middle = [view.width, view.height].map(|side| f64::from(side) / 2.0 * SUBPIXELS as f64);
        Self {
            at: normal.z / offset - x * middle[0] - y * middle[1],
            right: x,
            down: y,
            low: 1.0 / farthest,
            high: 1.0 / nearest,
        }
    }

    /// At a place in 1/4096 pixel from the picture's corner. A plane that
    /// goes through the eye, or nearly, is kept between its corners.
    #[inline]
    pub(super) fn at(&self, x: f64, y: f64) -> f64 {
        let value = self.at + self.right * x + self.down * y;
        // Not `clamp`: a value that is not a number becomes a number.
        value.max(self.low).min(self.high)
    }
}

/// The point that a place of the picture, in 1/4096 pixel from its corner, sees at a depth.
#[inline]
pub(super) fn point_seen(view: &RasterCamera, x: f64, y: f64, depth: f64) -> DVec3 {
    let scale = depth / view.focal_px;
    let across = x / SUBPIXELS as f64 - f64::from(view.width) / 2.0;
    let upwards = f64::from(view.height) / 2.0 - y / SUBPIXELS as f64;
    view.eye + view.forward * depth + view.right * (across * scale) + view.up * (upwards * scale)
}

pub(super) fn light_of(
    view: &RasterCamera,
    light: Option<&Light>,
    point: DVec3,
    (color, normal): (DVec3, DVec3),
) -> DVec3 {
    let Some(light) = light else { return color };
    let is_front = normal.dot(view.eye - point) >= 0.0;
    color * light.on(if is_front { normal } else { -normal })
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Paint<'s> {
    triangle: Triangle<'s>,
    face: DVec3,
    flat: Option<DVec3>,
}

impl<'s> Paint<'s> {
    pub(super) fn of(view: &RasterCamera, triangle: Triangle<'s>, light: Option<&Light>) -> Self {
        let plane = plane_normal(triangle.corners);
        let is_front = (view.eye - triangle.corners[0]).dot(plane) >= 0.0;
        let face = if is_front { plane } else { -plane };
        let mut paint = Self {
            triangle,
            face,
            flat: None,
        };
        let same = |of: &[DVec3; 3]| of[0] == of[1] && of[1] == of[2];
        let is_flat = triangle.sampler.is_none() && same(&triangle.colors);
        if is_flat && (light.is_none() || same(&triangle.normals)) {
            paint.flat = Some(paint.mixed([1.0, 0.0, 0.0], 0.0, light));
        }
        paint
    }

    /// At a place of the picture, for a sample that is so many pixels wide.
    pub(super) fn light(
        &self,
        view: &RasterCamera,
        light: Option<&Light>,
        [x, y]: [f64; 2],
        depth: f64,
        pixels: f64,
    ) -> DVec3 {
        if let Some(flat) = self.flat {
            return flat;
        }
        let point = point_seen(view, x, y, depth);
        let shares = barycentric(&self.triangle.corners, point);
        self.mixed(shares, depth * pixels / view.focal_px, light)
    }

    fn mixed(&self, share: [f64; 3], side: f64, light: Option<&Light>) -> DVec3 {
        let (color, _) = self.triangle.at(share, side);
        let Some(light) = light else { return color };
        let normal = blend(&self.triangle.normals, share).normalize_or(self.face);
        let is_behind = normal.dot(self.face) < 0.0;
        color * light.on(if is_behind { -normal } else { normal })
    }
}
