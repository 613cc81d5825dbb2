//! Settings that are words.

use pyo3::prelude::*;
use shiftvox::{CageKind, Coverage, EngineKind};

use crate::Error;

const ENGINES: [(&str, EngineKind); 3] = [
    ("fast", EngineKind::Fast),
    ("machine", EngineKind::Machine),
    ("rays", EngineKind::Rays),
];
const COVERAGES: [(&str, Coverage); 4] = [
    ("exact", Coverage::Exact),
    ("alpha", Coverage::Alpha),
    ("center", Coverage::Center),
    ("any", Coverage::Any),
];
const CAGES: [(&str, CageKind); 2] = [("frame", CageKind::Frame), ("corners", CageKind::Corners)];

fn one_of<T: Copy>(what: &str, word: &str, known: &[(&str, T)]) -> PyResult<T> {
    let found = known.iter().find(|(name, _)| *name == word);
    found.map(|&(_, value)| value).ok_or_else(|| {
        let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
        Error::new_err(format!("{what}: {word:?} is none of {}", names.join(", ")))
    })
}

pub(crate) fn engine(word: &str) -> PyResult<EngineKind> {
    one_of("engine", word, &ENGINES)
}

pub(crate) fn coverage(word: &str) -> PyResult<Coverage> {
    one_of("coverage", word, &COVERAGES)
}

pub(crate) fn cage(word: &str) -> PyResult<CageKind> {
    one_of("cage", word, &CAGES)
}
