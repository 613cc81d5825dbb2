//! `stress` and `reproduce` as a script meets it.

use std::fs;

use serde_json::Value;

use crate::program::{run, stderr_of, stdout_of, words};

#[test]
fn a_sweep_is_told_in_every_form() {
    let folder = tempfile::tempdir().unwrap();
    let line = "stress gen:shell,depth=3 cyclic:4,1 --bits 16,32 --size 16 --rules 1 --viewpoints 0 \
        --json --export-json s.json";
    let told = run(folder.path(), &words(line)).success();
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
    let again = run(folder.path(), &words(line)).code(1);
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
fn reproduced_results_are_counted_the_same_in_every_run() {
    let folder = tempfile::tempdir().unwrap();
    // The paper's list with smaller pictures and scenes.
    let list = include_str!("../../../lab/src/reproduce.toml");
    let list = list
        .replace("512", "32")
        .replace("[64, 128, 256, 32, 1024]", "[16, 64]");
    let list = list
        .replace("menger,depth=5", "menger,depth=2")
        .replace("truss,depth=8", "truss,depth=4");
    let list = (6..=10).fold(list, |list, depth| {
        list.replace(&format!("terrain,depth={depth}"), "terrain,depth=5")
    });
    fs::write(folder.path().join("list.toml"), list).unwrap();
    let reproduced = |outdir: &str| {
        let line = ["reproduce", "list.toml", "--runs", "1", "--outdir", outdir];
        let told = stdout_of(&run(folder.path(), &line).success());
        assert!(told.contains("Table I") && told.contains("<1"), "{told}");
        let text = fs::read_to_string(folder.path().join(outdir).join("results.json")).unwrap();
        let document: Value = serde_json::from_str(&text).unwrap();
        let rows = document["rows"].as_array().unwrap().clone();
        let lasting = [
            "table",
            "scene",
            "size",
            "settings",
            "hash",
            "work",
            "operations",
            "changed",
        ];
        rows.iter()
            .map(|row| lasting.map(|name| row[name].clone()))
            .collect::<Vec<_>>()
    };
    let (one, two) = (reproduced("one"), reproduced("two"));
    assert_eq!(one, two);
    // Of the machine with everything on: two sizes, five scenes, five terrains, four scenes; twice.
    assert_eq!(
        one.iter().filter(|row| row[4].is_string()).count(),
        2 * (2 + 5 + 5 + 4)
    );
    assert!(folder.path().join("two/figures.svg").exists());
    let page = fs::read_to_string(folder.path().join("one/report.md")).unwrap();
    for part in [
        "Table I",
        "occlusion order",
        "Objects of all kinds",
        "exponent",
    ] {
        assert!(page.contains(part), "{part}");
    }
    fs::write(folder.path().join("wrong.toml"), "[[run]]\nscenes = []\n").unwrap();
    let told = stderr_of(&run(folder.path(), &["reproduce", "wrong.toml"]).code(4));
    assert!(told.contains("wrong.toml: "), "{told}");
}
