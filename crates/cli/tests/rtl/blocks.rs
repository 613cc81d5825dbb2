//! The blocks against the rows of the vectors.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde_json::Value;
use tempfile::TempDir;

use super::tools::{rtl, shiftvox, text, try_run, words};
use super::turned::turned;

/// A view from outside, where records change to screen space.
pub(crate) const OUTSIDE: &str = "gen:menger,depth=3 --size 48";
/// A view from within, where they do not.
pub(crate) const WITHIN: &str = "gen:menger,depth=3 --size 48 --eye 13.4,12.7,3.5 --target 20,14,9";
/// Boxes across the picture's edges.
pub(crate) const NEAR: &str = "gen:menger,depth=3 --size 48 --zoom 6";

/// Rules of stage A, and of stages B and C.
pub(crate) const PAPER: &str = "--paper";
pub(crate) const EXACT: &str = "--coverage exact --cage frame";
/// Rules with margins, whose blocks stage A shares.
pub(crate) const WIDENED: &str = "--coverage any --cage corners --tolerance 0.125";
pub(crate) const CENTRES: &str = "--coverage center --cage corners --tolerance 0.125";

/// The folders of blocks with corners and with frames.
pub(crate) const CORNERS: &[&str] = &["blocks"];
pub(crate) const FRAMES: &[&str] = &["blocks_exact", "blocks"];
/// Those of blocks that undo others.
pub(crate) const BACK: &[&str] = &["stage_c", "machine", "blocks_exact", "blocks"];

/// A folder of vectors of a view, and its manifest.
pub(crate) struct Rows {
    _shelter: TempDir,
    pub(crate) folder: PathBuf,
    pub(crate) manifest: Value,
    is_widened: bool,
}

pub(crate) fn rows(rules: &str, view: &str, bits: &str) -> Rows {
    rows_of_records(rules, view, bits, 60)
}

pub(crate) fn rows_of_records(rules: &str, view: &str, bits: &str, records: u64) -> Rows {
    let shelter = tempfile::tempdir().unwrap();
    let folder = shelter.path().join("rows");
    let line = format!(
        "model {view} {rules} --bits {bits} --vectors {} --vector-records {records}",
        text(&folder)
    );
    shiftvox(shelter.path(), &words(&line));
    let manifest = fs::read(folder.join("manifest.json")).unwrap();
    Rows {
        _shelter: shelter,
        folder,
        manifest: serde_json::from_slice(&manifest).unwrap(),
        is_widened: rules.contains("--tolerance"),
    }
}

impl Rows {
    /// The blocks with rows. Under a tolerance, the limit of size is not one sample, which stage A's is.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = (&str, &Value)> {
        let blocks = self.manifest["blocks"].as_array().unwrap().iter();
        let blocks = blocks.filter(|block| block["rows"].as_u64() != Some(0));
        let named = blocks.map(|block| (block["name"].as_str().unwrap(), block));
        named.filter(|(name, _)| !(self.is_widened && *name == "size_limit"))
    }

    /// The word's widths, as definitions.
    fn defines(&self) -> String {
        let word = &self.manifest["word"];
        let (bits, wide, fraction) = (
            &word["bits"],
            &word["wide_bits"],
            &word["screen_fraction_bits"],
        );
        format!("-DWORD_BITS={bits} -DWIDE_BITS={wide} -DFRACTION_BITS={fraction}")
    }
}

/// A testbench of a block: `rtl/tb/rows.vh` with its macros.
pub(crate) fn testbench(name: &str, block: &Value) -> String {
    let mut connections = Vec::new();
    for (side, wire) in [("in", "row"), ("out", "result")] {
        for port in block[side]["ports"].as_array().unwrap() {
            let (name, lowest) = (port["name"].as_str().unwrap(), &port["lowest_bit"]);
            let bits = port["count"].as_u64().unwrap() * port["bits"].as_u64().unwrap();
            connections.push(format!(".{name}({wire}[{lowest} +: {bits}])"));
        }
    }
    let (mut clock, mut unclock) = ("", "");
    if name == "to_screen_divide" {
        connections.push(".clk(clk), .start(start), .last(last)".to_owned());
        (clock, unclock) = ("`define CLOCKED\n", "`undef CLOCKED\n");
    }
    let (into, out, ports) = (
        &block["in"]["bits"],
        &block["out"]["bits"],
        connections.join(", "),
    );
    format!(
        "`define BENCH {name}_tb\n`define BLOCK {name}\n`define ROWS \"{name}.jsonl\"\n`define INTO {into}\n\
         `define OUT {out}\n`define PORTS {ports}\n{clock}`include \"tb/rows.vh\"\n{unclock}"
    )
}

