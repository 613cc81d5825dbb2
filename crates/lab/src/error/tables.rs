//! What was measured, as tables.

use super::measure::{MethodErrors, Outcome, SceneErrors};
use super::pareto::beaten_by;
use super::picture_error::PictureError;
use crate::measure::Spread;
use crate::report::{Cell, Table};

fn number(value: f64, digits: usize) -> Cell {
    if value.is_finite() {
        Cell::Number(value, digits)
    } else if value.is_infinite() {
        Cell::from("inf")
    } else {
        Cell::None
    }
}

/// A share in percent.
fn percent(share: f64) -> Cell {
    number(100.0 * share, 2)
}

const PICTURE_COLUMNS: [&str; 7] = [
    "psnr",
    "ssim",
    "flip",
    "bias_percent",
    "coverage_percent",
    "thin_bias_percent",
    "thin_coverage_percent",
];

fn picture_cells(error: &PictureError) -> Vec<Cell> {
    let (all, thin) = (&error.coverage.all, &error.coverage.thin);
    let of_thin = |share: f64| {
        if thin.area > 0.0 {
            percent(share)
        } else {
            Cell::None
        }
    };
    vec![
        number(error.psnr_linear, 2),
        number(error.ssim, 4),
        number(error.flip, 4),
        percent(all.bias()),
        percent(all.relative()),
        of_thin(thin.bias()),
        of_thin(thin.relative()),
    ]
}

const SAMPLE_COLUMNS: [&str; 4] = ["extra", "missing", "elsewhere", "coarser"];

fn sample_cells(outcome: Option<&Outcome>) -> Vec<Cell> {
    let samples = outcome.and_then(|o| o.samples);
    vec![
        samples.map(|s| s.coverage.extra).into(),
        samples.map(|s| s.coverage.missing).into(),
        samples.map(|s| s.elsewhere).into(),
        samples.map(|s| s.coverage.wrong_voxel - s.elsewhere).into(),
    ]
}

fn counter(row: &MethodErrors, name: &str) -> Cell {
    let outcome = row.outcome.as_ref().ok();
    outcome
        .and_then(|o| o.counters.iter().find(|(found, _)| *found == name))
        .map(|(_, count)| *count)
        .into()
}

fn remark(row: &MethodErrors) -> Cell {
    match &row.outcome {
        Ok(outcome) => outcome.remark.as_deref().map_or(Cell::None, Cell::from),
        Err(refused) => Cell::Text(refused.to_string()),
    }
}

/// What people read of a scene.
#[must_use]
pub fn table(scene: &SceneErrors) -> Table {
    let mut columns = vec!["method", "ms", "deviation", "operations", "bytes_touched"];
    columns.extend(SAMPLE_COLUMNS);
    columns.extend(["depth_worst", "vertex_worst", "vertex_mean"]);
    columns.extend(PICTURE_COLUMNS);
    columns.extend(["beaten_by", "remark"]);
    let title = format!(
        "{}, {}x{}: errors against exact rays and a reference of {} samples a pixel",
        scene.scene, scene.width, scene.height, scene.reference_samples
    );
    let mut table = Table::new(title, &columns);
    let beaten_by = beaten_by(&scene.rows);
    for (row, beaten_by) in scene.rows.iter().zip(beaten_by) {
        let outcome = row.outcome.as_ref().ok();
        let spread = |of: fn(&Outcome) -> Option<Spread>, value: fn(&Spread) -> f64, digits| {
            let spread = outcome.and_then(of);
            spread.map_or(Cell::None, |spread| number(value(&spread), digits))
        };
        let time = outcome.map(|o| o.thread.unwrap_or(o.wall));
        let mut cells = vec![
            Cell::Text(row.method.clone()),
            time.map_or(Cell::None, |t| Cell::ms(t.median_ms)),
            time.map_or(Cell::None, |t| Cell::ms(t.deviation_ms)),
            counter(row, "operations"),
            counter(row, "bytes_touched"),
        ];
        cells.extend(sample_cells(outcome));
        cells.push(spread(|o| o.depth_voxels, |s| s.worst, 2));
        cells.push(spread(|o| o.vertex_px, |s| s.worst, 3));
        cells.push(spread(|o| o.vertex_px, |s| s.mean, 4));
        cells.extend(match outcome {
            Some(outcome) => picture_cells(&outcome.picture),
            None => vec![Cell::None; PICTURE_COLUMNS.len()],
        });
        cells.push(beaten_by.map_or(Cell::None, Cell::Text));
        cells.push(remark(row));
        table.rows.push(cells);
    }
    let mut floor = vec![Cell::from("noise floor: the reference with another seed")];
    floor.resize(5 + SAMPLE_COLUMNS.len() + 3, Cell::None);
    floor.extend(picture_cells(&scene.noise_floor));
    floor.resize(columns.len(), Cell::None);
    table.rows.push(floor);
    table
}

