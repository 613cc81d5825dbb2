//! The quality of the rows: the mistakes in the text of a block that they detect.

use rayon::prelude::*;

use super::blocks::{
    BACK, CENTRES, CORNERS, EXACT, FRAMES, NEAR, OUTSIDE, PAPER, Rows, WIDENED, WITHIN,
    is_detected, rows, text_of,
};
use super::tools::{modules, words};
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
fn assert_score(names: &[String], folders: &[&str], all: &[Rows]) {
    let slips = names.iter().flat_map(|module| {
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
    let (all, missed) = (results.len(), missed.len());
    let score = 100.0 - 100.0 * missed as f64 / all as f64;
    eprintln!("{missed} of {all} mistakes not detected, {score:.1} %");
    assert!(all > 20 && score >= 95.0, "{score}");
}

/// Words so short that comparisons often have equal sides.
const SHORT: &str = "--paper --frac 1";
/// Boxes that must hold a sample.
const SAMPLES: &str = "--coverage exact --cage corners";
/// Margins wider than a node, in short words.
const WIDE: &str = "--coverage any --cage corners --tolerance 2 --frac 1";
/// Frame cages with margins have inputs that no row of exact coverage has.
const FRAME_NARROW: &str = "--coverage any --cage frame --tolerance 0.125";
const FRAME_WIDE: &str = "--coverage any --cage frame --tolerance 2 --frac 1";
const FRAME_WHOLE: &str = "--coverage any --cage frame --tolerance inf --frac 1";

#[test]
#[ignore = "takes minutes"]
fn mutation_scores() {
    // A mistake in the divide's registers may make it endless.
    let modules_in = |folder: &str| {
        let mut names = modules(folder);
        let endless = ["divide_lane", "divide_control", "to_screen_divide"];
        names.retain(|name| !endless.contains(&name.as_str()));
        names
    };
    let all = [
        rows(PAPER, OUTSIDE, "32"),
        rows(PAPER, WITHIN, "32"),
        rows(SHORT, NEAR, "16"),
        rows(WIDENED, NEAR, "24"),
        rows(WIDE, NEAR, "16"),
        rows(CENTRES, NEAR, "24"),
        rows(SAMPLES, OUTSIDE, "32"),
    ];
    assert_score(&modules_in("blocks"), CORNERS, &all);
    let all = [
        rows(EXACT, OUTSIDE, "32"),
        rows(EXACT, WITHIN, "32"),
        rows(EXACT, NEAR, "24"),
        rows(FRAME_NARROW, NEAR, "24"),
        rows(FRAME_WHOLE, NEAR, "16"),
        rows(FRAME_WIDE, NEAR, "16"),
    ];
    assert_score(&modules_in("blocks_exact"), FRAMES, &all);
    let all = [(OUTSIDE, "32"), (WITHIN, "32"), (NEAR, "24")];
    let all = all.map(|(view, bits)| turned(rows(EXACT, view, bits)));
    let back = words("grown_cage parent_cage plane_whole parent_planes whole_clip");
    let back: Vec<String> = back.into_iter().map(str::to_owned).collect();
    assert_score(&back, BACK, &all);
}
