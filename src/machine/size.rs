//! How large a record is in samples, and which sample holds its centre.

use hwmodel::{Datapath, Probe, Short, Word};

use super::constants::Constants;
use super::fit::sum_of_shifts;
use super::lattice::Lattice;
use super::record::{Clip, Record, Screen};
use super::taps::{Block, LEVEL_BITS, NODE_BITS};
use crate::frame::QuadNode;
use crate::project::setup::ShiftSum;

/// Whether a clip-space voxel is at most `limit` samples wide and high.
///
/// An edge `E` moves a vertex at `x` (0 to 1 across the node) by
/// `(E_X - x E_W) / W`, so the sum over the edges of the greater of `|E_X|`
/// and `|E_X - E_W|` over the least `W` bounds the size. Conservative: a few
/// voxels just within the limit are taken for larger.
pub(super) fn clip_at_most<P: Probe, L: Lattice>(
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
        let mut size = Word::ZERO;
        for (along_x, along_w) in edges_x.into_iter().zip(edges_w) {
            let at_far_side = dp.sub(along_x, along_w);
            let here = magnitude(dp, along_x);
            let there = magnitude(dp, at_far_side);
            let greater = dp.max(here, there);
            size = dp.add(size, greater);
        }
        let fits = dp.le(size, most);
        dp.tap(Block::SizeClip, &(edges_x, edges_w, most), &fits);
        fits
    })
}

fn magnitude<P: Probe>(dp: &mut Datapath<P>, a: Word) -> Word {
    let negated = dp.neg(a);
    dp.max(a, negated)
}

/// Whether a screen-space voxel's box is at most `limit` wide and high.
#[inline]
pub(super) fn screen_at_most<P: Probe, L: Lattice>(
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

/// The sample that holds a clip-space voxel's centre, by bisection from its
/// quadtree node on; `None` outside the picture's root.
pub(super) fn clip_sample<P: Probe, L: Lattice>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    record: &Record<L>,
    clip: &Clip<L>,
    w: Word,
) -> Option<QuadNode> {
    let mut x = clip.x.centre(dp);
    let mut y = clip.y.centre(dp);
    dp.tap(Block::CageCentre, &clip.x, &x);
    dp.tap(Block::CageCentre, &clip.y, &y);
    if !record.inside {
        for v in [x, y] {
            if dp.is_negative(v) || !dp.lt(v, w) {
                return None;
            }
        }
    }
    let mut quad = record.quad;
    while quad.level < constants.levels {
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
        quad = quad.quadrant(row << 1 | column);
    }
    Some(quad)
}

/// The sample that holds a screen-space voxel's centre: its integer bits.
/// `None` outside the picture's root.
pub(super) fn screen_sample<P: Probe, L: Lattice>(
    dp: &mut Datapath<P>,
    constants: &Constants,
    record: &Record<L>,
    screen: &Screen<L>,
) -> Option<QuadNode> {
    let below = constants.levels - record.quad.level;
    let mut column = |lattice: &L, node: u32| {
        let centre = lattice.centre(dp);
        dp.tap(Block::CageCentre, lattice, &centre);
        let position = dp.shr(centre, constants.screen_frac);
        let first = Word::from_host(i64::from(node) << below);
        let last = Word::from_host((i64::from(node + 1) << below) - 1);
        if !record.inside && (dp.lt(position, first) || dp.lt(last, position)) {
            return None;
        }
        // A box of no size may lie on its node's far edge, and a word that
        // overflowed anywhere.
        let position = dp.min(position, last);
        let position = dp.max(position, first);
        let place = (
            Short::unsigned(node, NODE_BITS),
            Short::unsigned(below, LEVEL_BITS),
        );
        dp.tap(Block::CentreSample, &(centre, place), &position);
        Some(position.to_host() as u32)
    };
    let x = column(&screen.x, record.quad.x)?;
    let y = column(&screen.y, record.quad.y)?;
    Some(QuadNode {
        level: constants.levels,
        x,
        y,
    })
}
