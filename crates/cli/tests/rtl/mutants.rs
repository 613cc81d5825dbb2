//! The quality of the rows: the mistakes in the text of a block that they detect.

use std::fs;

use rayon::prelude::*;

use super::blocks::{
    BACK, CENTRES, CORNERS, EXACT, FRAMES, NEAR, OUTSIDE, PAPER, Rows, WIDENED, WITHIN,
    is_detected, rows, text_of,
};
use super::tools::{rtl, words};
use super::turned::turned;

/// A text, and a mistake.
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

/// Lines that begin like this compute nothing.
const DECLARES: &str = "// for ( module input output localparam ` if ( function";

/// Whether the mistake makes no difference: of two numbers that are compared one is chosen, and they are equal.
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

/// All texts with one mistake, each with its line.
fn mutants(source: &str) -> Vec<(String, String)> {
    let mut mutants = Vec::new();
    let mut begun = 0;
    let declares = words(DECLARES);
    let is_code = |line: &str| {
        let line = line.trim_start();
        !declares
            .iter()
            .any(|word| *word != "(" && line.starts_with(word))
    };
    for line in source.split_inclusive('\n') {
        // Indices and comments are no arithmetic of the block.
        let code = line.split("//").next().unwrap_or_default();
        for (right, wrong) in SLIPS.iter().filter(|_| is_code(line)) {
            for (at, _) in code.match_indices(right) {
                let open = code[..at].matches('[').count() - code[..at].matches(']').count();
                if open == 0 && !chooses_of_equals(code, at, right) {
                    let (before, after) = source.split_at(begun + at);
                    let text = format!("{before}{wrong}{}", &after[right.len()..]);
                    let (left, rest) = code.split_at(at);
                    let slip = format!("{left}{wrong}{}", &rest[right.len()..]);
                    mutants.push((text, slip.trim().to_owned()));
                }
            }
        }
        begun += line.len();
    }
    mutants
}

/// Asserts that rows detect 95 % of the mistakes in these modules.
fn assert_score(modules: &[String], folders: &[&str], all: &[Rows]) {
    let slips = modules.iter().flat_map(|module| {
        let all = mutants(&text_of(module, folders)).into_iter();
        all.map(move |(text, slip)| (module, text, slip))
    });
    let slips: Vec<_> = slips.collect();
    let results: Vec<(String, bool)> = slips
        .into_par_iter()
        .filter_map(|(module, text, slip)| {
            let is_detected = is_detected(all, folders, module, &text)?;
            Some((format!("{module}: {slip}"), is_detected))
        })
        .collect();
    let missed: Vec<_> = results
        .iter()
        .filter(|(_, is_detected)| !is_detected)
        .collect();
    for (slip, _) in &missed {
        eprintln!("not detected: {slip}");
    }
    let (all, detected) = (results.len(), results.len() - missed.len());
    let score = 100.0 * detected as f64 / all as f64;
    eprintln!("{detected} of {all} mistakes detected, {score:.1} %");
    assert!(all > 20 && score >= 95.0, "{score}");
}

/// The modules of a folder. Those of the divide's registers are left out: a mistake may make it endless.
fn modules(folder: &str) -> Vec<String> {
    let files = fs::read_dir(rtl().join(folder)).unwrap();
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    let names = names.filter_map(|name| name.strip_suffix(".v").map(str::to_owned));
    let endless = ["divide_lane", "divide_control", "to_screen_divide"];
    names
        .filter(|name| !endless.contains(&name.as_str()))
        .collect()
}

/// Margins wider than a node, and words so short that comparisons often have equal sides.
const WIDE: &str = "--coverage any --cage corners --tolerance 2 --frac 1";
/// Boxes that must hold a sample.
const SAMPLES: &str = "--coverage exact --cage corners";
/// Short words, too.
const SHORT: &str = "--paper --frac 1";

#[test]
#[ignore = "takes minutes"]
fn mutation_score() {
    let all = [
        rows(PAPER, OUTSIDE, "32"),
        rows(PAPER, WITHIN, "32"),
        rows(SHORT, NEAR, "16"),
        rows(WIDENED, NEAR, "24"),
        rows(WIDE, NEAR, "16"),
        rows(CENTRES, NEAR, "24"),
        rows(SAMPLES, OUTSIDE, "32"),
    ];
    assert_score(&modules("blocks"), CORNERS, &all);
}

/// Frame cages with margins and without have inputs that no row of exact coverage has.
#[test]
#[ignore = "takes minutes"]
fn mutation_score_of_exact_coverage() {
    let any = "--coverage any --cage frame --tolerance";
    let all = [
        rows(EXACT, OUTSIDE, "32"),
        rows(EXACT, WITHIN, "32"),
        rows(EXACT, NEAR, "24"),
        rows(&format!("{any} 0.125"), NEAR, "24"),
        rows(&format!("{any} inf --frac 1"), NEAR, "16"),
        rows(&format!("{any} 2 --frac 1"), NEAR, "16"),
    ];
    assert_score(&modules("blocks_exact"), FRAMES, &all);
}

/// Blocks of stage C that undo others.
#[test]
#[ignore = "takes minutes"]
fn mutation_score_of_the_way_back() {
    let all = [(OUTSIDE, "32"), (WITHIN, "32"), (NEAR, "24")];
    let all = all.map(|(view, bits)| turned(rows(EXACT, view, bits)));
    let modules = words("grown_cage parent_cage plane_whole parent_planes whole_clip");
    let modules: Vec<String> = modules.into_iter().map(str::to_owned).collect();
    assert_score(&modules, BACK, &all);
}
