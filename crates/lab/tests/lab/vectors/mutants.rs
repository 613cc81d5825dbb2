//! The quality of the rows: the faults that they detect.

use std::collections::BTreeSet;

use shiftvox::project::{CageKind, Coverage};

use super::replay::replay;
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
    let spare = 128 - bits;
    match signed {
        true => changed << spare >> spare,
        false => changed & ((1 << bits) - 1),
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

/// Bits of a number that are wires: of an unsigned one, not those above all its values.
fn wires<'r>(values: impl Iterator<Item = &'r i128>, bits: u32, is_signed: bool) -> u32 {
    match is_signed {
        true => bits,
        false => 128 - values.max().unwrap_or(&0).leading_zeros(),
    }
}

/// Mutants of a block: one bit of an input or an output is stuck at 0 or at 1. Returns their count, and those that the rows
/// do not detect.
fn stuck_mutants(block: &BlockRows, constants: &Constants) -> (usize, Vec<String>) {
    let (mut all, mut alive) = (0, Vec::new());
    for (side, ports) in block.ports.iter().enumerate() {
        for (at, (name, bits, signed)) in ports.numbers.iter().enumerate() {
            let used = wires(
                block.rows.iter().map(|row| &row[side].values[at]),
                *bits,
                *signed,
            );
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
                    let stuck_at = u8::from(at_one);
                    alive.push(format!(
                        "{}: {name}, number {at}, [{bit}] stuck at {stuck_at}",
                        block.name
                    ));
                }
            }
        }
    }
    (all, alive)
}

/// A typical fault in a block: the block, the fault in words, and its outputs then.
type Fault = (
    &'static str,
    &'static str,
    fn(&Row, &[i128], u32) -> Vec<i128>,
);

/// A word of `bits` without the bits above.
fn wrapped(value: i128, bits: u32) -> i128 {
    value << (128 - bits) >> (128 - bits)
}

