//! Mistakes in a machine: a small frame is then not drawn as the reference machine draws it.

use std::fs;

use rayon::prelude::*;
use shiftvox::graph::vxg;
use tempfile::TempDir;

use super::frames::tree_with_larger_solids;
use super::machines::{Expected, LANES, Machine, STAGE_A, STAGE_B, STAGE_C, STAGE_C_BRICKS};
use super::tools::{files, icarus, run, stem};

static TWO_LANES: Machine = Machine::new("stage_c", "LANES=2 CONTEXTS=2 TILE_LEVELS=2 BRICKS=1");

fn machine_of(name: &str) -> &'static Machine {
    match name {
        "stage_a" => &STAGE_A,
        "stage_b" => &STAGE_B,
        "stage_c" => &STAGE_C,
        "stage_c_bricks" => &STAGE_C_BRICKS,
        "four_lanes" => &LANES[3],
        "four_contexts" => &LANES[6],
        "two_lanes" => &TWO_LANES,
        other => panic!("no machine {other}"),
    }
}

/// A folder with a file of these folders that has a line's mistake.
fn mistaken(folders: &str, line: &str) -> TempDir {
    let parts = line.split('"').map(|part| part.replace("\\n", "\n"));
    let [name, right, _, fault, _] = &parts.collect::<Vec<_>>()[..] else {
        panic!("{line}");
    };
    let files = files(folders);
    let path = files.iter().find(|path| stem(path) == name.trim()).unwrap();
    let source = fs::read_to_string(path).unwrap();
    assert_eq!(source.matches(right).count(), 1, "{line}");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(path.file_name().unwrap());
    fs::write(file, source.replace(right, fault)).unwrap();
    folder
}

/// Draws the small frame of a section in Icarus Verilog: as it is, and with each mistake.
fn faults_are_found(machine: &Machine, view: &str, lines: &[&str]) {
    let shelter = tempfile::tempdir().unwrap();
    let file = shelter.path().join("solids.vxg");
    vxg::write(&tree_with_larger_solids(3), &file, true).unwrap();
    let view = view.replace("SOLIDS", file.to_str().unwrap());
    let expected = Expected::new(machine, &view, None);
    let compiled = shelter.path().join("frame.vvp");
    let draw = |folders: &str| {
        icarus(folders, machine.testbench(), machine.parameters, &compiled);
        expected.compare_in_icarus(&compiled, 2 * expected.cycles)
    };
    draw(machine.folders()).unwrap_or_else(|error| panic!("{view}: {error}"));
    for line in lines {
        let modules = mistaken(machine.folders(), line);
        let folders = format!("{} {}", modules.path().display(), machine.folders());
        assert!(draw(&folders).is_err(), "{line}");
    }
}

/// Tests the sections of a set, and returns the number of mistakes.
fn faults_of_set_are_found(set: &str) -> usize {
    let lines = include_str!("faults.txt").lines();
    let lines: Vec<&str> = lines
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .collect();
    let mut sections: Vec<_> = lines.chunk_by(|_, next| !next.starts_with('[')).collect();
    sections.retain(|section| section[0].starts_with(&format!("[{set} ")));
    let count = |section: &[&str]| {
        let (head, view) = section[0].split_once("] ").unwrap();
        let (_, machine) = head.split_once(' ').unwrap();
        faults_are_found(machine_of(machine), view, &section[1..]);
        section.len() - 1
    };
    sections.into_par_iter().map(count).sum()
}

#[test]
fn faults_of_every_machine_are_found() {
    assert_eq!(faults_of_set_are_found("short"), 12);
}

#[test]
#[ignore = "takes minutes"]
fn more_faults_are_found() {
    assert_eq!(faults_of_set_are_found("long"), 72);
}

#[test]
fn an_arbiter_serves_who_came_first() {
    let shelter = tempfile::tempdir().unwrap();
    let is_right = |folders: &str| {
        let compiled = shelter.path().join("tb.vvp");
        icarus(folders, "arbiter_tb", "", &compiled);
        run(shelter.path(), "vvp -n tb.vvp").trim() == "0 wrong"
    };
    assert!(is_right("machine"));
    for line in [
        r#"arbiter "waiting[i] | ~waiting[j]" "1'b1""#,
        r#"arbiter "waiting[j] ? lower_first[i*N + j]" "waiting[j] ? 1'b1""#,
        r#"arbiter "request & ~grant" "request""#,
        r#"arbiter "first & {N{enable}}" "request & {N{enable}}""#,
    ] {
        let modules = mistaken("machine", line);
        assert!(
            !is_right(&format!("{} machine", modules.path().display())),
            "{line}"
        );
    }
}
