//! What came of all methods, as tables.

use super::measure::{Distance, Facts, MeshMethods, MethodAtDistance};
use crate::report::{Cell, Table};

/// Columns of a table.
const COLUMNS: [&str; 13] = [
    "method",
    "ms",
    "rms",
    "flip",
    "bias",
    "wrong_share",
    "flicker",
    "pop",
    "work",
    "work_of",
    "bytes",
    "build_ms",
    "remark",
];

/// What people read of a mesh at a distance.
#[must_use]
pub fn table(mesh: &MeshMethods, distance: &Distance) -> Table {
    let (width, height) = distance.size;
    let floor = &distance.noise_floor;
    let mut table = Table::new(
        format!(
            "{}, {} triangles, {width} x {height} pixels; rms, flicker, pop in thousandths of \
             white; noise floor: rms {:.2}, FLIP {:.4}",
            mesh.mesh,
            mesh.triangles,
            1e3 * floor.rms_linear,
            floor.flip
        ),
        &COLUMNS,
    );
    table.rows = cells(mesh, distance);
    table
}

fn cells<'m>(mesh: &'m MeshMethods, distance: &'m Distance) -> Vec<Vec<Cell>> {
    let cells = |(row, facts): (&MethodAtDistance, &Facts)| {
        let mut cells = vec![Cell::Text(facts.label.clone())];
        let outcome = match &row.outcome {
            Ok(outcome) => outcome,
            Err(reason) => {
                cells.resize(COLUMNS.len() - 3, Cell::None);
                cells.push(facts.bytes.into());
                cells.push(Cell::ms(facts.build_ms));
                cells.push(Cell::Text(reason.to_string()));
                return cells;
            }
        };
        let thousandths = |value: f64| Cell::Number(1e3 * value, 2);
        let time = outcome.thread.as_ref().unwrap_or(&outcome.wall);
        let bias = &outcome.picture.coverage.all;
        let (work_of, work) = outcome.counters.first().copied().unwrap_or(("", 0));
        cells.extend([
            Cell::ms(time.median_ms),
            thousandths(outcome.picture.rms_linear),
            Cell::Number(outcome.picture.flip, 4),
            Cell::Number(bias.bias(), 3),
            Cell::Number(bias.relative(), 3),
            outcome.flicker.map_or(Cell::None, thousandths),
            outcome.pop.map_or(Cell::None, thousandths),
            work.into(),
            work_of.into(),
            facts.bytes.into(),
            Cell::ms(facts.build_ms),
            outcome.remark.as_deref().map_or(Cell::None, Cell::from),
        ]);
        cells
    };
    distance.rows.iter().zip(&mesh.facts).map(cells).collect()
}
