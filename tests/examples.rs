//! Every program in `examples/` runs, in a folder of its own, and leaves the files that it announces.

use std::path::PathBuf;
use std::process::Command;

/// The folder of the examples that were built beside this test.
fn built() -> PathBuf {
    let mut folder = std::env::current_exe().expect("this program");
    folder.pop();
    folder.pop();
    folder.join("examples")
}

/// Runs an example in an empty folder; the files that it left, and what it printed.
fn run(name: &str) -> (Vec<String>, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let program = built().join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    assert!(
        program.exists(),
        "{}: build it with `cargo build --release --examples`",
        program.display()
    );
    let output = Command::new(program)
        .current_dir(&folder)
        .output()
        .expect("a run");
    let said = String::from_utf8(output.stdout).expect("text");
    let failed = String::from_utf8(output.stderr).expect("text");
    assert!(output.status.success(), "{name}: {said}{failed}");
    let entries = std::fs::read_dir(&folder).expect("the folder");
    let mut files: Vec<String> = entries
        .map(|entry| {
            entry
                .expect("a file")
                .file_name()
                .into_string()
                .expect("text")
        })
        .collect();
    files.sort();
    (files, said)
}

#[test]
fn a_picture() {
    let (files, said) = run("picture");
    assert_eq!(files, ["picture.png"]);
    assert!(said.contains("hash"), "{said}");
}

#[test]
fn buffers() {
    let (files, said) = run("buffers_to_numpy");
    assert_eq!(files, ["depth.npy", "normal.npy", "voxel.npy"]);
    assert!(said.contains("show a voxel"), "{said}");
}

#[test]
fn a_turntable() {
    assert_eq!(run("turntable").0.len(), 12);
}

#[test]
fn voxels_of_a_function() {
    assert_eq!(run("own_voxels").0, ["sphere.png", "sphere.vxg"]);
}

#[test]
fn engines_agree() {
    assert!(run("compare_engines").1.contains("Rays"));
}

#[test]
fn operations_and_energy() {
    assert!(run("count_operations").1.contains("uJ"));
}

#[test]
fn another_hardware() {
    assert!(run("own_hardware").1.contains("4 lanes"));
}

#[test]
fn an_order() {
    assert!(run("occlusion_order").1.contains("none out of order"));
}

/// No example is forgotten here.
#[test]
fn all_of_them() {
    let here = include_str!("examples.rs");
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|end| end == "rs") {
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            assert!(here.contains(&format!("run(\"{name}\")")), "{name}");
        }
    }
}
