//! Every program in `examples/` runs, in a folder of its own, and leaves the files that it announces.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// The names of a folder's files.
fn files(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.expect("a file").file_name();
    entries
        .map(|entry| name(entry).into_string().expect("text"))
        .collect()
}

/// Name, files that it leaves, and a part of its output.
const EXAMPLES: [(&str, &str, &str); 8] = [
    (
        "buffers_to_numpy",
        "depth.npy normal.npy voxel.npy",
        "show a voxel",
    ),
    ("compare_engines", "", "Rays"),
    ("count_operations", "", "uJ"),
    ("occlusion_order", "", "none out of order"),
    ("own_hardware", "", "4 lanes"),
    ("own_voxels", "sphere.png sphere.vxg", ""),
    ("picture", "picture.png", "hash"),
    ("turntable", "12 files", ""),
];

#[test]
fn every_example_runs() {
    let this = std::env::current_exe().expect("this program");
    let built = this.ancestors().nth(2).expect("a folder").join("examples");
    for (name, expected, part) in EXAMPLES {
        let folder = tempfile::tempdir().expect("a folder");
        let program = built.join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
        let output = Command::new(program).current_dir(&folder).output();
        let output = output.expect("build it with `cargo build --release --examples`");
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(
            output.status.success() && said.contains(part),
            "{name}: {output:?}"
        );
        let left = files(folder.path());
        let is_right = match expected.strip_suffix(" files") {
            Some(count) => left.len().to_string() == count,
            None => left.iter().eq(expected.split_whitespace()),
        };
        assert!(is_right, "{name}: {left:?}");
    }
    let sources = files(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples")));
    assert!(
        sources
            .into_iter()
            .eq(EXAMPLES.map(|(name, ..)| format!("{name}.rs")))
    );
}
