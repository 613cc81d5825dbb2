//! Proofs of the error bounds by Gappa (`spec/fast.md`, section 2). The scripts take their constants from the code.

use std::collections::HashMap;
use std::io::Write as _;
use std::process::{Command, Stdio};

use rayon::prelude::*;

use super::constants::{DIRECTION_ERROR, PRODUCT_ERROR};
use super::directions::LINE_ERROR;
use super::exact::PLANE_ERROR;
use super::lines::{CENTRE_ERROR, FARTHEST, OFFSETS};

const LINES: &str = include_str!("lines.gappa");
const DOUBLES: &str = include_str!("doubles.gappa");

/// A script with the constants of the code, one of them multiplied.
fn filled(script: &str, (changed, factor): (&str, f64)) -> String {
    let offsets = OFFSETS.iter().flat_map(|at| [at.next, at.last]).flatten();
    let constants = [
        ("LINE_ERROR", f64::from(LINE_ERROR)),
        ("FARTHEST", f64::from(FARTHEST)),
        ("CENTRE_ERROR", f64::from(CENTRE_ERROR)),
        ("OFFSET", f64::from(offsets.fold(0.0, f32::max))),
        ("DIRECTION_ERROR", DIRECTION_ERROR),
        ("PRODUCT_ERROR", PRODUCT_ERROR),
        ("PLANE_ERROR", PLANE_ERROR),
    ];
    let mut text = script.to_owned();
    for (name, value) in constants {
        let value = if name == changed {
            value * factor
        } else {
            value
        };
        // Enough digits to be exact.
        text = text.replace(&format!("{{{name}}}"), &format!("{value:.60}"));
    }
    text
}

/// Whether Gappa proves a script for each of its cases, or one: some inputs are 1, the others are 0.
fn is_proved(script: &str, change: (&str, f64), case: Option<[&str; 2]>) -> bool {
    let script = filled(script, change);
    let list = script.split("\n{ {").nth(1).unwrap();
    let list = &list[..list.find('}').unwrap()];
    // A product of an edge and a sample is multiplied by a coordinate, so both are 1.
    let of = |group: &'static str| list.split(' ').filter(move |input| group.contains(input));
    let (products, coordinates) = ("P0 P1 P2 N0 N1 N2", "B K L");
    let pairs = of(products).flat_map(|product| of(coordinates).map(move |at| [product, at]));
    let is_alone = |input: &&str| !products.contains(input) && !coordinates.contains(input);
    let alone = list.split(' ').filter(is_alone).map(|input| [input; 2]);
    let cases: Vec<[&str; 2]> =
        case.map_or_else(|| alone.chain(pairs).collect(), |case| vec![case]);
    cases.par_iter().all(|ones| {
        let value = |input| format!("{input} = {}", u8::from(ones.contains(&input)));
        let values: Vec<_> = list.split(' ').map(value).collect();
        let text = script.replace(&format!("{{{list}}}"), &values.join(" /\\ "));
        let mut gappa = Command::new("gappa");
        let gappa = gappa.stdin(Stdio::piped()).stderr(Stdio::null()).spawn();
        let mut gappa = gappa.unwrap();
        gappa
            .stdin
            .take()
            .unwrap()
            .write_all(text.as_bytes())
            .unwrap();
        gappa.wait().unwrap().success()
    })
}

#[test]
#[ignore = "needs gappa"]
fn gappa_proves_the_bounds() {
    for script in [LINES, DOUBLES] {
        assert!(is_proved(script, ("", 1.0), None));
    }
    // A bound a little smaller, or an error larger, is not proved, in the case of these inputs.
    for (script, constant, factor, case) in [
        (LINES, "LINE_ERROR", 8.0 / 9.0, ["Bl"; 2]),
        (LINES, "FARTHEST", 0.8, ["Al"; 2]),
        (LINES, "CENTRE_ERROR", 0.5, ["Qx"; 2]),
        (LINES, "OFFSET", 1.25, ["Al"; 2]),
        (LINES, "DIRECTION_ERROR", 8.0, ["Al"; 2]),
        (DOUBLES, "PLANE_ERROR", 0.25, ["P1", "K"]),
        (DOUBLES, "PRODUCT_ERROR", 0.5, ["U0"; 2]),
    ] {
        let change = (constant, factor);
        assert!(!is_proved(script, change, Some(case)), "{constant}");
    }
}

/// The values of `lines.gappa` in `f32`, from those of its variables that are no definitions, and of some that are.
pub(super) fn lines_in_floats<'n>(
    inputs: impl Iterator<Item = (&'n str, f32)>,
) -> HashMap<String, f32> {
    let script = filled(LINES, ("", 1.0));
    let definitions = script.split("\n{ ").next().unwrap().lines();
    let definitions = definitions.filter(|line| !line.starts_with('#'));
    let mut known: HashMap<_, _> = inputs
        .map(|(name, value)| (name.to_owned(), value))
        .collect();
    for definition in definitions.flat_map(|line| line.split("; ")) {
        let (name, value) = definition.split_once(" = ").unwrap_or_default();
        if let Some(value) = in_floats(value.trim_end_matches(';'), &known) {
            known.insert(name.to_owned(), value);
        }
    }
    known
}

/// An operation on two expressions, a product, a variable or a number. `None` for others.
fn in_floats(expression: &str, known: &HashMap<String, f32>) -> Option<f32> {
    let operands = expression
        .split_once('(')
        .map(|(_, rest)| rest.strip_suffix(')'));
    let Some(operands) = operands else {
        if let Some((a, b)) = expression.split_once(" * ") {
            return Some(in_floats(a, known)? * in_floats(b, known)?);
        }
        let value = known.get(expression).copied();
        return value.or_else(|| expression.parse().ok());
    };
    let mut depth = 0;
    let (a, b) = operands?.split_once(|c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        c == ',' && depth == 0
    })?;
    let (a, b) = (in_floats(a, known)?, in_floats(b.trim_start(), known)?);
    match &expression[..3] {
        "add" => Some(a + b),
        "sub" => Some(a - b),
        "mul" => Some(a * b),
        _ => None,
    }
}
