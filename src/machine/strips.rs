//! Silhouettes in screen space: where a voxel is a parallelepiped, its
//! outline is the intersection of three strips, one along each edge
//! direction (`SPEC.md`, "Strips").
//!
//! All voxels of a level that changed to screen space together have the same
//! edges, so the shape of the outline is kept for the next voxel. The
//! products that a strip needs are made by shifts and adds over the ten
//! bits of its normal. Normals are rounded, so strips are taken wide enough
//! to hold all eight vertices, and the box cuts off what that adds.

use hwmodel::{Datapath, Probe, WideWord, Word};

use super::constants::Constants;
use super::lattice::Lattice;
use super::record::Screen;
use super::silhouette::{Cover, Silhouette};
use crate::frame::QuadNode;

/// Bits of a strip's normal, without sign.
const NORMAL_BITS: u32 = 10;

/// What a strip has of the edges alone: `low <= gx x + gy y <= high` relative
/// to the voxel's lowest corner, in half units of the last place.
#[derive(Debug, Clone, Copy)]
struct Shape {
    gx: Word,
    gy: Word,
    /// `|gx| + |gy|`.
    slope: WideWord,
    low: WideWord,
    high: WideWord,
}

/// The shapes of the three strips of the voxel drawn last, and its edges.
#[derive(Debug, Default)]
pub(super) struct Shapes {
    last: Option<([[Word; 3]; 2], [Shape; 3])>,
}

impl Shapes {
    /// The shapes for these edges (along x and y of the picture): those of the last voxel if it had the same.
    fn of<P: Probe>(&mut self, dp: &mut Datapath<P>, edges: [[Word; 3]; 2]) -> [Shape; 3] {
        if let Some((last, shapes)) = &self.last {
            let mut pairs = edges.iter().flatten().zip(last.iter().flatten());
            if pairs.all(|(&new, &old)| dp.equal(new, old)) {
                return *shapes;
            }
        }
        let shapes = [0, 1, 2].map(|j| Shape::new(dp, edges, j));
        self.last = Some((edges, shapes));
        shapes
    }
}

impl Shape {
    /// The strip along edge `j`.
    fn new<P: Probe>(dp: &mut Datapath<P>, [x, y]: [[Word; 3]; 2], j: usize) -> Self {
        let (normal_x, normal_y) = normal(dp, x[j], y[j]);
        let gx = dp.neg(normal_y);
        let gy = normal_x;
        let mut low = WideWord::ZERO;
        let mut high = WideWord::ZERO;
        for k in 0..3 {
            let across = along(dp, [gx, gy], [x[k], y[k]]);
            let across = dp.shl(across, 1);
            let below = dp.min(across, WideWord::ZERO);
            let above = dp.max(across, WideWord::ZERO);
            low = dp.add(low, below);
            high = dp.add(high, above);
        }
        Self {
            gx,
            gy,
            slope: slope(dp, gx, gy),
            low,
            high,
        }
    }
}

/// `gx x + gy y`.
fn along<P: Probe>(dp: &mut Datapath<P>, [gx, gy]: [Word; 2], [x, y]: [Word; 2]) -> WideWord {
    let along_x = times(dp, gx, x);
    let along_y = times(dp, gy, y);
    dp.add(along_x, along_y)
}

/// The five strips of a voxel's outline: one along each edge direction, and
/// the two pairs of the box's sides.
#[derive(Debug)]
pub(super) struct Outline {
    shapes: [Shape; STRIPS],
    /// The functions' values in the middle of the voxel's quadtree node.
    values: [WideWord; STRIPS],
    /// Fraction bits of screen positions.
    frac: u32,
}

/// Strips of an outline.
const STRIPS: usize = 5;

/// An outline relative to a quadtree node.
#[derive(Debug, Clone)]
pub(super) struct StripSilhouette<'o> {
    outline: &'o Outline,
    /// The functions' values in the middle of the node.
    values: [WideWord; STRIPS],
    /// Whether all samples of the node are inside, by strip.
    settled: [bool; STRIPS],
}

/// `small * a` by shifts and adds; `|small| < 2^NORMAL_BITS`.
fn times<P: Probe>(dp: &mut Datapath<P>, small: Word, a: Word) -> WideWord {
    let negative = dp.is_negative(small);
    let negated = dp.neg(small);
    let magnitude = dp.select(negative, negated, small);
    let a = dp.widen(a);
    let mut sum = WideWord::ZERO;
    for place in 0..NORMAL_BITS {
        let part = dp.shl(a, place);
        let with = dp.add(sum, part);
        let bit = dp.bit(magnitude, place);
        sum = dp.select(bit, with, sum);
    }
    let negated = dp.neg(sum);
    dp.select(negative, negated, sum)
}

