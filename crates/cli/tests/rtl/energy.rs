//! Energy of the machine's operations by toggles. Synthesized blocks, with the delays of their cells, run through the rows of
//! a frame. Every change of a pin takes the energy in the library of cells.
//!
//! A change of an input takes `C V^2 / 2`. A change of an output takes the cell's internal energy at a load of about 25 fF
//! and the shortest transition: the mean of rise and fall, and of the inputs that may cause it. Wires and registers are left
//! out. Only ratios compare, because the cells are of 0.18 um and the model's energies of 45 nm.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use hwmodel::cost::CostTable;
use serde_json::Value;

use super::area::operations;
use super::blocks::{PAPER, rows_of_records, testbench};
use super::tools::{rtl, run, text, words};
use super::views::TREE;

const CELLS: &str = "/usr/share/qflow/tech/osu018";
/// Supply voltage.
const VOLTS: f64 = 1.8;
/// Load at which internal energies are taken, pF.
const LOAD: f64 = 0.025;
/// Most rows of a block.
const ROWS: u64 = 400;

/// Blocks, the main operations of their logic, and the distance of successive rows of the same block in the machine. Rows of
/// the others alternate between x and y.
const BLOCKS: [(&str, &str, u64); 9] = [
    ("centre", "add", 1),
    ("vertex_pool", "add", 2),
    ("size_screen", "sub, less", 1),
    ("octant_order", "less", 1),
    ("child_span", "min", 2),
    ("child_corners", "select", 1),
    ("fill_update", "logic", 1),
    ("size_limit", "shift", 1),
    ("to_screen_divide", DIVIDE, 1),
];
const DIVIDE: &str = "divide step";

/// By cell, what a change of each pin takes, pJ.
type PinEnergies = BTreeMap<String, Vec<(String, f64)>>;

/// Numbers between quotation marks.
fn quoted(line: &str) -> Vec<f64> {
    let inside = line.split('"').nth(1).unwrap_or_default();
    let numbers = inside.split(',').map(|number| number.trim().parse());
    numbers.map(Result::unwrap).collect()
}

/// Reads the library of cells: it has one value a line, and tables a row a line.
fn energies_of_pins(liberty: &str) -> PinEnergies {
    let lines: Vec<&str> = liberty.lines().map(str::trim).collect();
    let liberty = lines.join("\n");
    let mut cells = PinEnergies::new();
    for cell in liberty.split("\ncell ").skip(1) {
        let pins = cell.split("pin(").skip(1);
        let energies = pins.map(|pin| {
            let name = pin.split(')').next().unwrap_or_default().trim();
            (name.to_owned(), energy_of_pin(pin))
        });
        let name = cell.split(['(', ')']).nth(1).unwrap_or_default().trim();
        cells.insert(name.to_owned(), energies.collect());
    }
    cells
}

