//! `model --vectors`: folders of test vectors, as a script meets them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::stderr_of;

use crate::common::Run;

fn model(folder: &Path, more: &[&str]) -> crate::common::Assert {
    let mut command = crate::common::command();
    command.current_dir(folder);
    command.args(["model", "gen:menger,depth=2", "--size", "24"]);
    command.args(more).assert()
}

/// The files of a folder with their bytes.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    entries
        .map(|entry| {
            let name = entry.file_name().into_string().unwrap();
            (name, fs::read(entry.path()).unwrap())
        })
        .collect()
}

#[test]
fn a_folder_of_vectors() {
    let shelter = tempfile::tempdir().unwrap();
    let at = shelter.path();
    let few = ["--vectors", "made/rows", "--vector-records", "5"];
    model(at, &few).success();
    let folder = at.join("made/rows");
    let first = files(&folder);
    let manifest: Value = serde_json::from_slice(&first["manifest.json"]).unwrap();
    assert_eq!(manifest["schema"], 6);
    assert_eq!(manifest["scene"], "gen:menger,depth=2");
    assert_eq!(manifest["records"], 5);
    assert_eq!(manifest["word"]["bits"], 32);
    let blocks = manifest["blocks"].as_array().unwrap();
    let centre = blocks.iter().find(|b| b["name"] == "centre").unwrap();
    let rows = centre["rows"].as_u64().unwrap();
    // No record has more than one centre.
    assert!((1..=5).contains(&centre["frame_rows"].as_u64().unwrap()));
    assert!(rows > 5, "rows made for the block");
    assert_eq!(centre["in"]["bits"], 6 * 32);
    let text = String::from_utf8(first["centre.jsonl"].clone()).unwrap();
    assert_eq!(text.lines().count() as u64, rows);
    let row: Value = serde_json::from_str(text.lines().next().unwrap()).unwrap();
    assert_eq!(row["in"].as_str().map(str::len), Some(6 * 32 / 4));
    assert_eq!(row["out"].as_str().map(str::len), Some(3 * 32 / 4));
    // The same again is the same to the byte; more records are more rows.
    let more = ["--vectors", "more", "--vector-records", "40"];
    model(at, &["--vectors", "again", "--vector-records", "5"]).success();
    assert!(files(&at.join("again")) == first);
    model(at, &more).success();
    assert!(files(&at.join("more"))["filled.jsonl"].len() > first["filled.jsonl"].len());
    // Nothing temporary is left.
    let mut names: Vec<_> = fs::read_dir(at)
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    names.sort();
    assert_eq!(names, ["again", "made", "more"]);
}

#[test]
fn what_is_there_stays_there() {
    let shelter = tempfile::tempdir().unwrap();
    let at = shelter.path();
    let rows = ["--vectors", "rows", "--vector-records", "5"];
    let forced = [&rows[..], &["--force"]].concat();
    // An empty folder is as good as none.
    let folder = at.join("rows");
    fs::create_dir(&folder).unwrap();
    model(at, &rows).success();
    fs::write(folder.join("centre.jsonl"), b"mine").unwrap();
    let refused = model(at, &rows).code(1);
    assert!(stderr_of(&refused).contains("--force"));
    assert_eq!(files(&folder)["centre.jsonl"], b"mine");
    model(at, &forced).success();
    assert_ne!(files(&folder)["centre.jsonl"], b"mine");
    // Foreign files are kept.
    fs::write(folder.join("thesis.tex"), b"mine").unwrap();
    let refused = model(at, &forced).code(1);
    assert!(stderr_of(&refused).contains("thesis.tex"));
    assert_eq!(files(&folder)["thesis.tex"], b"mine");
    fs::write(at.join("file"), b"mine").unwrap();
    model(at, &["--vectors", "file", "--force"]).code(1);
    assert_eq!(fs::read(at.join("file")).unwrap(), b"mine");
    model(at, &["--vectors", "none", "--vector-records", "0"]).code(2);
    assert!(!at.join("none").exists());
}

/// A frame that overflows leaves no folder.
#[test]
fn a_frame_that_fails_leaves_nothing() {
    let shelter = tempfile::tempdir().unwrap();
    let at = shelter.path();
    let narrow = ["--vectors", "rows", "--bits", "16", "--frac", "12"];
    model(at, &narrow).failure();
    assert!(files(at).is_empty());
}
