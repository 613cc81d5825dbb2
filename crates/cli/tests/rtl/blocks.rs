//! The blocks against the rows of the vectors.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use tempfile::TempDir;

use super::testbench::testbench;
use super::tools::{is_there, rtl, run, shiftvox, text};
use super::turned::turned;

/// Views: from outside, where records change to screen space; and with the eye within, where they stay.
pub(crate) const VIEWS: [&[&str]; 2] = [
    &["gen:menger,depth=3", "--size", "48"],
    &[
        "gen:menger,depth=3",
        "--size",
        "48",
        "--eye",
        "13.4,12.7,3.5",
        "--target",
        "20,14,9",
    ],
];

/// A folder of vectors of a view, its manifest, and definitions of its widths.
pub(crate) struct Rows {
    _shelter: TempDir,
    pub(crate) folder: PathBuf,
    pub(crate) manifest: Value,
    defines: [String; 3],
    is_widened: bool,
}

/// Settings of stage A, and of the blocks of exact coverage.
pub(crate) const PAPER: &[&str] = &["--paper"];
pub(crate) const EXACT: &[&str] = &["--coverage", "exact", "--cage", "frame"];
/// Rules with margins, whose blocks stage A shares.
pub(crate) const WIDENED: &[&str] = &[
    "--coverage",
    "any",
    "--cage",
    "corners",
    "--tolerance",
    "0.125",
];
/// Margins wider than a node, and words so short that sums are often equal to what they are compared with.
pub(crate) const WIDE: &[&str] = &[
    "--coverage",
    "any",
    "--cage",
    "corners",
    "--tolerance",
    "2",
    "--frac",
    "1",
];
/// Boxes that must hold a sample.
pub(crate) const CORNERS: &[&str] = &["--coverage", "exact", "--cage", "corners"];
pub(crate) const CENTRES: &[&str] = &[
    "--coverage",
    "center",
    "--cage",
    "corners",
    "--tolerance",
    "0.125",
];
/// Short words, too.
pub(crate) const SHORT: &[&str] = &["--paper", "--frac", "1"];
/// Boxes across the picture's edges.
pub(crate) const NEAR: &[&str] = &["gen:menger,depth=3", "--size", "48", "--zoom", "6"];

impl Rows {
    /// The blocks that have rows. Under a tolerance the limit of size is not one sample, which stage A's is.
    fn blocks(&self) -> impl Iterator<Item = &Value> {
        let blocks = self.manifest["blocks"].as_array().unwrap();
        blocks
            .iter()
            .filter(|block| block["rows"].as_u64() != Some(0))
            .filter(|block| !(self.is_widened && block["name"] == "size_limit"))
    }
}

