//! The program's commands, run in this process.

use std::ffi::OsString;

use pyo3::prelude::*;

use crate::pool::on_all_threads;
use crate::refused;

/// What the program prints for a command line with --json. The `exit_code` of an `Error` is the program's.
#[pyfunction]
pub(crate) fn documents(py: Python<'_>, words: Vec<OsString>) -> PyResult<String> {
    let printed = on_all_threads(py, || shiftvox_cli::documents(words))?;
    printed.map_err(|error| {
        let told = refused(&error);
        match told.value(py).setattr("exit_code", error.kind.code()) {
            Ok(()) => told,
            Err(other) => other,
        }
    })
}
