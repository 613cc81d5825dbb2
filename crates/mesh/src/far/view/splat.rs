//! A voxel in the picture: a square of the size of its cube's outline.

use glam::DVec3;

use crate::far::record::Node;
use crate::raster::RasterCamera;

/// Share by which an outline is drawn larger, so that rounding and perspective leave no gap
/// between cubes side by side.
const OUTLINE_MARGIN: f64 = 0.01;

/// Where the voxels of a node are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places {
    origin: DVec3,
    voxel: f64,
}

/// A voxel's square.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Square {
    /// Its middle, pixels.
    pub(super) middle: [f64; 2],
    /// Half its side, pixels: its area is that of the cube's outline.
    pub(super) half: f64,
    /// View-axis depth of the cube's middle.
    pub(super) depth: f64,
    /// Unit vector to the eye.
    pub(super) towards_eye: DVec3,
}

impl Places {
    pub(super) fn of(node: &Node, centre: DVec3) -> Self {
        Self {
            origin: DVec3::from_array(node.origin.map(f64::from)) + centre,
            voxel: f64::from(node.voxel),
        }
    }

    /// The direction from the middle of a voxel to the eye.
    pub(super) fn towards_eye(&self, view: &RasterCamera, place: &[u8]) -> DVec3 {
        (view.eye - self.middle(place)).normalize_or(-view.forward)
    }

    fn middle(&self, place: &[u8]) -> DVec3 {
        let place = DVec3::new(
            f64::from(place[0]),
            f64::from(place[1]),
            f64::from(place[2]),
        );
        self.origin + (place + DVec3::splat(0.5)) * self.voxel
    }

    /// The square of a voxel; `None` before the near plane.
    pub(super) fn square(&self, view: &RasterCamera, place: &[u8]) -> Option<Square> {
        let seen = view.seen(self.middle(place));
        if seen.z < view.near {
            return None;
        }
        let towards_eye = self.towards_eye(view, place);
        // The outline of a unit cube has this area.
        let outline = towards_eye.abs().element_sum();
        let side = self.voxel * view.focal_px / seen.z * libm::sqrt(outline);
        Some(Square {
            middle: view.place(seen),
            half: side / 2.0,
            depth: seen.z,
            towards_eye,
        })
    }
}

/// The outline of a voxel's cube in the picture: a hexagon.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hexagon {
    middle: [f64; 2],
    /// Half of the cube's edges, pixels.
    edges: [[f64; 2]; 3],
    /// How far the hexagon reaches from its middle across each edge, times the edge's length.
    reach: [f64; 3],
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

impl Places {
    /// The outline of a voxel's cube, of which `square` has the place.
    pub(super) fn hexagon(&self, view: &RasterCamera, square: &Square) -> Hexagon {
        // Where the middle is, per unit of depth.
        let across = (square.middle[0] - f64::from(view.width) / 2.0) / view.focal_px;
        let up = (f64::from(view.height) / 2.0 - square.middle[1]) / view.focal_px;
        let scale = self.voxel / 2.0 * view.focal_px / square.depth;
        let edges = [0, 1, 2].map(|axis| {
            let forward = view.forward[axis];
            [
                (view.right[axis] - across * forward) * scale,
                (up * forward - view.up[axis]) * scale,
            ]
        });
        let reach = [0, 1, 2].map(|axis| {
            let others = edges.iter().map(|&other| cross(other, edges[axis]).abs());
            others.sum::<f64>() * (1.0 + OUTLINE_MARGIN)
        });
        Hexagon {
            middle: square.middle,
            edges,
            reach,
        }
    }
}

impl Hexagon {
    /// First pixel and the one after the last, right and down, of those whose middles may be in it.
    pub(super) fn pixels(&self, view: &RasterCamera) -> [[usize; 2]; 2] {
        let range = |k: usize, side: u32| {
            let most = f64::from(side);
            // Within the picture.
            let at = |c: f64| (c - 0.5).ceil().clamp(0.0, most) as usize;
            let half = self.edges.iter().map(|edge| edge[k].abs()).sum::<f64>();
            let half = half * (1.0 + OUTLINE_MARGIN);
            [at(self.middle[k] - half), at(self.middle[k] + half)]
        };
        let ([x0, x1], [y0, y1]) = (range(0, view.width), range(1, view.height));
        [[x0, y0], [x1, y1]]
    }

