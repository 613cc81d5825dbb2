//! What the area table says of the machine: its memories, bit by bit, and the prediction that the synthesis of
//! `rtl/synth.sh machine` stands beside.

use std::fs;

use hwmodel::cost::{CostTable, Goal};
use serde_json::Value;

use super::machines::{Expected, Machine, STAGE_A, STAGE_B, STAGE_C, STAGE_C_BRICKS, lanes};
use super::tools::{icarus, is_there, parameter, rtl, run, shiftvox, text};
use super::views::TREE;

/// What the model says of the machine for a view, words of 32 bits.
fn modelled(machine: &Machine, view: &[&str]) -> Value {
    let shelter = tempfile::tempdir().unwrap();
    let file = shelter.path().join("hardware.toml");
    fs::write(&file, machine.hardware()).unwrap();
    let hardware = ["--hw", text(&file), "--bits", "32", "--json"];
    let arguments = [&["model"], view, machine.rules, &hardware].concat();
    serde_json::from_str(&shiftvox(shelter.path(), &arguments)).unwrap()
}

/// The parameters of a machine for this view alone: no number is wider than the model's record has it. What lies on
/// stage C's stack does not tell all of them; its records are stage B's.
fn parameters(machine: &Machine, view: &[&str], top: &str) -> Vec<String> {
    let model = match machine.stage {
        "stage_c" => modelled(&STAGE_B, view),
        _ => modelled(machine, view),
    };
    let bits = |name: &str| {
        let fields = model["record"].as_array().unwrap();
        let field = fields.iter().find(|field| field["field"] == name).unwrap();
        field["bits"].as_u64().unwrap()
    };
    let of_frame = [
        ("PICTURE_LEVELS", bits("quadtree place") / 2),
        ("LEVEL_BOUND", bits("lowest vertex") / 3 - 1),
        // As many bits as the greatest of them.
        ("DEPTH", (1 << bits("level of the voxel")) - 1),
        ("NODE_WIDTH", bits("octree node")),
    ];
    of_frame
        .into_iter()
        .chain(machine.parameters())
        .map(|(name, value)| parameter(top, name, value))
        .collect()
}

#[test]
fn memories_have_the_bits_that_the_model_says() {
    if !is_there("iverilog") {
        return;
    }
    let shelter = tempfile::tempdir().unwrap();
    let into = shelter.path().join("memories.vvp");
    let views: [&[&str]; 3] = [
        &[TREE, "--size", "64"],
        &["gen:menger,depth=4", "--size", "96x20"],
        &["gen:terrain,depth=6", "--size", "300", "--lod", "0"],
    ];
    let side_by_side = [
        Machine::lanes_of_stage_b(lanes(3, 1, 2)),
        Machine::lanes_of_stage_c(lanes(2, 2, 2), true),
    ];
    for (machine, view) in [&STAGE_A, &STAGE_B, &STAGE_C, &STAGE_C_BRICKS]
        .into_iter()
        .chain(&side_by_side)
        .flat_map(|machine| views.map(|view| (machine, view)))
        // Lanes have the memories of a machine, but for the fill vectors, bricks but for the stack: one view is enough.
        .filter(|(machine, view)| machine.parameters().is_empty() || *view == views[1])
    {
        let model = modelled(machine, view);
        let top = match machine.testbench() {
            "frame_tb" => "memories_tb",
            _ => "lanes_memories_tb",
        };
        icarus(
            machine.folders,
            top,
            &parameters(machine, view, top),
            text(&into),
        );
        let printed = run(shelter.path(), "vvp", &["-n", text(&into)]);
        let of_verilog: Vec<(&str, u64)> = printed
            .lines()
            .map(|line| line.split_once(": ").unwrap())
            .map(|(name, bits)| (name, bits.parse().unwrap()))
            .filter(|(name, _)| *name != "levels of detail")
            .collect();
        let lines = model["area"]["memories"]["lines"].as_array().unwrap();
        let of_model: Vec<(&str, u64)> = lines
            .iter()
            .map(|line| {
                (
                    line["name"].as_str().unwrap(),
                    line["times"].as_u64().unwrap(),
                )
            })
            .collect();
        assert_eq!(of_verilog, of_model, "{} {view:?}", machine.name);
        assert_eq!(of_model.len(), 6);
    }
}

#[test]
#[ignore = "takes a quarter of a minute"]
fn a_machine_of_just_a_frames_widths_draws_it() {
    if !is_there("iverilog") {
        return;
    }
    let shelter = tempfile::tempdir().unwrap();
    let into = shelter.path().join("frame.vvp");
    let view = ["gen:menger,depth=2", "--size", "7x8", "--view", "iso"];
    for machine in [&STAGE_A, &STAGE_B, &STAGE_C, &STAGE_C_BRICKS] {
        let parameters = parameters(machine, &view, "frame_tb");
        icarus(machine.folders, "frame_tb", &parameters, text(&into));
        let simulator = ["vvp", "-n", text(&into), "+most=200000"];
        let agreement = Expected::new(machine, &view).compare(&simulator).unwrap();
        assert_eq!(agreement.cycles[0], agreement.cycles[1]);
    }
}

