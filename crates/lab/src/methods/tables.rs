//! What came of all methods, as tables.

use super::measure::{Distance, Facts, MeshMethods, MethodAtDistance};
use crate::report::{Cell, Table};

/// Columns of every table.
const COLUMNS: [&str; 19] = [
    "mesh",
    "pixels",
    "method",
    "ms",
    "wall_ms",
    "rms",
    "psnr",
    "flip",
    "ssim",
    "bias",
    "wrong_share",
    "flicker",
    "pop",
    "work",
    "work_of",
    "read_bytes",
    "bytes",
    "build_ms",
    "remark",
];

/// A row for each mesh, distance and method.
#[must_use]
pub fn rows(meshes: &[MeshMethods]) -> Table {
    let mut table = Table::new("All methods", &COLUMNS);
    for mesh in meshes {
        for distance in &mesh.distances {
            table.rows.extend(cells(mesh, distance));
        }
    }
    table
}

/// What people read of a mesh at a distance.
#[must_use]
pub fn table(mesh: &MeshMethods, distance: &Distance) -> Table {
    let (width, height) = distance.size;
    let floor = &distance.noise_floor;
    let mut table = Table::new(
        format!(
            "{}, {} triangles, {width} x {height} pixels; psnr in decibel; flicker, pop in \
             thousandths of white; noise floor: psnr {:.1}, FLIP {:.4}",
            mesh.mesh, mesh.triangles, floor.psnr_linear, floor.flip
        ),
        &COLUMNS,
    );
    table.rows = cells(mesh, distance);
    for (number, row) in (1..).zip(&mut table.rows) {
        row[2] = Cell::Text(format!("{number} {}", row[2].for_people()));
    }
    table.without(&[
        "mesh",
        "pixels",
        "wall_ms",
        "rms",
        "ssim",
        "wrong_share",
        "work_of",
    ])
}

fn cells<'m>(mesh: &'m MeshMethods, distance: &'m Distance) -> Vec<Vec<Cell>> {
    let cells = |(row, facts): (&MethodAtDistance, &Facts)| {
        let mut cells = vec![
            Cell::Text(mesh.mesh.clone()),
            Cell::Count(u64::from(distance.size.1)),
            Cell::Text(facts.label.clone()),
        ];
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
            Cell::ms(outcome.wall.median_ms),
            thousandths(outcome.picture.rms_linear),
            Cell::Number(outcome.picture.psnr_linear, 1),
            Cell::Number(outcome.picture.flip, 4),
            Cell::Number(outcome.picture.ssim, 3),
            Cell::Number(bias.bias(), 3),
            Cell::Number(bias.relative(), 3),
            outcome.flicker.map_or(Cell::None, thousandths),
            outcome.pop.map_or(Cell::None, thousandths),
            work.into(),
            work_of.into(),
            outcome.read_bytes.into(),
            facts.bytes.into(),
            Cell::ms(facts.build_ms),
            outcome.remark.as_deref().map_or(Cell::None, Cell::from),
        ]);
        cells
    };
    distance.rows.iter().zip(&mesh.facts).map(cells).collect()
}
