//! From the world to the picture's plane: what is in front of the eye, and near it sideways.
//!
//! A polygon is cut at the near plane and at four planes through the eye, far
//! outside the picture, which keep coordinates in the bits that there are.
//! Where an edge crosses a plane is computed from its inner end to its outer
//! one, so two triangles that share an edge cut it at the same point.

use glam::DVec3;

use super::RasterCamera;
use super::samples::SUBPIXELS;

/// Pixels from the middle of the picture that coordinates may reach.
const GUARD_PX: f64 = 65536.0;
/// Three corners, and one more for each of five planes.
const MOST: usize = 8;

/// A convex polygon in 1/4096 pixel from the picture's top left corner.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outline {
    points: [[i64; 2]; MOST],
    count: usize,
}

impl Outline {
    /// The part of a triangle that lies before the eye, on the picture's plane.
    /// `None` where there is none.
    pub(super) fn of(view: &RasterCamera, corners: &[DVec3; 3]) -> Option<Self> {
        let seen = corners.map(|corner| in_view(view, corner));
        let mut points = [DVec3::ZERO; MOST];
        points[..3].copy_from_slice(&seen);
        let mut count = 3;
        let guard = GUARD_PX / view.focal_px;
        let planes = [
            (DVec3::Z, view.near),
            (DVec3::new(1.0, 0.0, guard), 0.0),
            (DVec3::new(-1.0, 0.0, guard), 0.0),
            (DVec3::new(0.0, 1.0, guard), 0.0),
            (DVec3::new(0.0, -1.0, guard), 0.0),
        ];
        for (normal, least) in planes {
            let inside = |p: DVec3| p.dot(normal) - least;
            if points[..count].iter().all(|&p| inside(p) >= 0.0) {
                continue;
            }
            (points, count) = cut(&points[..count], inside);
            if count < 3 {
                return None;
            }
        }
        let middle = [view.width, view.height].map(|side| f64::from(side) / 2.0);
        let place = |p: DVec3| {
            let x = middle[0] + p.x / p.z * view.focal_px;
            let y = middle[1] - p.y / p.z * view.focal_px;
            // Within the guard's 2^17 pixels: 2^29 steps.
            [x, y].map(|c| libm::round(c * SUBPIXELS as f64) as i64)
        };
        Some(Self {
            points: points.map(|p| if p.z > 0.0 { place(p) } else { [0; 2] }),
            count,
        })
    }

    /// The corners, in order.
    pub(super) fn points(&self) -> &[[i64; 2]] {
        &self.points[..self.count]
    }

    /// Least and greatest pixel that may hold a sample within; may lie outside the picture.
    pub(super) fn pixels(&self) -> [[i64; 2]; 2] {
        let points = self.points().iter();
        let (mut low, mut high) = ([i64::MAX; 2], [i64::MIN; 2]);
        for point in points {
            for k in 0..2 {
                low[k] = low[k].min(point[k]);
                high[k] = high[k].max(point[k]);
            }
        }
        [low, high].map(|p| p.map(|c| c.div_euclid(SUBPIXELS)))
    }
}

/// Right, up and depth of a point.
pub(super) fn in_view(view: &RasterCamera, point: DVec3) -> DVec3 {
    let offset = point - view.eye;
    DVec3::new(
        offset.dot(view.right),
        offset.dot(view.up),
        offset.dot(view.forward),
    )
}

fn cut(points: &[DVec3], inside: impl Fn(DVec3) -> f64) -> ([DVec3; MOST], usize) {
    let mut kept = [DVec3::ZERO; MOST];
    let mut count = 0;
    let mut keep = |point| {
        // Rounding may make a polygon that is not quite convex; what is too many is dropped.
        if count < MOST {
            kept[count] = point;
            count += 1;
        }
    };
    for (i, &here) in points.iter().enumerate() {
        let next = points[(i + 1) % points.len()];
        let (a, b) = (inside(here), inside(next));
        if a >= 0.0 {
            keep(here);
        }
        if (a >= 0.0) != (b >= 0.0) {
            let (from, to, a, b) = if a >= 0.0 {
                (here, next, a, b)
            } else {
                (next, here, b, a)
            };
            keep(from + (to - from) * (a / (a - b)));
        }
    }
    (kept, count)
}
