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

    pub(super) fn cage(&self, name: &str) -> Cage {
        Cage(self.of(name).to_vec())
    }
}

/// One coordinate of eight vertices: themselves, or a corner and three edges.
#[derive(Clone)]
pub(super) struct Cage(pub(super) Vec<i128>);

impl Cage {
    fn vertices(&self) -> Vec<i128> {
        match self.0[..] {
            [corner, x, y, z] => (0..8)
                .map(|i| corner + (i >> 2 & 1) * x + (i >> 1 & 1) * y + (i & 1) * z)
                .collect(),
            _ => self.0.clone(),
        }
    }

    pub(super) fn least(&self) -> i128 {
        self.vertices().into_iter().min().unwrap()
    }

    pub(super) fn greatest(&self) -> i128 {
        self.vertices().into_iter().max().unwrap()
    }

    pub(super) fn each(&self, f: impl Fn(i128) -> i128) -> Self {
        Self(self.0.iter().map(|&v| f(v)).collect())
    }

    /// `self * a + other * b`.
    pub(super) fn with(&self, a: i128, other: &Self, b: i128) -> Self {
        let numbers = self.0.iter().zip(&other.0);
        Self(numbers.map(|(&v, &w)| a * v + b * w).collect())
    }

    /// The cages of the eight children, one after another.
    pub(super) fn children(&self) -> Vec<i128> {
        if let [corner, x, y, z] = self.0[..] {
            // Towards zero, as `/` does.
            let [x, y, z] = [x / 2, y / 2, z / 2];
            let child = |c: i128| {
                let moved = corner + (c >> 2) * x + (c >> 1 & 1) * y + (c & 1) * z;
                [moved, x, y, z]
            };
            return (0..8).flat_map(child).collect();
        }
        // Of 27 points. A coordinate of 1 is the midpoint of 0 and 2; z is the outermost midpoint.
        fn point(corners: &[i128], at: [usize; 3]) -> i128 {
            let Some(k) = (0..3).rfind(|&k| at[k] == 1) else {
                return corners[at[0] / 2 * 4 + at[1] / 2 * 2 + at[2] / 2];
            };
            let (mut low, mut high) = (at, at);
            (low[k], high[k]) = (0, 2);
            (point(corners, low) + point(corners, high)).div_euclid(2)
        }
        let corner = |c: usize, v: usize| {
            let at = [2, 1, 0].map(|bit| (c >> bit & 1) + (v >> bit & 1));
            point(&self.0, at)
        };
        (0..64).map(|i| corner(i / 8, i % 8)).collect()
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

/// The lines of a file, each an object of JSON.
pub(super) fn lines(folder: &Path, file: &Value) -> Vec<Value> {
    let text = fs::read_to_string(folder.join(file.as_str().unwrap())).unwrap();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

/// The rows of a block: inputs and outputs.
pub(super) fn rows_of(folder: &Path, block: &Value) -> Vec<[Row; 2]> {
    let ports = ["in", "out"].map(|side| (side, Ports::new(&block[side])));
    let row = |line: Value| {
        ports
            .each_ref()
            .map(|(side, ports)| ports.row(line[side].as_str().unwrap()))
    };
    lines(folder, &block["file"]).into_iter().map(row).collect()
}
