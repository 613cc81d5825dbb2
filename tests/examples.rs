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

/// Runs an example in an empty folder; returns the files that it left and its output.
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

/// Name, files that it leaves, and a part of its output.
const EXAMPLES: [(&str, &str, &str); 8] = [
    ("picture", "picture.png", "hash"),
    (
        "buffers_to_numpy",
        "depth.npy normal.npy voxel.npy",
        "show a voxel",
    ),
    ("turntable", "12", ""),
    ("own_voxels", "sphere.png sphere.vxg", ""),
    ("compare_engines", "0", "Rays"),
    ("count_operations", "0", "uJ"),
    ("own_hardware", "0", "4 lanes"),
    ("occlusion_order", "0", "none out of order"),
];

#[test]
fn every_example_runs() {
    for (name, expected, part) in EXAMPLES {
        let (files, said) = run(name);
        let is_right = files.join(" ") == expected || files.len().to_string() == expected;
        assert!(is_right, "{name}: {files:?}");
        assert!(said.contains(part), "{name}: {said}");
    }
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    let entries = std::fs::read_dir(folder).unwrap();
    let sources = entries.filter(|entry| {
        let path = entry.as_ref().unwrap().path();
        path.extension().is_some_and(|end| end == "rs")
    });
    assert_eq!(sources.count(), EXAMPLES.len());
}
