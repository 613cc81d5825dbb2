//! Mistakes in a machine: a small frame is then not drawn as the reference machine draws it.

use std::fs;

use rayon::prelude::*;
use shiftvox::graph::vxg;

use super::frames::tree_with_larger_solids;
use super::machines::{
    Expected, LANES, Machine, STAGE_A, STAGE_B, STAGE_C, STAGE_C_BRICKS, agree_in_icarus,
};
use super::tools::{icarus, rtl, run, text};

/// The list of mistakes.
const FAULTS: &str = include_str!("faults.txt");

static TWO_LANES: Machine = Machine::new("stage_c", Some([2, 2, 2]), true);

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

/// File, text, mistake.
fn fault_of(line: &'static str) -> [String; 3] {
    let mut parts = line.split('"');
    let [file, right, _, fault] = std::array::from_fn(|_| parts.next().unwrap());
    [file.trim(), right, fault].map(|text| text.replace("\\n", "\n"))
}

/// Draws the small frame of a section in Icarus Verilog: as it is, and with each mistake. Returns how many there were.
fn faults_are_found(machine: &'static Machine, view: &str, lines: &[&'static str]) -> usize {
    let shelter = tempfile::tempdir().unwrap();
    let file = shelter.path().join("solids.vxg");
    vxg::write(&tree_with_larger_solids(3), &file, true).unwrap();
    let expected = Expected::new(machine, &view.replace("SOLIDS", text(&file)), None);
    let modules = shelter.path().join("modules");
    fs::create_dir(&modules).unwrap();
    let compiled = shelter.path().join("frame.vvp");
    let faults = lines.iter().map(|line| fault_of(line));
    for [file, right, fault] in std::iter::once(Default::default()).chain(faults) {
        // Of files in several folders the first counts.
        let mut found = 1;
        for folder in machine.folders().iter().rev() {
            for path in fs::read_dir(rtl().join(folder)).unwrap() {
                let path = path.unwrap().path();
                let mut source = fs::read_to_string(&path).unwrap();
                if path.file_stem().unwrap() == file.as_str() {
                    found = source.matches(&right).count();
                    source = source.replace(&right, &fault);
                }
                fs::write(modules.join(path.file_name().unwrap()), source).unwrap();
            }
        }
        assert_eq!(found, 1, "{file}: {right}");
        icarus(
            &[text(&modules)],
            machine.testbench(),
            &machine.parameters(),
            &compiled,
        );
        let drawn = agree_in_icarus(&expected, &compiled, 2 * expected.cycles);
        assert_eq!(drawn.is_ok(), file.is_empty(), "{file}: {fault}: {drawn:?}");
    }
    lines.len()
}

/// The mistakes of a set's sections.
fn faults_of_set_are_found(set: &str) -> usize {
    let lines = FAULTS
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'));
    let lines: Vec<&str> = lines.collect();
    let mut sections = lines
        .chunk_by(|_, next| !next.starts_with('['))
        .collect::<Vec<_>>();
    sections.retain(|section| section[0].starts_with(&format!("[{set} ")));
    let found = sections.into_par_iter().map(|section| {
        let (head, view) = section[0].split_once("] ").unwrap();
        let (_, machine) = head.split_once(' ').unwrap();
        faults_are_found(machine_of(machine), view, &section[1..])
    });
    found.sum()
}

#[test]
fn faults_of_every_machine_are_found() {
    assert_eq!(faults_of_set_are_found("short"), 36);
}

#[test]
#[ignore = "takes minutes"]
fn more_faults_are_found() {
    assert_eq!(faults_of_set_are_found("long"), 47);
}

#[test]
fn an_arbiter_serves_who_came_first() {
    let shelter = tempfile::tempdir().unwrap();
    let [module, compiled] = ["arbiter.v", "tb.vvp"].map(|name| shelter.path().join(name));
    let source = fs::read_to_string(rtl().join("machine/arbiter.v")).unwrap();
    for (right, fault) in [
        ("", ""),
        ("waiting[i] | ~waiting[j]", "1'b1"),
        ("waiting[j] ? lower_first[i*N + j]", "waiting[j] ? 1'b1"),
        ("request & ~grant", "request"),
        ("first & {N{enable}}", "request & {N{enable}}"),
    ] {
        let times = usize::from(!right.is_empty());
        assert!(
            right.is_empty() || source.matches(right).count() == 1,
            "{right}"
        );
        fs::write(&module, source.replacen(right, fault, times)).unwrap();
        icarus(&[text(shelter.path())], "arbiter_tb", &[], &compiled);
        let printed = run(shelter.path(), "vvp", &["-n", text(&compiled)]);
        assert_eq!(
            printed.trim() == "0 wrong",
            right.is_empty(),
            "{fault}: {printed}"
        );
    }
}