/// Runs blocks through their first rows, with modules from the first folder that has them. Returns the number of wrong rows
/// by block, or why the modules are not Verilog.
pub(crate) fn wrong_rows(
    rows: &Rows,
    folders: &[&Path],
    is_run: impl Fn(&str) -> bool,
    most: u64,
) -> Result<BTreeMap<String, u64>, String> {
    let blocks: Vec<_> = rows.blocks().filter(|(name, _)| is_run(name)).collect();
    if blocks.is_empty() {
        return Ok(BTreeMap::new());
    }
    let mut source = format!("`define MOST {most}\n");
    source.extend(blocks.iter().map(|(name, block)| testbench(name, block)));
    let shelter = tempfile::tempdir().unwrap();
    let [file, compiled] = ["rows.v", "rows.vvp"].map(|name| shelter.path().join(name));
    fs::write(&file, source).unwrap();
    let mut line = format!(
        "-g2012 -I {} -o {} {}",
        text(&rtl()),
        text(&compiled),
        rows.defines()
    );
    for folder in folders {
        let _ = write!(line, " -y {0} -I {0}", text(folder));
    }
    for (name, _) in &blocks {
        let _ = write!(line, " -s {name}_tb");
    }
    try_run(
        &rows.folder,
        "iverilog",
        &words(&format!("{line} {}", text(&file))),
    )?;
    let printed = try_run(&rows.folder, "vvp", &["-n", text(&compiled)])?;
    let mut wrong = BTreeMap::new();
    for (name, block) in blocks {
        let line = printed
            .lines()
            .find_map(|line| line.strip_prefix(&format!("{name}_tb: ")));
        let (count, all) = line.and_then(|line| line.split_once(" of ")).unwrap();
        let expected = block["rows"].as_u64().unwrap().min(most).to_string();
        assert_eq!(all, expected, "{name}: {printed}");
        wrong.insert(name.to_owned(), count.parse().unwrap());
    }
    Ok(wrong)
}

/// The testbenches that contain a module.
fn benches(module: &str) -> Vec<&str> {
    match module {
        "midpoints" | "child_vertices" => vec!["vertex_pool"],
        "plane_sum" | "moved_planes" => vec!["cube_planes", "child_planes"],
        "divide_step" => vec!["to_screen_divide"],
        other => vec![other],
    }
}

/// Whether rows detect another text of a module. `None`: the text is not Verilog.
pub(crate) fn is_detected(
    all: &[Rows],
    folders: &[&str],
    module: &str,
    source: &str,
) -> Option<bool> {
    let shelter = tempfile::tempdir().unwrap();
    fs::write(shelter.path().join(format!("{module}.v")), source).unwrap();
    let folders: Vec<PathBuf> = folders.iter().map(|folder| rtl().join(folder)).collect();
    let folders = std::iter::once(shelter.path()).chain(folders.iter().map(PathBuf::as_path));
    let folders: Vec<&Path> = folders.collect();
    let benches = benches(module);
    for rows in all {
        let wrong = wrong_rows(rows, &folders, |name| benches.contains(&name), 3000).ok()?;
        if wrong.values().any(|&wrong| wrong > 0) {
            return Some(true);
        }
    }
    Some(false)
}

/// The text of a module, from the first folder that has it.
pub(crate) fn text_of(module: &str, folders: &[&str]) -> String {
    let paths = folders
        .iter()
        .map(|folder| rtl().join(folder).join(format!("{module}.v")));
    let path = paths.into_iter().find(|path| path.exists());
    fs::read_to_string(path.unwrap_or_else(|| panic!("no module {module}"))).unwrap()
}

