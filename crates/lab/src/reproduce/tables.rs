//! The reproduced results as tables and plots.

use super::{Evidence, Timed};
use crate::bench::scaling::{PAPER_TABLE_I, paper_ms};
use crate::bench::{PowerLaw, ablation};
use crate::report::plot::{Bar, Chart, Panel, Series};
use crate::report::{Cell, Table};

/// The law of the image-order paper's Table I, the first row (<1) left out.
#[must_use]
pub fn paper_law() -> Option<PowerLaw> {
    let points: Vec<(f64, f64)> = PAPER_TABLE_I
        .iter()
        .filter_map(|&(side, ms)| Some((f64::from(side * side), ms.parse().ok()?)))
        .collect();
    PowerLaw::fit(&points)
}

/// What drew: engine and settings.
fn engine_label(timed: &Timed) -> String {
    format!("{}, {} settings", timed.timing.engine, timed.settings)
}

fn names(times: &[Timed]) -> Vec<String> {
    let mut names = Vec::new();
    for timed in times {
        let name = engine_label(timed);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

fn evidence_of<'e>(all: &'e [Evidence], timed: &Timed) -> Option<&'e Evidence> {
    let timing = &timed.timing;
    all.iter().find(|e| {
        (e.scene.as_str(), e.settings.as_str(), e.side)
            == (timing.scene.as_str(), timed.settings, timing.width)
    })
}

/// Table I.
#[must_use]
pub fn table_one(times: &[Timed], evidence: &[Evidence]) -> Table {
    let columns = "engine size paper_ms median_ms min_ms paper_over_ours records operations \
        exponent_from_row_above";
    let mut table = Table::of(
        "Table I: a frame's time by the picture's size (processor time of one thread; the \
         operations are the machine's)",
        columns,
    );
    for name in names(times) {
        let mut before: Option<(f64, f64)> = None;
        for timed in times.iter().filter(|t| engine_label(t) == name) {
            let timing = &timed.timing;
            let ms = timing.best_median_ms();
            let paper = paper_ms(timing.width, timing.height);
            let point = (timing.pixels() as f64, ms);
            let step = before.and_then(|before| PowerLaw::fit(&[before, point]));
            before = Some(point);
            let quotient = paper.and_then(|p| p.parse::<f64>().ok()).map(|p| p / ms);
            let is_machine = timing.engine == "machine";
            let counted = evidence_of(evidence, timed).filter(|_| is_machine);
            table.rows.push(vec![
                Cell::Text(name.clone()),
                Cell::Text(timing.size()),
                paper.into(),
                Cell::ms(ms),
                Cell::ms(timing.thread.unwrap_or(timing.wall).min_ms),
                quotient.map_or(Cell::None, |q| Cell::Number(q, 0)),
                timing.work.into(),
                counted.map(|e| e.operations).into(),
                step.map_or(Cell::None, |law| Cell::ratio(law.exponent)),
            ]);
        }
    }
    table
}

/// The exponents, the image-order paper's among them.
#[must_use]
pub fn laws(times: &[Timed]) -> Table {
    let columns = ["what", "exponent_in_pixels", "r_squared", "points"];
    let mut table = Table::new(
        "Fitted growth: time or work as a power of the pixels",
        &columns,
    );
    let mut push = |name: String, law: Option<PowerLaw>| {
        if let Some(law) = law {
            table.rows.push(vec![
                Cell::Text(name),
                Cell::ratio(law.exponent),
                law.r_squared.map_or(Cell::None, Cell::ratio),
                (law.points as u64).into(),
            ]);
        }
    };
    push("the paper's Table I, from 128 on".to_owned(), paper_law());
    for name in names(times) {
        let of_name = || times.iter().filter(|t| engine_label(t) == name);
        let law = |y: &dyn Fn(&Timed) -> f64| {
            let points: Vec<(f64, f64)> = of_name()
                .map(|t| (t.timing.pixels() as f64, y(t)))
                .collect();
            PowerLaw::fit(&points)
        };
        push(format!("{name}: time"), law(&|t| t.timing.best_median_ms()));
        push(
            format!("{name}: records"),
            law(&|t| t.timing.work.unwrap_or(0) as f64),
        );
    }
    table
}

/// Objects of all kinds at one size.
#[must_use]
pub fn objects(times: &[Timed], evidence: &[Evidence]) -> Table {
    let columns = "engine scene voxels covered_pixels median_ms us_a_covered_pixel records \
        records_a_covered_pixel";
    let mut table = Table::of("Objects at one size", columns);
    for name in names(times) {
        for timed in times.iter().filter(|t| engine_label(t) == name) {
            let timing = &timed.timing;
            let ms = timing.best_median_ms();
            let covered = evidence_of(evidence, timed).map(|e| e.covered);
            let share =
                |y: f64| covered.map_or(Cell::None, |c| Cell::Number(y / c.max(1) as f64, 2));
            table.rows.push(vec![
                Cell::Text(name.clone()),
                Cell::Text(timing.scene.clone()),
                timing.voxels.into(),
                covered.into(),
                Cell::ms(ms),
                share(ms * 1e3),
                timing.work.into(),
                share(timing.work.unwrap_or(0) as f64),
            ]);
        }
    }
    table
}

