//! Blocks that undo others, by the rows of those, turned around: outputs become inputs, and inputs outputs. Only rows that
//! can be undone are used: halves without a remainder, numbers whose double does not overflow.

use std::fs;

use serde_json::{Value, json};

use super::blocks::Rows;

/// Bits, the highest first.
type Bits = String;

/// Inputs and outputs of a block, by port.
type Row = [Vec<(&'static str, Bits)>; 2];

/// The bits of a port in a row of hexadecimal digits.
fn bits_of(side: &Value, hexadecimal: &str, port: &str) -> Bits {
    let digits = hexadecimal.chars().map(|digit| digit.to_digit(16).unwrap());
    let row: Bits = digits.map(|digit| format!("{digit:04b}")).collect();
    let mut ports = side["ports"].as_array().unwrap().iter();
    let found = ports.find(|of| of["name"] == port);
    let found = found.unwrap_or_else(|| panic!("no port {port}"));
    let number = |key: &str| found[key].as_u64().unwrap() as usize;
    let (lowest, bits) = (number("lowest_bit"), number("bits") * number("count"));
    row[row.len() - lowest - bits..row.len() - lowest].to_owned()
}

/// Whether the double of each number of a port fits its bits.
fn can_be_doubled(numbers: &str, bits: usize) -> bool {
    (0..numbers.len() / bits).all(|at| ["00", "11"].contains(&&numbers[at * bits..][..2]))
}

fn doubled(numbers: &str, bits: usize) -> Bits {
    let double = |at: usize| format!("{}0", &numbers[at * bits + 1..(at + 1) * bits]);
    (0..numbers.len() / bits).map(double).collect()
}

/// The blocks, and those whose rows they use.
const TURNED: [(&str, &str); 5] = [
    ("grown_cage", "vertex_pool"),
    ("parent_cage", "vertex_pool"),
    ("whole_clip", "bisector_clip"),
    ("plane_whole", "plane_quadrant"),
    ("parent_planes", "child_planes"),
];

/// Rows of a block from the inputs and outputs of a row of another.
fn turn(block: &str, into: &dyn Fn(&str) -> Bits, out: &dyn Fn(&str) -> Bits) -> Vec<Row> {
    match block {
        "grown_cage" | "parent_cage" => {
            let parent = into("parent");
            let bits = parent.len() / 4;
            if (1..4).any(|at| parent.as_bytes()[(at + 1) * bits - 1] == b'1') {
                return Vec::new();
            }
            let row = |octant: u8| {
                let octant = format!("{octant:03b}");
                let child = ("child", out(&format!("child_{octant}")));
                let (octant, parent) = (("octant", octant), ("parent", parent.clone()));
                match block {
                    "grown_cage" => [vec![parent, octant], vec![child]],
                    _ => [vec![child, octant], vec![parent]],
                }
            };
            (0..8).map(row).collect()
        }
        "whole_clip" => {
            let (x, w) = (into("x"), into("w"));
            let bits = x.len() / 4;
            if !can_be_doubled(&x, bits) {
                return Vec::new();
            }
            let halves = [("0", doubled(&x, bits)), ("1", out("relative"))];
            let row = |(right, inner): (&str, Bits)| {
                let stimulus = vec![("x", inner), ("w", w.clone()), ("right", right.to_owned())];
                [stimulus, vec![("outer", x.clone())]]
            };
            halves.map(row).into()
        }
        "plane_whole" => {
            let plane = into("plane");
            let (ab, c) = plane.split_at(plane.len() / 3 * 2);
            if !can_be_doubled(c, c.len()) {
                return Vec::new();
            }
            let inner = ("plane", ab.to_owned() + &out("inner_c"));
            let stimulus = vec![inner, ("quadrant", into("quadrant"))];
            vec![[stimulus, vec![("outer_c", c.to_owned())]]]
        }
        "parent_planes" => {
            let unchanged = [
                "axis_x", "axis_y", "axis_z", "axis_x_c", "axis_y_c", "axis_z_c", "half", "octant",
            ];
            let edges = [
                ("edge_x", "child_edge_x", "parent_edge_x"),
                ("edge_y", "child_edge_y", "parent_edge_y"),
                ("edge_z", "child_edge_z", "parent_edge_z"),
            ];
            let children = edges.map(|(edge, child, _)| (edge, out(child)));
            let others = unchanged.map(|name| (name, into(name)));
            let parents = edges.map(|(edge, _, parent)| (parent, into(edge)));
            vec![[[&children[..], &others].concat(), parents.into()]]
        }
        other => unreachable!("{other}"),
    }
}

/// Ports side by side, the first highest.
fn described(ports: &[(&str, Bits)]) -> Value {
    let all: usize = ports.iter().map(|(_, bits)| bits.len()).sum();
    let mut lowest = all;
    let ports = ports.iter().map(|(name, bits)| {
        lowest -= bits.len();
        json!({ "name": name, "count": 1, "bits": bits.len(), "lowest_bit": lowest })
    });
    json!({ "bits": all, "ports": ports.collect::<Vec<_>>() })
}

fn hexadecimal(ports: &[(&str, Bits)]) -> String {
    let bits: String = ports.iter().map(|(_, bits)| bits.as_str()).collect();
    let padded = format!("{}{bits}", "0".repeat((4 - bits.len() % 4) % 4));
    let digit = |at: usize| u8::from_str_radix(&padded[4 * at..][..4], 2).unwrap();
    let digits = (0..padded.len() / 4).map(|at| format!("{:x}", digit(at)));
    digits.collect()
}

/// The rows of these blocks alone.
pub(crate) fn turned(mut rows: Rows) -> Rows {
    let mut blocks = Vec::new();
    for (name, of) in TURNED {
        let (_, block) = rows.blocks().find(|(name, _)| *name == of).unwrap();
        let text = fs::read_to_string(rows.folder.join(format!("{of}.jsonl"))).unwrap();
        let lines = text
            .lines()
            .map(|line| serde_json::from_str::<Value>(line).unwrap());
        let made = lines.flat_map(|line| {
            let side = |side: &'static str| {
                let digits = line[side].as_str().unwrap().to_owned();
                move |port: &str| bits_of(&block[side], &digits, port)
            };
            turn(name, &side("in"), &side("out"))
        });
        let made: Vec<Row> = made.collect();
        let line = |[into, out]: &Row| {
            let (into, out) = (hexadecimal(into), hexadecimal(out));
            format!("{{\"in\":\"{into}\",\"out\":\"{out}\"}}\n")
        };
        let lines: String = made.iter().map(line).collect();
        fs::write(rows.folder.join(format!("{name}.jsonl")), lines).unwrap();
        let [into, out] = made.first().unwrap();
        blocks.push(json!({
            "name": name,
            "rows": made.len(),
            "in": described(into),
            "out": described(out),
        }));
    }
    rows.manifest["blocks"] = Value::Array(blocks);
    rows
}
