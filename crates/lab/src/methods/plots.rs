//! Which method is worth having at which distance.

use super::measure::{Distance, MeshMethods, Outcome};
use crate::error::dominated;
use crate::report::plot::{Axis, Chart, Panel, Point, Scale, Series};

/// For each distance time against error; then error, time and flicker over distances, of the
/// method of each family that has the least error.
#[must_use]
pub fn panels(mesh: &MeshMethods) -> Vec<Panel> {
    let mut panels: Vec<Panel> = mesh.distances.iter().map(|d| pareto(mesh, d)).collect();
    let error = |o: &Outcome| Some(o.picture.flip);
    let time = |o: &Outcome| Some(o.thread.as_ref().unwrap_or(&o.wall).median_ms);
    let flicker = |o: &Outcome| o.flicker.map(|f| 1e3 * f);
    panels.extend(over_distances(mesh, "error: mean FLIP", error));
    panels.extend(over_distances(mesh, "ms a frame, one thread", time));
    panels.extend(over_distances(
        mesh,
        "flicker, thousandths of white",
        flicker,
    ));
    panels
}

fn axis(label: &str) -> Axis {
    Axis {
        label: label.to_owned(),
        scale: Scale::Log,
    }
}

fn pareto(mesh: &MeshMethods, distance: &Distance) -> Panel {
    let done: Vec<(usize, &str, &str, [f64; 2])> = distance
        .rows
        .iter()
        .zip(&mesh.facts)
        .enumerate()
        .filter_map(|(number, (row, facts))| {
            let outcome = row.outcome.as_ref().ok()?;
            let time = outcome.thread.as_ref().unwrap_or(&outcome.wall);
            let place = [time.median_ms, outcome.picture.flip];
            Some((number + 1, facts.label.as_str(), row.family, place))
        })
        .collect();
    let places: Vec<[f64; 2]> = done.iter().map(|(.., place)| *place).collect();
    let mut front: Vec<(f64, f64)> = Vec::new();
    let mut families: Vec<Series> = Vec::new();
    let mut grey = Series::dots("dominated", Vec::new());
    grey.grey = true;
    for ((number, label, family, [x, y]), is_dominated) in done.iter().zip(dominated(&places)) {
        let (x, y) = (*x, *y);
        let named = |label: String| Point {
            x,
            y,
            label: Some(label),
        };
        if is_dominated {
            // The table has its name.
            grey.points.push(named(number.to_string()));
            continue;
        }
        let point = named(format!("{number} {label}"));
        front.push((x, y));
        match families.iter_mut().find(|series| series.name == *family) {
            Some(series) => series.points.push(point),
            None => families.push(Series::dots(*family, vec![point])),
        }
    }
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut line = Series::curve("", front);
    (line.dots, line.grey) = (false, true);
    // Names before numbers: what has no room is left out.
    let mut series = vec![line];
    series.extend(families);
    series.push(grey);
    let (width, height) = distance.size;
    Panel::Chart(Chart {
        title: format!("{}, {width} x {height} pixels", mesh.mesh),
        x: axis("ms a frame, one thread (median)"),
        y: axis("error against 256 samples: mean FLIP"),
        series,
        level: Some((distance.noise_floor.flip, "noise floor".to_owned())),
    })
}

/// Of each family the method with the least error, all distances together.
fn leaders(mesh: &MeshMethods) -> Vec<usize> {
    let Some(first) = mesh.distances.first() else {
        return Vec::new();
    };
    let error = |place: usize| -> f64 {
        let outcomes = mesh.distances.iter().map(|d| &d.rows[place].outcome);
        outcomes
            .map(|outcome| outcome.as_ref().map_or(1.0, |outcome| outcome.picture.flip))
            .sum()
    };
    let mut leaders: Vec<usize> = Vec::new();
    for (place, row) in first.rows.iter().enumerate() {
        let family = |at: &&mut usize| first.rows[**at].family == row.family;
        match leaders.iter_mut().find(family) {
            None => leaders.push(place),
            Some(leader) if error(place) < error(*leader) => *leader = place,
            Some(_) => {}
        }
    }
    leaders
}

/// A value of the leaders over the distances; nothing where it was not measured.
fn over_distances(
    mesh: &MeshMethods,
    label: &str,
    value: impl Fn(&Outcome) -> Option<f64>,
) -> Option<Panel> {
    let points = leaders(mesh).into_iter().flat_map(|place| {
        let facts = &mesh.facts[place];
        let value = &value;
        mesh.distances.iter().filter_map(move |distance| {
            let outcome = distance.rows[place].outcome.as_ref().ok()?;
            let at = (f64::from(distance.size.1), value(outcome)?);
            Some((facts.label.clone(), at))
        })
    });
    let series = Series::collect(points);
    (!series.is_empty()).then(|| {
        Panel::Chart(Chart {
            title: format!("{}: {label}", mesh.mesh),
            x: axis("pixels down the picture"),
            y: axis(label),
            series,
            level: None,
        })
    })
}
