//! `bench methods`: all ways to draw a mesh, side by side.

use std::fs;
use std::path::Path;

use serde_json::Value;
use std::process::Command;

use crate::common::Run;

fn shiftvox(folder: &Path) -> Command {
    let mut command = crate::common::command();
    command.current_dir(folder);
    command
}

/// A fan of thin blades, as a Wavefront file.
fn blades() -> String {
    let mut text = String::new();
    for i in 0..40 {
        let around = f64::from(i) * 2.4;
        let (s, c) = around.sin_cos();
        let out = 0.2 + f64::from(i) * 0.02;
        let up = 1.0 + f64::from(i % 7) * 0.1;
        text += &format!(
            "v {} 0 {}\nv {} {up} {}\n",
            c * 0.1,
            s * 0.1,
            c * out,
            s * out
        );
        text += &format!("v {} 0.1 {}\n", c * 0.1 - s * 0.1, s * 0.1 + c * 0.1);
        text += "f -3 -2 -1\n";
    }
    text
}

#[test]
fn all_methods_in_all_forms() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("blades.obj"), blades()).unwrap();
    let command = "bench methods blades.obj --size 64 --least 16 --depth 6 --runs 1 --frames 2 \
        --budgets 4 --json --export-csv m.csv --export-svg m.svg --export-html m.html"
        .split(' ');
    let output = shiftvox(at).args(command).assert().success();
    let document: Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    let mesh = &document["meshes"][0];
    assert_eq!(mesh["triangles"], 40);
    let labels: Vec<&str> = mesh["facts"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| f["label"].as_str().unwrap())
        .collect();
    assert_eq!(labels.len(), 26);
    let blended = labels.iter().filter(|label| label.contains("alpha"));
    assert_eq!(blended.count(), 3, "{labels:?}");
    let distances = mesh["distances"].as_array().unwrap();
    let sizes: Vec<u64> = distances
        .iter()
        .map(|d| d["size"][1].as_u64().unwrap())
        .collect();
    assert_eq!(sizes, [64, 32, 16]);
    let near = distances[0]["distance_world"].as_f64().unwrap();
    assert!((distances[2]["distance_world"].as_f64().unwrap() / near - 4.0).abs() < 1e-9);
    for distance in distances {
        let rows = distance["rows"].as_array().unwrap();
        assert_eq!(rows.len(), labels.len());
        let outcome = |label: &str| {
            let place = labels.iter().position(|l| *l == label).unwrap();
            &rows[place]["outcome"]
        };
        let error = |label: &str| outcome(label)["picture"]["rms_linear"].as_f64().unwrap();
        let floor = distance["noise_floor"]["rms_linear"].as_f64().unwrap();
        // More samples, less error; nothing below the noise.
        assert!(error("triangles, 16") < error("triangles, 4"));
        assert!(error("triangles, 4") < error("triangles, 1"));
        for label in &labels {
            assert!(error(label) > floor, "{label}");
            assert!(outcome(label)["flicker"].as_f64().unwrap() > 0.0, "{label}");
            assert!(!outcome(label)["counters"].as_object().unwrap().is_empty());
        }
        assert!(error("decimated 1/4, 16") > error("triangles, 16"));
        assert!((error("hybrid, 16") / error("triangles, 16") - 1.0).abs() < 0.1);
        assert!((error("far six aa 4") / error("triangles, 16") - 1.0).abs() < 0.1);
        let rivals = &distance["rivals"];
        assert_eq!(rivals[2]["method"], "hybrid, 16");
        assert!(rivals[2]["ahead"].as_f64().unwrap() > -0.5);
        assert!(distance["answers"].as_array().unwrap().len() > 30);
        // So few triangles are one leaf, which far voxels draw as they are.
        assert!((error("far six") / error("triangles, 1") - 1.0).abs() < 0.01);
        assert_eq!(
            outcome("textured 16, eroded 0")["counters"]["primitives"],
            0
        );
    }
    let csv = fs::read_to_string(at.join("m.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 3 * labels.len());
    let svg = fs::read_to_string(at.join("m.svg")).unwrap();
    assert!(svg.contains("noise floor") && svg.contains("textured"));
    let html = fs::read_to_string(at.join("m.html")).unwrap();
    assert_eq!(html.matches("<img").count(), 3 * (1 + labels.len()));
    assert_eq!(html.matches("<svg").count(), 3 + 3);
    // A distance's plot stands before its pictures, its answers between.
    let first = |what: &str| html.find(what).unwrap();
    assert!(first("<svg") < first("<img") && first("at equal ms") < first("<img"));
    assert!(!html.contains("http://") || !html.contains("src=\"http"));
}

#[test]
fn heights_are_those_asked_for_on_a_generated_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let make = ["generate", "mesh:wheel,seed=3", "-o", "wheel.ply", "--json"];
    let made = shiftvox(at).args(make).assert().success();
    let made: Value = serde_json::from_slice(&made.get_output().stdout).unwrap();
    let command = "bench methods wheel.ply --heights 40,22 --frames 0 --runs 1 --warmup 0 --json \
        --only triangles,decimated,hybrid"
        .split(' ');
    let output = shiftvox(at).args(command).assert().success();
    let document: Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    let mesh = &document["meshes"][0];
    assert_eq!(mesh["triangles"], made["triangles"]);
    for (distance, height) in mesh["distances"].as_array().unwrap().iter().zip([40, 22]) {
        assert_eq!(distance["size"], serde_json::json!([height, height]));
        let bytes = |of: &str| {
            let mut rows = distance["rows"].as_array().unwrap().iter();
            let row = rows.find(|row| row["method"] == of).unwrap();
            row["outcome"]["read_bytes"].as_u64().unwrap()
        };
        assert!(bytes("decimated 1/4, 4") * 2 < bytes("triangles 4"));
        assert!(bytes("hybrid 16") < bytes("triangles 16"));
        // At 22 pixels nothing else is so small.
        let ahead = distance["rivals"][2]["ahead"].as_f64();
        assert_eq!(ahead.is_some(), height == 40);
        assert!(ahead.is_none_or(|ahead| ahead > -0.5), "{ahead:?}");
    }
    for (spec, output, code) in [
        ("mesh:bush", "b.ply", 4),
        ("mesh:tree,seed=x", "b.ply", 4),
        ("mesh:tree", "b.obj", 2),
        ("mesh:tree", "wheel.ply", 1),
    ] {
        let refused = shiftvox(at).args(["generate", spec, "-o", output]).assert();
        refused.code(code);
    }
}

#[test]
fn what_is_refused_and_what_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("blades.obj"), blades()).unwrap();
    let small = "bench methods blades.obj --size 16 --runs 1 --frames 0".split(' ');
    let some = ["--least", "16", "--only", "triangles,textured", "--json"];
    let output = shiftvox(at).args(small).args(some).assert().success();
    let document: Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    assert_eq!(document["meshes"][0]["facts"].as_array().unwrap().len(), 7);
    let outcome = &document["meshes"][0]["distances"][0]["rows"][0]["outcome"];
    assert!(outcome["flicker"].is_null());
    let cases: [(&[&str], i32); 4] = [
        (&["bench", "methods"], 2),
        (&["bench", "methods", "none.obj"], 4),
        (
            &[
                "bench",
                "methods",
                "blades.obj",
                "--size",
                "16",
                "--least",
                "32",
            ],
            2,
        ),
        (&["bench", "methods", "blades.obj", "--only", "nothing"], 2),
    ];
    for (arguments, code) in cases {
        shiftvox(at).args(arguments).assert().code(code);
    }
}