    /// Whether the middle of a pixel is in it.
    pub(super) fn holds(&self, x: usize, y: usize) -> bool {
        let offset = [
            x as f64 + 0.5 - self.middle[0],
            y as f64 + 0.5 - self.middle[1],
        ];
        let edges = self.edges.iter().zip(self.reach);
        edges
            .into_iter()
            .all(|(&edge, reach)| cross(offset, edge).abs() <= reach)
    }
}

impl Square {
    /// First pixel and the one after the last of those that it touches.
    pub(super) fn touched(&self, view: &RasterCamera) -> [[usize; 2]; 2] {
        let range = |k: usize, side: u32| {
            let most = f64::from(side);
            let low = (self.middle[k] - self.half).floor().clamp(0.0, most) as usize;
            let high = (self.middle[k] + self.half).ceil().clamp(0.0, most) as usize;
            [low, high]
        };
        let ([x0, x1], [y0, y1]) = (range(0, view.width), range(1, view.height));
        [[x0, y0], [x1, y1]]
    }

    /// The parts of a row or column of pixels whose middles are in the square, a bit for each of the [`PARTS`] of pixel
    /// `pixel` along axis `k`.
    pub(super) fn parts(&self, k: usize, pixel: usize) -> u32 {
        let at = |edge: f64| {
            let part = ((edge - pixel as f64) * PARTS as f64 - 0.5).ceil();
            part.clamp(0.0, PARTS as f64) as u32
        };
        let (low, high) = (
            at(self.middle[k] - self.half),
            at(self.middle[k] + self.half),
        );
        (1 << high) - (1 << low.min(high))
    }
}

/// Parts of a pixel along each axis, at which transparent voxels are resolved.
pub(super) const PARTS: usize = 4;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::looking;

    #[test]
    fn squares_side_by_side_share_the_parts_of_pixels() {
        let square = |low: f64, high: f64| Square {
            middle: [(low + high) / 2.0; 2],
            half: (high - low) / 2.0,
            depth: 1.0,
            towards_eye: DVec3::Z,
        };
        for edge in (0..60).map(|step| 2.0 + f64::from(step) / 37.0) {
            let (left, right) = (square(0.3, edge), square(edge, 5.2));
            let mut parts = 0;
            for pixel in 0..6 {
                let (a, b) = (left.parts(0, pixel), right.parts(0, pixel));
                assert_eq!(a & b, 0, "{edge}");
                parts += (a | b).count_ones();
            }
            // From 0.3 to 5.2 there are the middles of 4.9 * 4 parts.
            assert_eq!(parts, 20, "{edge}");
        }
    }

    #[test]
    fn hexagons_have_the_area_of_their_squares_and_leave_no_gap() {
        let forward = DVec3::new(0.48, 0.6, 0.64);
        let view = looking(DVec3::ZERO, forward, [64; 2], 400.0);
        let places = Places {
            origin: forward * 40.0 - DVec3::splat(2.0),
            voxel: 1.0,
        };
        // A block of 4 x 4 x 4 cubes.
        let mut covered = vec![0u32; 64 * 64];
        let (mut pixels, mut area) = (0, 0.0);
        for number in 0..64u8 {
            let place = [number % 4, number / 4 % 4, number / 16];
            let square = places.square(&view, &place).unwrap();
            let hexagon = places.hexagon(&view, &square);
            let [[x0, y0], [x1, y1]] = hexagon.pixels(&view);
            for (y, x) in (y0..y1).flat_map(|y| (x0..x1).map(move |x| (y, x))) {
                let held = u32::from(hexagon.holds(x, y));
                covered[y * 64 + x] += held;
                pixels += held;
            }
            area += (2.0 * square.half).powi(2);
        }
        let error = f64::from(pixels) / area - 1.0;
        assert!(error.abs() < 0.03, "{error}");
        // A row that begins outside the block enters and leaves it once.
        for row in covered.chunks(64) {
            let pairs = row.windows(2);
            let edges = pairs.filter(|pair| (pair[0] == 0) != (pair[1] == 0));
            assert!(edges.count() <= 2, "{row:?}");
        }
    }
}
