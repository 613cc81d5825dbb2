//! Faults of rules that the rows must detect. Those of single operators are in `crates/cli/tests/rtl/faults.rs`.

use super::replay::Rules;

pub(super) const BITS: u32 = 32;

/// Some have several blocks.
const FAULTS: [Missed; 10] = [
    ("centre blend_way", "sums lose their carry", |rules| {
        rules.half = |sum| sum << (128 - BITS) >> (128 - BITS + 1);
    }),
    ("centre blend_way cage_centre", "towards zero", |rules| {
        rules.half = |sum| sum / 2;
    }),
    ("margin_gap blend_way", "towards zero", |rules| {
        rules.scaled = |a, places| a / (1 << -places);
    }),
    ("blend_shares blend_counts blend_sample", "down", |rules| {
        rules.nearest = |a, b| a.div_euclid(b);
    }),
    ("blend_counts", "the root down", |rules| {
        rules.root = |square| square.isqrt();
    }),
    ("blend_weight", "7 counts for 8 sixteenths", |rules| {
        rules.covered = |opacity| opacity + i128::from(opacity >= 7);
    }),
    ("plane_side", "ties not broken", |rules| {
        rules.ties = |[a, b, c]| vec![2 * c + a + b];
    }),
    ("plane_side", "ties broken by b before a", |rules| {
        rules.ties = |[a, b, c]| vec![2 * c + a + b, b, a];
    }),
    ("blend_sample", "opaque at 65", |rules| rules.opaque = 65),
    ("blend_sample", "opaque at 63", |rules| rules.opaque = 63),
];

/// A block, a fault that its rows must detect, and how rules get it.
pub(super) type Missed = (&'static str, &'static str, fn(&mut Rules));

pub(super) fn all() -> impl Iterator<Item = Missed> {
    let of_block =
        |(blocks, fault, spoil): Missed| blocks.split(' ').map(move |block| (block, fault, spoil));
    FAULTS.into_iter().flat_map(of_block)
}
