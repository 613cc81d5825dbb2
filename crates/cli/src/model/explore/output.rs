//! What an exploration found: lines, tables, plots, the page.

use serde_json::{Value, json};

use super::words::{given_up, values};
use super::{Explorations, page};
use crate::console::Console;
use crate::document;
use crate::error::CliError;
use crate::experiment::context::Context;
use crate::experiment::export::{self, Results};
use crate::model::args::ModelArgs;
use shiftvox::whole;
use shiftvox_lab::model::explore::front::FrontPoint;
use shiftvox_lab::model::explore::lines::{PointLine, kind_first};
use shiftvox_lab::report::plot::{Axis, Chart, Panel, Point, Scale, Series};
use shiftvox_lab::report::{Cell, Table};

/// Writes all files, then prints.
pub(super) fn write(
    found: &[Explorations],
    args: &ModelArgs,
    console: &Console,
) -> Result<(), CliError> {
    let tables: Vec<Table> = found.iter().map(|of| table(of, args)).collect();
    let command = Context::now().command_line();
    if let Some(path) = &args.files.html {
        let page = page::html(found, &tables, &command);
        whole::write(path, page.as_bytes(), args.export.force)?;
        console.note(format!("{}: written", path.display()));
    }
    let fronts: Vec<Value> = found.iter().map(front_json).collect();
    let results = Results {
        document: document::document("explore", json!({ "scenes": fronts })),
        rows: rows(found),
        tables,
        more_tables: Vec::new(),
        preface: format!("`{command}`\n"),
        panels: found.iter().map(panel).collect(),
    };
    export::write_files(&results, &args.export, console)?;
    if console.json {
        let mut fronts = fronts.iter();
        return fronts.try_for_each(|of| console.line(&kind_first("front", of)));
    }
    export::print(&results.tables, console)
}

fn front_json(of: &Explorations) -> Value {
    let point = |point: &FrontPoint| {
        let mut fields = json!(point);
        fields["hardware_says"] = json!(values(&point.line, &of.points));
        fields["gives_up_says"] = json!(given_up(point));
        fields
    };
    json!({
        "scene": of.scene,
        "space_points": of.all,
        "points": of.points.len(),
        "refused": refused(of),
        "too_slow_for_their_clock": too_slow(of),
        "front": of.front.iter().map(point).collect::<Vec<_>>(),
    })
}

/// Points that cannot draw the frame.
fn refused(of: &Explorations) -> usize {
    let drawn = of.points.iter().filter(|line| line.figures().is_some());
    of.points.len() - drawn.count()
}

/// Points that draw it, but whose units miss their clock.
fn too_slow(of: &Explorations) -> usize {
    let figures = of.points.iter().filter_map(PointLine::figures);
    figures.filter(|figures| !figures.meets_clock).count()
}

/// A number of things that need a word beside them only where there are some.
fn unless_none(count: usize, what: &str) -> String {
    match count {
        0 => String::new(),
        some => format!("; {some} {what}"),
    }
}

fn table(of: &Explorations, args: &ModelArgs) -> Table {
    let mut table = Table::of(
        format!(
            "{}, {} x {}: of {} hardware designs {} that no other beats in time, area, energy and wrong samples; of those, {} \
             beside which none is better by a tenth in something and nowhere worse by a tenth{}{}{}",
            of.scene,
            args.size.width,
            args.size.height,
            of.points.len(),
            of.front.len(),
            of.front.iter().filter(|point| point.stands_out).count(),
            unless_none(of.all - of.points.len(), "of the space are not measured"),
            unless_none(refused(of), "cannot draw the frame"),
            unless_none(too_slow(of), "are too slow for their clock"),
        ),
        "point hardware time_ms area_nand2 energy_uj wrong_samples ray_caster_uj \
         what_others_have_less_of",
    );
    for point in of.front.iter().filter(|point| point.stands_out) {
        let figures = point.figures();
        table.rows.push(vec![
            Cell::from(point.line.point as u64),
            Cell::Text(values(&point.line, &of.points)),
            Cell::ms(figures.time_ms),
            Cell::from(figures.area_nand2.value as u64),
            Cell::Number(figures.energy_pj.value / 1e6, 1),
            Cell::from(figures.wrong_samples),
            Cell::Number(figures.ray_caster.energy_pj.value / 1e6, 1),
            Cell::Text(given_up(point)),
        ]);
    }
    table
}

