//! Results as JSON and as tables.

use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};
use hwmodel::count::Counter;
use hwmodel::{Memory, OpClass, Stage};
use serde_json::{Value, json};

use super::args::camera_line;
pub(super) use super::document::document;
use shiftvox::drawing::{Figures, Shown};
use shiftvox::project::Camera;
use shiftvox_lab::bench::Summary;
pub(super) use shiftvox_lab::report::grouped;

/// A camera in JSON.
pub(super) fn camera(camera: &Camera) -> Value {
    json!({
        "eye": camera.eye.to_array(),
        "target": camera.target.to_array(),
        "up": camera.up.to_array(),
        "fov_degrees": camera.fov_degrees,
        "flags": camera_line(camera),
    })
}

/// What drawing one scene took.
pub(super) fn drawn(
    name: &str,
    load_ms: f64,
    at: &Camera,
    shown: &Shown<'_>,
    hash: Option<&str>,
) -> Value {
    let times = Summary::of(shown.times_ms);
    let (width, height) = shown.pixels.size();
    let map = |figures: &Figures| -> serde_json::Map<String, Value> {
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

/// A figure for people.
pub(super) fn figure(value: &Value) -> String {
    value.as_u64().map_or_else(|| value.to_string(), grouped)
}

/// A table in plain text, first column left, the others right.
pub(super) fn table(head: Vec<String>, rows: Vec<Vec<String>>) -> String {
    let mut table = Table::new();
    let columns = head.len();
    table.load_style(NOTHING).set_header(head);
    for row in rows {
        table.add_row(row);
    }
    for column in 1..columns {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table.trim_fmt()
}

/// A table of JSON objects, by the heads and keys of its columns.
pub(super) fn table_of(rows: &Value, columns: &[(&str, &str)]) -> String {
    let cell = |value: &Value| match value {
        Value::String(text) => text.clone(),
        value if value.is_f64() => format!("{:.4}", value.as_f64().unwrap_or_default()),
        value => figure(value),
    };
    let row = |row: &Value| columns.iter().map(|(_, key)| cell(&row[*key])).collect();
    let rows = rows.as_array().into_iter().flatten().map(row).collect();
    table(
        columns.iter().map(|(head, _)| (*head).to_owned()).collect(),
        rows,
    )
}

/// Lines of names and values.
pub(super) fn lines(lines: &[(&str, String)]) -> String {
    let lines = lines
        .iter()
        .map(|(name, value)| format!("{name:<9} {value}"));
    lines.collect::<Vec<String>>().join("\n")
}

/// Operations by stage and class, then accesses by memory.
pub(super) fn counts(counter: &Counter) -> String {
    let classes: Vec<OpClass> = OpClass::ALL
        .into_iter()
        .filter(|&class| counter.ops_of(class) > 0)
        .collect();
    let mut head = vec!["stage".to_owned()];
    head.extend(classes.iter().map(|class| class.name().to_owned()));
    head.push("all".to_owned());
    let row = |name: &str, at: &dyn Fn(OpClass) -> u64| {
        let counts: Vec<u64> = classes.iter().map(|&class| at(class)).collect();
        let all: u64 = counts.iter().sum();
        let mut row = vec![name.to_owned()];
        row.extend(counts.iter().map(|&count| grouped(count)));
        row.push(grouped(all));
        (all > 0).then_some(row)
    };
    let mut rows: Vec<_> = Stage::ALL
        .into_iter()
        .filter_map(|stage| row(stage.name(), &|class| counter.ops_at(stage, class)))
        .collect();
    rows.extend(row("all", &|class| counter.ops_of(class)));
    let operations = table(head, rows);
    let accesses = Memory::ALL
        .into_iter()
        .filter(|&memory| counter.reads(memory) + counter.writes(memory) > 0)
        .map(|memory| {
            let name = memory.name().to_owned();
            vec![
                name,
                grouped(counter.reads(memory)),
                grouped(counter.writes(memory)),
            ]
        })
        .collect();
    let accesses = table(
        ["memory", "reads", "writes"].map(String::from).into(),
        accesses,
    );
    format!("{operations}\n\n{accesses}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use hwmodel::{Probe, StageLevel};

    #[test]
    fn the_count_table_adds_up() {
        let mut counter = Counter::new();
        let place = |stage| StageLevel { stage, level: 0 };
        counter.op(OpClass::Add, 64, place(Stage::Centre), 1200);
        counter.op(OpClass::Add, 64, place(Stage::Draw), 34);
        counter.op(OpClass::Shift, 64, place(Stage::Draw), 5);
        counter.read(Memory::Node, 0, place(Stage::Pop));
        let squeezed: Vec<String> = counts(&counter)
            .lines()
            .map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "))
            .collect();
        let expected = [
            "stage add shift all",
            "centre 1,200 0 1,200",
            "draw 34 5 39",
            "all 1,234 5 1,239",
            "",
            "memory reads writes",
            "node 1 0",
        ];
        assert_eq!(squeezed, expected);
    }
}
