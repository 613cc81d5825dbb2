//! The Python package: scenes, cameras and pictures as objects, buffers as NumPy arrays, experiments
//! as dictionaries. Comments of what Python sees are its docstrings; the stubs (`shiftvox/_core.pyi`)
//! repeat them for editors.

mod arguments;
mod camera;
mod commands;
mod picture;
mod ply;
mod pool;
mod scene;

use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;

create_exception!(
    shiftvox,
    Error,
    PyException,
    "What shiftvox refuses or cannot do, in the words of the program. Errors of `run`, `model`, `hardware` and \
     `explore` have an `exit_code`: what the program would have ended with."
);

/// An error of the library, with its words.
fn refused(error: impl std::fmt::Display) -> PyErr {
    Error::new_err(error.to_string())
}

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("Error", module.py().get_type::<Error>())?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<camera::Camera>()?;
    module.add_class::<picture::Picture>()?;
    module.add_function(wrap_pyfunction!(picture::render, module)?)?;
    module.add_function(wrap_pyfunction!(commands::documents, module)?)?;
    Ok(())
}
