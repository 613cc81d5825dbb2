//! From the world to the picture's plane: what is in front of the eye, and near it sideways.
//!
//! A polygon is cut at the near plane and at four planes through the eye, far
//! outside the picture, which keep coordinates in the bits that there are.
//! Where an edge crosses a plane is computed from its inner end to its outer
//! one, so two triangles that share an edge cut it at the same point.

use glam::DVec3;

use super::RasterCamera;
use super::samples::SUBPIXELS;
use crate::geometry::Polygon;

/// Pixels from the middle of the picture that coordinates may reach.
const GUARD_PX: f64 = 65536.0;
const MOST: usize = 8;

/// A convex polygon in 1/4096 pixel from the picture's top left corner.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outline {
    points: [[i64; 2]; MOST],
    count: usize,
}

impl Outline {
    pub(super) fn of(view: &RasterCamera, corners: &[DVec3; 3]) -> Option<Self> {
        let mut seen = Polygon::of(&corners.map(|corner| view.seen(corner)));
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
            if seen.corners().iter().any(|&p| inside(p) < 0.0) {
                seen = seen.cut(inside);
                if seen.corners().len() < 3 {
                    return None;
                }
            }
        }
        let mut outline = Self {
            points: [[0; 2]; MOST],
            count: seen.corners().len().min(MOST),
        };
        for (point, &p) in outline.points.iter_mut().zip(seen.corners()) {
            // Within the guard's 2^17 pixels: 2^29 steps.
            let step = |c: f64| libm::round(c * SUBPIXELS as f64) as i64;
            if p.z > 0.0 {
                *point = view.place(p).map(step);
            }
        }
        Some(outline)
    }

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
