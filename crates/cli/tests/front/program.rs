//! The program, and its output.

use std::path::Path;

use crate::common::{Assert, Run};
use serde_json::Value;
use std::process::Command;

pub(crate) fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

pub(crate) fn shiftvox(folder: &Path) -> Command {
    let mut command = crate::common::command();
    command.current_dir(folder);
    command
}

pub(crate) fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

pub(crate) fn run(folder: &Path, line: &[&str]) -> Assert {
    shiftvox(folder).args(line).assert()
}

pub(crate) fn bench(folder: &Path, line: &[&str]) -> Assert {
    shiftvox(folder).arg("bench").args(line).assert()
}

pub(crate) fn stdout_of(assert: &Assert) -> String {
    String::from_utf8_lossy(&assert.get_output().stdout).into_owned()
}

pub(crate) fn stderr_of(assert: &Assert) -> String {
    String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
}

pub(crate) fn json_of(assert: &Assert) -> Value {
    let text = stdout_of(assert);
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e}: {text}"))
}