pub(crate) fn rows(rules: &[&str], view: &[&str], bits: &str) -> Rows {
    let shelter = tempfile::tempdir().unwrap();
    let folder = shelter.path().join("rows");
    let rest = [
        "--bits",
        bits,
        "--vectors",
        text(&folder),
        "--vector-records",
        "60",
    ];
    shiftvox(shelter.path(), &[&["model"], view, rules, &rest].concat());
    let manifest = fs::read_to_string(folder.join("manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    let of_word = |key: &str| manifest["word"][key].as_u64().unwrap();
    let (fraction, wide) = (of_word("screen_fraction_bits"), of_word("wide_bits"));
    Rows {
        _shelter: shelter,
        defines: [
            format!("-DWORD_BITS={bits}"),
            format!("-DFRACTION_BITS={fraction}"),
            format!("-DWIDE_BITS={wide}"),
        ],
        folder,
        manifest,
        is_widened: rules.contains(&"--tolerance"),
    }
}

/// Runs blocks through their rows, their modules from the first folder that has them; how many were wrong, by block.
fn wrong_rows(rows: &Rows, folders: &[&Path]) -> BTreeMap<String, u64> {
    let has_module = |name: &str| {
        let file = format!("{name}.v");
        folders.iter().any(|folder| folder.join(&file).exists())
    };
    wrong_rows_of(rows, folders, has_module, u64::MAX)
}

/// [`wrong_rows`] of some blocks, of each at most so many rows.
pub(crate) fn wrong_rows_of(
    rows: &Rows,
    folders: &[&Path],
    is_run: impl Fn(&str) -> bool,
    most: u64,
) -> BTreeMap<String, u64> {
    let name = |block: &Value| block["name"].as_str().unwrap().to_owned();
    let run_blocks: Vec<&Value> = rows.blocks().filter(|block| is_run(&name(block))).collect();
    if run_blocks.is_empty() {
        return BTreeMap::new();
    }
    let benches: String = run_blocks
        .iter()
        .map(|block| testbench(block, most))
        .collect();
    let shelter = tempfile::tempdir().unwrap();
    let (source, compiled) = (
        shelter.path().join("rows.v"),
        shelter.path().join("rows.vvp"),
    );
    fs::write(&source, benches).unwrap();
    let rtl = rtl();
    let mut arguments = vec!["-g2012", "-I", text(&rtl), "-o", text(&compiled)];
    let folders = folders.iter().map(|folder| text(folder));
    arguments.extend(folders.flat_map(|folder| ["-y", folder, "-I", folder]));
    arguments.extend(rows.defines.iter().map(String::as_str));
    let tops: Vec<String> = run_blocks
        .iter()
        .map(|block| format!("{}_tb", name(block)))
        .collect();
    arguments.extend(tops.iter().flat_map(|top| ["-s", top]));
    arguments.push(text(&source));
    run(&rows.folder, "iverilog", &arguments);
    run(&rows.folder, "vvp", &["-n", text(&compiled)])
        .lines()
        .filter_map(|line| line.split_once(' '))
        .filter_map(|(block, wrong)| Some((block.to_owned(), wrong.parse().ok()?)))
        .collect()
}

#[test]
fn every_row_of_every_block_in_two_formats() {
    if !is_there("iverilog") {
        return;
    }
    for bits in ["24", "32"] {
        for view in VIEWS {
            let (exact, others) = (rtl().join("blocks_exact"), rtl().join("blocks"));
            let of_corners = &[&*others][..];
            let settings = [
                (PAPER, of_corners),
                (EXACT, &[&*exact, &*others]),
                (WIDENED, of_corners),
                (CENTRES, of_corners),
            ];
            // Of the last two the margins alone are new.
            let settings = settings.iter().take(if bits == "24" { 4 } else { 2 });
            for &(rules, folders) in settings {
                let rows = rows(rules, view, bits);
                let wrong = wrong_rows(&rows, folders);
                assert_eq!(wrong.len(), rows.blocks().count(), "{wrong:?}");
                assert!(wrong.len() >= 22, "{wrong:?}");
                assert!(
                    wrong.values().all(|&wrong| wrong == 0),
                    "{bits} {view:?}: {wrong:?}"
                );
            }
        }
    }
}

/// Those of stage C that undo what others did, by rows of these.
#[test]
fn every_row_turned_around() {
    if !is_there("iverilog") {
        return;
    }
    let folders = ["stage_c", "machine", "blocks_exact", "blocks"].map(|folder| rtl().join(folder));
    let folders = folders.each_ref().map(|folder| folder.as_path());
    for (bits, view) in [("24", VIEWS[0]), ("32", VIEWS[1])] {
        let wrong = wrong_rows(&turned(rows(EXACT, view, bits)), &folders);
        assert_eq!(wrong.len(), 5);
        assert!(wrong.values().all(|&wrong| wrong == 0), "{bits}: {wrong:?}");
    }
}

/// Texts of the blocks, and a fault that somebody could make in each.
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

/// A fault in each block at once: each has rows that find it. The pool's two parts are one block.
#[test]
fn a_fault_in_any_block_is_found() {
    if !is_there("iverilog") {
        return;
    }
    let all: Vec<Rows> = VIEWS.iter().map(|view| rows(PAPER, view, "32")).collect();
    // The two that other blocks consist of go one by one.
    for parts in [&["child_vertices"][..], &["midpoints"], &[]] {
        let shelter = tempfile::tempdir().unwrap();
        for file in fs::read_dir(rtl().join("blocks")).unwrap() {
            let path = file.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap();
            let mut source = fs::read_to_string(&path).unwrap();
            let is_part = ["child_vertices", "midpoints"].contains(&name);
            if let Some((_, right, fault)) = FAULTS.iter().find(|(block, ..)| *block == name) {
                assert_eq!(source.matches(right).count(), 1, "{name}: {right}");
                if parts.contains(&name) || !is_part && parts.is_empty() {
                    source = source.replace(right, fault);
                }
            }
            fs::write(shelter.path().join(format!("{name}.v")), source).unwrap();
        }
        let mut wrong: BTreeMap<String, u64> = BTreeMap::new();
        for rows in &all {
            for (block, count) in wrong_rows(rows, &[shelter.path()]) {
                *wrong.entry(block).or_default() += count;
            }
        }
        if parts.is_empty() {
            wrong.remove("vertex_pool");
            let missed: Vec<_> = wrong.iter().filter(|&(_, &wrong)| wrong == 0).collect();
            assert!(missed.is_empty(), "{missed:?}");
        } else {
            assert!(wrong["vertex_pool"] > 0, "{parts:?}");
        }
    }
}
