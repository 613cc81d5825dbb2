//! The testbenches, run by a simulator: Icarus Verilog, where it is installed.

use std::fs;
use std::path::Path;
use std::process::Command;

use shiftvox::project::{CageKind, Coverage};

use super::{options, scenes, written};
use crate::common::setup;

/// The octant and the order of the children, by hand.
const OCTANT_ORDER: &str = include_str!("octant_order.v");

/// Runs sources in a folder of vectors; what they print, or what the compiler has against them.
fn run(folder: &Path, sources: &[&Path]) -> Result<String, String> {
    let compiled = folder.with_extension("vvp");
    let words = |out: &[u8]| String::from_utf8_lossy(out).into_owned();
    let made = Command::new("iverilog")
        .args(["-g2005", "-I"])
        .arg(folder)
        .arg("-o")
        .arg(&compiled)
        .args(sources)
        .output()
        .unwrap();
    if !made.status.success() {
        return Err(words(&made.stderr));
    }
    let ran = Command::new("vvp")
        .arg(&compiled)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(ran.status.success());
    Ok(words(&ran.stdout))
}

/// Rows that a testbench finds wrong, by its last line.
fn wrong_rows(printed: &str) -> u64 {
    let last = printed.lines().rfind(|line| line.contains("rows wrong"));
    let count = last.unwrap().split(": ").nth(1).unwrap();
    count.split(' ').next().unwrap().parse().unwrap()
}

#[test]
#[ignore = "needs iverilog"]
fn testbenches_pass_blocks_that_are_right_and_no_others() {
    let (_, graph, camera) = scenes().swap_remove(0);
    let options = options(Coverage::Exact, CageKind::Frame, 0.0, 24);
    let setup = setup(&graph, &camera, &options);
    let (shelter, folder, _) = written(&graph.view(), &setup, 100);
    let source = shelter.path().join("source.v");
    let wrong_rows_with = |text: &str, more: &[&Path]| {
        fs::write(&source, text).unwrap();
        let sources = [&[source.as_path()], more].concat();
        wrong_rows(&run(&folder, &sources).unwrap())
    };

    // The testbench of README.txt as it stands, with the block under it; then that block with faults.
    let readme = fs::read_to_string(folder.join("README.txt")).unwrap();
    let example = &readme[readme.find("module centre_tb;").unwrap()..];
    assert_eq!(wrong_rows_with(example, &[]), 0);
    for (right, fault) in [
        // Towards zero; without the carry; one axis for another.
        ("sum_y >>> 1", "sum_y / 2"),
        ("[24:0] sum_x", "[23:0] sum_x"),
        ("min_z + max_z", "min_z + max_y"),
    ] {
        assert_eq!(example.matches(right).count(), 1, "{right}");
        let wrong = wrong_rows_with(&example.replace(right, fault), &[]);
        assert!(wrong > 0, "{fault}");
    }

    // A block by hand that has its widths from parameters.vh.
    let testbench = folder.join("octant_order_tb.v");
    assert_eq!(wrong_rows_with(OCTANT_ORDER, &[&testbench]), 0);
    for (right, fault) in [
        ("eye_floor_x < centre_x", "eye_floor_x <= centre_x"),
        ("input signed", "input"),
        ("octant ^ 3'd4", "octant ^ 3'd3"),
    ] {
        assert!(OCTANT_ORDER.contains(right), "{right}");
        let wrong = wrong_rows_with(&OCTANT_ORDER.replace(right, fault), &[&testbench]);
        assert!(wrong > 0, "{fault}");
    }

    // Of every testbench the compiler misses the block alone.
    let mut benches = 0;
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        let Some(block) = name.strip_suffix("_tb.v") else {
            continue;
        };
        benches += 1;
        let missed = run(&folder, &[&path]).unwrap_err();
        let unknown = format!("error: Unknown module type: {block}\n");
        assert!(missed.contains(&unknown), "{missed}");
        assert!(
            missed.contains("\n2 error(s) during elaboration"),
            "{missed}"
        );
    }
    assert!(benches > 20);
}