/// Asserts that all rows of all blocks are right; at least so many blocks.
fn assert_right(rows: &Rows, folders: &[&str], least: usize, what: &str) {
    let paths: Vec<PathBuf> = folders.iter().map(|folder| rtl().join(folder)).collect();
    let paths: Vec<&Path> = paths.iter().map(PathBuf::as_path).collect();
    let wrong = wrong_rows(rows, &paths, |_| true, u64::MAX >> 33).unwrap();
    assert!(wrong.len() >= least, "{what}: {wrong:?}");
    assert!(wrong.values().all(|&wrong| wrong == 0), "{what}: {wrong:?}");
}

#[test]
fn every_row_of_every_block_in_two_formats() {
    let settings = [
        (PAPER, CORNERS),
        (EXACT, FRAMES),
        (WIDENED, CORNERS),
        (CENTRES, CORNERS),
    ];
    for bits in ["24", "32"] {
        // Of the last two settings only the margins are new.
        let settings = &settings[..if bits == "24" { 4 } else { 2 }];
        for (view, (rules, folders)) in [OUTSIDE, WITHIN]
            .iter()
            .flat_map(|v| settings.iter().map(move |s| (v, s)))
        {
            let rows = rows(rules, view, bits);
            assert_right(&rows, folders, 22, &format!("{bits} {rules} {view}"));
        }
    }
}

/// Blocks of stage C that undo others, by the rows of these.
#[test]
fn every_row_turned_around() {
    for (bits, view) in [("24", OUTSIDE), ("32", WITHIN)] {
        let rows = turned(rows(EXACT, view, bits));
        assert_right(&rows, BACK, 5, bits);
    }
}

/// Modules, a text in each, and a typical mistake.
const FAULTS: [(&str, &str, &str); 26] = [
    ("filled", "&vector", "|vector"),
    ("change_depth", "w_min >= least", "w_min > least"),
    ("detail_depth", "w_min >= least", "w_min > least"),
    ("change_guard", "~|beyond_left &", "|beyond_left &"),
    ("size_limit", "w_min >>> below", "w_min >> below"),
    ("size_clip", "here >= there", "here <= there"),
    ("size_screen", "size <= limit", "size < limit"),
    ("centre", "signed [W:0]   sum", "signed [W-1:0] sum"),
    ("octant_order", "eye < middle", "eye <= middle"),
    ("midpoints", "sum = a + b", "sum = a + b + 1"),
    ("child_vertices", "9*(v/4) + 3*(v/2%2)", "9*(v/4) + 3*(v%2)"),
    (
        "child_corners",
        "octant[k] ? centre",
        "octant[2 - k] ? centre",
    ),
    ("child_span", "a <= b", "a >= b"),
    ("border_clip", "left_high < 0", "left_high <= 0"),
    ("bisector_clip", "beyond < 0", "beyond <= 0"),
    ("near_node", "~|beyond", "|beyond"),
    ("half_clip", "right ? far", "~right ? far"),
    ("border_screen", "right < low", "right <= low"),
    ("bisector_screen", "middle < high", "middle <= high"),
    (
        "quadrants",
        "{high_half_x, low_half_x}",
        "{low_half_x, high_half_x}",
    ),
    (
        "node_choice",
        "overlapped[3] | overlapped[1]",
        "overlapped[1]",
    ),
    ("cage_centre", "sum[W:1]", "sum[W-1:0]"),
    ("centre_half", "beyond >= 0", "beyond > 0"),
    ("centre_sample", "- 1'b1", "- 1'b0"),
    ("fill_update", "&after", "^after"),
    ("divide_step", "~left[W+4]", "left[W+4]"),
];

/// Every fault is detected by rows that stage A has.
#[test]
fn a_fault_in_any_block_is_found() {
    let of_paper = [OUTSIDE, WITHIN].map(|view| rows(PAPER, view, "32"));
    let missed: Vec<_> = FAULTS
        .par_iter()
        .filter(|(module, right, fault)| {
            let source = text_of(module, CORNERS);
            assert_eq!(source.matches(right).count(), 1, "{module}: {right}");
            is_detected(&of_paper, CORNERS, module, &source.replace(right, fault)) != Some(true)
        })
        .collect();
    assert!(missed.is_empty(), "{missed:?}");
}
