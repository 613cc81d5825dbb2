//! How good the rows of the vectors are: which slips in the text of a block they tell.

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use rayon::prelude::*;

use super::blocks::{
    CENTRES, CORNERS, EXACT, NEAR, PAPER, SHORT, VIEWS, WIDE, WIDENED, rows, wrong_rows_of,
};
use super::tools::{is_there, rtl, text};
use super::turned::turned;

/// What a text of a block may become by a slip.
const SLIPS: [(&str, &str); 16] = [
    (" + ", " - "),
    (" - ", " + "),
    (" < ", " <= "),
    (" <= ", " < "),
    (" > ", " >= "),
    (" >= ", " > "),
    (" & ", " | "),
    (" | ", " & "),
    (" == ", " != "),
    (" << ", " >> "),
    (" >>> ", " >> "),
    ("= ~|", "= |"),
    ("= ~", "= "),
    ("[W:1]", "[W-1:0]"),
    ("1'b1", "1'b0"),
    (" ? ", " ? ~"),
];

/// Whether the slip makes no difference: of two that are compared one is chosen, and they are equal.
fn chooses_of_equals(code: &str, at: usize, compare: &str) -> bool {
    let before = code[..at].rsplit(' ').next().unwrap_or_default();
    let mut after = code[at + compare.len()..].trim_end().splitn(3, ' ');
    let (Some(right), Some("?"), Some(chosen)) = (after.next(), after.next(), after.next()) else {
        return false;
    };
    let chosen: Vec<&str> = chosen.trim_end_matches(';').split(" : ").collect();
    matches!(compare, " < " | " <= " | " > " | " >= ")
        && (chosen == [before, right] || chosen == [right, before])
}

/// All ways to make one slip in a block.
fn mutants(source: &str) -> Vec<String> {
    let is_code = |line: &str| {
        let declares = [
            "//",
            "for (",
            "module",
            "input",
            "output",
            "localparam",
            "`",
            "if (",
            "function",
        ];
        !declares
            .iter()
            .any(|word| line.trim_start().starts_with(word))
    };
    let mut mutants = Vec::new();
    let mut begun = 0;
    for line in source.split_inclusive('\n') {
        // What stands in an index or behind a comment is no arithmetic of the block.
        let code = line.split("//").next().unwrap_or_default();
        for (right, wrong) in SLIPS.iter().filter(|_| is_code(line)) {
            for (at, _) in code.match_indices(right) {
                let open = code[..at].matches('[').count() - code[..at].matches(']').count();
                if open == 0 && !chooses_of_equals(code, at, right) {
                    let (before, after) = source.split_at(begun + at);
                    mutants.push(format!("{before}{wrong}{}", &after[right.len()..]));
                }
            }
        }
        begun += line.len();
    }
    mutants
}

/// Whether a block's text is Verilog: a slip may be none. Other blocks are in these folders.
fn compiles(folders: &[&str], name: &str, text_of_block: &str) -> bool {
    let shelter = tempfile::tempdir().unwrap();
    let file = shelter.path().join(format!("{name}.v"));
    fs::write(&file, text_of_block).unwrap();
    let rtl = rtl();
    let folders = folders.iter().map(|folder| rtl.join(folder));
    let folders: Vec<_> = folders.collect();
    Command::new("iverilog")
        .args([
            "-g2012",
            "-t",
            "null",
            "-DWORD_BITS=32",
            "-DFRACTION_BITS=16",
        ])
        .args(["-DWIDE_BITS=64", "-I", text(&rtl)])
        .args(folders.iter().flat_map(|folder| ["-y", text(folder)]))
        .args(folders.iter().flat_map(|folder| ["-I", text(folder)]))
        .arg(&file)
        .output()
        .unwrap()
        .status
        .success()
}

