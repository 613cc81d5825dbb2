//! Testbenches of the blocks, from the manifest of a folder of vectors.
//!
//! Fields that belong together are one port: a cage's vertices (`x_0` to `x_7`), its corner and edges (`x_corner`,
//! `x_edge_x` to `x_edge_z`), an object's coordinates (`min_x`, `min_y`, `min_z`), as they lie in the row.

use std::fmt::Write;

use serde_json::Value;

/// Part of a row.
struct Port {
    name: String,
    bits: u64,
    lowest: u64,
    /// Whether it is a cage of a corner and edges.
    is_corner: bool,
    /// The ending that the next field must have to belong to it.
    next: Option<String>,
}

/// A field's name without its last part, and that.
fn split(name: &str) -> Option<(&str, &str)> {
    name.rsplit_once('_').filter(|(_, end)| {
        matches!(*end, "a" | "b" | "c" | "x" | "y" | "z") || "01234567".contains(*end)
    })
}

fn ports(fields: &Value) -> Vec<Port> {
    let mut ports: Vec<Port> = Vec::new();
    for field in fields["fields"].as_array().unwrap() {
        let name = field["name"].as_str().unwrap();
        let number = |key: &str| field[key].as_u64().unwrap();
        let (bits, lowest) = (number("bits"), number("lowest_bit"));
        let after = |end: &str| match end {
            "a" => Some("b".to_owned()),
            "b" => Some("c".to_owned()),
            "x" => Some("y".to_owned()),
            "y" => Some("z".to_owned()),
            "c" | "z" => None,
            number => Some((number.parse::<u32>().unwrap() + 1).to_string()),
        };
        if let Some(port) = ports.last_mut() {
            let edge = name.strip_prefix(port.name.as_str());
            if port.is_corner && edge.is_some_and(|edge| edge.starts_with("_edge_")) {
                port.bits += bits;
                port.lowest = lowest;
                continue;
            }
        }
        let corner = name.strip_suffix("_corner");
        if let (Some((stem, end)), Some(port)) = (split(name), ports.last_mut()) {
            let is_first = split(&port.name).is_some_and(|(first, _)| first == stem);
            if port.next.as_deref() == Some(end) && (is_first || port.name == stem) {
                stem.clone_into(&mut port.name);
                port.bits += bits;
                port.lowest = lowest;
                port.next = after(end);
                continue;
            }
        }
        ports.push(Port {
            name: corner.unwrap_or(name).to_owned(),
            is_corner: corner.is_some(),
            bits,
            lowest,
            next: split(name)
                .filter(|(_, end)| matches!(*end, "a" | "x" | "0"))
                .and_then(|(_, end)| after(end)),
        });
    }
    ports
}

/// A module `NAME_tb` that runs a block through its rows and prints how many were wrong; all such modules may be
/// simulated at once. A divide takes cycles, all others are functions. At most so
/// many rows, the first.
pub(crate) fn testbench(block: &Value, most: u64) -> String {
    let name = block["name"].as_str().unwrap();
    let rows = block["rows"].as_u64().unwrap().min(most);
    let (stimulus, expected) = (ports(&block["stimulus"]), ports(&block["expected"]));
    let bits = |ports: &[Port]| ports.iter().map(|port| port.bits).sum::<u64>();
    let (into, out) = (bits(&stimulus), bits(&expected));
    let mut connections = String::new();
    for (ports, from) in [(&stimulus, "row"), (&expected, "result")] {
        for Port {
            name, bits, lowest, ..
        } in ports
        {
            let _ = write!(connections, ", .{name}({from}[{lowest} +: {bits}])");
        }
    }
    let is_divide = name == "to_screen_divide";
    let (clock, step) = match is_divide {
        true => (
            ".clk(clk), .start(start), .last(last)",
            "start = 1; #1 clk = 1; #1 clk = 0; start = 0;\n      \
             while (!last) begin #1 clk = 1; #1 clk = 0; end\n      \
             #1 clk = 1; #1 clk = 0;",
        ),
        false => ("", "#1;"),
    };
    let connections = format!("{clock}{connections}");
    let connections = connections.trim_start_matches(", ");
    format!(
        "module {name}_tb;
  reg [{into}-1:0] stimulus [0:{rows}-1];
  reg [{out}-1:0] expected [0:{rows}-1];
  reg [{into}-1:0] row;
  wire [{out}-1:0] result;
  reg clk = 0, start = 0;
  wire last;
  integer i, wrong;
  {name} dut ({connections});
  initial begin
    $readmemh(\"{name}.in.hex\", stimulus);
    $readmemh(\"{name}.out.hex\", expected);
    wrong = 0;
    for (i = 0; i < {rows}; i = i + 1) begin
      row = stimulus[i];
      {step}
      if (result !== expected[i]) wrong = wrong + 1;
    end
    $display(\"{name} %0d\", wrong);
  end
endmodule
"
    )
}
