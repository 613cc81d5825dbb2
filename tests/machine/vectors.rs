//! Test vectors, replayed: every row of every block computed again from the
//! files alone, in plain integers, by `SPEC.md` and the manifest.
//! Nothing here uses the machine.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use hwmodel::Overflow;
use serde_json::Value;
use shiftvox::graph::{Graph, GraphView, Opacity};
use shiftvox::lab::model::vectors::{self, Request};
use shiftvox::project::{CageKind, Camera, Coverage, SetupOptions};

use super::common::{camera, octree, setup, sierpinski, solid, tolerance_of};

/// A row: its fields' values by name, and in order.
#[derive(Default)]
struct Row {
    names: BTreeMap<String, usize>,
    values: Vec<i128>,
}

impl Row {
    fn get(&self, name: &str) -> i128 {
        match self.names.get(name) {
            Some(&at) => self.values[at],
            None => panic!("no field {name}"),
        }
    }

    fn flag(&self, name: &str) -> bool {
        self.get(name) != 0
    }

    /// Fields `name_x`, `name_y`, `name_z`.
    fn axes(&self, name: &str) -> [i128; 3] {
        ["x", "y", "z"].map(|axis| self.get(&format!("{name}_{axis}")))
    }

    /// Fields `name_a`, `name_b`, `name_c`.
    fn plane(&self, name: &str) -> [i128; 3] {
        ["a", "b", "c"].map(|c| self.get(&format!("{name}_{c}")))
    }

