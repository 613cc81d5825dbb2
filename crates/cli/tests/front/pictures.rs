//! The experiments that compare pictures, as a script meets them.

use std::fs;

use serde_json::Value;

use crate::program::{bench, folder, json_of};

const SMALL: [&str; 8] = [
    "--size",
    "24",
    "--reference-samples",
    "4",
    "--runs",
    "1",
    "--warmup",
    "0",
];

/// A line of small numbers, then some more words.
fn error_line<'l>(scene: &'l str, more: &[&'l str]) -> Vec<&'l str> {
    [&["error", scene], &SMALL[..], more].concat()
}

#[test]
fn errors_in_every_form() {
    let folder = folder();
    let more = "--coverages exact,any --tolerances 0,inf --cages frame,corners --bits 64 --aas 1,2 \
        --lods 0 --json --export-json r.json --export-svg r-{scene}.svg";
    let more: Vec<&str> = more.split(' ').collect();
    let line = error_line("gen:menger,depth=2", &more);
    let document = json_of(&bench(folder.path(), &line).success());
    assert_eq!(document["schema"], "shiftvox.bench error");
    assert_eq!(document["schema_version"], 1);
    let scene = &document["scenes"][0];
    let rows = scene["rows"].as_array().unwrap();
    // Two cages and two numbers of samples; `any` with two tolerances.
    assert_eq!(rows.len(), 2 * 2 * (1 + 2));
    let row = |name: &str| {
        let found = rows.iter().find(|row| row["method"] == name);
        &found.unwrap_or_else(|| panic!("{name}: {rows:?}"))["outcome"]
    };
    // In clip space, down to the leaves, the exact rule is the oracle.
    let exact = row("exact frame lod 0");
    for kind in ["extra", "missing", "wrong_voxel", "elsewhere"] {
        assert_eq!(exact["samples"][kind], 0, "{kind}");
    }
    assert_eq!(exact["depth_voxels"]["worst"], 0.0);
    assert!(exact["vertex_px"]["worst"].as_f64().unwrap() < 0.01);
    let number = |outcome: &Value, path: &str| outcome.pointer(path).unwrap().as_f64().unwrap();
    let (any, flip) = (row("any 0 frame lod 0"), "/picture/flip");
    assert!(number(any, "/samples/extra") > 0.0);
    assert!(number(any, "/picture/coverage/all/signed") > 0.0);
    assert!(number(any, flip) > number(exact, flip));
    // More samples, nearer to the reference, which is not nearer to itself than its noise.
    let finer = row("exact frame lod 0 aa 2");
    let light = "/picture/rms_linear";
    assert!(number(finer, light) < number(exact, light));
    assert!(number(&scene["noise_floor"], "/rms_linear") < number(exact, light));
    assert!(number(exact, "/counters/operations") > 1000.0);
    assert!(number(exact, "/wall/median_ms") > 0.0);
    assert_eq!(
        row("any inf corners lod 0")["remark"],
        "the paper's; drawn by the machine"
    );

    let file = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(
        serde_json::from_str::<Value>(&file("r.json")).unwrap(),
        document
    );
    let svg = file("r-menger-depth-2.svg");
    assert!(svg.contains("dominated") && svg.contains("operations of the machine"));

    // Nothing is replaced, and that is said before the work.
    for export in ["--export-json=r.json", "--export-svg=r-{scene}.svg"] {
        bench(folder.path(), &["error", "gen:menger,depth=2", export]).code(1);
    }
}

#[test]
fn a_format_too_narrow_is_a_row_and_not_the_end() {
    let folder = folder();
    let more = ["--bits", "64,16", "--json"];
    let line = error_line("gen:sphere,depth=6", &more);
    let document = json_of(&bench(folder.path(), &line).success());
    let rows = document["scenes"][0]["rows"].as_array().unwrap();
    let worst = |row: &Value| row["outcome"]["vertex_px"]["worst"].as_f64();
    assert!(worst(&rows[0]).unwrap() < 0.01);
    // Sixteen bits are refused, or far off.
    let narrow = &rows[1]["outcome"];
    let is_refused = narrow["refused"].is_string();
    assert!(is_refused || worst(&rows[1]).unwrap() > 0.5, "{narrow}");
}

#[test]
fn errors_do_not_depend_on_the_run() {
    let folder = folder();
    let errors = || {
        let line = error_line(
            "gen:wires,depth=4",
            &["--coverages", "exact,center", "--json"],
        );
        let document = json_of(&bench(folder.path(), &line).success());
        let rows = document["scenes"][0]["rows"].as_array().unwrap().clone();
        let lasting = |row: &Value| {
            let outcome = &row["outcome"];
            ["samples", "picture", "counters", "vertex_levels"].map(|name| outcome[name].clone())
        };
        rows.iter().map(lasting).collect::<Vec<_>>()
    };
    assert_eq!(errors(), errors());
}

#[test]
fn films_are_restless_and_more_samples_calm_them() {
    let folder = folder();
    let line = "flicker gen:sphere,depth=5 --size 20 --frames 3 --motions turntable,dolly \
        --reference-samples 4 --json --export-svg f.svg";
    let line: Vec<&str> = line.split(' ').collect();
    let document = json_of(&bench(folder.path(), &line).success());
    assert_eq!(document["schema"], "shiftvox.bench flicker");
    let films = document["films"].as_array().unwrap();
    let motions: Vec<_> = films
        .iter()
        .map(|f| f["motion"].as_str().unwrap())
        .collect();
    assert_eq!(motions, ["turntable", "dolly"]);
    for films in films {
        let seen = |name: &str| {
            let films = films["films"].as_array().unwrap();
            let film = films.iter().find(|film| film["method"] == name);
            film.unwrap_or_else(|| panic!("{name}"))["seen"]["Ok"].clone()
        };
        let [one, four] = ["exact frame", "exact frame aa 4"].map(seen);
        let flicker = |film: &Value| film["flicker"].as_f64().unwrap();
        assert!(flicker(&four) < flicker(&one), "{one} {four}");
        assert_eq!(one["flicker_by_step"].as_array().unwrap().len(), 2);
        // Without level of detail there is no cut.
        assert!(seen("exact frame lod 0")["pop"].is_null());
        assert!(one["pop"].as_f64().unwrap() >= 0.0);
    }
    let file = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(file("f.svg").contains("turntable"));
}

#[test]
fn wrong_lines_exit_with_2_or_5() {
    let folder = folder();
    let scene = "gen:menger,depth=2";
    let lines: [&[&str]; 8] = [
        &["error", scene, "--aas", "3"],
        &["error", scene, "--bits", "8"],
        &["error", scene, "--coverages", "most"],
        &["error", scene, "--engines", "rays"],
        &["error", scene, "--reference-samples", "5"],
        &["error", scene, "--export-svg", "a", "--export-json", "a"],
        &["flicker", scene, "--frames", "1"],
        &["flicker", scene, "--motions", "fly"],
    ];
    for line in lines {
        let assert = bench(folder.path(), line).code(2);
        assert!(
            !assert.get_output().stderr.is_empty(),
            "{line:?} says nothing"
        );
    }
    bench(folder.path(), &["error", scene, "--size", "8192"]).code(5);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
