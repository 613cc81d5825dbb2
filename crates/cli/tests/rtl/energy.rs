//! Energy of the machine's operations by toggles. Synthesized blocks, with the delays of their cells, run through the rows of
//! a frame. Every change of a pin takes the energy in the library of cells.
//!
//! A change of an input takes `C V^2 / 2`. A change of an output takes the cell's internal energy at a load of about 25 fF
//! and the shortest transition, the mean of rise and fall and of all inputs. Wires and registers are left out. Only ratios
//! compare, because the cells are of 0.18 um and the model's energies of 45 nm.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use hwmodel::cost::CostTable;
use serde_json::Value;

use super::area::operations;
use super::blocks::{PAPER, Rows, name, testbench};
use super::tools::{rtl, run};
use super::views::TREE;

const CELLS: &str = "/usr/share/qflow/tech/osu018";
/// Supply voltage.
const VOLTS: f64 = 1.8;
/// Load at which internal energies are taken, pF.
const LOAD: f64 = 0.025;
/// Most rows of a block.
const ROWS: u64 = 400;

/// Blocks, their main operations, all operations as in `predictions.csv`, and a step between rows, because rows of some
/// alternate between x and y. A divide takes 26 steps in this frame.
const BLOCKS: [(&str, &str, &str, u64); 9] = [
    ("centre", "add", "3 add (33)", 1),
    ("vertex_pool", "add", "19 add (33)", 2),
    ("size_screen", "sub, less", "1 sub 1 less", 1),
    ("octant_order", "less", "3 less 8 xor (3)", 1),
    ("child_span", "min", "14 min", 2),
    ("child_corners", "select", "6 select", 1),
    ("fill_update", "logic", "1 or (4) 1 and (4)", 1),
    ("size_limit", "shift", "1 shift_var", 1),
    ("to_screen_divide", DIVIDE, "26 divide_step (36)", 1),
];
const DIVIDE: &str = "divide step";

/// By cell, the energy of a change of each pin, pJ.
type PinEnergies = BTreeMap<String, Vec<(String, f64)>>;

/// Reads the library of cells: it has one value per line, and a line per row of a table.
fn energies_of_pins(liberty: &str) -> PinEnergies {
    let lines: Vec<&str> = liberty.lines().map(str::trim).collect();
    let liberty = lines.join("\n");
    let cells = liberty.split("\ncell ").skip(1).map(|cell| {
        let pins = cell.split("pin(").skip(1);
        let energies = pins.map(|pin| {
            let (name, values) = pin.split_once(')').unwrap();
            (name.trim().to_owned(), energy_of_pin(values))
        });
        let name = cell.split(['(', ')']).nth(1).unwrap_or_default().trim();
        (name.to_owned(), energies.collect())
    });
    cells.collect()
}

