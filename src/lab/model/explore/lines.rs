//! Results, one a line of JSON: first what was asked, then points. The lines of several runs may stand one
//! after the other in one file, as `cat` puts them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::space::Point;
use super::{PointFigures, PointOutcome};

/// A point of a scene, measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointLine {
    /// The scene's name.
    pub scene: String,
    /// The point's number.
    pub point: usize,
    /// What it is made of.
    pub values: BTreeMap<String, Value>,
    /// What it came to.
    #[serde(flatten)]
    pub outcome: PointOutcome,
}

impl PointLine {
    /// A point's line.
    #[must_use]
    pub fn new(scene: &str, point: &Point, outcome: PointOutcome) -> Self {
        let values = point.values.iter();
        Self {
            scene: scene.to_owned(),
            point: point.number,
            values: values
                .map(|(key, value)| (key.clone(), serde_json::json!(value)))
                .collect(),
            outcome,
        }
    }

    /// Its figures, if the frame was drawn.
    #[must_use]
    pub fn figures(&self) -> Option<&PointFigures> {
        match &self.outcome {
            PointOutcome::Drawn(figures) => Some(figures),
            PointOutcome::Refused { .. } => None,
        }
    }

    /// The line, without its end.
    #[must_use]
    pub fn to_json(&self) -> String {
        kind_first("point", &serde_json::json!(self))
    }
}

/// A line that is of a kind, named in its first field.
#[must_use]
pub fn kind_first(kind: &str, fields: &Value) -> String {
    let fields = fields.to_string();
    format!(r#"{{"kind":"{kind}",{}"#, &fields[1..])
}

/// Why lines cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LinesError {
    /// Not a line that a run writes.
    #[error("line {line}: {why}")]
    Line {
        /// Its number, from 1.
        line: usize,
        /// What is wrong.
        why: String,
    },
    /// The results of something else.
    #[error("line {line}: these are results of another {what}: {there}, not {here}")]
    Other {
        /// The line's number, from 1.
        line: usize,
        /// What differs.
        what: String,
        /// What the file has.
        there: String,
        /// What is asked for.
        here: String,
    },
}

/// The points that whole lines hold, and the bytes of those lines: a last line without an end is none. `asked`: what
/// the run is of, which the first line must say, and every other line of its kind.
///
/// # Errors
/// When a line is none, or of another space, scene, size or version.
pub fn read(text: &[u8], asked: &Value) -> Result<(Vec<PointLine>, usize), LinesError> {
    let whole = text.iter().rposition(|&byte| byte == b'\n');
    let whole = whole.map_or(0, |end| end + 1);
    let mut points = Vec::new();
    let lines = text[..whole].split_inclusive(|&byte| byte == b'\n');
    for (at, line) in lines.enumerate() {
        let line_of = |why: String| LinesError::Line { line: at + 1, why };
        let no_result = |error: serde_json::Error| line_of(format!("this is no result: {error}"));
        let mut value: Value = serde_json::from_slice(line).map_err(no_result)?;
        let kind = value.get("kind").and_then(Value::as_str).unwrap_or_default();
        match kind {
            "space" => compare(&value, asked, at + 1)?,
            _ if at == 0 => {
                return Err(line_of("results begin with what they are of".to_owned()));
            }
            "front" => {}
            "point" => {
                if let Value::Object(fields) = &mut value {
                    fields.remove("kind");
                }
                points.push(serde_json::from_value(value).map_err(no_result)?);
            }
            _ => return Err(line_of("this is no result".to_owned())),
        }
    }
    Ok((points, whole))
}

fn compare(found: &Value, asked: &Value, line: usize) -> Result<(), LinesError> {
    let fields = asked.as_object().into_iter().flatten();
    for (what, here) in fields {
        let there = &found[what];
        if there != here {
            return Err(LinesError::Other {
                line,
                what: what.clone(),
                there: there.to_string(),
                here: here.to_string(),
            });
        }
    }
    Ok(())
}
