//! Folders of vectors, read by the manifest alone.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::Value;

/// A row: its fields' values by name, and in order.
#[derive(Default, Clone)]
pub(super) struct Row {
    pub(super) names: BTreeMap<String, usize>,
    pub(super) values: Vec<i128>,
}

impl Row {
    pub(super) fn get(&self, name: &str) -> i128 {
        match self.names.get(name) {
            Some(&at) => self.values[at],
            None => panic!("no field {name}"),
        }
    }

    pub(super) fn flag(&self, name: &str) -> bool {
        self.get(name) != 0
    }

    /// Fields `name_x`, `name_y`, `name_z`.
    pub(super) fn axes(&self, name: &str) -> [i128; 3] {
        ["x", "y", "z"].map(|axis| self.get(&format!("{name}_{axis}")))
    }

    /// Fields `name_a`, `name_b`, `name_c`.
    pub(super) fn plane(&self, name: &str) -> [i128; 3] {
        ["a", "b", "c"].map(|c| self.get(&format!("{name}_{c}")))
    }

    /// The numbers of a cage: eight or four.
    pub(super) fn cage(&self, name: &str) -> Cage {
        if self.names.contains_key(&format!("{name}_corner")) {
            let mut numbers = vec![self.get(&format!("{name}_corner"))];
            numbers.extend(self.axes(&format!("{name}_edge")));
            Cage(numbers)
        } else {
            Cage((0..8).map(|i| self.get(&format!("{name}_{i}"))).collect())
        }
    }
}

/// One coordinate of eight vertices: themselves, or a corner and three edges.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Cage(pub(super) Vec<i128>);

impl Cage {
    pub(super) fn vertices(&self) -> Vec<i128> {
        match self.0[..] {
            [corner, x, y, z] => (0..8)
                .map(|i| corner + (i >> 2 & 1) * x + (i >> 1 & 1) * y + (i & 1) * z)
                .collect(),
            _ => self.0.clone(),
        }
    }

    pub(super) fn least(&self) -> i128 {
        *self.vertices().iter().min().unwrap()
    }

    pub(super) fn greatest(&self) -> i128 {
        *self.vertices().iter().max().unwrap()
    }

    pub(super) fn each(&self, f: impl Fn(i128) -> i128) -> Self {
        Self(self.0.iter().map(|&v| f(v)).collect())
    }

    /// `self * a + other * b`.
    pub(super) fn with(&self, a: i128, other: &Self, b: i128) -> Self {
        let numbers = self.0.iter().zip(&other.0);
        Self(numbers.map(|(&v, &w)| a * v + b * w).collect())
    }

    pub(super) fn children(&self) -> Vec<Self> {
        if let [corner, x, y, z] = self.0[..] {
            // Towards zero, as `/` does.
            let halves = [x / 2, y / 2, z / 2];
            return (0..8i128)
                .map(|c| {
                    let [x, y, z] = halves;
                    let moved = corner + (c >> 2) * x + (c >> 1 & 1) * y + (c & 1) * z;
                    Self(vec![moved, x, y, z])
                })
                .collect();
        }
        // The 27 points: a coordinate of 1 is the midpoint of 0 and 2; z is
        // resolved last, so it is the outermost midpoint.
        fn point(corners: &[i128], at: [usize; 3]) -> i128 {
            for k in [2, 1, 0] {
                if at[k] == 1 {
                    let (mut low, mut high) = (at, at);
                    (low[k], high[k]) = (0, 2);
                    let sum = point(corners, low) + point(corners, high);
                    return sum.div_euclid(2);
                }
            }
            corners[at[0] / 2 * 4 + at[1] / 2 * 2 + at[2] / 2]
        }
        (0..8)
            .map(|c| {
                let corner = |v: usize| {
                    let at = [2, 1, 0].map(|bit| (c >> bit & 1) + (v >> bit & 1));
                    point(&self.0, at)
                };
                Self((0..8).map(corner).collect())
            })
            .collect()
    }
}

/// `a * 2^places`, rounded down.
pub(super) fn scaled(a: i128, places: i128) -> i128 {
    if places >= 0 {
        a << places
    } else {
        a.div_euclid(1 << (-places).min(100))
    }
}

