//! The part of a mesh's shape that fitted cameras use, kept in every file made of a mesh.

use super::place;

const PARTS: f64 = 512.0;

/// The box around a mesh with bevelled corners, and its vertical axis.
///
/// A bevel cuts a corner off at one share of its three edges, beyond which the mesh has no vertex. A share is less than
/// half an edge, so the 24 points where bevels and edges meet enclose the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshBox {
    /// Lowest corner, world units, rounded to single precision.
    pub low: [f64; 3],
    pub high: [f64; 3],
    /// Bevels of the corners `x << 2 | y << 1 | z`, in 512ths of the edges.
    pub bevels: [u8; 8],
    pub y_up: bool,
}

impl MeshBox {
    pub fn new((low, high): ([f64; 3], [f64; 3]), bevels: [u8; 8], y_up: bool) -> Self {
        let centre = place::centre(low, high);
        let kept =
            |p: [f64; 3]| [0, 1, 2].map(|k| centre[k] + f64::from((p[k] - centre[k]) as f32));
        Self {
            low: kept(low),
            high: kept(high),
            bevels,
            y_up,
        }
    }

    pub fn around(
        span: ([f64; 3], [f64; 3]),
        points: impl Iterator<Item = [f64; 3]>,
        y_up: bool,
    ) -> Self {
        Self::new(span, bevels(span, points), y_up)
    }

    /// Points that enclose the mesh.
    pub fn hull(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        (0..24).map(|i| {
            let (corner, along) = (i / 3, i % 3);
            let share = f64::from(self.bevels[corner]) / PARTS;
            let (mut from, to) = (self.corner(corner), self.corner(7 - corner));
            from[along] += (to[along] - from[along]) * share;
            from
        })
    }

    fn corner(&self, corner: usize) -> [f64; 3] {
        [0, 1, 2].map(|k| [self.low, self.high][corner >> (2 - k) & 1][k])
    }

    pub(super) fn can_be_seen(&self, finest: f64) -> bool {
        let (mut longest, mut is_box) = (0.0f64, true);
        for k in 0..3 {
            is_box &= self.low[k] <= self.high[k];
            longest = longest.max(self.high[k] - self.low[k]);
        }
        is_box && longest >= finest && place::can_be_seen(self.low, self.high, finest)
    }
}

/// Share of the edges at each corner of a box that has no point beyond it.
fn bevels((low, high): ([f64; 3], [f64; 3]), points: impl Iterator<Item = [f64; 3]>) -> [u8; 8] {
    let side = [0, 1, 2].map(|k| high[k] - low[k]);
    let mut least = [1.0f64; 8];
    for point in points {
        // From the lowest corner and from the highest, in sides; 0 for a box without extent along an axis.
        let shares = [0, 1, 2].map(|k| match side[k] > 0.0 {
            true => [
                (point[k] - low[k]) / side[k],
                (high[k] - point[k]) / side[k],
            ],
            false => [0.0; 2],
        });
        for (corner, least) in least.iter_mut().enumerate() {
            let [x, y, z] = [0, 1, 2].map(|k| shares[k][corner >> (2 - k) & 1]);
            *least = least.min(x + y + z);
        }
    }
    least.map(|share| (share * PARTS - 1.0) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_encloses_all_points_and_little_more() {
        // An octahedron, whose corners are the middles of the box's sides.
        let points: Vec<[f64; 3]> = (0..6)
            .map(|i| [0, 1, 2].map(|k| if k == i / 2 { [1.0, 3.0][i % 2] } else { 2.0 }))
            .collect();
        let mesh = MeshBox::around(([1.0; 3], [3.0; 3]), points.iter().copied(), true);
        assert_eq!(mesh.bevels, [255; 8]);
        let hull: Vec<[f64; 3]> = mesh.hull().collect();
        for signs in 0..27 {
            let way = [signs % 3, signs / 3 % 3, signs / 9].map(|s| f64::from(s) - 1.0);
            let most = |points: &[[f64; 3]]| {
                let along = points.iter().map(|p| (0..3).map(|k| p[k] * way[k]).sum());
                along.fold(f64::NEG_INFINITY, f64::max)
            };
            assert!(most(&hull) >= most(&points), "{way:?}");
        }
        // A corner is seen half a side nearer than that of the box.
        assert!(hull.iter().all(|p| p.iter().sum::<f64>() < 8.01));
    }

    #[test]
    fn flat_boxes_lose_nothing_and_places_are_of_single_precision() {
        let corners = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [4.0, 4.0, 0.0]];
        let mut flat = MeshBox::around((corners[0], corners[3]), corners.into_iter(), false);
        assert_eq!(flat.bevels, [0; 8]);
        assert!(flat.can_be_seen(1.0) && !flat.can_be_seen(5.0));
        assert!(flat.hull().all(|p| corners.contains(&p)));
        flat.high[1] = f64::NAN;
        assert!(!flat.can_be_seen(1.0));
        let exact = ([1e6, 0.1, -0.3], [1e6 + 1.0, 0.7, 0.3]);
        let MeshBox { low, high, .. } = MeshBox::new(exact, [0; 8], false);
        assert_eq!((low[0], high[0]), (1e6, 1e6 + 1.0));
        assert!((low[1] - 0.1).abs() < 1e-7);
    }
}