/// By engine: greatest over least time, and how time grows with the voxels
/// of scenes of one kind.
#[must_use]
pub fn independence(times: &[Timed], growing: &[String]) -> Table {
    let columns = "engine voxels_greatest_over_least time_greatest_over_least \
        exponent_in_voxels_all exponent_in_voxels_one_kind";
    let mut table = Table::of("Does time depend on the object?", columns);
    for name in names(times) {
        let of_name = || times.iter().filter(|t| engine_label(t) == name);
        let spread = |y: &dyn Fn(&Timed) -> f64| {
            let values: Vec<f64> = of_name().map(y).collect();
            let most = values.iter().copied().fold(0.0, f64::max);
            most / values.iter().copied().fold(f64::INFINITY, f64::min)
        };
        let law = |only: &dyn Fn(&Timed) -> bool| {
            let points: Vec<(f64, f64)> = of_name()
                .filter(|t| only(t))
                .map(|t| (t.timing.voxels as f64, t.timing.best_median_ms()))
                .collect();
            PowerLaw::fit(&points).map_or(Cell::None, |law| Cell::ratio(law.exponent))
        };
        table.rows.push(vec![
            Cell::Text(name.clone()),
            Cell::Number(spread(&|t| t.timing.voxels as f64), 0),
            Cell::Number(spread(&|t| t.timing.best_median_ms()), 1),
            law(&|_| true),
            law(&|t| growing.contains(&t.timing.scene)),
        ]);
    }
    table
}

/// Techniques that rest on occlusion order.
#[must_use]
pub fn order(rows: &[(&'static str, ablation::AblationRow)]) -> Table {
    let columns = "scene settings machine median_ms times_as_long records pixels_that_change \
        wrong_against_exact";
    let mut table = Table::of("With and without occlusion order", columns);
    for (settings, row) in rows {
        if !row.variant.starts_with("occlusion")
            && !row.variant.starts_with("fill")
            && row.variant != ablation::WHOLE
        {
            continue;
        }
        table.rows.push(vec![
            Cell::Text(row.scene.clone()),
            (*settings).into(),
            row.variant.into(),
            Cell::ms(row.thread.unwrap_or(row.wall).median_ms),
            Cell::Number(row.time_ratio, 2),
            row.work.into(),
            row.changed.into(),
            (row.coverage.extra + row.coverage.missing).into(),
        ]);
    }
    table
}

/// The recorded frames.
#[must_use]
pub fn hashes(evidence: &[Evidence]) -> Table {
    let columns = "scene settings side hash covered records operations";
    let mut table = Table::of("Frames, the same on every machine", columns);
    for e in evidence {
        table.rows.push(vec![
            Cell::Text(e.scene.clone()),
            Cell::Text(e.settings.clone()),
            u64::from(e.side).into(),
            Cell::Text(e.hash.clone()),
            e.covered.into(),
            e.records.into(),
            e.operations.into(),
        ]);
    }
    table
}

/// Figure 5: time against pixels, the image-order paper's and ours.
#[must_use]
pub fn figure_five(times: &[Timed]) -> Panel {
    let mut series = vec![Series::curve(
        "the paper",
        PAPER_TABLE_I
            .iter()
            .filter_map(|&(side, ms)| Some((f64::from(side * side), ms.parse().ok()?))),
    )];
    for name in names(times) {
        let of_name = times.iter().filter(|t| engine_label(t) == name);
        let points = of_name.map(|t| (t.timing.pixels() as f64, t.timing.best_median_ms()));
        series.push(Series::curve(name.clone(), points));
    }
    Panel::Chart(Chart::growth(
        "Figure 5: render time against pixels in the image",
        "pixels",
        "ms",
        series,
    ))
}

/// Time against voxels, at one size.
#[must_use]
pub fn object_chart(times: &[Timed]) -> Panel {
    let series = names(times)
        .into_iter()
        .map(|name| {
            let of_name = times.iter().filter(|t| engine_label(t) == name);
            let mut points: Vec<(f64, f64)> = of_name
                .map(|t| (t.timing.voxels as f64, t.timing.best_median_ms()))
                .collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            Series::curve(name, points)
        })
        .collect();
    Panel::Chart(Chart::growth(
        "Render time against voxels, at one size",
        "voxels",
        "ms",
        series,
    ))
}

/// How much longer a frame takes, on the whole's time.
#[must_use]
pub fn order_bars(rows: &[(&'static str, ablation::AblationRow)]) -> Panel {
    Panel::Bars {
        title: "Time without the technique, over time with it".to_owned(),
        bars: rows
            .iter()
            .filter(|(_, row)| {
                row.variant.starts_with("occlusion") || row.variant.starts_with("fill")
            })
            .map(|(settings, row)| Bar {
                name: format!("{}, {settings}: {}", row.scene, row.variant),
                value: row.time_ratio,
            })
            .collect(),
    }
}
