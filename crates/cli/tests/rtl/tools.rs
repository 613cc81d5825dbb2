//! The programs that tests run.

use std::path::{Path, PathBuf};
use std::process::Command;

pub(crate) const SHIFTVOX: &str = env!("CARGO_BIN_EXE_shiftvox");

/// The folder of the hardware.
pub(crate) fn rtl() -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("rtl")
}

/// A text for each of some words.
pub(crate) fn each(words: &str, text: impl Fn(&str) -> String) -> String {
    words.split_whitespace().map(text).collect()
}

/// Runs a command line in a folder and returns its output.
pub(crate) fn run(folder: &Path, line: &str) -> String {
    let mut words = line.split_whitespace();
    let mut command = Command::new(words.next().unwrap());
    let ran = command.args(words).current_dir(folder).output();
    let needed = "apt-get install iverilog verilator yosys";
    let ran = ran.unwrap_or_else(|error| panic!("{line}: {error}; {needed}"));
    let text = |out: &[u8]| String::from_utf8_lossy(out).into_owned();
    assert!(ran.status.success(), "{line}: {}", text(&ran.stderr));
    text(&ran.stdout)
}

/// Compiles a testbench of `rtl/tb` in Icarus Verilog, with the modules of these folders and the parameters `NAME=value`.
pub(crate) fn icarus(folders: &str, top: &str, parameters: &str, into: &Path) {
    let folders = each(folders, |folder| format!(" -I {folder} -y {folder}"));
    let parameters = each(parameters, |parameter| format!(" -P{top}.{parameter}"));
    let line = format!("iverilog -g2012 -I .{folders} -s {top} tb/{top}.v{parameters}");
    run(&rtl(), &format!("{line} -o {}", into.display()));
}

/// The files in some folders of `rtl`: of several with the same name, that of the first folder.
pub(crate) fn files(folders: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = Vec::new();
    for folder in folders.split(' ') {
        for file in std::fs::read_dir(rtl().join(folder)).unwrap() {
            let path = file.unwrap().path();
            if files.iter().all(|of| of.file_name() != path.file_name()) {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

/// The name of a file's module.
pub(crate) fn stem(path: &Path) -> &str {
    path.file_stem().and_then(|stem| stem.to_str()).unwrap()
}
