//! Blocks that undo others, by the rows of those, turned around: what came out goes in, what went in must come out.
//!
//! Only rows that can be undone are: halves without a remainder, numbers that their double does not overflow.

use std::fs;

use serde_json::{Value, json};

use super::blocks::Rows;

/// Bits, the highest first.
type Bits = String;

/// What goes into a block and what comes out, by port.
type Row = [Vec<(&'static str, Bits)>; 2];

/// A row of a block: the bits of its fields by the beginning of their names, which lie side by side.
struct Fields<'r> {
    fields: &'r Value,
    row: Bits,
}

impl<'r> Fields<'r> {
    fn new(fields: &'r Value, hexadecimal: &str) -> Self {
        let digits = hexadecimal.chars().map(|digit| digit.to_digit(16).unwrap());
        let row = digits.map(|digit| format!("{digit:04b}")).collect();
        Self { fields, row }
    }

    /// Of all fields whose name begins so, in the order in which they lie there.
    fn of(&self, beginning: &str) -> Bits {
        let fields = self.fields["fields"].as_array().unwrap().iter();
        let mut found: Vec<(usize, usize)> = fields
            .filter(|field| field["name"].as_str().unwrap().starts_with(beginning))
            .map(|field| ["lowest_bit", "bits"].map(|key| field[key].as_u64().unwrap() as usize))
            .map(|[lowest, bits]| (lowest, bits))
            .collect();
        found.sort_unstable();
        let end = self.row.len();
        let bits = |&(lowest, bits): &(usize, usize)| &self.row[end - lowest - bits..end - lowest];
        found.iter().rev().map(bits).collect()
    }
}

/// Whether the double of each number of a port overflows none of them.
fn can_be_doubled(numbers: &str, bits: usize) -> bool {
    (0..numbers.len() / bits).all(|at| {
        let number = &numbers[at * bits..][..2];
        number == "00" || number == "11"
    })
}

fn doubled(numbers: &str, bits: usize) -> Bits {
    let double = |at: usize| format!("{}0", &numbers[at * bits + 1..(at + 1) * bits]);
    (0..numbers.len() / bits).map(double).collect()
}

/// The blocks, each with that whose rows it has.
const TURNED: [(&str, &str); 5] = [
    ("grown_cage", "vertex_pool"),
    ("parent_cage", "vertex_pool"),
    ("whole_clip", "bisector_clip"),
    ("plane_whole", "plane_quadrant"),
    ("parent_planes", "child_planes"),
];

/// Rows of a block, from a row of another.
fn turn(block: &str, into: &Fields<'_>, out: &Fields<'_>) -> Vec<Row> {
    match block {
        "grown_cage" | "parent_cage" => {
            let parent = into.of("parent");
            let bits = parent.len() / 4;
            if (1..4).any(|at| parent.as_bytes()[(at + 1) * bits - 1] == b'1') {
                return Vec::new();
            }
            let row = |octant: u8| {
                let octant = format!("{octant:03b}");
                let child = out.of(&format!("child_{octant}"));
                let (octant, parent) = (("octant", octant), parent.clone());
                match block {
                    "grown_cage" => [vec![("parent", parent), octant], vec![("child", child)]],
                    _ => [vec![("child", child), octant], vec![("parent", parent)]],
                }
            };
            (0..8).map(row).collect()
        }
        "whole_clip" => {
            let (x, w) = (into.of("x"), into.of("w"));
            let bits = x.len() / 4;
            if !can_be_doubled(&x, bits) {
                return Vec::new();
            }
            let halves = [("0", doubled(&x, bits)), ("1", out.of("relative"))];
            let row = |(right, inner): (&str, Bits)| {
                let stimulus = vec![("x", inner), ("w", w.clone()), ("right", right.to_owned())];
                [stimulus, vec![("outer", x.clone())]]
            };
            halves.map(row).into()
        }
        "plane_whole" => {
            let plane = into.of("plane");
            let (ab, c) = plane.split_at(plane.len() / 3 * 2);
            if !can_be_doubled(c, c.len()) {
                return Vec::new();
            }
            let inner = format!("{ab}{}", out.of("inner_c"));
            let stimulus = vec![("plane", inner), ("quadrant", into.of("quadrant"))];
            vec![[stimulus, vec![("outer_c", c.to_owned())]]]
        }
        "parent_planes" => {
            let across = [
                "axis_x_a", "axis_x_b", "axis_y_a", "axis_y_b", "axis_z_a", "axis_z_b",
            ];
            let [xa, xb, ya, yb, za, zb] = across.map(|name| into.of(name));
            let stimulus = vec![
                ("edge_x", out.of("child_edge_x")),
                ("edge_y", out.of("child_edge_y")),
                ("edge_z", out.of("child_edge_z")),
                ("axis_x", xa + &xb),
                ("axis_y", ya + &yb),
                ("axis_z", za + &zb),
                ("axis_x_c", into.of("axis_x_c")),
                ("axis_y_c", into.of("axis_y_c")),
                ("axis_z_c", into.of("axis_z_c")),
                ("half", into.of("half")),
                ("octant", into.of("octant")),
            ];
            let expected = vec![
                ("parent_edge_x", into.of("edge_x")),
                ("parent_edge_y", into.of("edge_y")),
                ("parent_edge_z", into.of("edge_z")),
            ];
            vec![[stimulus, expected]]
        }
        other => unreachable!("{other}"),
    }
}

/// The rows of a file, one a line.
fn lines(rows: &Rows, side: &Value) -> Vec<String> {
    let path = rows.folder.join(side["file"].as_str().unwrap());
    let text = fs::read_to_string(path).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with("//"));
    rows.map(|line| line.trim().to_owned()).collect()
}

