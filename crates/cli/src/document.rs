//! JSON documents, and files of settings.

use std::path::Path;

use serde_json::{Value, json};

use super::error::CliError;
use shiftvox::bounded;

/// Version of every JSON document: raised when a field changes its meaning or goes.
const SCHEMA_VERSION: u32 = 1;

/// A command's document: its schema's name and version first, then its fields.
pub(super) fn document(command: &str, fields: Value) -> Value {
    let mut document = json!({
        "schema": format!("shiftvox.{command}"),
        "schema_version": SCHEMA_VERSION,
        "program_version": env!("CARGO_PKG_VERSION"),
    });
    if let (Value::Object(to), Value::Object(from)) = (&mut document, fields) {
        to.extend(from);
    }
    document
}

pub(super) fn failed(document: Option<Value>, error: &CliError) -> Value {
    let mut document = document.unwrap_or_else(|| self::document("error", json!({})));
    document["error"] = json!(error.message);
    document["advice"] = json!(error.advice);
    document["exit_code"] = json!(error.kind.code());
    document
}

/// The settings with a name: shipped ones, or a file relative to a folder. `noun` and `advice` are for messages.
pub(super) fn named_settings(
    name: &str,
    shipped: &[(&str, &str)],
    folder: &Path,
    [noun, advice]: [&str; 2],
) -> Result<String, CliError> {
    if let Some((_, text)) = shipped.iter().find(|(of, _)| *of == name) {
        return Ok((*text).to_owned());
    }
    let path = folder.join(name);
    if path.exists() {
        return read_settings(&path);
    }
    let names: Vec<&str> = shipped.iter().map(|(name, _)| *name).collect();
    let error = CliError::input(format!("no {noun} and no file is called {name}"));
    Err(error.advise(format!("take one of {}, or {advice}", names.join(", "))))
}

pub(super) fn read_settings(path: &Path) -> Result<String, CliError> {
    bounded::read_settings(path).map_err(|error| CliError::input(error).at(path.display()))
}
