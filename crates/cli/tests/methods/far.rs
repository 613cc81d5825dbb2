//! Experiments with far voxels.

use std::fs;
use std::path::Path;

use std::process::Command;

use crate::common::{Run, sheet as sheet_of};

fn shiftvox(folder: &Path) -> Command {
    let mut command = crate::common::command();
    command.current_dir(folder);
    command
}

#[test]
fn meshes_are_measured_against_their_triangles() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.obj"), sheet_of(12)).unwrap();
    let line = "bench quality sheet.obj --methods triangles:aa=1+2+4,far --depth 3 --size 48 --runs 1 \
        --warmup 0 --far-rays 5000 --json";
    let output = shiftvox(at).args(line.split_whitespace()).assert();
    let output = output.success();
    let document: serde_json::Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    let rows = document["rows"].as_array().unwrap();
    let error = |name: &str| {
        let row = rows.iter().find(|row| row["method"] == name);
        row.unwrap()["rms_linear"].as_f64().unwrap()
    };
    assert!(error("triangles 16") < error("triangles 4"));
    assert!(error("triangles 4") < error("triangles 1"));
    assert!(error("far six") < 0.1);
}

#[test]
fn a_dolly_shows_where_levels_change() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.obj"), sheet_of(48)).unwrap();
    // From one percent nearer to the next, to half the distance.
    let film = "bench quality sheet.obj --methods far --motions dolly --depth 3 --frames 40 --size 128 \
        --zoom 0.3 --far-rays 30000 --runs 1 --warmup 0 --json";
    let output = shiftvox(at).args(film.split_whitespace()).assert();
    let output = output.success();
    let document: serde_json::Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
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