/// Ports side by side, the first highest; planes number by number, as testbenches know them.
fn fields(ports: &[(&str, Bits)]) -> Value {
    let mut lowest: usize = ports.iter().map(|(_, bits)| bits.len()).sum();
    let mut fields = Vec::new();
    for (name, bits) in ports {
        let numbers: &[&str] = match *name {
            "axis_x" | "axis_y" | "axis_z" => &["_a", "_b"],
            name if name.contains("edge_") => &["_a", "_b", "_c"],
            _ => &[""],
        };
        for number in numbers {
            let bits = bits.len() / numbers.len();
            lowest -= bits;
            let name = format!("{name}{number}");
            fields.push(json!({ "name": name, "bits": bits, "lowest_bit": lowest }));
        }
    }
    json!({ "fields": fields })
}

fn hexadecimal(ports: &[(&str, Bits)]) -> String {
    let bits: String = ports.iter().map(|(_, bits)| bits.as_str()).collect();
    let padded = format!("{}{bits}", "0".repeat((4 - bits.len() % 4) % 4));
    let digit = |at: usize| u8::from_str_radix(&padded[4 * at..][..4], 2).unwrap();
    (0..padded.len() / 4)
        .map(|at| format!("{:x}", digit(at)))
        .collect()
}

/// The same rows, of these blocks alone.
pub(crate) fn turned(mut rows: Rows) -> Rows {
    let mut blocks = Vec::new();
    for (name, of) in TURNED {
        let all = rows.manifest["blocks"].as_array().unwrap();
        let block = all.iter().find(|block| block["name"] == of).unwrap();
        let [stimulus, expected] = [&block["stimulus"], &block["expected"]];
        let pairs = lines(&rows, stimulus)
            .into_iter()
            .zip(lines(&rows, expected));
        let made: Vec<Row> = pairs
            .flat_map(|(into, out)| {
                turn(
                    name,
                    &Fields::new(stimulus, &into),
                    &Fields::new(expected, &out),
                )
            })
            .collect();
        let [into, out] = made.first().unwrap();
        blocks.push(json!({
            "name": name,
            "rows": made.len(),
            "stimulus": fields(into),
            "expected": fields(out),
        }));
        for (side, end) in ["in", "out"].iter().enumerate() {
            let text: Vec<String> = made.iter().map(|row| hexadecimal(&row[side])).collect();
            let path = rows.folder.join(format!("{name}.{end}.hex"));
            fs::write(path, text.join("\n") + "\n").unwrap();
        }
    }
    rows.manifest["blocks"] = Value::Array(blocks);
    rows
}
