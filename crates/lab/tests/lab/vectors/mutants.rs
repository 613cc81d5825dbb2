//! The quality of the rows: the faults that they detect.

use std::collections::BTreeSet;

use shiftvox::project::{CageKind, Coverage};

use super::replay::Rules;
use super::rows::{BlockRows, Number, Row, manifest_of, rows_of};
use super::{options, scenes, written};
use crate::common::setup;

const BITS: u32 = 32;

/// A word of `bits` without the bits above.
fn wrapped(value: i128, bits: u32, signed: bool) -> i128 {
    match signed {
        true => value << (128 - bits) >> (128 - bits),
        false => value & ((1 << bits) - 1),
    }
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

/// Values of one number under faults: zero, off by one, or a bit is stuck at 0 or at 1.
fn faulty(value: i128, used: u32) -> Vec<i128> {
    let stuck = (0..used).flat_map(|bit| [value & !(1 << bit), value | 1 << bit]);
    [0, value - 1, value + 1].into_iter().chain(stuck).collect()
}

/// Faults of single numbers: their count, and those that no row detects.
fn faults_of_numbers(block: &BlockRows, rules: &Rules) -> (usize, Vec<String>) {
    let (mut all, mut alive) = (0, Vec::new());
    let numbers = |side: usize| block.ports[side].numbers.iter().enumerate();
    for (side, (at, (name, bits, signed))) in
        (0..2).flat_map(|side| numbers(side).map(move |number: (usize, &Number)| (side, number)))
    {
        let values = block.rows.iter().map(|row| row[side].values[at]);
        // Wires of an unsigned number are not those above all its values.
        let used = match signed {
            true => *bits,
            false => 128 - values.max().unwrap_or(0).leading_zeros(),
        };
        for fault in 0..faulty(0, used).len() {
            let is_detected = |[row, right]: &[Row; 2]| {
                let value = [row, right][side].values[at];
                let changed = wrapped(faulty(value, used)[fault], *bits, *signed);
                if side == 1 || changed == value {
                    return changed != value;
                }
                let into = row.with(at, changed);
                // An input that the block does not accept is detected, too.
                !takes(&block.name, &into) || rules.replay(&block.name, &into) != right.values
            };
            all += 1;
            if !block.rows.iter().any(is_detected) {
                alive.push(format!(
                    "{}: {name}, number {at}, fault {fault}",
                    block.name
                ));
            }
        }
    }
    (all, alive)
}

/// Blocks, a fault that their rows must detect, and how rules get it.
type Fault = (&'static str, &'static str, fn(&mut Rules));

const FAULTS: [Fault; 10] = [
    ("centre blend_way", "sums without carry", |rules| {
        rules.half = |sum| wrapped(sum, BITS, true) >> 1;
    }),
    (
        "centre blend_way cage_centre",
        "halves towards zero",
        |rules| {
            rules.half = |sum| sum / 2;
        },
    ),
    ("margin_gap blend_way", "shifts towards zero", |rules| {
        rules.scaled = |a, places| a / (1 << -places);
    }),
    (
        "blend_shares blend_counts blend_sample",
        "quotients rounded down",
        |rules| {
            rules.nearest = |a, b| a.div_euclid(b);
        },
    ),
    ("blend_counts", "the root rounded down", |rules| {
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
    ("blend_sample", "more light counts as none", |rules| {
        rules.opaque = 65
    }),
    ("blend_sample", "less light counts as none", |rules| {
        rules.opaque = 63
    }),
];

/// The rows of three frames detect nearly all faults of numbers, and all of rules.
#[test]
fn rows_tell_blocks_from_their_mutants() {
    let (graph, camera) = scenes().swap_remove(0);
    let (mut all, mut alive) = (0, Vec::new());
    let pairs = |(blocks, fault, _): Fault| blocks.split(' ').map(move |block| (block, fault));
    let mut missed: BTreeSet<(&str, &str)> = FAULTS.into_iter().flat_map(pairs).collect();
    for coverage in [Coverage::Exact, Coverage::Center, Coverage::Alpha] {
        let options = options(coverage, CageKind::Frame, 0.125, BITS);
        let setup = setup(&graph, &camera, &options);
        let (_shelter, folder, _) = written(&graph.view(), &setup, 100);
        let manifest = manifest_of(&folder);
        let rules = Rules::new(&manifest);
        let blocks = manifest["blocks"].as_array().unwrap().iter();
        for block in blocks.filter(|block| !block["file"].is_null()) {
            let block = rows_of(&folder, block);
            let (count, left) = faults_of_numbers(&block, &rules);
            all += count;
            alive.extend(left);
            for (blocks, fault, spoil) in FAULTS {
                let mut wrong = rules.clone();
                spoil(&mut wrong);
                let is_of = blocks.split(' ').any(|of| of == block.name);
                let tells =
                    |[row, right]: &[Row; 2]| wrong.replay(&block.name, row) != right.values;
                if is_of && block.rows.iter().any(tells) {
                    missed.retain(|of| *of != (block.name.as_str(), fault));
                }
            }
        }
    }
    assert!(missed.is_empty(), "not found: {missed:?}");
    let score = 100.0 - 100.0 * alive.len() as f64 / all as f64;
    assert!(
        score >= 95.0,
        "{score} % of {all} faults found, not {alive:#?}"
    );
}
