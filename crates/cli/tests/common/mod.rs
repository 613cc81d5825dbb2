//! Runs of the program, and what tests expect of them.
#![allow(dead_code, reason = "not every test crate uses all")]

use std::path::PathBuf;
use std::process::{Command, Output};

/// The program that was built with these tests.
pub(crate) fn program() -> PathBuf {
    env!("CARGO_BIN_EXE_shiftvox").into()
}

/// A run of the program.
pub(crate) fn command() -> Command {
    Command::new(program())
}

/// Runs a command to its end.
pub(crate) trait Run {
    /// Its output and exit code.
    fn assert(&mut self) -> Assert;
}

impl Run for Command {
    fn assert(&mut self) -> Assert {
        let output = self.output().unwrap();
        let line = format!("{self:?}");
        Assert { line, output }
    }
}

/// A command that has ended.
pub(crate) struct Assert {
    line: String,
    output: Output,
}

impl Assert {
    pub(crate) fn get_output(&self) -> &Output {
        &self.output
    }

    #[track_caller]
    pub(crate) fn success(self) -> Self {
        self.code(0)
    }

    #[track_caller]
    pub(crate) fn failure(self) -> Self {
        assert!(!self.output.status.success(), "{}", self.told());
        self
    }

    #[track_caller]
    pub(crate) fn code(self, code: i32) -> Self {
        assert_eq!(self.output.status.code(), Some(code), "{}", self.told());
        self
    }

    #[track_caller]
    pub(crate) fn stdout(self, expected: &str) -> Self {
        assert_eq!(
            String::from_utf8_lossy(&self.output.stdout),
            expected,
            "{}",
            self.line
        );
        self
    }

    fn told(&self) -> String {
        let words = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let Output { stdout, stderr, .. } = &self.output;
        format!("{}\n{}{}", self.line, words(stdout), words(stderr))
    }
}

/// A rough sheet of so many vertices along each side, as a Wavefront file.
pub(crate) fn sheet(side: usize) -> String {
    let mut text = String::new();
    for (z, x) in (0..side).flat_map(|z| (0..side).map(move |x| (z, x))) {
        text += &format!("v {x} {} {z}\n", (x * z) % 3);
    }
    for (z, x) in (0..side - 1).flat_map(|z| (1..side).map(move |x| (z, x))) {
        let a = z * side + x;
        text += &format!("f {a} {} {} {}\n", a + 1, a + side + 1, a + side);
    }
    text
}