/// All points as rows.
fn rows(found: &[Explorations]) -> Table {
    let mut table = Table::new(
        "Points",
        &[
            "scene",
            "point",
            "values",
            "on_front",
            "reason",
            "cycles",
            "time_ms",
            "area_nand2",
            "area_low",
            "area_high",
            "energy_pj",
            "energy_low",
            "energy_high",
            "wrong_samples",
            "meets_clock",
            "limits",
            "ray_caster_cycles",
            "ray_caster_energy_pj",
            "ray_caster_area_nand2",
        ],
    );
    let number = |value: f64| Cell::Number(value, 3);
    let yes = |is: bool| Cell::from(if is { "yes" } else { "no" });
    for of in found {
        for line in &of.points {
            let on_front = of.front.iter().any(|on| on.line.point == line.point);
            let mut row = vec![
                Cell::Text(of.scene.clone()),
                Cell::from(line.point as u64),
                Cell::Text(values(line, &of.points)),
                yes(on_front),
            ];
            match &line.outcome {
                shiftvox_lab::model::explore::PointOutcome::Refused { reason } => {
                    row.push(Cell::Text(reason.clone()));
                    row.resize(table.columns.len(), Cell::None);
                }
                shiftvox_lab::model::explore::PointOutcome::Drawn(figures) => {
                    let (area, energy) = (figures.area_nand2, figures.energy_pj);
                    row.extend([Cell::None, Cell::from(figures.cycles)]);
                    row.push(number(figures.time_ms));
                    row.extend([area.value, area.low, area.high].map(number));
                    row.extend([energy.value, energy.low, energy.high].map(number));
                    row.push(Cell::from(figures.wrong_samples));
                    row.push(yes(figures.meets_clock));
                    row.push(Cell::Text(figures.limits.clone()));
                    let rays = &figures.ray_caster;
                    row.push(Cell::from(rays.cycles));
                    row.push(number(rays.energy_pj.value));
                    row.push(number(rays.area_nand2.value));
                }
            }
            table.rows.push(row);
        }
    }
    table
}

/// Energy over time: all points by the description that they begin with, the front's best with their numbers, and the
/// ray caster beside each.
fn panel(of: &Explorations) -> Panel {
    let axis = |label: &str| Axis {
        label: label.to_owned(),
        scale: Scale::Linear,
    };
    let numbers = of.front.iter().filter(|point| point.stands_out);
    let numbers: Vec<usize> = numbers.map(|point| point.line.point).collect();
    let mut series: Vec<Series> = Vec::new();
    let mut rays = Vec::new();
    for line in &of.points {
        let Some(figures) = line.figures() else {
            continue;
        };
        let label = numbers.contains(&line.point);
        let point = Point {
            x: figures.time_ms,
            y: figures.energy_pj.value / 1e6,
            label: label.then(|| line.point.to_string()),
        };
        let name = line.values.get("hardware").and_then(Value::as_str);
        let name = name.unwrap_or_default();
        match series.iter_mut().find(|series| series.name == name) {
            Some(series) => series.points.push(point),
            None => series.push(Series::dots(name, vec![point])),
        }
        let rival = &figures.ray_caster;
        let share = rival.cycles as f64 / figures.cycles.max(1) as f64;
        rays.push(Point::from((
            figures.time_ms * share,
            rival.energy_pj.value / 1e6,
        )));
    }
    series.push(Series {
        grey: true,
        ..Series::dots("ray casters beside them, at their fastest", rays)
    });
    Panel::Chart(Chart {
        title: format!(
            "{}: time and energy of each hardware (numbered: no other is clearly better)",
            of.scene
        ),
        x: axis("time of the frame, ms"),
        y: axis("energy of the frame, microjoules"),
        series,
        level: None,
    })
}
