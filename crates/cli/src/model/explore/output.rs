//! The results of an exploration: lines, tables, plots.

use serde_json::{Value, json};

use super::Explorations;
use crate::console::Console;
use crate::document;
use crate::error::CliError;
use crate::experiment::export::{self, Results};
use crate::model::args::ModelArgs;
use shiftvox_lab::model::explore::front::FrontPoint;
use shiftvox_lab::model::explore::lines::{PointLine, kind_first};
use shiftvox_lab::model::tables::TableSpec;
use shiftvox_lab::report::Table;
use shiftvox_lab::report::plot::{Axis, Chart, Point, Scale, Series};

/// With more points, only the front is printed.
const MOST_PRINTED: usize = 64;

const POINTS: TableSpec = TableSpec {
    title: "Points",
    rows: "points",
    columns: "point hardware=hardware_says front time_ms cycles area_nand2::0 \
              energy_uj=energy_pj:1e-6:1 wrong_samples ray_caster_uj=ray_caster.energy_pj:1e-6:1 \
              p_light_less=verdict.p_light_less records=counts.records record_bits=counts.record_bits limits reason",
};

const ROWS: TableSpec = TableSpec {
    title: "Points",
    rows: "points",
    columns: "scene point hardware=hardware_says front reason cycles time_ms area_nand2 energy_pj \
              wrong_samples meets_clock limits ray_caster_cycles=ray_caster.cycles \
              ray_caster_energy_pj=ray_caster.energy_pj ray_caster_area_nand2=ray_caster.area_nand2 \
              ratio_low=verdict.low ratio_median=verdict.median ratio_high=verdict.high \
              p_light_less=verdict.p_light_less decides=verdict.decides turns_at=verdict.turns_at \
              outer_turns_at=verdict.outer_turns_at",
};

const FRONT: TableSpec = TableSpec {
    title: "",
    rows: "front",
    columns: "point hardware=hardware_says time_ms area_nand2::0 energy_uj=energy_pj:1e-6:1 \
              wrong_samples ray_caster_uj=ray_caster.energy_pj:1e-6:1",
};

pub(super) fn write(
    found: &[Explorations],
    args: &ModelArgs,
    console: &Console,
) -> Result<(), CliError> {
    let fronts: Vec<Value> = found.iter().map(front_json).collect();
    let rows: Vec<Value> = found.iter().flat_map(points_json).collect();
    let mut tables = Vec::new();
    for (of, front) in found.iter().zip(&fronts) {
        if of.points.len() <= MOST_PRINTED {
            let points = json!({ "points": points_json(of) });
            let title = format!("{}: all points", of.scene);
            tables.push(Table {
                title,
                ..POINTS.of(&points)
            });
        }
        tables.push(front_table(of, front, args));
    }
    let results = Results {
        document: document::document("explore", json!({ "scenes": fronts })),
        rows: ROWS.of(&json!({ "points": rows })),
        tables,
        charts: found
            .iter()
            .map(|of| shares(of).unwrap_or_else(|| times(of)))
            .collect(),
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
        fields
    };
    json!({
        "scene": of.scene,
        "space_points": of.all,
        "points": of.points.len(),
        "refused": of.points.len() - drawn(of).count(),
        "too_slow_for_their_clock": too_slow(of),
        "front": of.front.iter().map(point).collect::<Vec<_>>(),
    })
}

fn points_json(of: &Explorations) -> Vec<Value> {
    let point = |line: &PointLine| {
        let mut fields = json!(line);
        fields["hardware_says"] = json!(values(line, &of.points));
        fields["front"] = json!(of.front.iter().any(|on| on.line.point == line.point));
        fields
    };
    of.points.iter().map(point).collect()
}

fn values(line: &PointLine, points: &[PointLine]) -> String {
    let varies = |key: &str, value: &Value| {
        let mut others = points.iter().map(|other| other.values.get(key));
        others.any(|other| other != Some(value))
    };
    let hardware = line.values.get("hardware").and_then(Value::as_str);
    let mut words = vec![hardware.unwrap_or_default().to_owned()];
    for (key, value) in &line.values {
        if key != "hardware" && varies(key, value) {
            words.push(format!("{key} {}", value.to_string().trim_matches('"')));
        }
    }
    words.join(", ")
}

fn drawn(of: &Explorations) -> impl Iterator<Item = &PointLine> {
    of.points.iter().filter(|line| line.figures().is_some())
}

fn too_slow(of: &Explorations) -> usize {
    let figures = of.points.iter().filter_map(PointLine::figures);
    figures.filter(|figures| !figures.meets_clock).count()
}

fn front_table(of: &Explorations, front: &Value, args: &ModelArgs) -> Table {
    let points = front["front"].as_array().into_iter().flatten();
    let standing_out: Vec<&Value> = points.filter(|of| of["stands_out"] == true).collect();
    let mut title = format!(
        "{}, {} x {}: of {} hardware designs, {} are Pareto-optimal in time, area, energy and wrong samples. Listed are \
         {}: no other is a tenth better in one measure and less than a tenth worse in all others",
        of.scene,
        args.size.width,
        args.size.height,
        of.points.len(),
        of.front.len(),
        standing_out.len(),
    );
    for (count, what) in [
        (of.all - of.points.len(), "of the space are not measured"),
        (of.points.len() - drawn(of).count(), "cannot draw the frame"),
        (too_slow(of), "are too slow for their clock"),
    ] {
        if count > 0 {
            title += &format!("; {count} {what}");
        }
    }
    Table {
        title,
        ..FRONT.of(&json!({ "front": standing_out }))
    }
}

/// Over sizes of the picture, where they vary: whose energy is less, a curve for each of the other values.
fn shares(of: &Explorations) -> Option<Chart> {
    let mut curves = Vec::<Series>::new();
    for line in &of.points {
        let size = line.values.get("size")?.as_f64()?;
        let Some(figures) = line.figures() else {
            continue;
        };
        let mut others = line.clone();
        others.values.remove("size");
        let name = values(&others, &of.points);
        let curve = Series::of_name(&mut curves, &name, true);
        curve.points.push((size, figures.verdict.median).into());
    }
    curves.first().filter(|curve| curve.points.len() > 1)?;
    let title = format!("{}: energy of the frame, light over ray caster", of.scene);
    Some(Chart {
        level: Some((1.0, "equal".to_owned())),
        ..Chart::growth(&title, "side of the picture, pixels", "ratio", curves)
    })
}

/// Energy over time: a series per hardware description, and the ray caster beside each point.
fn times(of: &Explorations) -> Chart {
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
            y: figures.energy_pj / 1e6,
            label: label.then(|| line.point.to_string()),
        };
        let name = line.values.get("hardware").and_then(Value::as_str);
        let of_name = Series::of_name(&mut series, name.unwrap_or_default(), false);
        of_name.points.push(point);
        let rival = &figures.ray_caster;
        let share = rival.cycles as f64 / figures.cycles.max(1) as f64;
        let place = (figures.time_ms * share, rival.energy_pj / 1e6);
        rays.push(place.into());
    }
    series.push(Series {
        grey: true,
        ..Series::dots("ray casters beside them", rays)
    });
    Chart {
        title: format!(
            "{}: time and energy of each hardware (numbered: no other is clearly better)",
            of.scene
        ),
        x: axis("time of the frame, ms"),
        y: axis("energy of the frame, microjoules"),
        series,
        level: None,
    }
}