/// The testbenches' mutation score. Blocks have their first slip at once, then their second, ...
#[test]
#[ignore = "takes minutes"]
fn mutation_score() {
    if !is_there("iverilog") {
        return;
    }
    let all = [
        rows(PAPER, VIEWS[0], "32"),
        rows(PAPER, VIEWS[1], "32"),
        rows(SHORT, NEAR, "16"),
        rows(WIDENED, NEAR, "24"),
        rows(WIDE, NEAR, "16"),
        rows(CENTRES, NEAR, "24"),
        rows(CORNERS, VIEWS[0], "32"),
    ];
    let mut sources = BTreeMap::new();
    // By testbench: file and text.
    let mut slips: BTreeMap<&str, Vec<(String, String)>> = BTreeMap::new();
    for file in fs::read_dir(rtl().join("blocks")).unwrap() {
        let path = file.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let source = fs::read_to_string(&path).unwrap();
        let bench = match name.as_str() {
            "midpoints" | "child_vertices" => "vertex_pool",
            "divide_step" => "to_screen_divide",
            // Registers and counters of the divide: a slip may make it endless.
            "divide_lane" | "divide_control" | "to_screen_divide" => "",
            other => other,
        };
        if !bench.is_empty() {
            let mutants = mutants(&source)
                .into_iter()
                .filter(|text| compiles(&["blocks"], &name, text))
                .map(|text| (name.clone(), text));
            slips
                .entry(bench.to_owned().leak())
                .or_default()
                .extend(mutants);
        }
        sources.insert(name, source);
    }
    let rounds = slips.values().map(Vec::len).max().unwrap();
    let results: Vec<(String, bool)> = (0..rounds)
        .into_par_iter()
        .flat_map(|round| {
            let shelter = tempfile::tempdir().unwrap();
            let mut texts = sources.clone();
            let mut under_test = BTreeMap::new();
            for (bench, slips) in &slips {
                if let Some((file, text)) = slips.get(round) {
                    texts.insert(file.clone(), text.clone());
                    under_test.insert(*bench, (file, text));
                }
            }
            for (name, text) in &texts {
                fs::write(shelter.path().join(format!("{name}.v")), text).unwrap();
            }
            let mut wrong: BTreeMap<String, u64> = BTreeMap::new();
            for rows in &all {
                for (block, count) in wrong_rows_of(
                    rows,
                    &[shelter.path()],
                    |name| under_test.contains_key(name),
                    3000,
                ) {
                    *wrong.entry(block).or_default() += count;
                }
            }
            under_test
                .into_iter()
                .map(|(bench, (file, text))| {
                    let is_found = wrong.get(bench).is_some_and(|&count| count > 0);
                    (slip_in(file, text, &sources[file]), is_found)
                })
                .collect::<Vec<_>>()
        })
        .collect();
    assert_score(&results);
}

/// What a slip made of a line.
fn slip_in(file: &str, text: &str, right: &str) -> String {
    let lines = text.lines().zip(right.lines());
    let slip: String = lines
        .filter(|(slip, right)| slip != right)
        .map(|(slip, _)| slip.trim())
        .collect();
    format!("{file}: {slip}")
}

/// Slips, and whether each was found: 95 % must be.
fn assert_score(results: &[(String, bool)]) {
    let missed: Vec<_> = results.iter().filter(|(_, is_found)| !is_found).collect();
    for (slip, _) in &missed {
        eprintln!("not found: {slip}");
    }
    let all = results.len();
    let found = all - missed.len();
    eprintln!(
        "{found} of {all} slips found, {:.1} %",
        100.0 * found as f64 / all as f64
    );
    assert!(found * 100 >= all * 95);
}

/// Frame cages with margins and without, for the inputs that no row of exact coverage has.
const FRAMES: &[&str] = &[
    "--coverage",
    "any",
    "--cage",
    "frame",
    "--tolerance",
    "0.125",
];
const FRAMES_SHORT: &[&str] = &[
    "--coverage",
    "any",
    "--cage",
    "frame",
    "--tolerance",
    "inf",
    "--frac",
    "1",
];
const FRAMES_WIDE: &[&str] = &[
    "--coverage",
    "any",
    "--cage",
    "frame",
    "--tolerance",
    "2",
    "--frac",
    "1",
];

