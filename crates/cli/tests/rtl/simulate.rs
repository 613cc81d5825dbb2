//! `rtl/simulate`: from a scene to a picture.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use super::machines::{Machine, STAGE_A, STAGE_B};
use super::tools::{SHIFTVOX, rtl, run};

const TREE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/tree.vox");

/// Runs it in a folder, with the simulator of a machine or its own.
fn simulate(folder: &Path, machine: Option<&Machine>, flags: &str) -> Output {
    let mut command = Command::new(rtl().join("simulate"));
    if let Some(machine) = machine {
        command.env("SIMULATOR", machine.simulator());
    }
    let command = command.args(flags.split(' ')).env("SHIFTVOX", SHIFTVOX);
    command.current_dir(folder).output().unwrap()
}

/// Draws the tree, and compares the file with the picture of `render`.
fn draws_the_tree(machine: Option<&Machine>, stage: &str, rules: &str) {
    let shelter = tempfile::tempdir().unwrap();
    let folder = shelter.path();
    let output = simulate(folder, machine, &format!("{TREE} --size 40x24 {stage}"));
    assert!(output.status.success(), "{output:?}");
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains(" cycles\nall cycles and pixels are the model's\n"));
    let line =
        format!("{SHIFTVOX} render {TREE} --size 40x24 --bits 32 --shade flat {rules} -o flat.png");
    run(folder, &line);
    run(
        folder,
        &format!("{SHIFTVOX} compare simulated/picture.png flat.png"),
    );
}

#[test]
fn one_command_draws_a_file() {
    draws_the_tree(Some(&STAGE_A), "--stage a", "--paper --engine machine");
    draws_the_tree(Some(&STAGE_B), "--stage b", "");
}

/// With the command's own simulator, which it keeps.
#[test]
#[ignore = "takes most of a minute"]
fn one_command_writes_a_waveform() {
    let shelter = tempfile::tempdir().unwrap();
    let (folder, flags) = (shelter.path(), format!("{TREE} --size 16 --waves"));
    for flags in [flags.clone(), format!("{flags} --force")] {
        let output = simulate(folder, None, &flags);
        assert!(output.status.success(), "{output:?}");
    }
    let waves = fs::read(folder.join("simulated/waves.fst")).unwrap();
    assert!(waves.len() > 100_000, "{}", waves.len());
    assert_eq!(fs::read_dir(folder.join("simulated")).unwrap().count(), 2);
}

/// Neither replaced without `--force`, nor half-written.
#[test]
fn refusals_leave_no_files() {
    let shelter = tempfile::tempdir().unwrap();
    let folder = shelter.path();
    fs::create_dir(folder.join("simulated")).unwrap();
    fs::write(folder.join("simulated/picture.png"), "mine").unwrap();
    for (flags, code, why) in [
        ("gen:menger", 1, "picture.png exists"),
        ("no.vox -o other", 4, "no.vox"),
        ("gen:menger --size 300 -o other", 2, "256 x 256"),
        ("gen:menger --stage d", 2, "no stage"),
        ("gen:menger -o other --size", 2, "--size"),
        ("gen:menger --no -o other", 2, "--no"),
    ] {
        let output = simulate(folder, None, flags);
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(
            output.status.code() == Some(code) && told.contains(why),
            "{flags}: {told}"
        );
        assert!(!folder.join("other").exists(), "{flags}");
    }
    assert_eq!(fs::read_dir(folder.join("simulated")).unwrap().count(), 1);
    let kept = fs::read_to_string(folder.join("simulated/picture.png"));
    assert_eq!(kept.unwrap(), "mine");
}
