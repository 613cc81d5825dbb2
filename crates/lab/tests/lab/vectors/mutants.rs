//! The quality of the rows: the faults that they detect.

use std::collections::BTreeSet;

use shiftvox::project::{CageKind, Coverage};

use super::replay::{nearest, replay};
use super::rows::{BlockRows, Constants, Row, constants_of, manifest_of, rows_of};
use super::{options, scenes, written};
use crate::common::setup;

/// A number with one of its bits stuck.
fn stuck(value: i128, bit: u32, at_one: bool, bits: u32, signed: bool) -> i128 {
    let changed = if at_one {
        value | 1 << bit
    } else {
        value & !(1 << bit)
    };
    match signed {
        true => wrapped(changed, bits),
        false => changed & ((1 << bits) - 1),
    }
}

/// A word of `bits` without the bits above.
fn wrapped(value: i128, bits: u32) -> i128 {
    value << (128 - bits) >> (128 - bits)
}

/// Whether a block is defined for a row: quotients of a divide have four integer bits, and some side has a share.
fn takes(block: &str, row: &Row) -> bool {
    match block {
        "to_screen_divide" => {
            let (x, w) = (row.get("x"), row.get("w"));
            w > 0 && -4 * w <= x && x < 12 * w
        }
        "blend_counts" => row.three("share") != [0; 3],
        // Larger shifts leave the range of these integers.
        "change_guard" => row.get("places").abs() < 64,
        _ => true,
    }
}

/// Mutants of a block: one bit of an input or an output is stuck at 0 or at 1. Returns their count, and how many of them the
/// rows do not detect.
fn stuck_mutants(block: &BlockRows, constants: &Constants) -> (usize, usize) {
    let (mut all, mut alive) = (0, 0);
    for (side, ports) in block.ports.iter().enumerate() {
        for (at, (name, bits, signed)) in ports.numbers.iter().enumerate() {
            let values = block.rows.iter().map(|row| row[side].values[at]);
            // Wires of an unsigned number are not those above all its values.
            let used = match signed {
                true => *bits,
                false => 128 - values.max().unwrap_or(0).leading_zeros(),
            };
            for (bit, at_one) in (0..used).flat_map(|bit| [(bit, false), (bit, true)]) {
                let is_detected = |row: &[Row; 2]| {
                    let value = stuck(row[side].values[at], bit, at_one, *bits, *signed);
                    if side == 1 || value == row[side].values[at] {
                        return value != row[side].values[at];
                    }
                    let mut changed = row[0].clone();
                    changed.values[at] = value;
                    // An input that the block does not accept is detected, too.
                    !takes(&block.name, &changed)
                        || replay(&block.name, &changed, constants) != row[1].values
                };
                all += 1;
                if !block.rows.iter().any(is_detected) {
                    alive += 1;
                    let block = &block.name;
                    eprintln!("alive: {block}: {name}, number {at}, [{bit}] stuck, {at_one}");
                }
            }
        }
    }
    (all, alive)
}

const BITS: u32 = 32;

/// Faults that a block has which gets other inputs.
type WrongInput = (&'static str, &'static str, fn(&Row) -> Row);

const WRONG_INPUTS: [WrongInput; 14] = [
    ("filled", "any bit will do", |row| {
        row.map("vector", |v| if v == 0 { 0 } else { 15 })
    }),
    ("centre", "midpoints without the carry", without_carry),
    ("centre", "midpoints towards zero", towards_zero),
    ("octant_order", "<= for <", |row| {
        row.map("eye_floor", |v| v - 1)
    }),
    ("octant_order", "comparison without sign", |row| {
        let plain = |v: i128| v & ((1 << BITS) - 1);
        row.map("eye_floor", plain).map("centre", plain)
    }),
    ("detail_depth", "< for <=", |row| {
        row.map("least", |v| v + 1)
    }),
    ("child_corners", "upper and lower exchanged", |row| {
        row.map("octant", |v| v >> 2 | v & 2 | (v & 1) << 2)
    }),
    ("plane_quadrant", "columns and rows exchanged", |row| {
        row.map("quadrant", |v| v >> 1 | (v & 1) << 1)
    }),
    ("cube_front", "< for <= above", |row| {
        row.map("eye_floor", |v| v - 1)
    }),
    ("fill_update", "bits replaced, not added", |row| {
        row.map("vector", |_| 0)
    }),
    ("node_choice", "full quadrants not left out", |row| {
        row.map("vector", |_| 0)
    }),
    ("size_clip", "< for <=", |row| row.map("most", |v| v - 1)),
    ("blend_way", "the sum without its carry", without_carry),
    ("blend_way", "halves towards zero", towards_zero),
];

/// Sums of `min` and `max` wrap around.
fn without_carry(row: &Row) -> Row {
    let max = row.of("max").to_vec();
    let mut sums = max.into_iter();
    let sum = row.map("min", |min| wrapped(min + sums.next().unwrap(), BITS));
    sum.map("max", |_| 0)
}

/// Half of `min + max` is rounded towards zero.
fn towards_zero(row: &Row) -> Row {
    let max = row.of("max").to_vec();
    let mut other = max.into_iter();
    row.map("min", |min| {
        min + i128::from(min + other.next().unwrap() < 0)
    })
}

