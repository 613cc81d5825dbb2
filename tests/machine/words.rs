//! The machine computes with words alone.
//!
//! A `Word` has no operators. Its ways to a plain number are `to_host()` and, for the eyes of a probe, `Wires::show()`.
//! So a line of the machine that takes a number past the datapath holds `to_host`, a product, a quotient, or host
//! arithmetic by name. Each such line says why it may, in a comment `// host: reason`. `show()` is called only by
//! implementations of `Wires`.
//!
//! The search cannot see comparisons, sums and shifts of plain numbers. Those are for reviews.

use std::fs;
use std::path::Path;

/// Lines with a reason. Another one is a decision: change the number.
const MARKED: usize = 29;

/// The only files that compute with the machine's numbers in another way: for measurements, and for inputs of blocks.
const MEASURES: [&str; 3] = ["directed_blending.rs", "positions.rs", "widths.rs"];

const HOST: &str = "to_host,vector::,cross(,dot(,DVec3, * , / , % , *= , /= , %= ,_mul,_div,_rem,mul_,div_,rem_,\
                    .mul(,.div(,.rem(,.pow(,.product(";

fn takes_numbers(code: &str) -> bool {
    let padded = format!(" {} ", code.trim().replace("divide_", ""));
    HOST.split(',').any(|name| padded.contains(name))
}

/// The machine's files: name and text. `instruments/` watches the machine.
fn sources() -> Vec<(String, String)> {
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/machine");
    let folders = [machine.join("instruments"), machine];
    let entries = folders
        .iter()
        .flat_map(|folder| fs::read_dir(folder).expect("a folder"));
    let files = entries
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.is_file());
    files
        .map(|path| {
            (
                path.display().to_string(),
                fs::read_to_string(path).expect("a source"),
            )
        })
        .collect()
}

#[test]
fn numbers_are_taken_from_words_only_for_a_reason() {
    let mut marked = 0;
    for (file, text) in sources() {
        if MEASURES.iter().any(|name| file.ends_with(name)) {
            continue;
        }
        let mut is_wires = false;
        for line in text.lines() {
            is_wires = line.contains(" Wires for ") || is_wires && line != "}";
            let code = line.split("//").next().unwrap_or("");
            let has_reason = line
                .split_once("// host: ")
                .is_some_and(|(_, reason)| !reason.is_empty());
            assert_eq!(takes_numbers(code), has_reason, "{file}: {line}");
            let shows = code.contains("show(") || code.contains("Signal");
            assert!(
                !shows || is_wires || code.starts_with("use "),
                "{file}: {line}"
            );
            marked += usize::from(has_reason);
        }
    }
    assert_eq!(marked, MARKED);
}

/// Only `mod.rs` names the instruments, to hand them on; the machine imports neither `mod.rs` nor an upper module.
#[test]
fn the_machine_does_not_know_its_instruments() {
    let upper = ["crate::fast", "crate::rays", "crate::picture", "crate::api"];
    for (file, text) in sources() {
        let is_instrument = file.contains("/instruments/");
        for line in text
            .lines()
            .map(|line| line.split("//").next().unwrap_or(""))
        {
            assert!(
                !line.contains("instruments") || file.ends_with("machine/mod.rs"),
                "{file}: {line}"
            );
            assert!(
                !upper.iter().any(|name| line.contains(name)),
                "{file}: {line}"
            );
            // The full paths of a macro lead past it.
            let through = line.replace("$crate::machine::cage::", "");
            let through = through.contains("crate::machine") || through.contains("super::{");
            assert!(!through || is_instrument, "{file}: {line}");
        }
    }
}

#[test]
fn numbers_are_recognised() {
    let taken = [
        "let a = b * c;",
        "* c",
        "a /= 2;",
        "a.wrapping_mul(b)",
        "a.rem_euclid(b)",
        "w.to_host()",
    ];
    let words = [
        "*v = dp.select(right, v, w);",
        "let (a, b) = (*x, &*y);",
        "dp.divide_step(r, w, false);",
    ];
    assert!(taken.iter().all(|line| takes_numbers(line)));
    assert!(!words.iter().any(|line| takes_numbers(line)));
}