/// Energy of a change of a pin. For an output it is the mean of its tables at the nearest load.
fn energy_of_pin(pin: &str) -> f64 {
    let value = |key: &str| {
        let line = pin.lines().find_map(|line| line.trim().strip_prefix(key));
        line.unwrap_or_default().trim().trim_end_matches(';').trim()
    };
    if value("direction :") == "input" {
        let capacitance: f64 = value("capacitance :").parse().unwrap();
        return capacitance * VOLTS * VOLTS / 2.0;
    }
    let tables = pin.split("_power(energy").skip(1);
    let energies = tables.map(|table| {
        let line_with = |word: &str| table.lines().position(|line| line.trim().starts_with(word));
        let line = |at: usize| quoted(table.lines().nth(at).unwrap());
        let loads = line(line_with("index_1").unwrap());
        let far = |at: &usize| (loads[*at] - LOAD).abs();
        let nearest = (0..loads.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
        line(line_with("values").unwrap() + 1 + nearest.unwrap())[0]
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
        let is_counted = !cell.starts_with("DFF") && !cell.starts_with("LATCH");
        if line.starts_with("endmodule") && is_counted {
            let pins = energies.get(cell).map_or(&[][..], Vec::as_slice);
            for (pin, energy) in pins {
                let output = if pin.starts_with('Y') { 1 } else { 0 };
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

/// Energy of a list of operations in `predictions.csv` by the model's table, pJ, and their number.
fn by_table(table: &CostTable, list: &str) -> (f64, f64) {
    let operations = operations(list);
    let energies = operations
        .iter()
        .map(|&(times, operation, bits)| times * table.energy(operation, bits).unwrap().value);
    (
        energies.sum(),
        operations.iter().map(|(times, ..)| times).sum(),
    )
}

/// Steps of the frame's divides, the mean of all but the first: four, and one per fraction bit, which a row's inputs end
/// with.
fn divide_steps(rows: &Path) -> f64 {
    let text = fs::read_to_string(rows.join("to_screen_divide.jsonl")).unwrap();
    let rows = text
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap());
    let steps = rows.map(|row| {
        let into = row["in"].as_str().unwrap();
        4 + (u32::from_str_radix(&into[into.len() - 2..], 16).unwrap() & 63)
    });
    let steps: Vec<u32> = steps.take(ROWS as usize).skip(1).collect();
    f64::from(steps.iter().sum::<u32>()) / steps.len() as f64
}

/// The energy of a run of a block's netlist.
#[derive(Debug, Clone, Copy)]
struct Run {
    /// Energy of all rows but the first, pJ.
    pj: f64,
    /// Changes of outputs of a cell and row.
    activity: f64,
}

/// Runs a netlist through rows, of the frame or random ones.
fn run_rows(files: [&Path; 3], block: &Value, step: u64, random: bool) -> Run {
    let [folder, netlist, cells] = files;
    let name = block["name"].as_str().unwrap();
    // Where the frame has next to none, those made for the block: ends of ranges, and random numbers.
    let number = |key: &str| block[key].as_u64().unwrap();
    let rows = match number("frame_rows") {
        0..=2 => number("rows"),
        rows => rows,
    };
    let rows = rows.min(ROWS);
    // The first row is not counted.
    let taken = (rows.div_ceil(step) - 1) as f64;
    let words_in = block["in"]["bits"].as_u64().unwrap().div_ceil(32) as usize;
    let stimulus = match random {
        true => format!(
            "`define STIMULUS {{{}}}\n",
            vec!["$random"; words_in].join(", ")
        ),
        false => String::new(),
    };
    // A row lasts longer than the longest path.
    let bench = format!(
        "`timescale 1us/10ps\n`define MOST {rows}\n`define STEP {step}\n{stimulus}`define EACH count.on = 1;\n\
         `define SHOW $display(\"pj %f outputs %0d cells %0d\", count.pj, count.outputs, count.cells);\n{}",
        testbench(name, block)
    );
    let (source, compiled) = (folder.join("bench.v"), folder.join("bench.vvp"));
    fs::write(&source, bench).unwrap();
    let line = format!(
        "-g2012 -gspecify -I {} -s {name}_tb -s count -o {} {} {} {}",
        text(&rtl()),
        text(&compiled),
        text(&source),
        text(netlist),
        text(cells)
    );
    run(folder, "iverilog", &words(&line));
    let printed = run(folder, "vvp", &["-n", text(&compiled)]);
    let line = printed
        .lines()
        .find(|line| line.starts_with("pj "))
        .unwrap();
    let words: Vec<f64> = line
        .split(' ')
        .filter_map(|word| word.parse().ok())
        .collect();
    if !random {
        assert!(
            printed.contains(&format!("{name}_tb: 0 of ")),
            "{name}: the netlist's rows are wrong"
        );
    }
    let [pj, outputs, cells] = words[..] else {
        panic!("{line}");
    };
    Run {
        pj: pj / taken,
        activity: outputs / cells / taken,
    }
}

/// Prints changes per output and row, and energy per operation, with the frame's rows and with random ones. The energy of
/// random rows is also printed relative to an addition of the centre, beside the same ratio of the model's table.
#[test]
#[ignore = "takes minutes, and needs qflow-tech-osu018"]
fn energy_by_toggles_beside_the_table() {
    let liberty = Path::new(CELLS).join("osu018_stdcells.lib");
    let energies = energies_of_pins(&fs::read_to_string(liberty).unwrap());
    let verilog = fs::read_to_string(Path::new(CELLS).join("osu018_stdcells.v")).unwrap();
    let shelter = tempfile::tempdir().unwrap();
    let cells = shelter.path().join("cells.v");
    fs::write(&cells, counting_cells(&verilog, &energies)).unwrap();

    let vectors = rows_of_records(PAPER, TREE, "32", 4000);
    let rows = &vectors.folder;
    let predictions = fs::read_to_string(rtl().join("predictions.csv")).unwrap();
    let table = CostTable::load_shipped().unwrap();

    let mut adder = None;
    for (name, class, step) in BLOCKS {
        let netlist = shelter.path().join(format!("{name}.v"));
        let synthesize = format!("NETLIST={} ./synth.sh {name}", text(&netlist));
        run(&rtl(), "sh", &["-c", &synthesize]);
        let (_, block) = vectors.blocks().find(|(of, _)| *of == name).unwrap();
        let operations = match class {
            DIVIDE => format!("{:.1} divide_step (36)", divide_steps(rows)),
            _ => {
                let mut all = predictions.lines();
                let of_block = all.find_map(|row| row.strip_prefix(&format!("{name},")));
                of_block.unwrap().split(',').next().unwrap().to_owned()
            }
        };
        let (by_table, count) = by_table(&table, &operations);
        let files = [rows, &netlist, &cells].map(PathBuf::as_path);
        let of_frame = run_rows(files, block, step, false);
        // Random numerators and divisors make no quotients.
        let random = match class {
            DIVIDE => of_frame,
            _ => run_rows(files, block, step, true),
        };
        let [of_frame_pj, random_pj, table_pj] =
            [of_frame.pj, random.pj, by_table].map(|pj| pj / count);
        let (unit, table_unit) = *adder.get_or_insert((random_pj, table_pj));
        let (ratio, by_table) = (random_pj / unit, table_pj / table_unit);
        // A row is a visit of a block, but of the divider as many cycles as steps.
        let steps = if class == DIVIDE { count } else { 1.0 };
        eprintln!(
            "| `{name}` | {class} | {operations} | {:.2}, {:.2} | {of_frame_pj:.2}, {random_pj:.2} | {ratio:.2} | \
             {by_table:.2} | {:+.0} % |",
            of_frame.activity / steps,
            random.activity / steps,
            100.0 * (ratio / by_table - 1.0),
        );
        // Four bits are next to nothing; a step of the divide is larger than the table's, section 5 of `docs/rtl.md`.
        if !["logic", DIVIDE].contains(&class) {
            assert!((ratio / by_table - 1.0).abs() < 0.4, "{name}");
        }
    }
}

/// The parts of the sum, of a cell by hand.
#[test]
fn energies_of_a_cell_by_hand() {
    let liberty = "\ncell (INV) {\n pin(A) {\n direction : input;\n capacitance : 0.01;\n }\n pin(Y) {\n \
                   direction : output;\n capacitance : 0;\n internal_power() {\n \
                   rise_power(energy_template_5x5) {\n index_1 (\"0.005, 0.02, 0.15\");\n \
                   index_2 (\"0.06, 0.18\");\n values ( \\\n \"1, 2\", \\\n \"3, 4\", \\\n \"5, 6\");\n }\n \
                   fall_power(energy_template_5x5) {\n index_1 (\"0.005, 0.02, 0.15\");\n \
                   index_2 (\"0.06, 0.18\");\n values ( \\\n \"7, 8\", \\\n \"9, 10\", \\\n \"11, 12\");\n }\n";
    let energies = energies_of_pins(liberty);
    let pins = &energies["INV"];
    assert_eq!(pins.len(), 2);
    assert!((pins[0].1 - 0.01 * 1.8 * 1.8 / 2.0).abs() < 1e-12);
    // At a load of 20 fF and the first transition: rise 3, fall 9.
    assert!((pins[1].1 - 6.0).abs() < 1e-12);
    let counting = counting_cells("module INV (A, Y);\nendmodule\n", &energies);
    assert!(counting.contains("always @(Y) if (count.on) begin count.pj = count.pj + 6;"));
}
