//! Arguments. Errors name the argument.

use numpy::{Element, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyOverflowError;
use pyo3::prelude::*;
use pyo3::types::PyAny;
use shiftvox::{CageKind, Coverage, EngineKind, Up};

use crate::{Error, refused};

pub(crate) const ENGINES: [(&str, EngineKind); 3] = [
    ("fast", EngineKind::Fast),
    ("machine", EngineKind::Machine),
    ("rays", EngineKind::Rays),
];
pub(crate) const CAGES: [(&str, CageKind); 2] =
    [("frame", CageKind::Frame), ("corners", CageKind::Corners)];
pub(crate) const AXES: [(&str, Up); 2] = [("y", Up::Y), ("z", Up::Z)];

pub(crate) fn one_of<T: Copy>(what: &str, word: &str, known: &[(&str, T)]) -> PyResult<T> {
    let found = known.iter().find(|(name, _)| *name == word);
    found.map(|&(_, value)| value).ok_or_else(|| {
        let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
        Error::new_err(format!("{what}: {word:?} is none of {}", names.join(", ")))
    })
}

pub(crate) fn coverage(word: &str) -> PyResult<Coverage> {
    let rules = Coverage::ALL.map(|rule| (rule.name(), rule));
    one_of("coverage", word, &rules)
}

/// A whole number. One beyond 64 bits becomes the largest, which is out of every range, too.
pub(crate) fn whole(number: &Bound<'_, PyAny>) -> PyResult<i64> {
    number.extract().or_else(|error: PyErr| {
        let is_too_large = error.is_instance_of::<PyOverflowError>(number.py());
        is_too_large.then_some(i64::MAX).ok_or(error)
    })
}

pub(crate) fn count(what: &str, number: i64) -> PyResult<u32> {
    u32::try_from(number)
        .map_err(|_| Error::new_err(format!("{what}: a number from 0 to {}", u32::MAX)))
}

/// Pixels across and down; one number means a square.
pub(crate) fn size(size: &Bound<'_, PyAny>) -> PyResult<[u32; 2]> {
    let square = size.extract().map(|side: u32| [side, side]);
    square
        .or_else(|_| size.extract())
        .map_err(|_| Error::new_err("size: one number, or (width, height), in pixels"))
}

pub(crate) fn color(what: &str, color: &Bound<'_, PyAny>) -> PyResult<[u8; 3]> {
    let refuse = || Error::new_err(format!("{what}: three numbers, 0 to 255"));
    let [red, green, blue] = color.extract::<[i64; 3]>().map_err(|_| refuse())?;
    let byte = |number: i64| u8::try_from(number).map_err(|_| refuse());
    Ok([byte(red)?, byte(green)?, byte(blue)?])
}

/// Rows of an array of three columns, or of a value that NumPy converts to one. Floating-point types take any number,
/// others whole numbers in their range.
pub(crate) fn rows_of_three<T: Element + Copy>(
    what: &str,
    array: &Bound<'_, PyAny>,
) -> PyResult<Vec<[T; 3]>> {
    let refuse = |told: String| Error::new_err(format!("{what}: {told}"));
    let numpy = array.py().import("numpy")?;
    let array = numpy.call_method1("asarray", (array,));
    let array = array.map_err(|error| refuse(error.to_string()))?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    let [rows, 3] = shape[..] else {
        return Err(refuse(format!("the shape is {shape:?}, not (N, 3)")));
    };
    if rows == 0 {
        return Ok(Vec::new());
    }
    let [from, to] = [array.getattr("dtype")?, T::get_dtype(array.py()).into_any()];
    let kind = |of: &Bound<'_, PyAny>| of.getattr("kind")?.extract::<String>();
    let is_whole = kind(&to)? != "f";
    let kinds = if is_whole { "iu" } else { "fiu" };
    if !kinds.contains(&kind(&from)?) {
        return Err(refuse(format!("{from} is not converted to {to}")));
    }
    if is_whole {
        let range = numpy.call_method1("iinfo", (&to,))?;
        let lowest: i128 = range.getattr("min")?.extract()?;
        let highest: i128 = range.getattr("max")?.extract()?;
        let least: i128 = array.call_method0("min")?.extract()?;
        let most: i128 = array.call_method0("max")?.extract()?;
        if least < lowest || most > highest {
            let told = format!("numbers from {lowest} to {highest}, not {least} to {most}");
            return Err(refuse(told));
        }
    }
    let array = array.call_method1("astype", (to,))?;
    let array = array.cast_into::<PyArray2<T>>().map_err(refused)?;
    let array = array.try_readonly().map_err(refused)?;
    let array = array.as_array();
    let rows = array.rows().into_iter();
    Ok(rows.map(|row| [row[0], row[1], row[2]]).collect())
}