/// The same of the blocks of exact coverage, a slip at a time.
#[test]
#[ignore = "takes minutes"]
fn mutation_score_of_exact_coverage() {
    if !is_there("iverilog") {
        return;
    }
    let all = [
        rows(EXACT, VIEWS[0], "32"),
        rows(EXACT, VIEWS[1], "32"),
        rows(EXACT, NEAR, "24"),
        rows(FRAMES, NEAR, "24"),
        rows(FRAMES_SHORT, NEAR, "16"),
        rows(FRAMES_WIDE, NEAR, "16"),
    ];
    let (exact, others) = (rtl().join("blocks_exact"), rtl().join("blocks"));
    let mut slips = Vec::new();
    for file in fs::read_dir(&exact).unwrap() {
        let path = file.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let right = fs::read_to_string(&path).unwrap();
        for text in mutants(&right) {
            if compiles(&["blocks_exact"], &name, &text) {
                slips.push((name.clone(), text, right.clone()));
            }
        }
    }
    let results: Vec<(String, bool)> = slips
        .par_iter()
        .map(|(name, text, right)| {
            let benches: &[&str] = match name.as_str() {
                "midpoints" | "child_vertices" => &["vertex_pool"],
                "plane_sum" | "moved_planes" => &["cube_planes", "child_planes"],
                other => &[other],
            };
            let shelter = tempfile::tempdir().unwrap();
            fs::write(shelter.path().join(format!("{name}.v")), text).unwrap();
            let folders = [shelter.path(), &exact, &others];
            let is_found = all.iter().any(|rows| {
                let wrong = wrong_rows_of(rows, &folders, |block| benches.contains(&block), 3000);
                wrong.values().any(|&wrong| wrong > 0)
            });
            (slip_in(name, text, right), is_found)
        })
        .collect();
    assert_score(&results);
}

/// The same of the blocks of stage C that undo what others did.
#[test]
#[ignore = "takes minutes"]
fn mutation_score_of_the_way_back() {
    if !is_there("iverilog") {
        return;
    }
    let all = [
        turned(rows(EXACT, VIEWS[0], "32")),
        turned(rows(EXACT, VIEWS[1], "32")),
        turned(rows(EXACT, NEAR, "24")),
    ];
    const FOLDERS: [&str; 4] = ["stage_c", "machine", "blocks_exact", "blocks"];
    let folders = FOLDERS.map(|folder| rtl().join(folder));
    let mut slips = Vec::new();
    for name in [
        "grown_cage",
        "parent_cage",
        "plane_whole",
        "parent_planes",
        "whole_clip",
    ] {
        let file = format!("{name}.v");
        let at = folders.iter().find(|folder| folder.join(&file).exists());
        let right = fs::read_to_string(at.unwrap().join(&file)).unwrap();
        for text in mutants(&right) {
            if compiles(&FOLDERS, name, &text) {
                slips.push((name, text, right.clone()));
            }
        }
    }
    let results: Vec<(String, bool)> = slips
        .par_iter()
        .map(|(name, text, right)| {
            let shelter = tempfile::tempdir().unwrap();
            fs::write(shelter.path().join(format!("{name}.v")), text).unwrap();
            let rest = folders.iter().map(|folder| folder.as_path());
            let folders: Vec<_> = [shelter.path()].into_iter().chain(rest).collect();
            let is_found = all.iter().any(|rows| {
                let wrong = wrong_rows_of(rows, &folders, |block| block == *name, 3000);
                wrong.values().any(|&wrong| wrong > 0)
            });
            (slip_in(name, text, right), is_found)
        })
        .collect();
    assert_score(&results);
}
