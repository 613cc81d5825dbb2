//! The quality of the rows: the mistakes in the text of a block that they detect.

use std::fs;

use rayon::prelude::*;

use super::blocks::{
    CENTRES, CORNERS, EXACT, FRAMES, NEAR, OUTSIDE, PAPER, Rows, WIDENED, WITHIN, is_detected,
};
use super::tools::{files, stem};

/// A text, and a mistake.
const SLIPS: [(&str, &str); 17] = [
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
    ("= &", "= |"),
    ("[W:1]", "[W-1:0]"),
    ("1'b1", "1'b0"),
    (" ? ", " ? ~"),
];

/// Lines that begin like this compute nothing.
const DECLARES: &str = "// for module input output localparam ` if function";

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
    for line in source.split_inclusive('\n') {
        let code = line.split("//").next().unwrap_or_default();
        let is_code = !DECLARES
            .split(' ')
            .any(|word| line.trim_start().starts_with(word));
        for (right, wrong) in SLIPS.iter().filter(|_| is_code) {
            for (at, _) in code.match_indices(right) {
                // Indices are no arithmetic of the block.
                let is_index = code[..at].matches('[').count() > code[..at].matches(']').count();
                if !is_index && !chooses_of_equals(code, at, right) {
                    let (before, after) = source.split_at(begun + at);
                    let text = format!("{before}{wrong}{}", &after[right.len()..]);
                    mutants.push((text, format!("{right} became {wrong} in {}", code.trim())));
                }
            }
        }
        begun += line.len();
    }
    mutants
}

/// The modules of a folder and their texts, except those whose registers a mistake may make endless.
fn modules(folder: &str) -> Vec<(String, String)> {
    let mut files = files(folder);
    let endless = ["divide_lane", "divide_control", "to_screen_divide"];
    files.retain(|path| !endless.contains(&stem(path)));
    let texts = files.iter().map(|path| fs::read_to_string(path).unwrap());
    files
        .iter()
        .map(|path| stem(path).to_owned())
        .zip(texts)
        .collect()
}

/// Two views of stage A suffice.
#[test]
fn a_mistake_in_any_block_is_found() {
    let rows = [OUTSIDE, WITHIN].map(|view| Rows::new(PAPER, view, 32, 60));
    let missed: Vec<String> = modules("blocks")
        .into_par_iter()
        .filter(|(module, text)| {
            let mut mutants = mutants(text).into_iter();
            !mutants.any(|(text, _)| is_detected(&rows, CORNERS, module, &text) == Some(true))
        })
        .map(|(module, _)| module)
        .collect();
    // Under its rules no margin grows. The pool's sums are in other modules.
    assert_eq!(missed, ["margin_grow", "vertex_pool"]);
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
fn rows_detect_most_mistakes() {
    let of_corners = [
        (PAPER, OUTSIDE, 32),
        (PAPER, WITHIN, 32),
        (SHORT, NEAR, 16),
        (WIDENED, NEAR, 24),
        (WIDE, NEAR, 16),
        (CENTRES, NEAR, 24),
        (SAMPLES, OUTSIDE, 32),
    ];
    let of_frames = [
        (EXACT, OUTSIDE, 32),
        (EXACT, WITHIN, 32),
        (EXACT, NEAR, 24),
        (FRAME_NARROW, NEAR, 24),
        (FRAME_WHOLE, NEAR, 16),
        (FRAME_WIDE, NEAR, 16),
    ];
    for (folder, folders, settings) in [
        ("blocks", CORNERS, &of_corners[..]),
        ("blocks_exact", FRAMES, &of_frames[..]),
    ] {
        let rows = settings
            .iter()
            .map(|(rules, view, bits)| Rows::new(rules, view, *bits, 60));
        let rows: Vec<Rows> = rows.collect();
        let modules = modules(folder);
        let mistakes = modules.iter().flat_map(|(module, text)| {
            let mutants = mutants(text).into_iter();
            mutants.map(move |(text, slip)| (module, text, slip))
        });
        let mistakes: Vec<_> = mistakes.collect();
        let results: Vec<bool> = mistakes
            .into_par_iter()
            .filter_map(|(module, text, slip)| {
                let is_detected = is_detected(&rows, folders, module, &text)?;
                if !is_detected {
                    eprintln!("not detected: {module}: {slip}");
                }
                Some(is_detected)
            })
            .collect();
        let (all, detected) = (
            results.len(),
            results.iter().filter(|&&found| found).count(),
        );
        eprintln!("{folder}: {detected} of {all} mistakes detected");
        assert!(all > 100 && detected * 100 >= all * 95);
    }
}