/// Energy of a change of a pin. For an output it is the mean of its tables at the nearest load.
fn energy_of_pin(pin: &str) -> f64 {
    let value = |key: &str| pin.lines().find_map(|line| line.strip_prefix(key));
    if value("direction : ") == Some("input;") {
        let capacitance = value("capacitance : ").unwrap().trim_end_matches(';');
        return capacitance.parse::<f64>().unwrap() * VOLTS * VOLTS / 2.0;
    }
    let quoted = |line: &str| -> Vec<f64> {
        let numbers = line.split('"').nth(1).unwrap().split(',');
        numbers
            .map(|number| number.trim().parse().unwrap())
            .collect()
    };
    let tables = pin.split("_power(energy").skip(1);
    let energies = tables.map(|table| {
        let mut lines = table.lines();
        let loads = quoted(lines.find(|line| line.starts_with("index_1")).unwrap());
        let far = |at: &usize| (loads[*at] - LOAD).abs();
        let nearest = (0..loads.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
        let mut rows = lines.skip_while(|line| !line.starts_with("values")).skip(1);
        quoted(rows.nth(nearest.unwrap()).unwrap())[0]
    });
    let energies: Vec<f64> = energies.collect();
    energies.iter().sum::<f64>() / energies.len().max(1) as f64
}

/// The cells' Verilog with a sum of energies and changes in each cell that is no register.
fn counting_cells(verilog: &str, energies: &PinEnergies) -> String {
    let mut text = String::from(
        "`timescale 1ns/10ps\nmodule count;\n  real pj = 0;\n  integer outputs = 0, cells = 0;\n  \
         reg on = 0;\nendmodule\n",
    );
    let mut cell = "";
    for line in verilog.lines() {
        if let Some(rest) = line.strip_prefix("module ") {
            cell = rest.split([' ', '(']).next().unwrap();
        }
        if line.starts_with("endmodule") && !cell.starts_with("DFF") && !cell.starts_with("LATCH") {
            for (pin, energy) in energies.get(cell).into_iter().flatten() {
                let output = u8::from(pin.starts_with('Y'));
                let _ = writeln!(
                    text,
                    "  always @({pin}) if (count.on) begin count.pj = count.pj + {energy}; \
                     count.outputs = count.outputs + {output}; end"
                );
            }
            text += "  initial count.cells = count.cells + 1;\n";
        }
        text += line;
        text += "\n";
    }
    text
}

/// Runs the block's netlist through rows, of the frame or random ones. Returns changes of outputs per cell and row, and the
/// energy per row, pJ.
fn run_rows(folder: &Path, block: &Value, step: u64, random: bool) -> [f64; 2] {
    let name = name(block);
    // Where the frame has next to none, those made for the block: ends of ranges, and random numbers.
    let number = |key: &str| block[key].as_u64().unwrap();
    let rows = match number("frame_rows") {
        0..=2 => number("rows"),
        rows => rows,
    };
    let rows = rows.min(ROWS);
    let words_in = block["in"]["bits"].as_u64().unwrap().div_ceil(32) as usize;
    let stimulus = match random {
        true => format!(
            "`define STIMULUS {{{}}}",
            vec!["$random"; words_in].join(", ")
        ),
        false => String::new(),
    };
    // A row lasts longer than the longest path.
    let bench = format!(
        "`timescale 1us/10ps\n`define MOST {rows}\n`define STEP {step}\n{stimulus}\n`define EACH count.on = 1;\n\
         `define SHOW $display(\"pj %f %0d %0d\", count.pj, count.outputs, count.cells);\n{}",
        testbench(block)
    );
    fs::write(folder.join("bench.v"), bench).unwrap();
    let line = format!(
        "iverilog -g2012 -gspecify -I {} -s {name}_tb -s count",
        rtl().display()
    );
    run(
        folder,
        &format!("{line} -o bench.vvp bench.v {name}.v cells.v"),
    );
    let printed = run(folder, "vvp -n bench.vvp");
    let is_right = printed.contains(&format!("{name}_tb: 0 of "));
    assert!(random || is_right, "{name}: the netlist's rows are wrong");
    let figures = printed
        .lines()
        .find_map(|line| line.strip_prefix("pj "))
        .unwrap();
    let figures: Vec<f64> = figures
        .split(' ')
        .map(|word| word.parse().unwrap())
        .collect();
    // The first row is not counted.
    let taken = (rows.div_ceil(step) - 1) as f64;
    [figures[1] / figures[2] / taken, figures[0] / taken]
}

/// Prints the rows of `rtl/results/energy.csv`. Ratios are relative to an addition of the centre.
#[test]
#[ignore = "takes minutes, and needs qflow-tech-osu018"]
fn energy_by_toggles_beside_the_table() {
    let cells = |end: &str| fs::read_to_string(format!("{CELLS}/osu018_stdcells.{end}")).unwrap();
    let cells = counting_cells(&cells("v"), &energies_of_pins(&cells("lib")));
    let vectors = Rows::new(PAPER, TREE, 32, 4000);
    let folder = &vectors.folder();
    fs::write(folder.join("cells.v"), cells).unwrap();
    let table = CostTable::load_shipped().unwrap();

    let mut adder = None;
    for (block, class, list, step) in BLOCKS {
        let netlist = format!("NETLIST={}/{block}.v", folder.display());
        run(&rtl(), &format!("env {netlist} sh synth.sh {block}"));
        let block = vectors.blocks.iter().find(|of| name(of) == block).unwrap();
        let (mut count, mut by_table) = (0.0, 0.0);
        for (times, operation, bits) in operations(list) {
            count += times;
            by_table += times * table.energy(operation, bits).unwrap().value;
        }
        let of_frame = run_rows(folder, block, step, false);
        // Random numerators and divisors make no quotients.
        let random = match class {
            DIVIDE => of_frame,
            _ => run_rows(folder, block, step, true),
        };
        // A row is a visit of a block, but of the divider as many cycles as steps.
        let steps = if class == DIVIDE { count } else { 1.0 };
        let [toggles, random_toggles] = [of_frame[0], random[0]].map(|toggles| toggles / steps);
        let [pj, random_pj, table_pj] = [of_frame[1], random[1], by_table].map(|pj| pj / count);
        let (unit, table_unit) = *adder.get_or_insert((random_pj, table_pj));
        let (ratio, by_table) = (random_pj / unit, table_pj / table_unit);
        eprintln!(
            "{},\"{class}\",{list},{toggles:.2},{random_toggles:.2},{pj:.2},{random_pj:.2},{ratio:.2},{by_table:.2}",
            name(block),
        );
        // Four bits are next to nothing; a step of the divide is larger than the table's, section 5 of `docs/rtl.md`.
        if !["logic", DIVIDE].contains(&class) {
            assert!((ratio / by_table - 1.0).abs() < 0.4, "{block}");
        }
    }
}
