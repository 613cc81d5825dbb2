//! What the area table says of the machine: its memories, bit by bit, and the prediction that the synthesis of
//! `rtl/synth.sh machine` stands beside.

use std::fs;

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

/// The rows that were written before the machines were synthesized.
#[test]
fn the_predictions_of_the_machines_stand() {
    let of_stages = [
        (&STAGE_A, "predictions.csv"),
        (&STAGE_B, "predictions_exact.csv"),
    ];
    for (machine, file) in of_stages {
        let predictions = fs::read_to_string(rtl().join(file)).unwrap();
        let row = predictions
            .lines()
            .find(|row| row.starts_with("machine,"))
            .unwrap();
        let predicted: f64 = row.rsplit(',').next().unwrap().parse().unwrap();
        let area = &modelled(machine, &[TREE, "--size", "64"])["area"];
        let parts = ["units", "registers", "control"];
        let said: f64 = parts
            .iter()
            .map(|part| area[part]["total"].as_f64().unwrap())
            .sum();
        assert_eq!(said.round(), predicted, "{file}");
    }
}
