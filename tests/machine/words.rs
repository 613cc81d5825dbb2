//! The machine computes with words alone.
//!
//! A `Word` has no operators and no way to a number but `to_host()` and, for
//! the eyes of a probe, `Wires::show()`, so an operation that no probe sees has
//! to call one of these first, or work on something that never was a word. All
//! are searched for in the machine's sources: every line with `to_host()`, every
//! line that names what `show()` fills, and every line that multiplies or
//! divides or names the host's arithmetic has to be on a list here that says
//! why it may. `Datapath::tap` takes words and gives nothing back.
//!
//! What this test can not see: comparing two words with `<` or `==`, or
//! adding and shifting plain numbers. Those are for reviews.

use std::fs;
use std::path::Path;

/// A line that may stand in a file, and why.
struct Allowed {
    file: &'static str,
    line: &'static str,
    reason: &'static str,
}

const fn allowed(file: &'static str, line: &'static str, reason: &'static str) -> Allowed {
    Allowed { file, line, reason }
}

const TO_HOST: [Allowed; 14] = [
    allowed(
        "alpha.rs",
        "*sum = plus_product(dp, LIGHT_BITS, before, light, share, WEIGHT_BITS).to_host();",
        ACCUMULATOR,
    ),
    allowed(
        "alpha.rs",
        "sample.left = rest.to_host() as u16;",
        ACCUMULATOR,
    ),
    allowed(
        "constants.rs",
        "let near_crossing = near.to_host() >> NEAR_CROSSING_SHIFT;",
        CONSTANT,
    ),
    allowed(
        "constants.rs",
        "put(8, &[c.near, c.near_crossing].map(Word::to_host));",
        REGISTER,
    ),
    allowed(
        "constants.rs",
        "put(10, &sizes.map(Word::to_host));",
        REGISTER,
    ),
    allowed(
        "constants.rs",
        "put(16, &c.origin.map(Word::to_host));",
        REGISTER,
    ),
    allowed(
        "constants.rs",
        "put(19, &c.edges.map(|edges| edges.map(Word::to_host)).concat());",
        REGISTER,
    ),
    allowed(
        "constants.rs",
        "put(13, &c.eye_ceil.map(Word::to_host));",
        REGISTER,
    ),
    allowed(
        "constants.rs",
        "put(28, &c.eye_floor.map(Word::to_host));",
        REGISTER,
    ),
    allowed("constants.rs", "let number = number.to_host();", REGISTER),
    allowed(
        "constants.rs",
        "let depths = depths.map(|depth| depth.map_or(setup.format.max(), Word::to_host));",
        REGISTER,
    ),
    allowed(
        "decide.rs",
        "let voxel = min.to_host() >> c.sub_levels;",
        "the voxel's number in the picture: what is shown, not what is computed with",
    ),
    allowed(
        "instruments/descent.rs",
        "let mut vertices = |coordinate: L| coordinate.vertices(dp).map(Word::to_host);",
        "vertices read by an experiment; nothing of it goes back",
    ),
    allowed(
        "size.rs",
        "Some(position.to_host() as u32)",
        "a finished sample position becomes an address",
    ),
];

/// Lines that show words to a probe, or could take numbers from what is shown.
const SHOWN: [Allowed; 24] = [
    allowed(
        "cage.rs",
        "use hwmodel::{Datapath, Probe, Signal, Wires, Word};",
        "for the lines below",
    ),
    allowed("cage.rs", SHOW, "a cage is its words, in order"),
    allowed("cage.rs", "self.0.show(to);", "its eight corners"),
    allowed("cage.rs", SHOW, "a cage is its words, in order"),
    allowed(
        "cage.rs",
        "(self.corner, self.edges).show(to);",
        "its corner and its edges",
    ),
    allowed(
        "instruments/mutants.rs",
        "use hwmodel::{Datapath, NoProbe, Probe, Signal, Trap, Wires, Word};",
        "for the lines below",
    ),
    allowed(
        "instruments/mutants.rs",
        SHOW,
        "a mutated cage is its words too",
    ),
    allowed(
        "instruments/mutants.rs",
        "self.0.show(to);",
        "those of the cage",
    ),
    allowed(
        "path.rs",
        "use hwmodel::{Datapath, Probe, Short, Signal, Wires};",
        "for the lines below",
    ),
    allowed("path.rs", SHOW, "an entry of the stack is its fields"),
    allowed(
        "path.rs",
        "Short::unsigned(self.left, 8).show(to);",
        "the children that are left",
    ),
    allowed("path.rs", ".show(to);", "its levels"),
    allowed("path.rs", "self.inside.show(to);", "whether it is inside"),
    allowed(
        "record.rs",
        "use hwmodel::{Short, Signal, WideWord, Wires, Word};",
        "for the lines below",
    ),
    allowed("record.rs", SHOW, RECORD),
    allowed(
        "record.rs",
        "([cube.solid, self.place.inside, in_screen_space]).show(to);",
        RECORD,
    ),
    allowed("record.rs", ".show(to);", RECORD),
    allowed(
        "record.rs",
        "Short::unsigned(cube.node, ADDRESS_BITS).show(to);",
        RECORD,
    ),
    allowed("record.rs", ".show(to);", RECORD),
    allowed("record.rs", "(cube.min, cube.max).show(to);", RECORD),
    allowed(
        "record.rs",
        "(&clip.x, &clip.y, &clip.w, clip.w_min).show(to);",
        RECORD,
    ),
    allowed(
        "record.rs",
        "(nothing, planes.edge, planes.axis_c).show(to);",
        RECORD,
    ),
    allowed(
        "record.rs",
        "(&screen.x, &screen.y, none, Word::ZERO).show(to);",
        RECORD,
    ),
    allowed(
        "record.rs",
        "(screen.spans, planes.edge, planes.axis_c).show(to);",
        RECORD,
    ),
];

