//! Faults of rules that the rows must detect. Those of single operators are in `crates/cli/tests/rtl/mutants.rs`.

use std::collections::BTreeSet;

use shiftvox::project::{CageKind, Coverage};

use super::replay::Rules;
use super::rows::{Row, manifest_of, rows_of};
use super::{options, scenes, written};
use crate::common::setup;

const BITS: u32 = 32;

/// Blocks, a fault that their rows must detect, and how rules get it.
type Fault = (&'static str, &'static str, fn(&mut Rules));

const FAULTS: [Fault; 10] = [
    ("centre blend_way", "sums without carry", |rules| {
        rules.half = |sum| sum << (128 - BITS) >> (128 - BITS + 1);
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

#[test]
fn rows_tell_blocks_from_their_mutants() {
    let (graph, camera) = scenes().swap_remove(0);
    let pairs = |(blocks, fault, _): Fault| blocks.split(' ').map(move |block| (block, fault));
    let mut missed: BTreeSet<(&str, &str)> = FAULTS.into_iter().flat_map(pairs).collect();
    for coverage in [Coverage::Exact, Coverage::Center, Coverage::Alpha] {
        let options = options(coverage, CageKind::Frame, 0.125, BITS);
        let setup = setup(&graph, &camera, &options);
        let (_shelter, folder, _) = written(&graph.view(), &setup, 100);
        let manifest = manifest_of(&folder);
        for block in manifest["blocks"].as_array().unwrap() {
            let name = block["name"].as_str().unwrap();
            for (blocks, fault, spoil) in FAULTS {
                if block["file"].is_null() || !blocks.split(' ').any(|of| of == name) {
                    continue;
                }
                let mut wrong = Rules::new(&manifest);
                spoil(&mut wrong);
                let tells =
                    |[row, right]: &[Row; 2]| wrong.replay(name, row).unwrap() != right.values;
                if rows_of(&folder, block).iter().any(tells) {
                    missed.retain(|of| *of != (name, fault));
                }
            }
        }
    }
    assert!(missed.is_empty(), "not found: {missed:?}");
}
