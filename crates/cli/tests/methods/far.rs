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
    let measure = "bench error sheet.obj --families triangles,far --depth 3".split(' ');
    let settings = "--size 48 --runs 1 --warmup 0 --far-rays 5000 --json".split(' ');
    let output = shiftvox(at).args(measure).args(settings).assert().success();
    let document: serde_json::Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    let scene = &document["scenes"][0];
    assert_eq!(scene["reference_samples"], 256);
    let rows = scene["rows"].as_array().unwrap();
    let error = |name: &str| {
        let row = rows.iter().find(|row| row["method"] == name).unwrap();
        row["outcome"]["picture"]["rms_linear"].as_f64().unwrap()
    };
    assert_eq!(rows.len(), 3 + 6);
    assert!(error("triangles 16") < error("triangles 4"));
    assert!(error("triangles 4") < error("triangles 1"));
    assert!(error("far six") < 0.1);
    let film = "bench flicker sheet.obj --families far --motions dolly".split(' ');
    let settings = "--frames 2 --size 32 --depth 3 --far-rays 5000 --json".split(' ');
    shiftvox(at).args(film).args(settings).assert().success();
}

#[test]
fn a_dolly_shows_where_levels_change() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.obj"), sheet_of(48)).unwrap();
    // From one percent nearer to the next, to half the distance.
    let film = "bench flicker sheet.obj --families far --motions dolly --depth 3";
    let film: Vec<&str> = film.split(' ').collect();
    let settings = "--frames 40 --size 128 --zoom 0.3 --reference-samples 2 --far-rays 30000 \
        --far-lods 1 --json"
        .split(' ');
    let output = shiftvox(at).args(film).args(settings).assert().success();
    let document: serde_json::Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    let films = document["films"][0]["films"].as_array().unwrap();
    assert_eq!(films.len(), 3);
    for film in films {
        let seen = &film["seen"]["Ok"];
        let pops = seen["pop_by_step"].as_array().unwrap();
        let popped = pops
            .iter()
            .filter(|pop| pop.as_f64().unwrap() > 0.0)
            .count();
        // Nodes change one after the other; between, the other cut is the same.
        assert!(
            (1..pops.len() / 2).contains(&popped),
            "{popped} of {}",
            pops.len()
        );
        assert!(seen["pop"].as_f64().unwrap() > 1e-4, "{seen}");
    }
}