const RECORD: &str = "a record is its fields, in order, where it crosses the stack's port";

const SHOW: &str = "fn show(&self, to: &mut Vec<Signal>) {";

const PRODUCTS: [Allowed; 13] = [
    allowed(
        "constants.rs",
        "let (i, j) = ((k + 1) % 3, (k + 2) % 3);",
        INDEX,
    ),
    allowed(
        "canvas.rs",
        "let at = sample.y as usize * self.frame.width as usize + sample.x as usize;",
        "where a sample lies in the host's memory",
    ),
    allowed(
        "records_by_sample.rs",
        "let (level, x, y) = (self.levels, (at % width) as u32, (at / width) as u32);",
        WORK_MAP,
    ),
    allowed(
        "records_by_sample.rs",
        "let samples = f64::from(1u32 << below) * f64::from(1u32 << below);",
        WORK_MAP,
    ),
    allowed(
        "records_by_sample.rs",
        "f64::from(self.turns[sample.ancestor(level).address()]) / samples",
        WORK_MAP,
    ),
    allowed("cage.rs", "pool[18 * i + 6 * j + 2 * k] = value;", INDEX),
    allowed("cage.rs", "let at = 3 * j + k;", INDEX),
    allowed("cage.rs", "let at = 9 * i + k;", INDEX),
    allowed("cage.rs", "let at = 9 * i + 3 * j;", INDEX),
    allowed("cage.rs", "pool[low + 9 * a + 3 * b + c]", INDEX),
    allowed(
        "planes.rs",
        "let (k, l) = ((j + 1) % 3, (j + 2) % 3);",
        INDEX,
    ),
    allowed(
        "planes.rs",
        "let (k, l) = ((j + 1) % 3, (j + 2) % 3);",
        INDEX,
    ),
    allowed(
        "planes.rs",
        "let (k, l) = ((j + 1) % 3, (j + 2) % 3);",
        INDEX,
    ),
];

/// Lines that name arithmetic which multiplies.
const HOST: [Allowed; 2] = [
    allowed(
        "constants.rs",
        "use crate::project::vector::cross;",
        "for the line below",
    ),
    allowed(
        "constants.rs",
        "cross(a.map(i128::from), b.map(i128::from)).map(|c| dp.load_wide(clamped(c)))",
        CONSTANT,
    ),
];

const REGISTER: &str = "what the host writes into the registers of the Verilog (`rtl/`)";
const CONSTANT: &str = "a constant of the frame, made by the host before the first record";
const ACCUMULATOR: &str = "what a sample has taken goes to its memory";
const INDEX: &str = "which wire, known when the machine is built";
const WORK_MAP: &str = "records per sample: computed by the host after the last record";

/// The only files that compute with the machine's numbers in another way: for measurements, and for
/// inputs of blocks. Nothing of them may reach the machine: see
/// `the_machine_does_not_know_its_instruments`.
const MEASURES: [&str; 3] = [
    "instruments/directed_blending.rs",
    "instruments/positions.rs",
    "instruments/widths.rs",
];

/// The machine's sources and its instruments', without [`MEASURES`].
fn sources() -> Vec<(String, String)> {
    let mut sources = all_sources();
    sources.retain(|(file, _)| !MEASURES.contains(&file.as_str()));
    sources
}

fn all_sources() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/machine");
    let mut sources = sources_in(&folder, "");
    sources.extend(sources_in(&folder.join("instruments"), "instruments/"));
    sources.sort();
    sources
}

fn sources_in(folder: &Path, prefix: &str) -> Vec<(String, String)> {
    fs::read_dir(folder)
        .expect("a folder of sources")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| !path.ends_with("machine/instruments"))
        .map(|path| {
            let is_source = path.extension().is_some_and(|e| e == "rs");
            assert!(is_source, "{} is not read", path.display());
            let name = path.file_name().expect("a name").to_string_lossy();
            let text = fs::read_to_string(&path).expect("a source");
            (format!("{prefix}{name}"), text)
        })
        .collect()
}

