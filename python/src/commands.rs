//! The program's commands.

use std::ffi::OsString;

use pyo3::prelude::*;

use crate::pool::on_all_threads;
use crate::refused;

/// The program's output for a command line with --json. An `Error` has the program's `exit_code`.
#[pyfunction]
pub(crate) fn documents(py: Python<'_>, words: Vec<OsString>) -> PyResult<String> {
    let printed = on_all_threads(py, |_| shiftvox_cli::documents(words))?;
    printed.map_err(|error| {
        let told = refused(&error);
        match told.value(py).setattr("exit_code", error.kind.code()) {
            Ok(()) => told,
            Err(other) => other,
        }
    })
}