impl Shape {
    /// What a node has of the strip: `value` in its middle, `below` levels
    /// above the samples.
    fn cover<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        value: WideWord,
        below: u32,
        frac: u32,
    ) -> Cover {
        let (mut least, mut greatest) = (value, value);
        if below > 0 {
            // Samples lie within (2^below - 1) half samples of the middle.
            let most = dp.shl(self.slope, below + frac);
            let half = dp.shl(self.slope, frac);
            let reach = dp.sub(most, half);
            greatest = dp.add(value, reach);
            least = dp.sub(value, reach);
        }
        if dp.lt(greatest, self.low) || dp.lt(self.high, least) {
            return Cover::None;
        }
        if dp.le(self.low, least) && dp.le(greatest, self.high) {
            Cover::All
        } else {
            Cover::Some
        }
    }

    /// The value in the middle of a quadrant, `2^places` half units away from
    /// the node's along x and y.
    fn in_quadrant<P: Probe>(
        &self,
        dp: &mut Datapath<P>,
        value: WideWord,
        quadrant: u8,
        places: u32,
    ) -> WideWord {
        [(self.gx, quadrant & 1 != 0), (self.gy, quadrant & 2 != 0)]
            .into_iter()
            .fold(value, |value, (g, positive)| {
                let g = dp.widen(g);
                let step = dp.shl(g, places);
                if positive {
                    dp.add(value, step)
                } else {
                    dp.sub(value, step)
                }
            })
    }
}

impl Outline {
    pub(super) fn new<P: Probe, L: Lattice>(
        dp: &mut Datapath<P>,
        constants: &Constants,
        shapes: &mut Shapes,
        quad: QuadNode,
        pose: &Screen<L>,
    ) -> Self {
        let frac = constants.screen_frac;
        let below = constants.levels - quad.level;
        let edges_x = pose.x.edges(dp);
        let edges_y = pose.y.edges(dp);
        // The node's middle, in half units: whole half samples.
        let middle = |column: u32| Word::from_host(i64::from(2 * column + 1) << (below + frac));
        let corner_x = dp.shl(pose.x.corner(), 1);
        let corner_y = dp.shl(pose.y.corner(), 1);
        let (middle_x, middle_y) = (middle(quad.x), middle(quad.y));
        let from_corner_x = dp.sub(middle_x, corner_x);
        let from_corner_y = dp.sub(middle_y, corner_y);
        let [a, b, c] = shapes.of(dp, [edges_x, edges_y]);
        let value = |dp: &mut Datapath<P>, shape: &Shape| {
            along(dp, [shape.gx, shape.gy], [from_corner_x, from_corner_y])
        };
        let values = [
            value(dp, &a),
            value(dp, &b),
            value(dp, &c),
            dp.widen(middle_x),
            dp.widen(middle_y),
        ];
        let one = Word::from_host(1);
        let across = sides(dp, [one, Word::ZERO], pose.x_span);
        let down = sides(dp, [Word::ZERO, one], pose.y_span);
        Self {
            shapes: [a, b, c, across, down],
            values,
            frac,
        }
    }

    /// The outline relative to the voxel's own quadtree node.
    pub(super) fn silhouette(&self) -> StripSilhouette<'_> {
        StripSilhouette {
            outline: self,
            values: self.values,
            settled: [false; STRIPS],
        }
    }
}

/// An edge's direction in `NORMAL_BITS` bits.
fn normal<P: Probe>(dp: &mut Datapath<P>, x: Word, y: Word) -> (Word, Word) {
    let length_x = dp.bit_length(x);
    let length_y = dp.bit_length(y);
    let places = dp.longer(length_x, length_y).saturating_sub(NORMAL_BITS);
    // Towards zero, so that no component reaches 2^NORMAL_BITS.
    let mut part = |v: Word| {
        let negative = dp.is_negative(v);
        let negated = dp.neg(v);
        let magnitude = dp.select(negative, negated, v);
        let small = dp.shr(magnitude, places);
        let negated = dp.neg(small);
        dp.select(negative, negated, small)
    };
    (part(x), part(y))
}

fn slope<P: Probe>(dp: &mut Datapath<P>, gx: Word, gy: Word) -> WideWord {
    let mut magnitude = |g: Word| {
        let negated = dp.neg(g);
        dp.max(g, negated)
    };
    let x = magnitude(gx);
    let y = magnitude(gy);
    let sum = dp.add(x, y);
    dp.widen(sum)
}

/// One pair of the box's sides.
fn sides<P: Probe>(dp: &mut Datapath<P>, [gx, gy]: [Word; 2], (low, high): (Word, Word)) -> Shape {
    let low = dp.widen(low);
    let low = dp.shl(low, 1);
    let high = dp.widen(high);
    let high = dp.shl(high, 1);
    Shape {
        gx,
        gy,
        slope: WideWord::from_host(1),
        low,
        high,
    }
}

impl Silhouette for StripSilhouette<'_> {
    fn cover<P: Probe>(&mut self, dp: &mut Datapath<P>, below: u32) -> Cover {
        let mut all = true;
        for i in 0..STRIPS {
            if self.settled[i] {
                continue;
            }
            let shape = &self.outline.shapes[i];
            match shape.cover(dp, self.values[i], below, self.outline.frac) {
                Cover::None => return Cover::None,
                Cover::Some => all = false,
                Cover::All => self.settled[i] = true,
            }
        }
        if all { Cover::All } else { Cover::Some }
    }

    fn quadrant<P: Probe>(&self, dp: &mut Datapath<P>, quadrant: u8, below: u32) -> Self {
        // From a node's middle to a quadrant's: 2^(below - 1) half samples.
        let places = below - 1 + self.outline.frac;
        let mut inner = self.clone();
        for i in 0..STRIPS {
            if !self.settled[i] {
                let shape = &self.outline.shapes[i];
                inner.values[i] = shape.in_quadrant(dp, self.values[i], quadrant, places);
            }
        }
        inner
    }
}
