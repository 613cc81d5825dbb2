//! The area model of the machine: its memories, bit by bit, and the predictions for the synthesis of `rtl/synth.sh machine`.

use std::fs;

use hwmodel::cost::{CostTable, Goal};
use serde_json::Value;

use super::machines::{
    Expected, Machine, STAGE_A, STAGE_B, STAGE_C, STAGE_C_BRICKS, agree_in_icarus,
};
use super::tools::{icarus, rtl, run, shiftvox, text, words};
use super::views::TREE;

/// The model's report of the machine for a view, words of 32 bits.
fn modelled(machine: &Machine, view: &str) -> Value {
    let shelter = tempfile::tempdir().unwrap();
    let file = shelter.path().join("hardware.toml");
    fs::write(&file, machine.hardware()).unwrap();
    let line = format!("model {view} --hw {} --bits 32 --json", text(&file));
    let arguments = [words(&line), machine.rules()].concat();
    serde_json::from_str(&shiftvox(shelter.path(), &arguments)).unwrap()
}

/// The parameters of a machine for this view alone: no number is wider than in the model's record. The stack of stage C does
/// not hold all numbers; its records are stage B's.
fn parameters(machine: &Machine, view: &str) -> Vec<(&'static str, u64)> {
    let model = match machine.stage {
        "stage_c" => modelled(&STAGE_B, view),
        _ => modelled(machine, view),
    };
    let bits = |name: &str| {
        let mut fields = model["record"].as_array().unwrap().iter();
        fields.find(|field| field["field"] == name).unwrap()["bits"]
            .as_u64()
            .unwrap()
    };
    let of_frame = [
        ("PICTURE_LEVELS", bits("quadtree place") / 2),
        ("LEVEL_BOUND", bits("lowest vertex") / 3 - 1),
        // As many bits as the greatest of them.
        ("DEPTH", (1 << bits("level of the voxel")) - 1),
        ("NODE_WIDTH", bits("octree node")),
    ];
    of_frame.into_iter().chain(machine.parameters()).collect()
}

#[test]
fn memories_have_the_bits_that_the_model_says() {
    let shelter = tempfile::tempdir().unwrap();
    let into = shelter.path().join("memories.vvp");
    let views = [
        TREE,
        "gen:menger,depth=4 --size 96x20",
        "gen:terrain,depth=6 --size 300 --lod 0",
    ];
    let side_by_side = [
        Machine::new("stage_b", Some([3, 1, 2]), false),
        Machine::new("stage_c", Some([2, 2, 2]), true),
    ];
    let machines = [&STAGE_A, &STAGE_B, &STAGE_C, &STAGE_C_BRICKS];
    for machine in machines.into_iter().chain(&side_by_side) {
        // Lanes differ from a machine only in the fill vectors, bricks only in the stack: one view is enough.
        let views = if machine.parameters().is_empty() {
            &views[..]
        } else {
            &views[1..2]
        };
        for view in views {
            let top = match machine.testbench() {
                "frame_tb" => "memories_tb",
                _ => "lanes_memories_tb",
            };
            icarus(&machine.folders(), top, &parameters(machine, view), &into);
            let printed = run(shelter.path(), "vvp", &["-n", text(&into)]);
            let lines = printed.lines().map(|line| line.split_once(": ").unwrap());
            let of_verilog: Vec<(&str, u64)> = lines
                .map(|(name, bits)| (name, bits.parse().unwrap()))
                .filter(|(name, _)| *name != "levels of detail")
                .collect();
            let model = modelled(machine, view);
            let lines = model["area"]["memories"]["lines"]
                .as_array()
                .unwrap()
                .iter();
            let of_model: Vec<(&str, u64)> = lines
                .map(|line| {
                    (
                        line["name"].as_str().unwrap(),
                        line["times"].as_u64().unwrap(),
                    )
                })
                .collect();
            assert_eq!(of_verilog, of_model, "{} {view}", machine.name());
            assert_eq!(of_model.len(), 6);
        }
    }
}

/// Draws a view on machines in Icarus Verilog.
fn draws(machine: &Machine, parameters: &[(&str, u64)], view: &str) {
    let shelter = tempfile::tempdir().unwrap();
    let into = shelter.path().join("frame.vvp");
    icarus(&machine.folders(), machine.testbench(), parameters, &into);
    let expected = Expected::new(machine, view, None);
    let drawn = agree_in_icarus(&expected, &into, 200_000);
    assert_eq!(drawn, Ok(()), "{} {view}", machine.name());
}

#[test]
#[ignore = "takes a quarter of a minute"]
fn a_machine_of_just_a_frames_widths_draws_it() {
    let view = "gen:menger,depth=2 --size 7x8 --view iso";
    for machine in [&STAGE_A, &STAGE_B, &STAGE_C, &STAGE_C_BRICKS] {
        draws(machine, &parameters(machine, view), view);
    }
}

/// Pictures of one sample; pictures and tiles of one level, where nothing is joined, on machines of the fewest levels.
#[test]
fn small_pictures_have_room() {
    let side_by_side = Machine::new("stage_c", Some([1, 2, 2]), false);
    for (machine, size, levels) in [
        (&STAGE_A, "1x1", 2),
        (&STAGE_B, "1x1", 2),
        (&STAGE_C, "1x1", 2),
        (&STAGE_C, "2x2", 2),
        (&side_by_side, "7x8", 4),
        (&side_by_side, "4x4", 4),
    ] {
        let parameters = [machine.parameters(), vec![("PICTURE_LEVELS", levels)]].concat();
        let view = format!("gen:menger,depth=1 --size {size} --view iso");
        draws(machine, &parameters, &view);
    }
}

/// Operations of a list such as `3 add (33) 7 add`: times, name, and bits, by default 32.
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

/// The rows of blocks are the table's areas of their operations.
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

/// The predictions from before synthesis. That of stage B is the one after a correction.
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
        let area = &modelled(machine, TREE)["area"];
        let parts = ["units", "registers", "control"];
        let said: f64 = parts
            .iter()
            .map(|part| area[part]["total"].as_f64().unwrap())
            .sum();
        assert_eq!(said.round(), predicted, "{name} of {file}");
    }
}