    /// The numbers of a cage: eight or four.
    fn cage(&self, name: &str) -> Cage {
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
struct Cage(Vec<i128>);

impl Cage {
    fn vertices(&self) -> Vec<i128> {
        match self.0[..] {
            [corner, x, y, z] => (0..8)
                .map(|i| corner + (i >> 2 & 1) * x + (i >> 1 & 1) * y + (i & 1) * z)
                .collect(),
            _ => self.0.clone(),
        }
    }

    fn least(&self) -> i128 {
        *self.vertices().iter().min().unwrap()
    }

    fn greatest(&self) -> i128 {
        *self.vertices().iter().max().unwrap()
    }

    fn each(&self, f: impl Fn(i128) -> i128) -> Self {
        Self(self.0.iter().map(|&v| f(v)).collect())
    }

    /// `self * a + other * b`.
    fn with(&self, a: i128, other: &Self, b: i128) -> Self {
        let numbers = self.0.iter().zip(&other.0);
        Self(numbers.map(|(&v, &w)| a * v + b * w).collect())
    }

    fn children(&self) -> Vec<Self> {
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
fn scaled(a: i128, places: i128) -> i128 {
    if places >= 0 {
        a << places
    } else {
        a.div_euclid(1 << (-places).min(100))
    }
}

/// Constants of the manifest.
struct Constants {
    fraction: i128,
    shifts: Vec<i128>,
}

impl Constants {
    /// The extent that `size_limit` allows.
    fn share(&self, a: i128, below: i128) -> i128 {
        self.shifts.iter().map(|s| scaled(a, -(s + below))).sum()
    }
}

fn bits(flags: &[bool]) -> Vec<i128> {
    flags.iter().map(|&f| i128::from(f)).collect()
}

/// What a block gives for a row.
fn replay(block: &str, row: &Row, constants: &Constants) -> Vec<i128> {
    let get = |name: &str| row.get(name);
    match block {
        "filled" => bits(&[get("vector") == 15]),
        "change_depth" | "detail_depth" => bits(&[get("w_min") >= get("least")]),
        "change_guard" => {
            let (x, w, places) = (row.cage("x"), row.cage("w"), get("places"));
            // Times 2^places where that is a multiple, so that nothing is rounded.
            let (by, part) = (1 << places.max(0), 1 << (-places).max(0));
            let left = x.with(by, &w, part).least();
            let right = w.with(by, &x, -by).with(1, &w, part).least();
            bits(&[left >= 0 && right >= 0])
        }
        "to_screen_divide" => {
            let (x, w) = (get("x"), get("w"));
            assert!(w > 0 && -4 * w <= x && x < 12 * w, "{x} / {w}");
            vec![((x + 4 * w) << get("fraction_bits")).div_euclid(w)]
        }
        "size_limit" => vec![constants.share(get("w_min"), get("below"))],
        "size_clip" => {
            let (x, w) = (row.axes("edge_x"), row.axes("edge_w"));
            let size: i128 = (0..3).map(|k| x[k].abs().max((x[k] - w[k]).abs())).sum();
            bits(&[size <= get("most")])
        }
        "size_screen" => bits(&[get("high") - get("low") <= get("limit")]),
        "centre" => {
            let (min, max) = (row.axes("min"), row.axes("max"));
            (0..3).map(|k| (min[k] + max[k]).div_euclid(2)).collect()
        }
        "octant_order" => {
            let (centre, eye) = (row.axes("centre"), row.axes("eye_floor"));
            let octant = (0..3).map(|k| i128::from(centre[k] > eye[k]) << (2 - k));
            let octant: i128 = octant.sum();
            let mut out = vec![octant];
            out.extend([7, 6, 5, 3, 4, 2, 1, 0].map(|nearest| octant ^ nearest));
            out
        }
        "vertex_pool" => {
            let children = row.cage("parent").children();
            children.into_iter().flat_map(|child| child.0).collect()
        }
        "child_planes" => {
            let octant = get("octant");
            let has = |k: usize| octant >> (2 - k) & 1;
            let moved = |j: usize| {
                let (k, l) = ((j + 1) % 3, (j + 2) % 3);
                let (plane, along_k, along_l) = (edge(row, j), axis(row, k), axis(row, l));
                let half = 1 << get("half");
                [0, 1, 2].map(|c| plane[c] + half * (has(l) * along_k[c] - has(k) * along_l[c]))
            };
            (0..3).flat_map(moved).collect()
        }
        "child_corners" => {
            let (min, max, centre) = (row.axes("min"), row.axes("max"), row.axes("centre"));
            let upper = |k: usize| get("octant") >> (2 - k) & 1 == 1;
            let low = (0..3).map(|k| if upper(k) { centre[k] } else { min[k] });
            let high = (0..3).map(|k| if upper(k) { max[k] } else { centre[k] });
            low.chain(high).collect()
        }
        "child_span" => {
            let child = row.cage("child");
            vec![child.least(), child.greatest()]
        }
        "margin_grow" => {
            let places = get("places");
            let more = i128::from(places > 0);
            row.cage("w").each(|w| scaled(w, -places) + more).0
        }
        "margin_gap" => {
            let below = get("below");
            row.cage("w").each(|w| -scaled(w, -below)).0
        }
        "border_clip" => {
            let (x, w, m) = (row.cage("x"), row.cage("w"), row.cage("margin"));
            let right = x.with(1, &w, -1);
            let outside = x.with(1, &m, 1).greatest() < 0 || right.with(1, &m, -1).least() > 0;
            let (low, high) = (x.with(1, &m, -1).least(), right.with(1, &m, 1).greatest());
            let strict = i128::from(row.flag("wider"));
            bits(&[outside, !outside && low >= strict && high <= -strict])
        }
        "bisector_clip" => {
            let (x, w, m) = (row.cage("x"), row.cage("w"), row.cage("margin"));
            let relative = x.with(2, &w, -1);
            let (mut low, mut high);
            if row.flag("closed") {
                low = relative.with(1, &m, -1).least() <= 0;
                high = relative.with(1, &m, 1).greatest() >= 0;
            } else {
                low = relative.least() < 0;
                high = relative.greatest() > 0 || !low;
            }
            if row.flag("sample") {
                (low, high) = (low && high, low && high);
            }
            let mut out = relative.0;
            out.extend(bits(&[low, high]));
            out
        }
        "near_node" => {
            let (x, w) = (row.cage("x"), row.cage("w"));
            bits(&[x.with(1, &w, 1).least() >= 0 && x.with(1, &w, -2).greatest() <= 0])
        }
        "half_clip" if row.flag("right") => row.cage("far").0,
        "half_clip" => row.cage("x").each(|x| 2 * x).0,
        "plane_quadrant" => {
            let [a, b, c] = row.plane("plane");
            let quadrant = get("quadrant");
            vec![2 * c + (quadrant & 1) * a + (quadrant >> 1) * b]
        }
        "border_screen" => {
            let (low, high, node) = (get("low"), get("high"), get("node"));
            let unit = get("below") + constants.fraction;
            let (left, right) = (node << unit, (node + 1) << unit);
            let outside = high < left || low > right;
            bits(&[outside, !outside && left <= low && high <= right])
        }
        "bisector_screen" => {
            let unit = get("below") + constants.fraction - 1;
            let bisector = scaled(2 * get("node") + 1, unit);
            let low = get("low") < bisector;
            bits(&[low, get("high") > bisector || !low])
        }
        "quadrants" => {
            let x = [row.flag("low_half_x"), row.flag("high_half_x")];
            let y = [row.flag("low_half_y"), row.flag("high_half_y")];
            let bit = |q: usize| i128::from(x[q & 1] && y[q >> 1]) << q;
            vec![(0..4).map(bit).sum()]
        }
        "node_choice" => {
            let overlapped = get("overlapped");
            let among: Vec<i128> = (0..4).filter(|q| overlapped >> q & 1 == 1).collect();
            let rejected = among.iter().all(|q| get("vector") >> q & 1 == 1);
            let single = among.len() == 1;
            let quadrant = if single { among[0] } else { 0 };
            vec![i128::from(rejected), i128::from(single), quadrant]
        }
        "cage_centre" => vec![match row.cage("cage").0[..] {
            [corner, x, y, z] => corner + (x + y + z).div_euclid(2),
            ref corners => (corners[0] + corners[7]).div_euclid(2),
        }],
        "centre_half" => {
            let beyond = 2 * get("value") - get("w");
            let right = beyond >= 0;
            vec![
                i128::from(right),
                if right { beyond } else { 2 * get("value") },
            ]
        }
        "centre_sample" => {
            let (node, below) = (get("node"), get("below"));
            let sample = get("centre").div_euclid(1 << constants.fraction);
            vec![sample.clamp(node << below, ((node + 1) << below) - 1)]
        }
        "cube_planes" => {
            let side = 1 << get("side");
            let planes = |j: usize| {
                let (k, l) = ((j + 1) % 3, (j + 2) % 3);
                let (here, along_k, along_l) = (edge(row, j), axis(row, k), axis(row, l));
                // The edge itself, moved along k, along l, along both.
                [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(by_k, by_l)| {
                    [0, 1, 2].map(|c| here[c] + side * (by_l * along_k[c] - by_k * along_l[c]))
                })
            };
            (0..3).flat_map(planes).flatten().collect()
        }
        "cube_front" => {
            let (min, max) = (row.axes("min"), row.axes("max"));
            let (floor, ceil) = (row.axes("eye_floor"), row.axes("eye_ceil"));
            let outside = (0..3).find(|&k| ceil[k] <= min[k] || max[k] <= floor[k]);
            outside.map_or(vec![0, 0, 0], |k| {
                let same = (ceil[k] <= min[k]) == row.flag("positive");
                vec![1, k as i128, if same { 1 } else { 2 }]
            })
        }
        "plane_side" => vec![plane_side(row.plane("plane"), row.flag("sample"))],
        "plane_cover" => vec![plane_cover(row)],
        "fill_update" => {
            let after = get("vector") | get("bits");
            vec![after, i128::from(after == 15)]
        }
        "blend_way" => {
            let centre = (get("min") + get("max")).div_euclid(2);
            vec![(scaled(centre, -get("shift")) - get("eye")).abs()]
        }
        "blend_shares" => {
            let way = row.axes("way");
            let all = way.iter().sum::<i128>().max(1);
            // To the nearest, halves up.
            let nearest = |k: usize| (32 * way[k] + all).div_euclid(2 * all);
            let x = nearest(0);
            let y = nearest(1).min(16 - x);
            let shares = [x, y, 16 - x - y];
            let mut out = shares.to_vec();
            out.extend(bits(&shares.map(|share| share >= 4)));
            out
        }
        "blend_counts" => {
            let squares = row.axes("share").map(|share| share * share);
            let length = (squares.iter().sum::<i128>() as f64).sqrt().round() as i128;
            let nearest = |square: i128| (2 * square + length).div_euclid(2 * length);
            squares.map(nearest).to_vec()
        }
        "blend_weight" => {
            let (high, count, seen) = (row.axes("high"), row.axes("count"), row.axes("seen"));
            let opacity = |k: usize| {
                let side = ["low", "high"][high[k] as usize];
                get(&format!("opacity_{}_{side}", AXES[k]))
            };
            if (0..3).any(|k| seen[k] == 1 && opacity(k) == 15) {
                return vec![256];
            }
            // 15 covers all sixteen sixteenths.
            let covered = |k| opacity(k) + i128::from(opacity(k) >= 8);
            vec![(0..3).map(|k| covered(k) * count[k]).sum()]
        }
        "blend_sample" => {
            let (left, weight) = (get("left"), get("weight"));
            // To the nearest, halves up.
            let share = (2 * left * weight + 256).div_euclid(512);
            let full = left - share <= 64;
            let taken = if full { left } else { share };
            let mut out = vec![left - taken];
            for color in ["red", "green", "blue"] {
                let (sum, light) = (format!("sum_{color}"), format!("light_{color}"));
                out.push(get(&sum) + taken * get(&light));
            }
            out.extend(bits(&[left == 256, full]));
            out
        }
        other => panic!("no rule for block {other}"),
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];

fn edge(row: &Row, j: usize) -> [i128; 3] {
    row.plane(&format!("edge_{}", AXES[j]))
}

fn axis(row: &Row, l: usize) -> [i128; 3] {
    row.plane(&format!("axis_{}", AXES[l]))
}

/// The side of the open node's samples: at its corners the function takes all
/// its extremes, and a sample is moved right, then down, by next to nothing.
fn plane_side([a, b, c]: [i128; 3], is_sample: bool) -> i128 {
    let corners = [c, c + a, c + b, c + a + b];
    if corners == [0; 4] {
        3
    } else if corners.iter().all(|&v| v >= 0) {
        1
    } else if corners.iter().all(|&v| v <= 0) {
        2
    } else if is_sample {
        let middle = [2 * c + a + b, a, b];
        match middle.into_iter().find(|&v| v != 0) {
            Some(v) if v > 0 => 1,
            Some(_) => 2,
            None => 3,
        }
    } else {
        0
    }
}

fn plane_cover(row: &Row) -> i128 {
    let mut all = true;
    for axis in AXES {
        let sides: Vec<i128> = (0..4)
            .map(|i| row.get(&format!("side_{axis}_{i}")))
            .collect();
        let (above, below) = (sides.contains(&1), sides.contains(&2));
        if !(above && below) {
            if !sides.contains(&0) {
                return 0;
            }
            all = false;
        }
    }
    if row.flag("front") {
        let side = row.get("front_side");
        if side == 0 {
            all = false;
        } else if side != row.get("wanted") {
            // Where an axis is not settled, the front has not been examined yet;
            // its side is then the last one, for which the record was still alive.
            return 0;
        }
    }
    if all { 2 } else { 1 }
}

/// A file's rows, packed as the manifest defines.
fn read(folder: &Path, ports: &Value) -> Vec<Row> {
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

fn constants_of(manifest: &Value) -> Constants {
    let number = |name: &str| i128::from(manifest["constants"][name].as_i64().unwrap());
    let shifts = manifest["constants"]["size_shifts"].as_array().unwrap();
    Constants {
        fraction: number("screen_fraction_bits"),
        shifts: shifts.iter().map(|s| s.as_i64().unwrap().into()).collect(),
    }
}

/// Rows that are not what their block gives, and the first of them; and rows by block.
fn replay_folder(folder: &Path) -> (Option<String>, BTreeMap<String, usize>) {
    let text = fs::read_to_string(folder.join("manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(manifest["schema"], 4);
    let constants = constants_of(&manifest);
    let mut files = ["manifest.json", "README.txt", "parameters.vh"]
        .map(str::to_owned)
        .into_iter()
        .collect::<BTreeSet<_>>();
    let mut wrong = None;
    let mut counts = BTreeMap::new();
    for block in manifest["blocks"].as_array().unwrap() {
        let name = block["name"].as_str().unwrap();
        let rows = block["rows"].as_u64().unwrap() as usize;
        counts.insert(name.to_owned(), rows);
        if rows == 0 {
            assert!(!block["reason"].as_str().unwrap().is_empty(), "{name}");
            assert!(block["stimulus"]["file"].is_null() && block["expected"]["file"].is_null());
            continue;
        }
        assert!(block["reason"].is_null());
        for ports in ["stimulus", "expected"] {
            files.insert(block[ports]["file"].as_str().unwrap().to_owned());
        }
        files.insert(format!("{name}_tb.v"));
        let stimulus = read(folder, &block["stimulus"]);
        let expected = read(folder, &block["expected"]);
        assert_eq!((stimulus.len(), expected.len()), (rows, rows), "{name}");
        for (at, (into, out)) in stimulus.iter().zip(&expected).enumerate() {
            let found = replay(name, into, &constants);
            if found != out.values && wrong.is_none() {
                let (values, out) = (&into.values, &out.values);
                wrong = Some(format!(
                    "{name}, row {at}: {values:?} -> {out:?}, not {found:?}"
                ));
            }
        }
    }
    let there: BTreeSet<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert_eq!(there, files);
    (wrong, counts)
}

/// With opacities: sides of all kinds, and every fourth voxel with solid ones.
fn with_opacities(mut graph: Graph) -> Graph {
    let opacity = (0..graph.len()).map(|i| {
        let side = |k: usize| (i * 37 + k * 101) as u8;
        Opacity([0, 1, 2].map(|k| if i % 4 == k { 255 } else { side(k) }))
    });
    graph.opacity = opacity.collect::<Vec<_>>().into();
    graph
}

/// Scenes and cameras: a sponge-like thing from outside, a fractal from near,
/// a dense cube with the eye within, near its middle.
fn scenes() -> Vec<(&'static str, Graph, Camera)> {
    let blob = octree(4, &|[x, y, z]| {
        (x * 7 + y * 5 + z * 3) % 4 < 2 && x + y > z / 2
    });
    let scenes = vec![
        (
            "blob",
            blob,
            camera([30.0, 24.0, 20.0], [8.0, 8.0, 6.0], 48),
        ),
        (
            "tetrahedra",
            sierpinski(5),
            camera([40.0, -9.0, 20.0], [16.0, 16.0, 16.0], 37),
        ),
        (
            "inside",
            octree(3, &|[x, y, z]| x != 3 && (y + z) % 5 != 2),
            camera([3.4, 3.7, 3.5], [8.0, 5.0, 4.0], 40),
        ),
        (
            "cube",
            solid(3),
            camera([11.0, 10.0, 14.0], [4.0, 4.0, 4.0], 33),
        ),
    ];
    let with_opacities = |(name, graph, camera)| (name, with_opacities(graph), camera);
    scenes.into_iter().map(with_opacities).collect()
}

fn options(coverage: Coverage, cage: CageKind, tolerance_px: f64, bits: u32) -> SetupOptions {
    SetupOptions {
        bits,
        cage,
        tolerance_px: tolerance_of(coverage, tolerance_px),
        ..SetupOptions::of(coverage)
    }
}

/// Records a frame and replays it.
fn round_trip(
    graph: &Graph,
    camera: &Camera,
    options: &SetupOptions,
    records: u64,
) -> (Option<String>, BTreeMap<String, usize>) {
    let shelter = tempfile::tempdir().unwrap();
    let folder = shelter.path().join("vectors");
    let request = Request {
        scene: "a test",
        records,
        overflow: Overflow::Trap,
        folder: &folder,
        overwrite: false,
    };
    // A colour for each node.
    let light: Vec<[u16; 3]> = (0..graph.len() as u16)
        .map(|i| [0, 1, 2].map(|c| i.wrapping_mul(40_503).rotate_left(5 * c) ^ 0x9e37))
        .collect();
    let lit = GraphView {
        light: &light,
        ..graph.view()
    };
    let recorded = vectors::write(&lit, &setup(graph, camera, options), &request).unwrap();
    let (wrong, counts) = replay_folder(&folder);
    let rows: usize = counts.values().sum();
    assert_eq!(rows as u64, recorded.rows);
    assert_eq!(
        counts.values().filter(|&&rows| rows > 0).count(),
        recorded.blocks
    );
    (wrong, counts)
}

const COVERAGES: [Coverage; 4] = [
    Coverage::Any,
    Coverage::Center,
    Coverage::Exact,
    Coverage::Alpha,
];
const CAGES: [CageKind; 2] = [CageKind::Corners, CageKind::Frame];
const TOLERANCES: [f64; 3] = [0.0, 0.125, f64::INFINITY];

/// Every row of every block, for every scene, rule, cage and tolerance, in words of 24 and of 32
/// bits.
#[test]
fn rows_are_what_the_blocks_give() {
    let mut sums: BTreeMap<String, usize> = BTreeMap::new();
    let mut frames = 0;
    for (name, graph, camera) in scenes() {
        frames += 1;
        for coverage in COVERAGES {
            for cage in CAGES {
                for tolerance in TOLERANCES {
                    if tolerance != tolerance_of(coverage, tolerance) {
                        continue;
                    }
                    // Each of the two words in turn.
                    frames += 1;
                    let bits = [24, 32][frames % 2];
                    let options = options(coverage, cage, tolerance, bits);
                    let (wrong, counts) = round_trip(&graph, &camera, &options, 150);
                    let at = format!("{name}, {coverage:?}, {cage:?}, {tolerance}, {bits}");
                    assert_eq!(wrong, None, "{at}");
                    for (block, rows) in counts {
                        *sums.entry(block).or_default() += rows;
                    }
                }
            }
        }
    }
    // None is there that nothing came to.
    for (block, rows) in sums {
        assert!(rows > 0, "{block} has no rows anywhere");
    }
}

/// Wide words too, and a level of detail.
#[test]
fn rows_of_wide_words_and_coarse_frames() {
    let (_, graph, camera) = scenes().swap_remove(0);
    for coverage in COVERAGES {
        for lod_px in [0.0, 3.0] {
            let options = SetupOptions {
                lod_px,
                aa_log2: 1,
                ..options(coverage, CageKind::Frame, 1.0 / 64.0, 64)
            };
            let (wrong, _) = round_trip(&graph, &camera, &options, 100);
            assert_eq!(wrong, None, "{coverage:?}, {lod_px}");
        }
    }
}

/// Rows by block of all scenes.
fn rows_of_all_scenes(options: &SetupOptions) -> BTreeMap<String, usize> {
    let mut sums: BTreeMap<String, usize> = BTreeMap::new();
    for (name, graph, camera) in scenes() {
        let (wrong, counts) = round_trip(&graph, &camera, options, 400);
        assert_eq!(wrong, None, "{name}");
        for (block, rows) in counts {
            *sums.entry(block).or_default() += rows;
        }
    }
    sums
}

/// Blocks that frames must come to have rows; what a rule does not have has none.
#[test]
fn blocks_have_rows_where_they_should() {
    let always = [
        "filled",
        "centre",
        "octant_order",
        "vertex_pool",
        "child_corners",
        "child_span",
        "border_clip",
        "bisector_clip",
        "near_node",
        "half_clip",
        "quadrants",
        "node_choice",
        "fill_update",
        "detail_depth",
        "size_limit",
        "size_clip",
    ];
    let of_change = ["change_depth", "to_screen_divide", "margin_grow"];
    let of_exact = [
        "child_planes",
        "plane_quadrant",
        "margin_gap",
        "cube_planes",
        "cube_front",
        "plane_side",
        "plane_cover",
    ];
    let of_blending = [
        "blend_way",
        "blend_shares",
        "blend_counts",
        "blend_weight",
        "blend_sample",
    ];
    let of_samples = ["size_screen", "border_screen", "bisector_screen"];
    let of_centres = |changes| match changes {
        true => ["cage_centre", "centre_sample"],
        false => ["cage_centre", "centre_half"],
    };
    for coverage in COVERAGES {
        for (cage, tolerance) in CAGES.into_iter().zip([0.125, 0.0]) {
            let counts = rows_of_all_scenes(&options(coverage, cage, tolerance, 32));
            let has = |blocks: &[&str], expected: bool| {
                for block in blocks {
                    let rows = counts[*block];
                    assert_eq!(rows > 0, expected, "{coverage:?} {tolerance} {block}");
                }
            };
            let exact = coverage.draws_outlines();
            let changes = !exact && tolerance > 0.0;
            has(&of_blending, coverage == Coverage::Alpha);
            has(&always, true);
            has(&of_change, changes);
            has(&of_samples, changes);
            has(&of_exact, exact);
            if coverage != Coverage::Any {
                has(&of_centres(changes), !exact);
            }
        }
    }
}

/// A file with one bit changed is found out.
#[test]
fn a_wrong_bit_is_found() {
    let files = ["vertex_pool.out", "centre.in", "node_choice.out"];
    changed_bits_are_found(
        &options(Coverage::Exact, CageKind::Corners, 0.0, 24),
        &files,
    );
}

/// Of the blocks that blend too.
#[test]
fn a_wrong_bit_of_blending_is_found() {
    let files = [
        "blend_way.out",
        "blend_shares.out",
        "blend_counts.out",
        "blend_weight.out",
        "blend_sample.out",
    ];
    changed_bits_are_found(&options(Coverage::Alpha, CageKind::Frame, 0.0, 24), &files);
}

/// Changes the second lowest bit of the last row of each file, one after the other.
fn changed_bits_are_found(options: &SetupOptions, files: &[&str]) {
    let (_, graph, camera) = scenes().swap_remove(0);
    let shelter = tempfile::tempdir().unwrap();
    let folder = shelter.path().join("vectors");
    let request = Request {
        scene: "a test",
        records: 20,
        overflow: Overflow::Trap,
        folder: &folder,
        overwrite: false,
    };
    vectors::write(&graph.view(), &setup(&graph, &camera, options), &request).unwrap();
    assert_eq!(replay_folder(&folder).0, None);
    for file in files {
        let path = folder.join(format!("{file}.hex"));
        let text = fs::read_to_string(&path).unwrap();
        let last = text
            .trim_end()
            .chars()
            .last()
            .unwrap()
            .to_digit(16)
            .unwrap();
        let digit = char::from_digit(last ^ 2, 16).unwrap();
        let mut broken = text.trim_end().to_owned();
        broken.pop();
        broken.push(digit);
        fs::write(&path, broken + "\n").unwrap();
        let (wrong, _) = replay_folder(&folder);
        let block = file.split('.').next().unwrap();
        assert!(wrong.is_some_and(|w| w.starts_with(block)), "{file}");
        fs::write(&path, text).unwrap();
    }
}

/// A block's rows, as a folder has them.
struct BlockRows {
    name: String,
    inputs: Vec<(String, u32, bool)>,
    outputs: Vec<(String, u32, bool)>,
    stimulus: Vec<Row>,
    expected: Vec<Row>,
}

fn rows_of(folder: &Path) -> (Vec<BlockRows>, Constants) {
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

/// A number with one of its bits stuck.
fn stuck(value: i128, bit: u32, at_one: bool, bits: u32, signed: bool) -> i128 {
    let changed = if at_one {
        value | 1 << bit
    } else {
        value & !(1 << bit)
    };
    let spare = 128 - bits;
    match signed {
        true => changed << spare >> spare,
        false => changed & ((1 << bits) - 1),
    }
}

/// Whether a block has a result for a row: quotients of a divide have four integer bits.
fn takes(block: &str, row: &Row) -> bool {
    block != "to_screen_divide" || {
        let (x, w) = (row.get("x"), row.get("w"));
        w > 0 && -4 * w <= x && x < 12 * w
    }
}

/// Bits of a field that are wires: of an unsigned one not those above all its values.
fn wires(rows: &[Row], at: usize, bits: u32, is_signed: bool) -> u32 {
    let values = rows.iter().map(|row| row.values[at]);
    match is_signed {
        true => bits,
        false => 128 - values.max().unwrap_or(0).leading_zeros(),
    }
}

/// Mutants of a block whose inputs or outputs have a bit stuck at 0 or at 1: how many there are, and which
/// the rows do not tell from the block.
fn stuck_mutants(block: &BlockRows, constants: &Constants) -> (usize, Vec<String>) {
    let (mut all, mut alive) = (0, Vec::new());
    for (at, (name, bits, signed)) in block.inputs.iter().enumerate() {
        let used = wires(&block.stimulus, at, *bits, *signed);
        for bit in 0..used {
            for at_one in [false, true] {
                all += 1;
                let is_killed = block
                    .stimulus
                    .iter()
                    .zip(&block.expected)
                    .any(|(row, right)| {
                        let value = stuck(row.values[at], bit, at_one, *bits, *signed);
                        if value == row.values[at] {
                            return false;
                        }
                        let mut values = row.values.clone();
                        values[at] = value;
                        let row = Row {
                            names: row.names.clone(),
                            values,
                        };
                        // An input that the block's rule does not take is found out, too.
                        !takes(&block.name, &row)
                            || replay(&block.name, &row, constants) != right.values
                    });
                if !is_killed {
                    alive.push(format!(
                        "{}: {name}[{bit}] stuck at {}",
                        block.name,
                        u8::from(at_one)
                    ));
                }
            }
        }
    }
    for (at, (name, bits, signed)) in block.outputs.iter().enumerate() {
        let used = wires(&block.expected, at, *bits, *signed);
        for bit in 0..used {
            for at_one in [false, true] {
                all += 1;
                let shows = |row: &Row| {
                    stuck(row.values[at], bit, at_one, *bits, *signed) != row.values[at]
                };
                if !block.expected.iter().any(shows) {
                    alive.push(format!(
                        "{}: {name}[{bit}] stuck at {}",
                        block.name,
                        u8::from(at_one)
                    ));
                }
            }
        }
    }
    (all, alive)
}

/// What somebody who builds a block may get wrong: the block, the fault in words, and what it gives then.
type Fault = (
    &'static str,
    &'static str,
    fn(&Row, &[i128], u32) -> Vec<i128>,
);

/// Word of `bits`: what is above it is lost.
fn wrapped(value: i128, bits: u32) -> i128 {
    value << (128 - bits) >> (128 - bits)
}

/// Faults, given a row, what is right, and the bits of a word.
const FAULTS: [Fault; 17] = [
    ("filled", "any bit will do", |row, _, _| {
        vec![i128::from(row.get("vector") != 0)]
    }),
    ("centre", "midpoints without the carry", |row, _, bits| {
        let (min, max) = (row.axes("min"), row.axes("max"));
        (0..3)
            .map(|k| wrapped(min[k] + max[k], bits) >> 1)
            .collect()
    }),
    ("centre", "midpoints towards zero", |row, _, _| {
        let (min, max) = (row.axes("min"), row.axes("max"));
        (0..3).map(|k| (min[k] + max[k]) / 2).collect()
    }),
    ("octant_order", "<= for <", |row, _, _| {
        let (centre, eye) = (row.axes("centre"), row.axes("eye_floor"));
        let octant: i128 = (0..3)
            .map(|k| i128::from(centre[k] >= eye[k]) << (2 - k))
            .sum();
        let order = [7, 6, 5, 3, 4, 2, 1, 0].map(|nearest| octant ^ nearest);
        std::iter::once(octant).chain(order).collect()
    }),
    ("octant_order", "comparison without sign", |row, _, bits| {
        let plain = |value: i128| value & ((1 << bits) - 1);
        let (centre, eye) = (row.axes("centre"), row.axes("eye_floor"));
        let above = |k: usize| i128::from(plain(centre[k]) > plain(eye[k])) << (2 - k);
        let octant: i128 = (0..3).map(above).sum();
        let order = [7, 6, 5, 3, 4, 2, 1, 0].map(|nearest| octant ^ nearest);
        std::iter::once(octant).chain(order).collect()
    }),
    ("detail_depth", "< for <=", |row, _, _| {
        vec![i128::from(row.get("w_min") > row.get("least"))]
    }),
    ("child_corners", "upper and lower exchanged", |row, _, _| {
        let (min, max, centre) = (row.axes("min"), row.axes("max"), row.axes("centre"));
        let upper = |k: usize| row.get("octant") >> k & 1 == 1;
        let low = (0..3).map(|k| if upper(k) { centre[k] } else { min[k] });
        let high = (0..3).map(|k| if upper(k) { max[k] } else { centre[k] });
        low.chain(high).collect()
    }),
    ("near_node", "< for <= at the left", |row, _, _| {
        let (x, w) = (row.cage("x"), row.cage("w"));
        vec![i128::from(
            x.with(1, &w, 1).least() > 0 && x.with(1, &w, -2).greatest() <= 0,
        )]
    }),
    ("margin_gap", "margins towards zero", |row, _, _| {
        let below = row.get("below");
        row.cage("w").each(|w| -(w / (1 << below))).0
    }),
    ("plane_quadrant", "not doubled", |row, _, _| {
        let [a, b, c] = row.plane("plane");
        let quadrant = row.get("quadrant");
        vec![c + (quadrant & 1) * a + (quadrant >> 1) * b]
    }),
    (
        "plane_quadrant",
        "columns and rows exchanged",
        |row, _, _| {
            let [a, b, c] = row.plane("plane");
            let quadrant = row.get("quadrant");
            vec![2 * c + (quadrant >> 1) * a + (quadrant & 1) * b]
        },
    ),
    ("plane_side", "ties not broken", |row, right, _| {
        let [a, b, c] = row.plane("plane");
        match row.flag("sample") && 2 * c + a + b == 0 {
            true => vec![3],
            false => right.to_vec(),
        }
    }),
    (
        "plane_side",
        "ties broken by b before a",
        |row, right, _| {
            let [a, b, c] = row.plane("plane");
            match row.flag("sample") && right[0] != 3 && 2 * c + a + b == 0 && b != 0 {
                true => vec![if b > 0 { 1 } else { 2 }],
                false => right.to_vec(),
            }
        },
    ),
    ("cube_front", "< for <= above", |row, right, _| {
        let (max, floor) = (row.axes("max"), row.axes("eye_floor"));
        match (0..3).any(|k| max[k] == floor[k]) {
            true => vec![0, 0, 0],
            false => right.to_vec(),
        }
    }),
    ("fill_update", "bits replaced, not added", |row, _, _| {
        vec![row.get("bits"), i128::from(row.get("bits") == 15)]
    }),
    (
        "node_choice",
        "full quadrants not left out",
        |row, right, _| vec![i128::from(row.get("overlapped") == 0), right[1], right[2]],
    ),
    ("size_clip", "< for <=", |row, right, _| {
        let (x, w) = (row.axes("edge_x"), row.axes("edge_w"));
        let size: i128 = (0..3).map(|k| x[k].abs().max((x[k] - w[k]).abs())).sum();
        match size == row.get("most") {
            true => vec![0],
            false => right.to_vec(),
        }
    }),
];

/// The rows of two frames tell nearly every block from its mutants, and every named fault from the block.
#[test]
fn rows_tell_blocks_from_their_mutants() {
    let (_, graph, camera) = scenes().swap_remove(0);
    let (mut all, mut alive) = (0, Vec::new());
    let mut killed = BTreeSet::new();
    for coverage in [Coverage::Exact, Coverage::Center] {
        let shelter = tempfile::tempdir().unwrap();
        let folder = shelter.path().join("vectors");
        let request = Request {
            scene: "a test",
            records: 100,
            overflow: Overflow::Trap,
            folder: &folder,
            overwrite: false,
        };
        let options = options(coverage, CageKind::Frame, 0.125, 32);
        vectors::write(&graph.view(), &setup(&graph, &camera, &options), &request).unwrap();
        let (blocks, constants) = rows_of(&folder);
        for block in &blocks {
            let (mutants, left) = stuck_mutants(block, &constants);
            all += mutants;
            alive.extend(left);
            for (at, (name, _, fault)) in FAULTS.iter().enumerate() {
                let mut rows = block.stimulus.iter().zip(&block.expected);
                let tells =
                    |(row, right): (&Row, &Row)| fault(row, &right.values, 32) != right.values;
                if block.name == *name && rows.any(tells) {
                    killed.insert(at);
                }
            }
        }
    }
    for line in &alive {
        eprintln!("alive: {line}");
    }
    let score = 100.0 * (all - alive.len()) as f64 / all as f64;
    eprintln!(
        "{} of {all} stuck bits found: {score:.1} %",
        all - alive.len()
    );
    let missed = FAULTS
        .iter()
        .enumerate()
        .filter(|(at, _)| !killed.contains(at));
    let missed: Vec<_> = missed
        .map(|(_, (block, fault, _))| format!("{block}: {fault}"))
        .collect();
    assert!(missed.is_empty(), "not found: {missed:?}");
    assert!(score >= 95.0, "{score}");
}
