//! `stress` and `reproduce` as a script meets it.

use std::fs;

use serde_json::Value;

use crate::program::{run, stderr_of, stdout_of};

#[test]
fn a_sweep_is_told_in_every_form() {
    let folder = tempfile::tempdir().unwrap();
    let line = "stress gen:shell,depth=3 cyclic:4,1 --bits 16,32 --size 16 --rules 1 --viewpoints 0 \
        --json --export-json s.json";
    let line: Vec<&str> = line.split(' ').collect();
    let told = run(folder.path(), &line).success();
    let document: Value = serde_json::from_str(&stdout_of(&told)).unwrap();
    assert_eq!(document["schema"], "shiftvox.stress");
    // Two scenes, thirteen viewpoints, two widths with three fractions each.
    assert_eq!(document["total"]["cases"], 2 * 13 * 2 * 3);
    assert_eq!(document["total"]["failed"], 0);
    assert!(document["vertices"].as_array().unwrap().len() > 1);
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(
        serde_json::from_str::<Value>(&read("s.json")).unwrap(),
        document
    );
    // Nothing is replaced unasked.
    let again = run(folder.path(), &line).code(1);
    assert!(stderr_of(&again).contains("--force"));
}

#[test]
fn one_case_is_told_and_a_wrong_one_refused() {
    let folder = tempfile::tempdir().unwrap();
    let case = "scene=gen:shell,depth=3;eye=20,-9,7;target=4,4,4;bits=32;tolerance=0";
    let told = run(folder.path(), &["stress", "--case", case]).success();
    let text = stdout_of(&told);
    assert!(
        text.contains("drawn with") && text.contains("0 extra, 0 missing"),
        "{text}"
    );
    assert!(text.contains("clip space, both cages"), "{text}");
    let wrong = run(folder.path(), &["stress", "--case", "scene=ball"]).code(2);
    assert!(
        stderr_of(&wrong).contains("is no scene"),
        "{}",
        stderr_of(&wrong)
    );
    run(folder.path(), &["stress", "--case", case, "--thorough"]).code(2);
    run(folder.path(), &["stress", "--bits", "65"]).code(2);
}

#[test]
fn the_papers_results_are_counted_the_same_in_every_run() {
    let folder = tempfile::tempdir().unwrap();
    let line = [
        "reproduce",
        "--sides",
        "16,32",
        "--object-side",
        "32",
        "--runs",
        "1",
        "--growing",
        "gen:terrain,depth=5;gen:terrain,depth=6",
        "--outdir",
    ];
    let reproduced = |outdir: &str| {
        let assert = run(folder.path(), &[&line[..], &[outdir]].concat()).success();
        assert!(stdout_of(&assert).contains("Table I"));
        let text = fs::read_to_string(folder.path().join(outdir).join("results.json")).unwrap();
        serde_json::from_str::<Value>(&text).unwrap()
    };
    let (one, two) = (reproduced("one"), reproduced("two"));
    assert!(folder.path().join("two/figures.svg").exists());
    // A simple scene at two sizes, and six more at one of them; the paper's settings and the default ones.
    assert_eq!(one["evidence"].as_array().unwrap().len(), 2 * (2 + 6));
    assert_eq!(one["evidence"], two["evidence"]);
    let page = fs::read_to_string(folder.path().join("one/report.md")).unwrap();
    for part in ["Table I", "occlusion order", "Objects at one size"] {
        assert!(page.contains(part), "{part}");
    }
}
