//! Depth and colour of a sample, from the triangle's plane.

use glam::{DVec2, DVec3};

use super::RasterCamera;
use super::samples::SUBPIXELS;
use crate::geometry::{barycentric, blend, plane_normal};
use crate::texture::Image;
use crate::{Sampler, Triangle};

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
    pub(super) side: Side,
}

/// The side that a triangle shows, and its depths that are the same.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    /// Its corners are seen counter-clockwise.
    pub(super) faces_eye: bool,
    /// Depths that differ by this share are the same.
    pub(super) slack: f64,
}

/// Most slack, of planes that go nearly through the eye.
const MOST_SLACK: f64 = 1.0 / 65536.0;

impl Nearness {
    /// Points within `rounding` are the same. A plane that moves by it changes its depths by the share that this is of
    /// its distance from the eye.
    pub(super) fn of(view: &RasterCamera, corners: &[DVec3; 3], rounding: f64) -> Self {
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
            side: Side {
                // Right, up and forward are left-handed axes.
                faces_eye: offset > 0.0,
                slack: (rounding * normal.length() / offset.abs()).min(MOST_SLACK),
            },
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

/// A triangle and what samples see of its texture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen<'s> {
    triangle: Triangle<'s>,
    /// Of the texture's two axes. In a plane through the eye, across the view axis, a sample's sides are so many texels.
    texels: [DVec2; 2],
    /// By so much of each texel off the eye's place, they turn to the triangle's plane.
    tilt: DVec2,
    eye: [f64; 2],
}

impl<'s> Seen<'s> {
    pub(super) fn of(view: &RasterCamera, triangle: Triangle<'s>) -> Self {
        let mut seen = Self {
            triangle,
            texels: [DVec2::ZERO; 2],
            tilt: DVec2::ZERO,
            eye: [0.0; 2],
        };
        if let Some(sampler) = &triangle.sampler {
            let [a, b, c] = triangle.corners;
            let normal = (b - a).cross(c - a);
            let along = |of: DVec3| DVec2::new(of.dot(view.right), of.dot(view.up));
            let texels = sampler.texels_along(&triangle.corners);
            seen.tilt = along(normal) / normal.dot(a - view.eye);
            seen.texels = texels.map(along);
            let size = sampler.texture.size();
            let place = |k: usize| f64::from(sampler.places[0][k]) * size[k];
            seen.eye = [0, 1].map(|k| place(k) - texels[k].dot(a - view.eye));
        }
        seen
    }

    pub(super) fn shares(&self, point: DVec3) -> [f64; 3] {
        barycentric(&self.triangle.corners, point)
    }

    /// Colour at shares of the corners, for a sample whose sides are so long there.
    fn color(&self, shares: [f64; 3], side: f64) -> DVec3 {
        let color = blend(&self.triangle.colors, shares);
        self.triangle.sampler.as_ref().map_or(color, |sampler| {
            let (place, image) = self.image(sampler, shares, side);
            color * sampler.texture.at(place, image).0
        })
    }

    pub(super) fn opacity(&self, shares: [f64; 3], side: f64) -> f64 {
        let alpha = self.triangle.alpha;
        self.triangle.sampler.as_ref().map_or(alpha, |sampler| {
            let (place, image) = self.image(sampler, shares, side);
            alpha * sampler.texture.opacity(place, image)
        })
    }

    fn image(&self, sampler: &Sampler<'_>, shares: [f64; 3], side: f64) -> ([f64; 2], Image) {
        let (place, size) = (sampler.place(shares), sampler.texture.size());
        let rows = [0, 1].map(|k| {
            let off = place[k] * size[k] - self.eye[k];
            ((self.texels[k] - self.tilt * off) * side).extend(0.0)
        });
        (place, Image::by(rows))
    }
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
    seen: Seen<'s>,
    face: DVec3,
    flat: Option<DVec3>,
}

impl<'s> Paint<'s> {
    pub(super) fn of(view: &RasterCamera, triangle: Triangle<'s>, light: Option<&Light>) -> Self {
        let plane = plane_normal(triangle.corners);
        let is_front = (view.eye - triangle.corners[0]).dot(plane) >= 0.0;
        let face = if is_front { plane } else { -plane };
        let mut paint = Self {
            seen: Seen::of(view, triangle),
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
        let shares = self.seen.shares(point);
        self.mixed(shares, depth * pixels / view.focal_px, light)
    }

    fn mixed(&self, share: [f64; 3], side: f64, light: Option<&Light>) -> DVec3 {
        let color = self.seen.color(share, side);
        let Some(light) = light else { return color };
        let normal = blend(&self.seen.triangle.normals, share).normalize_or(self.face);
        let is_behind = normal.dot(self.face) < 0.0;
        color * light.on(if is_behind { -normal } else { normal })
    }
}
