//! The programs that tests run.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The folder of the hardware.
pub(crate) fn rtl() -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("rtl")
}

/// The words of a command line.
pub(crate) fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

/// Runs a program in a folder and returns its output, or its errors.
pub(crate) fn try_run<A: AsRef<str>>(
    folder: &Path,
    program: &str,
    arguments: &[A],
) -> Result<String, String> {
    let arguments: Vec<&str> = arguments.iter().map(AsRef::as_ref).collect();
    let ran = Command::new(program)
        .args(&arguments)
        .current_dir(folder)
        .output();
    let needed = "the tests need iverilog, verilator and yosys";
    let ran = ran.unwrap_or_else(|error| panic!("{program}: {error}; {needed}"));
    let words = |out: &[u8]| String::from_utf8_lossy(out).into_owned();
    match ran.status.success() {
        true => Ok(words(&ran.stdout)),
        false => Err(format!("{program} {arguments:?}: {}", words(&ran.stderr))),
    }
}

/// Runs a program in a folder and returns its output.
pub(crate) fn run<A: AsRef<str>>(folder: &Path, program: &str, arguments: &[A]) -> String {
    try_run(folder, program, arguments).unwrap_or_else(|error| panic!("{error}"))
}

/// Compiles a testbench of `rtl/tb` in Icarus Verilog, with the modules of those folders.
pub(crate) fn icarus(folders: &[&str], top: &str, parameters: &[(&str, u64)], into: &Path) {
    let mut arguments: Vec<String> = words("-g2012 -I .")
        .into_iter()
        .map(str::to_owned)
        .collect();
    for folder in folders {
        arguments.extend(["-I", folder, "-y", folder].map(str::to_owned));
    }
    let source = format!("tb/{top}.v");
    arguments.extend(["-s", top, &source, "-o", text(into)].map(str::to_owned));
    arguments.extend(
        parameters
            .iter()
            .map(|(name, value)| format!("-P{top}.{name}={value}")),
    );
    run(&rtl(), "iverilog", &arguments);
}

/// Runs `shiftvox`.
pub(crate) fn shiftvox(folder: &Path, arguments: &[&str]) -> String {
    run(folder, env!("CARGO_BIN_EXE_shiftvox"), arguments)
}

/// A path as a command needs it.
pub(crate) fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// The names of the modules in a folder of `rtl`.
pub(crate) fn modules(folder: &str) -> Vec<String> {
    let files = std::fs::read_dir(rtl().join(folder)).unwrap();
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    let names = names.filter_map(|name| name.strip_suffix(".v").map(str::to_owned));
    names.collect()
}