/// Lines of code that hold what `is_wanted` looks for: file and line, without
/// indentation and comments.
fn lines(sources: &[(String, String)], is_wanted: impl Fn(&str) -> bool) -> Vec<(String, String)> {
    let code = |line: &str| line.split("//").next().unwrap_or("").trim().to_owned();
    sources
        .iter()
        .flat_map(|(file, text)| text.lines().map(move |line| (file.clone(), code(line))))
        .filter(|(_, line)| is_wanted(line))
        .collect()
}

/// Whether a line multiplies, divides or takes a remainder. `cargo fmt` puts
/// a space on either side of a binary operator, and none after a dereference;
/// where it breaks a line, the operator comes first.
fn has_product(line: &str) -> bool {
    let operators = [" * ", " / ", " % ", " *= ", " /= ", " %= "];
    let methods = [
        "_mul",
        "_div",
        "_rem",
        "mul_",
        "div_",
        "rem_",
        ".mul(",
        ".div(",
        ".rem(",
        ".pow(",
        ".product(",
    ];
    // The host's names of divide steps are no divisions by the host.
    let plain = line
        .replace("divide_integer_step", "")
        .replace("divide_step", "");
    let padded = format!(" {plain} ");
    operators.iter().any(|o| padded.contains(o)) || methods.iter().any(|m| plain.contains(m))
}

fn check(found: &[(String, String)], list: &[Allowed]) {
    for entry in list {
        assert!(!entry.reason.is_empty());
    }
    let mut expected: Vec<_> = list
        .iter()
        .map(|entry| (entry.file.to_owned(), entry.line.to_owned()))
        .collect();
    for line in found {
        let at = expected.iter().position(|e| e == line);
        let Some(at) = at else {
            panic!(
                "{}: `{}` takes numbers past the datapath, or stands there once \
                 more than allowed; if it has a good reason, write it down here",
                line.0, line.1
            );
        };
        expected.swap_remove(at);
    }
    assert!(
        expected.is_empty(),
        "allowed, but not there any more: {expected:?}"
    );
}

#[test]
fn words_are_read_by_the_host_alone() {
    check(
        &lines(&sources(), |line| line.contains("to_host")),
        &TO_HOST,
    );
}

#[test]
fn the_host_s_arithmetic_makes_constants_alone() {
    let is_host = |line: &str| {
        let names = ["vector::", "cross(", "dot(", "DVec3"];
        names.iter().any(|name| line.contains(name))
    };
    check(&lines(&sources(), is_host), &HOST);
}

#[test]
fn words_are_shown_and_not_taken_back() {
    let is_shown = |line: &str| line.contains("Signal") || line.contains("show(");
    check(&lines(&sources(), is_shown), &SHOWN);
}

/// Only `mod.rs` names the instruments, to hand them on; nothing of the machine
/// imports `mod.rs`, its instruments or an upper room.
#[test]
fn the_machine_does_not_know_its_instruments() {
    let sources = all_sources();
    for measures in MEASURES {
        assert!(sources.iter().any(|(file, _)| file == measures));
    }
    for (file, line) in lines(&sources, |line| line.contains("instruments")) {
        assert_eq!(file, "mod.rs", "{line}");
    }
    let is_upwards = |line: &str| {
        let named = ["crate::lab", "crate::cli", "crate::fast", "crate::rays"];
        named.iter().any(|name| line.contains(name))
    };
    assert_eq!(lines(&sources, is_upwards), []);
    let through_mod = |line: &str| line.contains("crate::machine") || line.contains("super::{");
    // The full paths of a macro lead past it.
    let through_mod = |line: &str| through_mod(line) && !line.contains("$crate::machine::cage::");
    for (file, line) in lines(&sources, through_mod) {
        assert!(file.starts_with("instruments/"), "{file}: {line}");
    }
}

#[test]
fn nothing_is_multiplied_but_indices_and_constants() {
    check(&lines(&sources(), has_product), &PRODUCTS);
}

/// The search itself finds what it looks for.
#[test]
fn products_are_recognised() {
    for line in [
        "let a = b * c;",
        "* c",
        "a /= 2;",
        "let r = a % 3;",
        "a.wrapping_mul(b)",
        "a.rem_euclid(b)",
        "a.pow(2)",
        "std::ops::Mul::mul(a, b).div_ceil(3)",
    ] {
        assert!(has_product(line), "{line}");
    }
    for line in [
        "*v = dp.select(right, beyond, doubled);",
        "let (a, b) = (*x, &*y);",
        "let (rest, bit) = dp.divide_step(remainder, w, false);",
        "use super::smallest_node::*;",
    ] {
        assert!(!has_product(line), "{line}");
    }
}