/// Faults given a row and the right outputs.
type WrongOutput = (&'static str, &'static str, fn(&Row, &[i128]) -> Vec<i128>);

const WRONG_OUTPUTS: [WrongOutput; 12] = [
    ("near_node", "< for <= at the left", |row, _| {
        let (x, w) = (row.cage("x"), row.cage("w"));
        let is_near = x.with(1, &w, 1).least() > 0 && x.with(1, &w, -2).greatest() <= 0;
        vec![i128::from(is_near)]
    }),
    ("margin_gap", "margins towards zero", |row, _| {
        let below = row.get("below");
        row.cage("w").each(|w| -(w / (1 << below))).0
    }),
    ("plane_quadrant", "not doubled", |row, right| {
        vec![right[0] - row.three("plane")[2]]
    }),
    ("plane_side", "ties not broken", |row, right| {
        let [a, b, c] = row.three("plane");
        match row.flag("sample") && 2 * c + a + b == 0 {
            true => vec![3],
            false => right.to_vec(),
        }
    }),
    ("plane_side", "ties broken by b before a", |row, right| {
        let [a, b, c] = row.three("plane");
        match row.flag("sample") && right[0] != 3 && 2 * c + a + b == 0 && b != 0 {
            true => vec![if b > 0 { 1 } else { 2 }],
            false => right.to_vec(),
        }
    }),
    ("blend_shares", "rounded down", |row, _| {
        let way = row.three("way");
        let all = way.iter().sum::<i128>().max(1);
        let x = 16 * way[0] / all;
        let y = (16 * way[1] / all).min(16 - x);
        vec![x, y, 16 - x - y]
    }),
    ("blend_shares", "the second not limited", |row, right| {
        let way = row.three("way");
        let y = nearest(16 * way[1], way.iter().sum::<i128>().max(1));
        vec![right[0], y, 16 - right[0] - y]
    }),
    ("blend_counts", "the root rounded down", |row, _| {
        let squares = row.three("share").map(|share| share * share);
        let length = squares.iter().sum::<i128>().isqrt();
        squares.map(|square| nearest(square, length)).to_vec()
    }),
    ("blend_counts", "quotients rounded down", |row, _| {
        let squares = row.three("share").map(|share| share * share);
        let length = (squares.iter().sum::<i128>() as f64).sqrt().round() as i128;
        squares.map(|square| square / length).to_vec()
    }),
    ("blend_weight", "7 counts for 8 sixteenths", |row, right| {
        if right[0] == 256 {
            return right.to_vec();
        }
        let (high, count) = (row.three("high"), row.three("count"));
        let of = |k: usize| {
            let opacity = row.of(["opacity_x", "opacity_y", "opacity_z"][k])[high[k] as usize];
            (opacity + i128::from(opacity >= 7)) * count[k]
        };
        vec![(0..3).map(of).sum()]
    }),
    ("blend_sample", "< for <=", |row, right| {
        let left = row.get("left");
        match left - nearest(left * row.get("weight"), 256) == 64 {
            true => [&[64], &right[1..5], &[0]].concat(),
            false => right.to_vec(),
        }
    }),
    ("blend_sample", "shares rounded down", |row, right| {
        let left = row.get("left");
        match left - ((left * row.get("weight")) >> 8) {
            rest @ 65.. => [&[rest], &right[1..]].concat(),
            _ => right.to_vec(),
        }
    }),
];

/// The rows of three frames detect nearly all stuck bits, and all named faults.
#[test]
fn rows_tell_blocks_from_their_mutants() {
    let (_, graph, camera) = scenes().swap_remove(0);
    let (mut all, mut alive) = (0, 0);
    let mut missed: BTreeSet<(&str, &str)> = WRONG_INPUTS.map(|(a, b, _)| (a, b)).into();
    missed.extend(WRONG_OUTPUTS.map(|(a, b, _)| (a, b)));
    for coverage in [Coverage::Exact, Coverage::Center, Coverage::Alpha] {
        let options = options(coverage, CageKind::Frame, 0.125, BITS);
        let setup = setup(&graph, &camera, &options);
        let (_shelter, folder, _) = written(&graph.view(), &setup, 100);
        let manifest = manifest_of(&folder);
        let constants = constants_of(&manifest);
        let blocks = manifest["blocks"].as_array().unwrap().iter();
        for block in blocks.filter(|block| !block["file"].is_null()) {
            let block = rows_of(&folder, block);
            let (mutants, left) = stuck_mutants(&block, &constants);
            (all, alive) = (all + mutants, alive + left);
            let mut find = |name: &str, fault, wrong: &dyn Fn(&Row, &[i128]) -> Vec<i128>| {
                let tells = |[row, right]: &[Row; 2]| wrong(row, &right.values) != right.values;
                if name == block.name && block.rows.iter().any(tells) {
                    missed.retain(|of| *of != (name, fault));
                }
            };
            for (name, fault, input) in WRONG_INPUTS {
                find(name, fault, &|row, _| replay(name, &input(row), &constants));
            }
            for (name, fault, output) in WRONG_OUTPUTS {
                find(name, fault, &output);
            }
        }
    }
    assert!(missed.is_empty(), "not found: {missed:?}");
    let score = 100.0 * (all - alive) as f64 / all as f64;
    assert!(score >= 95.0, "{score} % of {all} stuck bits found");
}
