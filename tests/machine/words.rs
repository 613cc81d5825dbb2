//! The machine computes with words alone.
//!
//! A `Word` has no operators. Its ways to a plain number are `to_host()` and, for a probe, `Wires::show()`. So a line
//! of the machine that takes a number past the datapath holds `to_host`, a product, a quotient, or host arithmetic by
//! name. Each such line says why it may, in a comment `// host: reason`. The search cannot see comparisons, sums and
//! shifts of plain numbers.

use std::fs;
use std::path::Path;

/// Lines with a reason. Another one is a decision: change the number.
const MARKED: usize = 31;

/// The only files that compute with the machine's numbers in another way: for measurements, and for inputs of blocks.
const MEASURES: [&str; 3] = ["directed.rs", "positions.rs", "widths.rs"];

const HOST: &str = "to_host,vector::,cross(,dot(,DVec3, * , / , % , *= , /= , %= ,_mul,_div,_rem,mul_,div_,rem_,\
                    .mul(,.div(,.rem(,.pow(,.product(";

/// The machine's lines: file, code, and whether a comment gives a reason.
fn lines() -> Vec<(String, String, bool)> {
    let mut lines = Vec::new();
    for folder in ["src/machine", "src/machine/instruments"] {
        for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let text = fs::read_to_string(&path).unwrap_or_default();
            lines.extend(text.lines().map(|line| {
                let (code, comment) = line.split_once("//").unwrap_or((line, ""));
                let reason = comment.strip_prefix(" host: ").unwrap_or_default();
                let file = path.display().to_string();
                (file, code.to_owned(), !reason.is_empty())
            }));
        }
    }
    lines
}

#[test]
fn numbers_are_taken_from_words_only_for_a_reason() {
    let (mut marked, mut is_wires) = (0, false);
    for (file, code, has_reason) in lines() {
        if MEASURES.iter().any(|name| file.ends_with(name)) {
            continue;
        }
        is_wires = code.contains(" Wires for ") || is_wires && code != "}";
        let shows = code.contains("show(") || code.contains("Signal");
        let may_show = is_wires || code.starts_with("use ");
        assert!(!shows || may_show, "{file}: {code}");
        let padded = format!(" {} ", code.trim().replace("divide_", ""));
        let takes_numbers = HOST.split(',').any(|name| padded.contains(name));
        assert_eq!(takes_numbers, has_reason, "{file}: {code}");
        marked += usize::from(has_reason);
    }
    assert_eq!(marked, MARKED);
}
