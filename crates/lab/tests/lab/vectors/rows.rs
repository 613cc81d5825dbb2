//! Folders of vectors, read by the manifest alone.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::rc::Rc;

use serde_json::Value;

/// The ports of a row: name, first number, count.
type Names = Rc<BTreeMap<String, (usize, usize)>>;

/// The numbers of the ports, in order.
pub(super) struct Row {
    names: Names,
    pub(super) values: Vec<i128>,
}

impl Row {
    pub(super) fn of(&self, name: &str) -> &[i128] {
        let (first, count) = self.names[name];
        &self.values[first..first + count]
    }

    /// The number of a port that has one.
    pub(super) fn get(&self, name: &str) -> i128 {
        let [one] = *self.of(name) else {
            panic!("{name} has several numbers");
        };
        one
    }

    pub(super) fn flag(&self, name: &str) -> bool {
        self.get(name) != 0
    }

    /// Three numbers: by axis, or a, b, c of a plane.
    pub(super) fn three(&self, name: &str) -> [i128; 3] {
        self.of(name).try_into().unwrap()
    }

    /// One coordinate of eight vertices, which are given themselves or as a corner and three edges.
    pub(super) fn vertices(&self, name: &str) -> Vec<i128> {
        let [corner, x, y, z] = *self.of(name) else {
            return self.of(name).to_vec();
        };
        let vertex = |i: i128| corner + (i >> 2 & 1) * x + (i >> 1 & 1) * y + (i & 1) * z;
        (0..8).map(vertex).collect()
    }
}

/// Inputs or outputs as the manifest describes them.
pub(super) struct Ports {
    names: Names,
    /// Bits and sign.
    numbers: Vec<(u32, bool)>,
}

impl Ports {
    pub(super) fn new(side: &Value) -> Self {
        let mut names = BTreeMap::new();
        let mut numbers = Vec::new();
        let mut end = side["bits"].as_u64().unwrap();
        for port in side["ports"].as_array().unwrap() {
            let number = |key: &str| port[key].as_u64().unwrap();
            let name = port["name"].as_str().unwrap().to_owned();
            let (count, bits) = (number("count"), number("bits"));
            // Ports lie side by side.
            assert_eq!(number("lowest_bit") + count * bits, end, "{name}");
            end = number("lowest_bit");
            let one = (bits as u32, port["signed"] == true);
            let place = (numbers.len(), count as usize);
            assert_eq!(names.insert(name, place), None);
            numbers.extend(vec![one; count as usize]);
        }
        assert_eq!(end, 0);
        let names = Rc::new(names);
        Self { names, numbers }
    }

    /// A row from its hexadecimal digits.
    pub(super) fn row(&self, text: &str) -> Row {
        let digits = text.chars().map(|digit| digit.to_digit(16).unwrap());
        let bits = digits.flat_map(|digit| (0..4).rev().map(move |bit| digit >> bit & 1));
        let bits: Vec<i128> = bits.map(i128::from).collect();
        let width: u32 = self.numbers.iter().map(|(bits, _)| bits).sum();
        let (padding, mut rest) = bits.split_at(bits.len() - width as usize);
        assert!(padding.len() < 4 && !padding.contains(&1), "{text}");
        let number = |(bits, signed): &(u32, bool)| {
            let (part, after) = rest.split_at(*bits as usize);
            rest = after;
            let value = part.iter().fold(0, |v, bit| v << 1 | bit);
            value - ((i128::from(*signed) * part[0]) << bits)
        };
        Row {
            names: self.names.clone(),
            values: self.numbers.iter().map(number).collect(),
        }
    }
}

pub(super) fn manifest_of(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("manifest.json")).unwrap()).unwrap()
}

/// The rows of a block: inputs and outputs.
pub(super) fn rows_of(folder: &Path, block: &Value) -> Vec<[Row; 2]> {
    let ports = ["in", "out"].map(|side| (side, Ports::new(&block[side])));
    let row = |line: Value| {
        ports
            .each_ref()
            .map(|(side, ports)| ports.row(line[side].as_str().unwrap()))
    };
    let text = fs::read_to_string(folder.join(block["file"].as_str().unwrap())).unwrap();
    let lines = text.lines().map(|line| serde_json::from_str(line).unwrap());
    lines.map(row).collect()
}
