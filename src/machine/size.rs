//! The size of a record in samples, and the sample that contains its centre (`SPEC.md`, R7).

use hwmodel::{Datapath, OpClass, Probe, Short, Word};

use super::blocks::{Block, LEVEL_BITS, NODE_BITS, node_wires};
use super::cage::CageCoordinate;
use super::constants::Constants;
use super::levels;
use super::record::{Clip, ImagePlace, Screen};
use super::shifts::sum_of_shifts;
use crate::frame::QuadNode;
use crate::project::options::ShiftSum;

/// Whether a clip-space cage is at most `limit` samples wide and high, in a node `below` levels above the samples. An
/// edge `E` moves a vertex at `x` (0 to 1 across the node) by `(E_X - x E_W) / W`. So the sum of the greater of `|E_X|`
/// and `|E_X - E_W|`, divided by the least `W`, bounds the size. A few cages just within are rejected.
pub(super) fn clip_at_most<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    clip: &Clip<L>,
    limit: &ShiftSum,
    below: u32,
) -> bool {
    let most = sum_of_shifts(dp, clip.w_min, limit.shifts(), below as i32);
    dp.tap(
        Block::SizeLimit,
        &(clip.w_min, Short::unsigned(below, LEVEL_BITS)),
        &most,
    );
    let edges_w = clip.w.edges(dp);
    [&clip.x, &clip.y].into_iter().all(|x| {
        let edges_x = x.edges(dp);
        edges_at_most(dp, edges_x, edges_w, |_, _| most)
    })
}

/// R7.3: whether a cube would cross a quarter of a sample at the picture's edge, but is about one sample where it is.
/// The part of the cube beyond the near plane lies in one column of samples, or less than half a sample from an edge of
/// one, and in one row likewise.
/// Unlike [`clip_at_most`], this uses the vertices' own places.
pub(super) fn is_about_one_sample<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    c: &Constants,
    place: ImagePlace,
    clip: &Clip<L>,
) -> bool {
    let (w_min, w_max) = clip.w.span(dp);
    let depth = dp.sub(w_max, w_min);
    let shallow = dp.shr(w_min, c.levels + 2);
    if !dp.lt(shallow, depth) {
        return false;
    }
    let below = levels::above(dp, place.quad.level, c.levels);
    let least = dp.max(w_min, c.near);
    let half = dp.shr(least, below + 1);
    [clip.x, clip.y].into_iter().all(|mut x| {
        // Edges of the node, then bisectors.
        for edge in 0..below + 2 {
            let beyond = x.zip(&clip.w, |x, w| {
                let to_edge = if edge == 0 {
                    Word::ZERO
                } else {
                    dp.shr(w, edge - 1)
                };
                dp.sub(x, to_edge)
            });
            let (low, high) = beyond.span(dp);
            let is_beyond = !dp.is_negative(low);
            if !is_beyond && !dp.is_negative(high) {
                let most = dp.neg(low);
                let most = dp.max(most, high);
                return dp.lt(most, half);
            }
            if is_beyond && edge != 1 {
                x = beyond;
            }
        }
        true
    })
}

/// Whether edges are at most as long as `most` of their length.
#[inline(always)]
pub(super) fn edges_at_most<P: Probe>(
    dp: &mut Datapath<P>,
    edges_x: [Word; 3],
    edges_w: [Word; 3],
    most: impl FnOnce(&mut Datapath<P>, Word) -> Word,
) -> bool {
    let mut size = Word::ZERO;
    for (along_x, along_w) in edges_x.into_iter().zip(edges_w) {
        let at_far_side = dp.sub(along_x, along_w);
        let here = magnitude(dp, along_x);
        let there = magnitude(dp, at_far_side);
        let greater = dp.max(here, there);
        size = dp.add(size, greater);
    }
    let most = most(dp, size);
    let fits = dp.le(size, most);
    dp.tap(Block::SizeClip, &(edges_x, edges_w, most), &fits);
    fits
}

fn magnitude<P: Probe>(dp: &mut Datapath<P>, a: Word) -> Word {
    let negated = dp.neg(a);
    dp.max(a, negated)
}

/// Whether a screen-space box is at most `limit` wide and high.
#[inline]
pub(super) fn screen_at_most<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    screen: &Screen<L>,
    limit: Word,
) -> bool {
    let mut fits = |(low, high): (Word, Word)| {
        let size = dp.sub(high, low);
        let fits = dp.le(size, limit);
        dp.tap(Block::SizeScreen, &(low, high, limit), &fits);
        fits
    };
    fits(screen.spans[0]) && fits(screen.spans[1])
}

/// The sample of the centre of a clip-space cage, whose depth is `w`, by bisection; `None` outside the picture.
pub(super) fn clip_sample<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    place: ImagePlace,
    clip: &Clip<L>,
    w: Word,
) -> Option<QuadNode> {
    let x = clip.x.centre(dp);
    let y = clip.y.centre(dp);
    dp.tap(Block::CageCentre, &clip.x, &x);
    dp.tap(Block::CageCentre, &clip.y, &y);
    point_sample(dp, constants, place, [x, y, w])
}

/// The sample of a clip vector.
pub(super) fn point_sample<P: Probe>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    place: ImagePlace,
    [mut x, mut y, w]: [Word; 3],
) -> Option<QuadNode> {
    if !place.inside {
        for v in [x, y] {
            if dp.is_negative(v) || !dp.lt(v, w) {
                return None;
            }
        }
    }
    let mut quad = place.quad;
    dp.next_step(0);
    while !levels::reaches(dp, quad.level, constants.levels) {
        let mut half = |v: &mut Word| {
            let doubled = dp.shl(*v, 1);
            let beyond = dp.sub(doubled, w);
            let right = !dp.is_negative(beyond);
            let inner = dp.select(right, beyond, doubled);
            dp.tap(Block::CentreHalf, &(*v, w), &(right, inner));
            *v = inner;
            u8::from(right)
        };
        let column = half(&mut x);
        let row = half(&mut y);
        levels::next(dp, quad.level);
        quad = quad.quadrant(row << 1 | column);
        dp.next_step(0);
    }
    Some(quad)
}

/// The sample of the centre of a screen-space cage: its integer bits. `None` outside the picture.
pub(super) fn screen_sample<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    place: ImagePlace,
    screen: &Screen<L>,
) -> Option<QuadNode> {
    let below = levels::above(dp, place.quad.level, constants.levels);
    let mut column = |coordinate: &L, node: u32| {
        let centre = coordinate.centre(dp);
        dp.tap(Block::CageCentre, coordinate, &centre);
        let position = dp.shr(centre, constants.screen_frac);
        // Shifts of the node's column, filled with zeros or ones.
        dp.control(OpClass::Shift, NODE_BITS);
        dp.control(OpClass::Shift, NODE_BITS);
        let first = Word::from_host(i64::from(node) << below);
        let last = Word::from_host((i64::from(node + 1) << below) - 1);
        if !place.inside && (dp.lt(position, first) || dp.lt(last, position)) {
            return None;
        }
        // A box of no size may lie on its node's far edge, and a word that wrapped or saturated may be anywhere.
        let position = dp.min(position, last);
        let position = dp.max(position, first);
        let node = node_wires(node, below);
        dp.tap(Block::CentreSample, &(centre, node), &position);
        Some(position.to_host() as u32) // host: a sample's address
    };
    let x = column(&screen.x, place.quad.x)?;
    let y = column(&screen.y, place.quad.y)?;
    Some(QuadNode {
        level: constants.levels,
        x,
        y,
    })
}
