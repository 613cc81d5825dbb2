//! Meshes: all formats, and all methods side by side.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{Run, sheet};
use crate::shapes::squares;

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

fn document(at: &Path, line: &str) -> Value {
    let mut command = crate::common::command();
    command.current_dir(at).args(line.split_whitespace());
    let output = command.arg("--json").assert().success();
    serde_json::from_slice(&output.get_output().stdout).unwrap()
}

#[test]
fn all_methods_at_all_distances() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("blades.obj"), blades()).unwrap();
    let line = "bench quality blades.obj --heights 64,32,16 --depth 6 --runs 1 --frames 2 \
        --motions pan --export-csv m.csv --export-svg m.svg";
    let document = document(at, line);
    let rows = document["rows"].as_array().unwrap();
    let of_height = |height: u64| {
        let of = rows.iter().filter(move |row| row["height"] == height);
        of.collect::<Vec<_>>()
    };
    // Of 40 triangles none are left of 64 or more.
    assert_eq!(of_height(64).len(), 3 + 6 + 4 + 6 + 6 + 4 + 1);
    let distance = |height| of_height(height)[0]["distance"].as_f64().unwrap();
    assert!((distance(16) / distance(64) - 4.0).abs() < 1e-9);
    for height in [64, 32, 16] {
        let rows = of_height(height);
        let row = |method: &str| {
            let mut rows = rows.iter();
            rows.find(|row| row["method"] == method)
                .unwrap_or_else(|| panic!("{method}"))
        };
        let number = |row: &Value, name: &str| row[name].as_f64().unwrap();
        let error = |method: &str| number(row(method), "rms_linear");
        // More samples, less error; nothing below the noise.
        assert!(error("triangles 16") < error("triangles 4"));
        assert!(error("triangles 4") < error("triangles 1"));
        for row in &rows[..rows.len() - 1] {
            assert!(number(row, "rms_linear") > error("noise floor"), "{row}");
            assert!(
                number(row, "flicker_pan") > 0.0 && number(row, "work") > 0.0,
                "{row}"
            );
        }
        assert!(error("decimated 1/4, 16") > error("triangles 16"));
        assert!((error("hybrid 16") / error("triangles 16") - 1.0).abs() < 0.1);
        assert!((error("far six aa 4") / error("triangles 16") - 1.0).abs() < 0.1);
        assert!(number(row("hybrid 16"), "ahead") > -0.5);
        // So few triangles are one leaf, which far voxels draw as they are.
        assert!((error("far six") / error("triangles 1") - 1.0).abs() < 0.01);
        assert_eq!(row("textured 16 eroded 0")["primitives"], 0);
        assert_eq!(row("exact frame")["scene_triangles"], 40);
    }
    let csv = fs::read_to_string(at.join("m.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + rows.len());
    let svg = fs::read_to_string(at.join("m.svg")).unwrap();
    assert!(svg.contains("noise floor") && svg.contains("textured") && svg.contains("64x64"));
}

#[test]
fn bytes_and_rivals_of_a_generated_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let made = document(at, "generate mesh:wheel,seed=3 -o wheel.ply");
    let line = "bench quality wheel.ply --heights 40,22 --runs 1 --warmup 0 --methods \
        triangles,decimated,hybrid";
    let document = document(at, line);
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows[0]["scene_triangles"], made["triangles"]);
    for height in [40, 22] {
        let row = |method: &str| {
            let same = |row: &&Value| row["method"] == method && row["height"] == height;
            rows.iter().find(same).unwrap()
        };
        let bytes = |method: &str| row(method)["read_bytes"].as_u64().unwrap();
        assert!(bytes("decimated 1/4, 4") * 2 < bytes("triangles 4"));
        assert!(bytes("hybrid 16") < bytes("triangles 16"));
        // At 22 pixels nothing else is so small.
        let ahead = row("hybrid 16")["ahead"].as_f64();
        assert_eq!(ahead.is_some(), height == 40);
        assert!(ahead.is_none_or(|ahead| ahead > -0.5), "{ahead:?}");
    }
}

#[test]
fn a_dolly_shows_where_levels_change() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("sheet.obj"), sheet(48)).unwrap();
    // From one percent nearer to the next, to half the distance.
    let line = "bench quality sheet.obj --methods far --motions dolly --depth 3 --frames 40 --size 128 \
        --zoom 0.3 --far-rays 30000 --runs 1 --warmup 0";
    let document = document(folder.path(), line);
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 3 + 1);
    for row in &rows[..3] {
        // Nodes change one after the other, each in one frame.
        let flicker = |name: &str| row[name].as_f64().unwrap();
        assert!(
            flicker("flicker_dolly_worst") > 1.5 * flicker("flicker_dolly"),
            "{row}"
        );
        assert_eq!(row["reference_samples"], 256);
    }
}

#[test]
fn every_format_is_told_by_content_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    for (i, (name, _, bytes)) in squares().into_iter().enumerate() {
        let file = format!("scene{i}.dat");
        fs::write(folder.path().join(&file), bytes).unwrap();
        let document = document(folder.path(), &format!("info {file} --depth 4"));
        let scene = &document["scenes"][0];
        assert_eq!(scene["mesh"]["triangles"], 2, "{name}");
        assert_eq!(scene["voxels"], 256, "{name}");
        // STL is customarily Z-up, all others Y-up.
        let camera = scene["camera"].as_str().unwrap();
        let mut words = camera.split([' ', ',']).skip_while(|word| *word != "--up");
        let up: Vec<f64> = words
            .by_ref()
            .skip(1)
            .take(3)
            .map(|n| n.parse().unwrap())
            .collect();
        assert_eq!(up[2] > up[1], name.starts_with("stl"), "{name}: {camera}");
    }
}
