//! Results as lines of JSON: headers with scene, space and settings, then points. Files of several runs can be concatenated.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::space::Point;
use super::{PointFigures, PointOutcome};

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointLine {
    pub scene: String,
    pub point: usize,
    pub values: BTreeMap<String, Value>,
    #[serde(flatten)]
    pub outcome: PointOutcome,
}

impl PointLine {
    pub fn new(scene: &str, point: &Point, outcome: PointOutcome) -> Self {
        let values = point.values.iter();
        let values = values.map(|(key, value)| (key.clone(), in_json(value)));
        Self {
            scene: scene.to_owned(),
            point: point.number,
            values: values.collect(),
            outcome,
        }
    }

    pub fn figures(&self) -> Option<&PointFigures> {
        match &self.outcome {
            PointOutcome::Drawn(figures) => Some(figures),
            PointOutcome::Refused { .. } => None,
        }
    }

    pub fn to_json(&self) -> String {
        kind_first("point", &serde_json::json!(self))
    }
}

/// A value of a space in JSON, which has no infinity.
fn in_json(value: &toml::Value) -> Value {
    match value.as_float() {
        Some(number) if number.is_infinite() => "inf".into(),
        _ => serde_json::json!(value),
    }
}

pub fn kind_first(kind: &str, fields: &Value) -> String {
    let fields = fields.to_string();
    format!(r#"{{"kind":"{kind}",{}"#, &fields[1..])
}

const BEGIN: &[u8] = br#"{"kind":""#;

/// A line that no run writes, or results of another run: the line's number, from 1, and the fault.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {0}: {1}")]
pub struct LinesError(usize, String);

#[derive(Debug, Clone, Default)]
pub struct Recorded {
    pub points: BTreeMap<(String, usize), PointLine>,
    pub scenes: BTreeSet<String>,
    /// Bytes of complete lines.
    pub bytes: usize,
}

/// Reads lines. `asked` has the headers of this run, one per scene. A last line without an end is ignored.
pub fn read(text: &[u8], asked: &[Value]) -> Result<Recorded, LinesError> {
    let end = text.iter().rposition(|&byte| byte == b'\n');
    let mut recorded = Recorded {
        bytes: end.map_or(0, |end| end + 1),
        ..Recorded::default()
    };
    let lines = text[..recorded.bytes].split_inclusive(|&byte| byte == b'\n');
    for (at, line) in lines.enumerate() {
        let wrong = |why: &str| LinesError(at + 1, why.to_owned());
        let no_result = |error: serde_json::Error| wrong(&format!("this is no result: {error}"));
        let mut value: Value = serde_json::from_slice(line).map_err(no_result)?;
        match value["kind"].as_str() {
            Some("space") => {
                compare(&value, asked, at + 1)?;
                recorded.scenes.extend(name(&value["scene"]));
            }
            Some("front") => {}
            Some("point") => {
                if let Value::Object(fields) = &mut value {
                    fields.remove("kind");
                }
                let line: PointLine = serde_json::from_value(value).map_err(no_result)?;
                if !recorded.scenes.contains(&line.scene) {
                    return Err(wrong("what this point is of does not stand above it"));
                }
                let key = (line.scene.clone(), line.point);
                recorded.points.insert(key, line);
            }
            _ => return Err(wrong("this is no result")),
        }
    }
    // Only what could have become a line of ours is cut off.
    let rest = &text[recorded.bytes..];
    if !rest.iter().zip(BEGIN).all(|(there, ours)| there == ours) {
        let complete = text.iter().filter(|&&byte| byte == b'\n').count();
        return Err(LinesError(complete + 1, "this is no result".to_owned()));
    }
    Ok(recorded)
}

fn name(scene: &Value) -> Option<String> {
    scene["name"].as_str().map(str::to_owned)
}

fn compare(found: &Value, asked: &[Value], line: usize) -> Result<(), LinesError> {
    let scene = |of: &Value| name(&of["scene"]);
    let like = asked.iter().find(|of| scene(of) == scene(found));
    let asked = like.or(asked.first()).and_then(Value::as_object);
    for (what, here) in asked.into_iter().flatten() {
        let there = &found[what];
        if there != here {
            let why = format!("these are other results: their `{what}` is {there}, not {here}");
            return Err(LinesError(line, why));
        }
    }
    Ok(())
}
