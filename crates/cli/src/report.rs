//! Results as JSON and as text.

use serde_json::{Map, Value, json};

use shiftvox::drawing::{Figures, Shown};
use shiftvox::project::Camera;
use shiftvox_lab::bench::Summary;
pub(super) use shiftvox_lab::report::grouped;
use shiftvox_lab::report::{TextColumn, in_lines};

pub(super) fn camera(camera: &Camera) -> Value {
    json!({
        "eye": camera.eye.to_array(),
        "target": camera.target.to_array(),
        "up": camera.up.to_array(),
        "fov_degrees": camera.fov_degrees,
        "ortho": camera.ortho,
        "flags": camera.flags(),
    })
}

pub(super) fn drawn(
    name: &str,
    load_ms: f64,
    at: &Camera,
    shown: &Shown<'_>,
    hash: Option<&str>,
) -> Value {
    let times = Summary::of(shown.times_ms);
    let (width, height) = shown.pixels.size();
    let map = |figures: &Figures| -> Map<String, Value> {
        let named = figures.iter().cloned();
        named
            .map(|(name, value)| (name.to_owned(), value))
            .collect()
    };
    let mut result = json!({
        "scene": name,
        "width": width,
        "height": height,
        "pixels_drawn": shown.pixels_drawn,
        "camera": camera(at),
        "load_ms": load_ms,
        "render_ms": { "runs": times.runs, "min": times.min_ms, "median": times.median_ms, "max": times.max_ms },
        "counters": map(&shown.counters),
        "hash": hash,
    });
    if let Value::Object(result) = &mut result {
        result.extend(map(&shown.details));
    }
    result
}

pub(super) fn figure(value: &Value) -> String {
    match value {
        Value::Null => "-".to_owned(),
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(figure).collect::<Vec<_>>().join(", "),
        value => match (value.as_u64(), value.as_f64()) {
            (Some(whole), _) => grouped(whole),
            (_, Some(0.0)) => "0".to_owned(),
            (_, Some(real)) if value.is_f64() => {
                let magnitude = real.abs().max(1e-9).log10().floor() as i32;
                format!("{real:.*}", (5 - magnitude).max(0) as usize)
            }
            _ => value.to_string(),
        },
    }
}

/// A table in lines of at most 100 letters, first column left, the others right. Heads are broken at each `_`.
pub(super) fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let column = |(at, head): (usize, &&str)| {
        TextColumn::new(at == 0, head, rows.iter().map(move |row| row[at].clone()))
    };
    let columns: Vec<TextColumn> = head.iter().enumerate().map(column).collect();
    in_lines("", &columns).trim_start_matches('\n').to_owned()
}

/// The fields of a JSON object as lines, then its arrays of objects as tables.
pub(super) fn description(object: &Value) -> String {
    let (mut lines, mut tables) = (Vec::new(), Vec::new());
    for (key, value) in ordered(object) {
        let name = key.replace('_', " ");
        match value {
            Value::Null => {}
            Value::Object(fields) => {
                let fields = fields
                    .iter()
                    .map(|(key, value)| (key.replace('_', " "), value));
                lines.extend(fields.map(|(key, value)| (format!("{name}: {key}"), figure(value))));
            }
            Value::Array(rows) if rows.iter().all(Value::is_object) => {
                tables.extend(tables_of(&name, rows));
            }
            value => lines.push((name, figure(value))),
        }
    }
    let width = lines.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let lines = lines
        .iter()
        .map(|(name, value)| format!("{name:<width$}  {value}\n"));
    let lines: String = lines.collect();
    tables.insert(0, lines.trim_end().to_owned());
    tables.join("\n\n")
}

fn ordered(object: &Value) -> Vec<(&String, &Value)> {
    let mut fields: Vec<_> = object.as_object().into_iter().flatten().collect();
    fields.sort_by_key(|(key, _)| !matches!(key.as_str(), "scene" | "format" | "level"));
    fields
}

fn tables_of(name: &str, rows: &[Value]) -> Vec<String> {
    let Some(first) = rows.first() else {
        return Vec::new();
    };
    let inner = |value: &Value| {
        value
            .as_array()
            .filter(|of| of.iter().any(Value::is_object))
            .cloned()
    };
    let keys = ordered(first)
        .into_iter()
        .filter(|(_, value)| inner(value).is_none());
    let keys: Vec<&str> = keys.map(|(key, _)| key.as_str()).collect();
    let cells = |row: &Value| keys.iter().map(|key| figure(&row[*key])).collect();
    let mut tables = vec![table(&keys, &rows.iter().map(cells).collect::<Vec<_>>())];
    for (number, row) in rows.iter().enumerate() {
        for (key, rows) in ordered(row)
            .into_iter()
            .filter_map(|(key, value)| Some((key, inner(value)?)))
        {
            let title = format!("{name} {number}, {key}");
            let inner = tables_of(&title, &rows).into_iter();
            tables.extend(inner.map(|table| format!("{title}:\n{table}")));
        }
    }
    tables
}