/// Pictures of one sample; pictures and tiles of one level, where nothing is joined, on machines of the fewest levels
/// that there are.
#[test]
fn small_pictures_have_room() {
    if !is_there("iverilog") {
        return;
    }
    let shelter = tempfile::tempdir().unwrap();
    let into = shelter.path().join("frame.vvp");
    let side_by_side = Machine::lanes_of_stage_c(lanes(1, 2, 2), false);
    for (machine, size, levels) in [
        (&STAGE_A, "1x1", 2),
        (&STAGE_B, "1x1", 2),
        (&STAGE_C, "1x1", 2),
        (&STAGE_C, "2x2", 2),
        (&side_by_side, "7x8", 4),
        (&side_by_side, "4x4", 4),
    ] {
        let top = machine.testbench();
        let levels = ("PICTURE_LEVELS", levels);
        let parameters = machine.parameters().into_iter().chain([levels]);
        let parameters: Vec<String> = parameters
            .map(|(name, value)| parameter(top, name, value))
            .collect();
        icarus(machine.folders, top, &parameters, text(&into));
        let view = ["gen:menger,depth=1", "--size", size, "--view", "iso"];
        let simulator = ["vvp", "-n", text(&into), "+most=200000"];
        let agreement = Expected::new(machine, &view).compare(&simulator).unwrap();
        assert_eq!(agreement.cycles[0], agreement.cycles[1], "{size}");
    }
}

/// Operations of a list such as `3 add (33) 7 add`: how often, which, and their bits; 32 where none are told.
pub(crate) fn operations(list: &str) -> Vec<(f64, &str, u32)> {
    let words: Vec<&str> = list.split(' ').collect();
    let mut operations = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let width = words.get(at + 2).and_then(|word| word.strip_prefix('('));
        let bits = width.map_or(32, |word| word.trim_end_matches(')').parse().unwrap());
        // The tables have one price for both bitwise operations.
        let operation = match words[at + 1] {
            "or" => "and",
            other => other,
        };
        operations.push((words[at].parse().unwrap(), operation, bits));
        at += if width.is_some() { 3 } else { 2 };
    }
    operations
}

/// Rows of a file of predictions: what for, operations or parts, NAND2.
fn predictions(text: &str) -> impl Iterator<Item = (&str, &str, f64)> {
    let rows = text.lines().filter(|row| !row.starts_with('#')).skip(1);
    rows.map(|row| {
        let [of, what, area] = row.split(',').collect::<Vec<_>>()[..] else {
            unreachable!("{row}");
        };
        (of, what, area.parse().unwrap())
    })
}

/// The rows of blocks are what the table of areas says of their operations.
#[test]
fn the_predictions_of_the_blocks_are_the_tables() {
    let table = CostTable::load_shipped().unwrap();
    let mut blocks = 0;
    for file in ["predictions.csv", "predictions_exact.csv"] {
        let text = fs::read_to_string(rtl().join(file)).unwrap();
        for (block, what, predicted) in predictions(&text) {
            if block.starts_with("machine") || what == "none" {
                continue;
            }
            let each = |(times, operation, bits)| {
                let area = table.area(operation, bits, Goal::Area).unwrap();
                times * area.value
            };
            let said: f64 = operations(what).into_iter().map(each).sum();
            // The table's rows are rounded.
            let rounding = 0.1 + 2e-5 * predicted;
            assert!((said - predicted).abs() < rounding, "{block}: {said}");
            blocks += 1;
        }
    }
    assert_eq!(blocks, 39);
}

/// The rows that were written before the machines were synthesized; of stage B the one with a fault mended that it had
/// then.
#[test]
fn the_predictions_of_the_machines_stand() {
    let of_stages = [
        (&STAGE_A, "predictions.csv", "machine"),
        (&STAGE_B, "predictions_exact.csv", "machine_mended"),
        (&STAGE_C, "predictions_exact.csv", "machine_c"),
    ];
    for (machine, file, name) in of_stages {
        let text = fs::read_to_string(rtl().join(file)).unwrap();
        let row = predictions(&text).find(|&(of, ..)| of == name);
        let (_, _, predicted) = row.unwrap();
        let area = &modelled(machine, &[TREE, "--size", "64"])["area"];
        let parts = ["units", "registers", "control"];
        let said: f64 = parts
            .iter()
            .map(|part| area[part]["total"].as_f64().unwrap())
            .sum();
        assert_eq!(said.round(), predicted, "{name} of {file}");
    }
}