/// Faults, given a row, the right outputs, and the bits of a word.
const FAULTS: [Fault; 26] = [
    ("filled", "any bit will do", |row, _, _| {
        vec![i128::from(row.get("vector") != 0)]
    }),
    ("centre", "midpoints without the carry", |row, _, bits| {
        let (min, max) = (row.three("min"), row.three("max"));
        (0..3)
            .map(|k| wrapped(min[k] + max[k], bits) >> 1)
            .collect()
    }),
    ("centre", "midpoints towards zero", |row, _, _| {
        let (min, max) = (row.three("min"), row.three("max"));
        (0..3).map(|k| (min[k] + max[k]) / 2).collect()
    }),
    ("octant_order", "<= for <", |row, _, _| {
        let (centre, eye) = (row.three("centre"), row.three("eye_floor"));
        let octant: i128 = (0..3)
            .map(|k| i128::from(centre[k] >= eye[k]) << (2 - k))
            .sum();
        let order = [7, 6, 5, 3, 4, 2, 1, 0].map(|nearest| octant ^ nearest);
        std::iter::once(octant).chain(order).collect()
    }),
    ("octant_order", "comparison without sign", |row, _, bits| {
        let plain = |value: i128| value & ((1 << bits) - 1);
        let (centre, eye) = (row.three("centre"), row.three("eye_floor"));
        let above = |k: usize| i128::from(plain(centre[k]) > plain(eye[k])) << (2 - k);
        let octant: i128 = (0..3).map(above).sum();
        let order = [7, 6, 5, 3, 4, 2, 1, 0].map(|nearest| octant ^ nearest);
        std::iter::once(octant).chain(order).collect()
    }),
    ("detail_depth", "< for <=", |row, _, _| {
        vec![i128::from(row.get("w_min") > row.get("least"))]
    }),
    ("child_corners", "upper and lower exchanged", |row, _, _| {
        let (min, max, centre) = (row.three("min"), row.three("max"), row.three("centre"));
        let upper = |k: usize| row.get("octant") >> k & 1 == 1;
        let low = (0..3).map(|k| if upper(k) { centre[k] } else { min[k] });
        let high = (0..3).map(|k| if upper(k) { max[k] } else { centre[k] });
        low.chain(high).collect()
    }),
    ("near_node", "< for <= at the left", |row, _, _| {
        let (x, w) = (row.cage("x"), row.cage("w"));
        vec![i128::from(
            x.with(1, &w, 1).least() > 0 && x.with(1, &w, -2).greatest() <= 0,
        )]
    }),
    ("margin_gap", "margins towards zero", |row, _, _| {
        let below = row.get("below");
        row.cage("w").each(|w| -(w / (1 << below))).0
    }),
    ("plane_quadrant", "not doubled", |row, _, _| {
        let [a, b, c] = row.three("plane");
        let quadrant = row.get("quadrant");
        vec![c + (quadrant & 1) * a + (quadrant >> 1) * b]
    }),
    (
        "plane_quadrant",
        "columns and rows exchanged",
        |row, _, _| {
            let [a, b, c] = row.three("plane");
            let quadrant = row.get("quadrant");
            vec![2 * c + (quadrant >> 1) * a + (quadrant & 1) * b]
        },
    ),
    ("plane_side", "ties not broken", |row, right, _| {
        let [a, b, c] = row.three("plane");
        match row.flag("sample") && 2 * c + a + b == 0 {
            true => vec![3],
            false => right.to_vec(),
        }
    }),
    (
        "plane_side",
        "ties broken by b before a",
        |row, right, _| {
            let [a, b, c] = row.three("plane");
            match row.flag("sample") && right[0] != 3 && 2 * c + a + b == 0 && b != 0 {
                true => vec![if b > 0 { 1 } else { 2 }],
                false => right.to_vec(),
            }
        },
    ),
    ("cube_front", "< for <= above", |row, right, _| {
        let (max, floor) = (row.three("max"), row.three("eye_floor"));
        match (0..3).any(|k| max[k] == floor[k]) {
            true => vec![0, 0, 0],
            false => right.to_vec(),
        }
    }),
    ("fill_update", "bits replaced, not added", |row, _, _| {
        vec![row.get("bits"), i128::from(row.get("bits") == 15)]
    }),
    (
        "node_choice",
        "full quadrants not left out",
        |row, right, _| vec![i128::from(row.get("overlapped") == 0), right[1], right[2]],
    ),
    ("size_clip", "< for <=", |row, right, _| {
        let (x, w) = (row.three("edge_x"), row.three("edge_w"));
        let size: i128 = (0..3).map(|k| x[k].abs().max((x[k] - w[k]).abs())).sum();
        match size == row.get("most") {
            true => vec![0],
            false => right.to_vec(),
        }
    }),
    ("blend_way", "the sum without its carry", |row, _, bits| {
        let centre = wrapped(row.get("min") + row.get("max"), bits) >> 1;
        vec![((centre >> row.get("shift")) - row.get("eye")).abs()]
    }),
    ("blend_way", "halves towards zero", |row, _, _| {
        let centre = (row.get("min") + row.get("max")) / 2;
        vec![((centre >> row.get("shift")) - row.get("eye")).abs()]
    }),
    ("blend_shares", "rounded down", |row, right, _| {
        let way = row.three("way");
        let all = way.iter().sum::<i128>().max(1);
        let x = 16 * way[0] / all;
        let y = (16 * way[1] / all).min(16 - x);
        [&[x, y, 16 - x - y], &right[3..]].concat()
    }),
    ("blend_shares", "the second not limited", |row, right, _| {
        let way = row.three("way");
        let all = way.iter().sum::<i128>().max(1);
        let y = (32 * way[1] + all) / (2 * all);
        [&[right[0], y, 16 - right[0] - y], &right[3..]].concat()
    }),
    ("blend_counts", "the root rounded down", |row, _, _| {
        let squares = row.three("share").map(|share| share * share);
        let length = squares.iter().sum::<i128>().isqrt();
        squares
            .map(|square| (2 * square + length) / (2 * length))
            .to_vec()
    }),
    ("blend_counts", "quotients rounded down", |row, _, _| {
        let squares = row.three("share").map(|share| share * share);
        let length = (squares.iter().sum::<i128>() as f64).sqrt().round() as i128;
        squares.map(|square| square / length).to_vec()
    }),
    (
        "blend_weight",
        "7 counts for 8 sixteenths",
        |row, right, _| {
            if right[0] == 256 {
                return right.to_vec();
            }
            let (high, count) = (row.three("high"), row.three("count"));
            let of = |k: usize| {
                let opacity = row.of(["opacity_x", "opacity_y", "opacity_z"][k])[high[k] as usize];
                (opacity + i128::from(opacity >= 7)) * count[k]
            };
            vec![(0..3).map(of).sum()]
        },
    ),
    ("blend_sample", "< for <=", |row, right, _| {
        let (left, weight) = (row.get("left"), row.get("weight"));
        let share = (left * weight + 128) >> 8;
        match left - share == 64 {
            true => [&[64], &right[1..4], &[right[4], 0]].concat(),
            false => right.to_vec(),
        }
    }),
    ("blend_sample", "shares rounded down", |row, right, _| {
        let (left, weight) = (row.get("left"), row.get("weight"));
        let share = (left * weight) >> 8;
        match left - share <= 64 {
            true => right.to_vec(),
            false => [&[left - share], &right[1..]].concat(),
        }
    }),
];

/// The rows of three frames detect nearly all stuck bits, and all named faults.
#[test]
fn rows_tell_blocks_from_their_mutants() {
    let (_, graph, camera) = scenes().swap_remove(0);
    let (mut all, mut alive) = (0, Vec::new());
    let mut killed = BTreeSet::new();
    for coverage in [Coverage::Exact, Coverage::Center, Coverage::Alpha] {
        let options = options(coverage, CageKind::Frame, 0.125, 32);
        let setup = setup(&graph, &camera, &options);
        let (_shelter, folder, _) = written(&graph.view(), &setup, 100);
        let manifest = manifest_of(&folder);
        let constants = constants_of(&manifest);
        let blocks = manifest["blocks"].as_array().unwrap().iter();
        for block in blocks.filter(|block| !block["file"].is_null()) {
            let block = rows_of(&folder, block);
            let (mutants, left) = stuck_mutants(&block, &constants);
            all += mutants;
            alive.extend(left);
            for (at, (name, _, fault)) in FAULTS.iter().enumerate() {
                let tells = |[row, right]: &[Row; 2]| fault(row, &right.values, 32) != right.values;
                if block.name == *name && block.rows.iter().any(tells) {
                    killed.insert(at);
                }
            }
        }
    }
    for line in &alive {
        eprintln!("alive: {line}");
    }
    let score = 100.0 * (all - alive.len()) as f64 / all as f64;
    eprintln!(
        "{} of {all} stuck bits found: {score:.1} %",
        all - alive.len()
    );
    let missed = FAULTS
        .iter()
        .enumerate()
        .filter(|(at, _)| !killed.contains(at));
    let missed: Vec<_> = missed
        .map(|(_, (block, fault, _))| format!("{block}: {fault}"))
        .collect();
    assert!(missed.is_empty(), "not found: {missed:?}");
    assert!(score >= 95.0, "{score}");
}
