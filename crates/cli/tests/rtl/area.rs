//! The area model of the machine: its memories, bit by bit, and the predictions for the synthesis of `rtl/synth.sh machine`.

use std::fs;

use serde_json::Value;

use super::machines::{Expected, Machine, STAGE_A, STAGE_B, STAGE_C, STAGE_C_BRICKS};
use super::tools::{icarus, rtl, run};
use super::views::TREE;

fn modelled(machine: &Machine, view: &str) -> Value {
    machine.model(tempfile::tempdir().unwrap().path(), view, "")
}

/// The parameters of a machine for this view alone: no number is wider than in the model's record. The stack of stage C does
/// not hold all numbers; its records are stage B's.
fn parameters(machine: &Machine, view: &str) -> String {
    let model = match machine.stage {
        "stage_c" => modelled(&STAGE_B, view),
        _ => modelled(machine, view),
    };
    let bits = |name: &str| {
        let mut fields = model["record"].as_array().unwrap().iter();
        let field = fields.find(|field| field["field"] == name).unwrap();
        field["bits"].as_u64().unwrap()
    };
    format!(
        "PICTURE_LEVELS={} LEVEL_BOUND={} DEPTH={} NODE_WIDTH={} {}",
        bits("quadtree place") / 2,
        bits("lowest vertex") / 3 - 1,
        // As many bits as the greatest of them.
        (1 << bits("level of the voxel")) - 1,
        bits("octree node"),
        machine.parameters
    )
}

#[test]
#[ignore = "takes half a minute"]
fn memories_have_the_bits_that_the_model_says() {
    let shelter = tempfile::tempdir().unwrap();
    let into = shelter.path().join("memories.vvp");
    let views = [
        TREE,
        "gen:menger,depth=4 --size 96x20",
        "gen:terrain,depth=6 --size 300 --lod 0",
    ];
    let side_by_side = [
        Machine::new("stage_b", "LANES=3 CONTEXTS=1 TILE_LEVELS=2"),
        Machine::new("stage_c", "LANES=2 CONTEXTS=2 TILE_LEVELS=2 BRICKS=1"),
    ];
    let machines = [&STAGE_A, &STAGE_B, &STAGE_C, &STAGE_C_BRICKS];
    for machine in machines.into_iter().chain(&side_by_side) {
        // Lanes differ from a machine only in the fill vectors, bricks only in the stack: one view is enough.
        let is_plain = machine.parameters.is_empty();
        for view in if is_plain { &views[..] } else { &views[1..2] } {
            let top = match machine.has_lanes() {
                true => "lanes_memories_tb",
                false => "memories_tb",
            };
            icarus(machine.folders(), top, &parameters(machine, view), &into);
            let printed = run(shelter.path(), &format!("vvp -n {}", into.display()));
            let model = modelled(machine, view);
            let lines = model["area"]["memories"]["lines"].as_array().unwrap();
            let said = lines.iter().map(|line| {
                let name = line["name"].as_str().unwrap();
                format!("{name}: {}", line["times"])
            });
            let said: Vec<String> = said.collect();
            // The last line is not in the model.
            let there: Vec<&str> = printed.lines().take(6).collect();
            assert_eq!(
                there, said,
                "{} {} {view}",
                machine.stage, machine.parameters
            );
        }
    }
}

/// Draws a view on a machine with these parameters.
fn draws(machine: &Machine, parameters: &str, view: &str) {
    let shelter = tempfile::tempdir().unwrap();
    let into = shelter.path().join("frame.vvp");
    icarus(machine.folders(), machine.testbench(), parameters, &into);
    let expected = Expected::new(machine, view, None);
    let drawn = expected.compare_in_icarus(&into, 200_000);
    drawn.unwrap_or_else(|error| panic!("{} {parameters} {view}: {error}", machine.stage));
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
    let side_by_side = Machine::new("stage_c", "LANES=1 CONTEXTS=2 TILE_LEVELS=2");
    for (machine, size, levels) in [
        (&STAGE_A, "1x1", 2),
        (&STAGE_B, "1x1", 2),
        (&STAGE_C, "1x1", 2),
        (&STAGE_C, "2x2", 2),
        (&side_by_side, "7x8", 4),
        (&side_by_side, "4x4", 4),
    ] {
        let parameters = format!("{} PICTURE_LEVELS={levels}", machine.parameters);
        let view = format!("gen:menger,depth=1 --size {size} --view iso");
        draws(machine, &parameters, &view);
    }
}

/// Predictions of whole machines without memories are within 15 % of their syntheses, and bits of registers within 5 %. The
/// share of control was fitted to the first two rows alone.
#[test]
fn machines_have_the_predicted_areas() {
    let text = fs::read_to_string(rtl().join("results/machines.csv")).unwrap();
    let mut count = 0;
    for row in text.lines().skip(1) {
        let fields: Vec<&str> = row.split(',').collect();
        let [stage, parameters] = [fields[0], fields[1]].map(|of| &*of.to_owned().leak());
        let [nand2, bits] = [fields[3], fields[4]].map(|of| of.parse::<f64>().unwrap());
        let folder = tempfile::tempdir().unwrap();
        let flags = format!("--bits {}", fields[2]);
        let model = Machine::new(stage, parameters).model(folder.path(), TREE, &flags);
        let area = &model["area"];
        let of = |part: &str| area[part]["total"].as_f64().unwrap();
        let said = of("units") + of("registers") + of("control");
        // A bit is four NAND2.
        let found = [said / nand2, of("registers") / 4.0 / bits];
        let is_near = |(found, within): (f64, f64)| (found - 1.0).abs() <= within;
        let all = found.into_iter().zip([0.15, 0.05]).all(is_near);
        assert!(all, "{row}: {said:.0} NAND2, over the synthesis {found:?}");
        count += 1;
    }
    assert!(count >= 3);
}
