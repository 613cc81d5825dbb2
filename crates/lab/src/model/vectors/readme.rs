//! What stands in `README.txt`: how to read the rows in Verilog.

use std::fmt::Write;

use hwmodel::Format;

use super::ports::Ports;
use super::recorder::Recording;
use super::rows::{EXPECTED, STIMULUS, file_name};
use shiftvox::project::FrameSetup;

/// The text, with a testbench for one of the blocks.
pub(super) fn text(format: Format, recordings: &[Recording]) -> String {
    let mut text = String::from(
        "Test vectors of the blocks of a light voxel hardware.\n\n\
         BLOCK.in.hex has the inputs of a block, BLOCK.out.hex its outputs; line n of one\n\
         goes with line n of the other (comments, which begin with //, do not count).\n\
         A line is one row: the fields of manifest.json one after the other, the first\n\
         the most significant, each as wide as \"bits\" says, two's complement where it is\n\
         \"signed\", zeros before the first up to a whole hexadecimal digit.\n\
         \"lowest_bit\" is where a field begins: row[lowest_bit +: bits].\n\
         Every block is a function of its inputs and of the manifest's \"constants\"; it\n\
         keeps nothing from row to row. \"function\" says which; \"section\" where SPEC.md\n\
         has it.\n\
         turns.ports.hex has whole turns: what crosses the ports to stack, fill vectors,\n\
         nodes and pixels, in order; a pop begins a turn. Records stand in\n\
         turns.records.hex.\n",
    );
    let with_rows = |r: &&Recording| r.rows > 0;
    let centre = recordings.iter().find(|r| r.description.name == "centre");
    let chosen = centre
        .filter(with_rows)
        .or_else(|| recordings.iter().find(with_rows));
    if let Some(recording) = chosen {
        text += "\nA testbench. Save it as ../tb.v (--force replaces no folder that holds other\n\
                 files), add your block, and run in this folder\n\
                 `iverilog -g2005 -o ../tb ../tb.v && vvp ../tb`. Every block has one like it,\n\
                 BLOCK_tb.v, and parameters.vh has the frame's constants.\n\n";
        text += &testbench(format, recording);
        if recording.description.name == "centre" {
            text += "\n// A block that passes, as an example:\n";
            text += &centre_module(format);
        }
    }
    text
}

/// The frame's constants as Verilog parameters.
pub(super) fn parameters(setup: &FrameSetup) -> String {
    let format = setup.format;
    let mut text = String::from("// The frame's constants; word widths in bits.\n");
    for (name, value) in [
        ("WORD_BITS", format.bits()),
        ("WIDE_BITS", format.wide().bits()),
        ("SCREEN_FRACTION_BITS", format.frac()),
        ("DEPTH", setup.depth),
        ("IMAGE_LEVELS", setup.levels),
        ("WIDTH", setup.width),
        ("HEIGHT", setup.height),
    ] {
        // Writing to a string does not fail.
        let _ = writeln!(text, "localparam {name} = {value};");
    }
    text
}

/// A testbench of one block.
pub(super) fn testbench(format: Format, recording: &Recording) -> String {
    let d = &recording.description;
    let (into, out) = (d.stimulus.bits(format), d.expected.bits(format));
    let names = |ports: &Ports| {
        let names: Vec<&str> = ports.fields().iter().map(|f| f.name.as_str()).collect();
        names.join(", ")
    };
    let stimulus_file = file_name(d.name, STIMULUS);
    let expected_file = file_name(d.name, EXPECTED);
    let connections: Vec<String> = d
        .stimulus
        .fields()
        .iter()
        .chain(d.expected.fields())
        .map(|f| format!(".{0}({0})", f.name))
        .collect();
    let wires = wires(format, &d.stimulus, true) + &wires(format, &d.expected, false);
    let (name, rows) = (d.name, recording.rows);
    let (last_row, last_in, last_out) = (rows - 1, into - 1, out - 1);
    let (outputs, connections) = (names(&d.expected), connections.join(", "));
    format!(
        "module {name}_tb;\n\
         \x20 reg [{last_in}:0] stimulus [0:{last_row}];\n\
         \x20 reg [{last_out}:0] expected [0:{last_row}];\n\
         \x20 reg [{last_in}:0] row;\n\
         \x20 integer i, wrong;\n\
         {wires}\
         \x20 {name} dut ({connections});\n\
         \x20 initial begin\n\
         \x20   $readmemh(\"{stimulus_file}\", stimulus);\n\
         \x20   $readmemh(\"{expected_file}\", expected);\n\
         \x20   wrong = 0;\n\
         \x20   for (i = 0; i < {rows}; i = i + 1) begin\n\
         \x20     row = stimulus[i];\n\
         \x20     #1 if ({{{outputs}}} !== expected[i]) begin\n\
         \x20       wrong = wrong + 1;\n\
         \x20       $display(\"row %0d: %h, not %h\", i, {{{outputs}}}, expected[i]);\n\
         \x20     end\n\
         \x20   end\n\
         \x20   $display(\"{name}: %0d of {rows} rows wrong\", wrong);\n\
         \x20   $finish;\n\
         \x20 end\n\
         endmodule\n"
    )
}

/// The wires of a block's inputs, cut out of a row, or of its outputs.
fn wires(format: Format, ports: &Ports, is_input: bool) -> String {
    let mut text = String::new();
    for (field, lowest) in ports.placed(format) {
        let bits = field.kind.bits(format);
        let sign = if field.kind.is_signed() {
            "signed "
        } else {
            ""
        };
        let from = if is_input {
            format!(" = row[{lowest} +: {bits}]")
        } else {
            String::new()
        };
        // Writing to a string does not fail.
        let _ = writeln!(text, "  wire {sign}[{}:0] {}{from};", bits - 1, field.name);
    }
    text
}

/// The centre: an add with its carry, and a shift, along each axis.
fn centre_module(format: Format) -> String {
    let word = format!("signed [{}:0]", format.bits() - 1);
    let sum = format!("signed [{}:0]", format.bits());
    let mut text = format!(
        "module centre (\n\
         \x20 input {word} min_x, min_y, min_z, max_x, max_y, max_z,\n\
         \x20 output {word} centre_x, centre_y, centre_z);\n"
    );
    for axis in ["x", "y", "z"] {
        let _ = writeln!(
            text,
            "  wire {sum} sum_{axis} = min_{axis} + max_{axis};\n  \
             assign centre_{axis} = sum_{axis} >>> 1;"
        );
    }
    text + "endmodule\n"
}
