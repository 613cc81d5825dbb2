//! The Python package. Comments of Python's objects become their docstrings.
#![forbid(unsafe_code)]

mod arguments;
mod camera;
mod picture;
mod ply;
mod pool;
mod scene;

use std::ffi::OsString;

use numpy::PyArrayDyn;
use numpy::ndarray::IxDyn;
use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;

create_exception!(
    shiftvox,
    Error,
    PyException,
    "An error with the program's message. Errors of `run`, `model`, `hardware` and `explore` have its `exit_code`."
);

/// A Python error with the message of one of the library.
fn refused(error: impl std::fmt::Display) -> PyErr {
    Error::new_err(error.to_string())
}

/// The program's output for a command line with --json. An `Error` has the program's `exit_code`.
#[pyfunction]
fn documents(py: Python<'_>, words: Vec<OsString>) -> PyResult<String> {
    let printed = pool::on_all_threads(py, |_| shiftvox_cli::documents(words))?;
    printed.map_err(|error| {
        let told = refused(&error);
        match told.value(py).setattr("exit_code", error.kind.code()) {
            Ok(()) => told,
            Err(other) => other,
        }
    })
}

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    // Loads NumPy now: a signal while it loads would be a panic.
    PyArrayDyn::<u8>::zeros(module.py(), IxDyn(&[0]), false);
    module.add("Error", module.py().get_type::<Error>())?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<camera::Camera>()?;
    module.add_class::<picture::Picture>()?;
    module.add_function(wrap_pyfunction!(picture::render, module)?)?;
    module.add_function(wrap_pyfunction!(documents, module)?)?;
    Ok(())
}
