//! The program's commands, run in this process.

use std::ffi::OsString;

use pyo3::prelude::*;

use crate::refused;

/// What a command prints with `--json`. The error has the program's exit code.
#[pyfunction]
pub(crate) fn documents(py: Python<'_>, words: Vec<OsString>) -> PyResult<String> {
    let printed = py.detach(|| shiftvox::cli::documents(words));
    printed.map_err(|error| {
        let told = refused(&error);
        match told.value(py).setattr("exit_code", error.kind.code()) {
            Ok(()) => told,
            Err(other) => other,
        }
    })
}
