//! The programs that tests run.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The folder of the hardware.
pub(crate) fn rtl() -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("rtl")
}

/// Whether a program is installed; says that a test is skipped if not.
pub(crate) fn is_there(program: &str) -> bool {
    let is_there = Command::new(program).arg("-V").output().is_ok();
    if !is_there {
        eprintln!("skipped: no {program} (apt-get install iverilog verilator yosys)");
    }
    is_there
}

/// Runs a program in a folder; what it prints.
pub(crate) fn run(folder: &Path, program: impl AsRef<Path>, arguments: &[&str]) -> String {
    let program = program.as_ref();
    let ran = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let words = |out: &[u8]| String::from_utf8_lossy(out).into_owned();
    let (out, errors) = (words(&ran.stdout), words(&ran.stderr));
    let last = errors.len().saturating_sub(2000);
    assert!(
        ran.status.success(),
        "{} {arguments:?}: {}",
        program.display(),
        errors.get(last..).unwrap_or(&errors)
    );
    out
}

/// Compiles a testbench of `rtl/tb` in Icarus Verilog, with modules from those folders.
pub(crate) fn icarus(folders: &[&str], top: &str, parameters: &[String], into: &str) {
    let source = format!("tb/{top}.v");
    let mut arguments = vec!["-g2012", "-I", "."];
    arguments.extend(
        folders
            .iter()
            .flat_map(|folder| ["-I", folder, "-y", folder]),
    );
    arguments.extend(["-s", top, &source, "-o", into]);
    arguments.extend(parameters.iter().map(String::as_str));
    run(&rtl(), "iverilog", &arguments);
}

/// A parameter of a testbench, as [`icarus`] has it.
pub(crate) fn parameter(top: &str, name: &str, value: u64) -> String {
    format!("-P{top}.{name}={value}")
}

/// Runs `shiftvox`.
pub(crate) fn shiftvox(folder: &Path, arguments: &[&str]) -> String {
    run(folder, env!("CARGO_BIN_EXE_shiftvox"), arguments)
}

/// A path as a command has it.
pub(crate) fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}