/// Constants of the manifest.
pub(super) struct Constants {
    pub(super) fraction: i128,
    pub(super) shifts: Vec<i128>,
}

impl Constants {
    /// The extent that `size_limit` allows.
    pub(super) fn share(&self, a: i128, below: i128) -> i128 {
        self.shifts.iter().map(|s| scaled(a, -(s + below))).sum()
    }
}

/// A file's rows, packed as the manifest defines.
pub(super) fn read(folder: &Path, ports: &Value) -> Vec<Row> {
    let fields = ports["fields"].as_array().unwrap();
    let names: BTreeMap<String, usize> = fields
        .iter()
        .enumerate()
        .map(|(at, field)| (field["name"].as_str().unwrap().to_owned(), at))
        .collect();
    assert_eq!(names.len(), fields.len(), "a name twice");
    let number = |value: &Value| value.as_u64().unwrap() as usize;
    let (width, digits) = (number(&ports["bits"]), number(&ports["digits"]));
    let text = fs::read_to_string(folder.join(ports["file"].as_str().unwrap())).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with("//"));
    let row = |line: &str| {
        assert_eq!(line.len(), digits, "{line}");
        let all: Vec<bool> = line
            .chars()
            .flat_map(|digit| {
                let digit = digit.to_digit(16).expect("a hexadecimal digit");
                (0..4).rev().map(move |bit| digit >> bit & 1 == 1)
            })
            .collect();
        let (padding, all) = all.split_at(all.len() - width);
        assert!(padding.len() < 4 && !padding.contains(&true));
        let mut end = width;
        let values = fields
            .iter()
            .map(|field| {
                let (bits, lowest) = (number(&field["bits"]), number(&field["lowest_bit"]));
                assert_eq!(lowest + bits, end, "fields without gaps");
                end = lowest;
                let part = &all[width - lowest - bits..width - lowest];
                let value = part.iter().fold(0i128, |v, &bit| v << 1 | i128::from(bit));
                let is_negative = field["signed"].as_bool().unwrap() && part[0];
                value - (i128::from(is_negative) << bits)
            })
            .collect();
        assert_eq!(end, 0);
        Row {
            names: names.clone(),
            values,
        }
    };
    lines.map(row).collect()
}

pub(super) fn constants_of(manifest: &Value) -> Constants {
    let number = |name: &str| i128::from(manifest["constants"][name].as_i64().unwrap());
    let shifts = manifest["constants"]["size_shifts"].as_array().unwrap();
    Constants {
        fraction: number("screen_fraction_bits"),
        shifts: shifts.iter().map(|s| s.as_i64().unwrap().into()).collect(),
    }
}

/// A block's rows, as a folder has them.
pub(super) struct BlockRows {
    pub(super) name: String,
    pub(super) inputs: Vec<(String, u32, bool)>,
    pub(super) outputs: Vec<(String, u32, bool)>,
    pub(super) stimulus: Vec<Row>,
    pub(super) expected: Vec<Row>,
}

pub(super) fn rows_of(folder: &Path) -> (Vec<BlockRows>, Constants) {
    let text = fs::read_to_string(folder.join("manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&text).unwrap();
    let blocks = manifest["blocks"].as_array().unwrap();
    let fields = |ports: &Value| -> Vec<(String, u32, bool)> {
        let all = ports["fields"].as_array().unwrap();
        let field = |f: &Value| {
            let bits = f["bits"].as_u64().unwrap() as u32;
            let name = f["name"].as_str().unwrap().to_owned();
            (name, bits, f["signed"].as_bool().unwrap())
        };
        all.iter().map(field).collect()
    };
    let found = blocks
        .iter()
        .filter(|block| block["rows"].as_u64() > Some(0));
    let found = found.map(|block| BlockRows {
        name: block["name"].as_str().unwrap().to_owned(),
        inputs: fields(&block["stimulus"]),
        outputs: fields(&block["expected"]),
        stimulus: read(folder, &block["stimulus"]),
        expected: read(folder, &block["expected"]),
    });
    (found.collect(), constants_of(&manifest))
}