/// Everything, a row for each method and scene: CSV.
#[must_use]
pub fn rows(scenes: &[SceneErrors]) -> Table {
    // Of all families, each name once.
    let (mut settings, mut counters) = (Vec::new(), Vec::new());
    for row in scenes.iter().flat_map(|scene| &scene.rows) {
        add_new(&mut settings, row.settings.iter().map(|s| s.0));
        let counted = row.outcome.iter().flat_map(|outcome| &outcome.counters);
        add_new(&mut counters, counted.map(|c| c.0));
    }
    let mut columns = vec!["scene", "size", "method", "family"];
    columns.extend(&settings);
    columns.extend(["median_ms", "min_ms", "deviation_ms", "thread_median_ms"]);
    columns.extend(&counters);
    columns.extend(["pixels", "covered"]);
    columns.extend(SAMPLE_COLUMNS);
    columns.extend(["depth_mean", "depth_p999", "depth_worst"]);
    columns.extend(["vertex_mean", "vertex_p999", "vertex_worst"]);
    columns.push("rms_linear");
    columns.extend(PICTURE_COLUMNS);
    columns.extend(["beaten_by", "remark"]);
    let mut table = Table::new("Run time against error", &columns);
    for scene in scenes {
        for (row, beaten_by) in scene.rows.iter().zip(beaten_by(&scene.rows)) {
            let outcome = row.outcome.as_ref().ok();
            let mut cells = vec![
                Cell::Text(scene.scene.clone()),
                Cell::Text(format!("{}x{}", scene.width, scene.height)),
                Cell::Text(row.method.clone()),
                row.family.into(),
            ];
            let setting = |name: &&str| row.settings.iter().find(|(found, _)| found == name);
            let setting = |name| setting(name).map_or(Cell::None, |s| Cell::Text(s.1.clone()));
            cells.extend(settings.iter().map(setting));
            let time = |value: Option<f64>| value.map_or(Cell::None, |value| number(value, 3));
            cells.push(time(outcome.map(|o| o.wall.median_ms)));
            cells.push(time(outcome.map(|o| o.wall.min_ms)));
            cells.push(time(outcome.map(|o| o.wall.deviation_ms)));
            cells.push(time(outcome.and_then(|o| o.thread).map(|t| t.median_ms)));
            cells.extend(counters.iter().map(|name| counter(row, name)));
            let samples = outcome.and_then(|o| o.samples);
            cells.push(samples.map(|s| s.coverage.pixels).into());
            cells.push(samples.map(|s| s.coverage.covered).into());
            cells.extend(sample_cells(outcome));
            for spread in [
                outcome.and_then(|o| o.depth_voxels),
                outcome.and_then(|o| o.vertex_px),
            ] {
                let of = |value: fn(&Spread) -> f64| {
                    spread.map_or(Cell::None, |spread| number(value(&spread), 5))
                };
                cells.extend([of(|s| s.mean), of(|s| s.percentile_99_9), of(|s| s.worst)]);
            }
            cells.push(outcome.map_or(Cell::None, |o| number(o.picture.rms_linear, 5)));
            cells.extend(match outcome {
                Some(outcome) => picture_cells(&outcome.picture),
                None => vec![Cell::None; PICTURE_COLUMNS.len()],
            });
            cells.push(beaten_by.map_or(Cell::None, Cell::Text));
            cells.push(remark(row));
            table.rows.push(cells);
        }
    }
    table
}

/// Appends the names that are not there yet.
fn add_new(names: &mut Vec<&'static str>, more: impl Iterator<Item = &'static str>) {
    for name in more {
        if !names.contains(&name) {
            names.push(name);
        }
    }
}

/// Vertex errors by octree level of some methods of a scene.
#[must_use]
pub fn vertex_table(scene: &SceneErrors, wanted: &dyn Fn(&str) -> bool) -> Table {
    let columns = "method level records on_screen mean_px p999_px worst_px";
    let title = format!("{}: vertices against exact projection", scene.scene);
    let mut table = Table::of(title, columns);
    for row in scene.rows.iter().filter(|row| wanted(&row.method)) {
        for level in row.outcome.iter().flat_map(|o| &o.vertex_levels) {
            table.rows.push(vec![
                Cell::Text(row.method.clone()),
                u64::from(level.level).into(),
                level.records.into(),
                level.on_screen.into(),
                number(level.px.mean, 5),
                number(level.px.percentile_99_9, 4),
                number(level.px.worst, 4),
            ]);
        }
    }
    table
}
