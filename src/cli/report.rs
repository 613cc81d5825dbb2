//! Results as JSON and as tables.

use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};
use hwmodel::count::Counter;
use hwmodel::{Memory, OpClass, Stage};
use serde_json::{Value, json};

use super::args::camera_line;
use super::drawing::{Drawn, min_median_max};
use super::scenes::Scene;
use crate::project::Camera;

/// Version of every JSON document: raised when a field changes its meaning or goes.
pub(super) const SCHEMA_VERSION: u32 = 1;

/// A JSON document of a verb: its schema's name and version first, then its fields.
pub(super) fn document(verb: &str, fields: Value) -> Value {
    let mut document = json!({
        "schema": format!("shiftvox.{verb}"),
        "schema_version": SCHEMA_VERSION,
        "program_version": env!("CARGO_PKG_VERSION"),
    });
    if let (Value::Object(to), Value::Object(from)) = (&mut document, fields) {
        to.extend(from);
    }
    document
}

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
pub(super) fn drawn(scene: &Scene, at: &Camera, drawn: &Drawn, hash: Option<&str>) -> Value {
    let (min, median, max) = min_median_max(&drawn.times_ms);
    let mut counters: serde_json::Map<String, Value> = drawn
        .stats
        .iter()
        .map(|&(name, count)| (name.to_owned(), count.into()))
        .collect();
    for (name, count) in page_counters(scene) {
        counters.insert(name.to_owned(), count.into());
    }
    json!({
        "scene": scene.source,
        "width": drawn.pixels.size().0,
        "height": drawn.pixels.size().1,
        "pixels_drawn": drawn.pixels_drawn,
        "camera": camera(at),
        "word": {
            "bits": drawn.setup.format.bits(),
            "screen_fraction_bits": drawn.setup.format.frac(),
            "clip_fraction_bits": drawn.setup.clip_frac,
        },
        "load_ms": scene.load_ms,
        "render_ms": { "runs": drawn.times_ms.len(), "min": min, "median": median, "max": max },
        "resolve_ms": drawn.resolve_ms,
        "counters": counters,
        "hash": hash,
    })
}

/// Pages of a mapped scene: all, and those in memory by now. None of others.
pub(super) fn page_counters(scene: &Scene) -> Vec<(&'static str, u64)> {
    let pages = scene.graph.mapped_pages();
    pages.map_or_else(Vec::new, |pages| {
        vec![
            ("pages_mapped", pages.mapped),
            ("pages_resident", pages.resident),
        ]
    })
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

/// A number with its digits in groups of three.
pub(super) fn grouped(number: impl Into<u128>) -> String {
    let digits = number.into().to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at) % 3 == 0 {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use hwmodel::{Place, Probe};

    #[test]
    fn groups_of_digits() {
        for (number, text) in [
            (0u64, "0"),
            (999, "999"),
            (1000, "1,000"),
            (1_234_567, "1,234,567"),
        ] {
            assert_eq!(grouped(number), text);
        }
    }

    #[test]
    fn the_count_table_adds_up() {
        let mut counter = Counter::new();
        let place = |stage| Place { stage, level: 0 };
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
