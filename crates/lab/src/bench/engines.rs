//! `bench engines`: time and errors of each engine.

use super::measure::Timing;
use crate::report::plot::{Bar, Chart, Panel, Series};
use crate::report::{Cell, Table};

/// The times as a table.
#[must_use]
pub fn table(timings: &[Timing]) -> Table {
    let columns = "scene size engine threads median_ms min_ms deviation_ms thread_median_ms work \
        work_unit extra missing other_voxel";
    let mut table = Table::of("Engines: clear, traverse and colour", columns);
    for timing in timings {
        let coverage = timing.coverage;
        table.rows.push(vec![
            Cell::Text(timing.scene.clone()),
            Cell::Text(timing.size()),
            timing.engine.into(),
            (timing.threads as u64).into(),
            Cell::ms(timing.wall.median_ms),
            Cell::ms(timing.wall.min_ms),
            Cell::ms(timing.wall.deviation_ms),
            timing.thread.map_or(Cell::None, |t| Cell::ms(t.median_ms)),
            timing.work.into(),
            timing.work_unit.into(),
            coverage.map(|c| c.extra).into(),
            coverage.map(|c| c.missing).into(),
            coverage.map(|c| c.wrong_voxel).into(),
        ]);
    }
    table
}

/// A plot for each scene: times by size where there are several, else bars.
#[must_use]
pub fn panels(timings: &[Timing]) -> Vec<Panel> {
    timings
        .chunk_by(|a, b| a.scene == b.scene)
        .map(panel)
        .collect()
}

fn panel(timings: &[Timing]) -> Panel {
    let [first, ..] = timings else {
        return Panel::Bars {
            title: String::new(),
            bars: Vec::new(),
        };
    };
    let name = |t: &Timing| match t.threads {
        1 => t.engine.to_owned(),
        threads => format!("{}, {threads} threads", t.engine),
    };
    if timings.iter().all(|t| t.pixels() == first.pixels()) {
        let bar = |t: &Timing| Bar {
            name: name(t),
            value: t.wall.median_ms,
        };
        return Panel::Bars {
            title: format!("{}, {}, ms a frame", first.scene, first.size()),
            bars: timings.iter().map(bar).collect(),
        };
    }
    let at = |t: &Timing| (name(t), (t.pixels() as f64, t.wall.median_ms));
    let series = Series::collect(timings.iter().map(at));
    Panel::Chart(Chart::growth(&first.scene, "pixels", "ms a frame", series))
}
