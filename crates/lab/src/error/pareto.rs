//! Which methods are worth having: those that no other beats in everything.

use super::measure::SceneErrors;
use super::measure::{MethodErrors, Outcome};
use crate::report::plot::{Axis, Chart, Panel, Point, Scale, Series};

/// For each point, whether another is at most as far along every axis and
/// less along one. Points without a place (not finite) are neither.
#[must_use]
pub fn dominated<const N: usize>(points: &[[f64; N]]) -> Vec<bool> {
    points
        .iter()
        .map(|p| points.iter().any(|q| beats(q, p)))
        .collect()
}

/// Whether `q` is nowhere worse than `p`, and somewhere better.
fn beats<const N: usize>(q: &[f64; N], p: &[f64; N]) -> bool {
    let pairs = || q.iter().zip(p);
    pairs().all(|(q, p)| q <= p) && pairs().any(|(q, p)| q < p)
}

/// A method's work, wrong coverage and picture error: what it is beaten by.
fn standing(outcome: &Outcome) -> [f64; 3] {
    [
        work(outcome),
        outcome.samples.map_or(f64::INFINITY, |s| s.wrong_share()),
        outcome.picture.rms_linear,
    ]
}

/// What a method counts as its work.
fn work(outcome: &Outcome) -> f64 {
    outcome.counters.first().map_or(f64::NAN, |c| c.1 as f64)
}

/// What is less by a smaller part than this is not worth mentioning.
const WORTH_MENTIONING: f64 = 0.01;

/// By row, the method of the same family that beats it with the least work:
/// no more work, no more wrong coverage, no greater error of the picture, and one of
/// them less by a hundredth or more.
#[must_use]
pub fn beaten_by(rows: &[MethodErrors]) -> Vec<Option<String>> {
    let standings: Vec<_> = rows
        .iter()
        .map(|row| row.outcome.as_ref().ok().map(standing))
        .collect();
    let winner = |place: usize| {
        let own = standings[place]?;
        let others = rows.iter().zip(&standings);
        let better = others.filter_map(|(row, other)| {
            let other = (*other)?;
            let same = row.family == rows[place].family;
            let less = |(q, p): (&f64, &f64)| *q < p * (1.0 - WORTH_MENTIONING);
            let clearly = other.iter().zip(&own).any(less);
            (same && clearly && beats(&other, &own)).then_some((other[0], row))
        });
        better
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, row)| row.method.clone())
    };
    (0..rows.len()).map(winner).collect()
}

/// What plots have across.
#[derive(Clone, Copy)]
enum XAxis {
    Time,
    Work,
}

/// Points nearer to each other than this part of their values would have
/// their names on top of each other.
const CLOSE: f64 = 0.12;

/// What plots have up.
#[derive(Clone, Copy)]
enum YAxis {
    Light,
    Flip,
    Coverage,
}

/// Plots of a scene: time, and machine-independent work, against three errors.
#[must_use]
pub fn panels(scene: &SceneErrors) -> Vec<Panel> {
    let mut panels = Vec::new();
    for up in [YAxis::Light, YAxis::Flip, YAxis::Coverage] {
        for across in [XAxis::Work, XAxis::Time] {
            panels.push(Panel::Chart(chart(scene, across, up)));
        }
    }
    panels
}

fn chart(scene: &SceneErrors, across: XAxis, up: YAxis) -> Chart {
    // Half a sample in a million stands for none, which a logarithm has no place for.
    const NONE: f64 = 0.5;
    let done: Vec<(&MethodErrors, &Outcome)> = scene
        .rows
        .iter()
        .filter_map(|row| Some((row, row.outcome.as_ref().ok()?)))
        .collect();
    let place = |outcome: &Outcome| {
        let x = match across {
            XAxis::Time => outcome.thread.unwrap_or(outcome.wall).median_ms,
            // Other families count other things.
            XAxis::Work if outcome.samples.is_none() => f64::NAN,
            XAxis::Work => work(outcome),
        };
        let y = match up {
            YAxis::Light => outcome.picture.rms_linear,
            YAxis::Flip => outcome.picture.flip,
            YAxis::Coverage => {
                let samples = outcome.samples.map_or(f64::NAN, |s| s.wrong_share());
                (1e6 * samples).max(if samples.is_nan() { f64::NAN } else { NONE })
            }
        };
        [x, y]
    };
    let places: Vec<[f64; 2]> = done.iter().map(|(_, outcome)| place(outcome)).collect();
    let is_dominated = dominated(&places);
    let mut grey = Series::dots("dominated", Vec::new());
    grey.grey = true;
    let mut front: Vec<(f64, f64)> = Vec::new();
    let mut kinds: Vec<Series> = Vec::new();
    for (((row, _), [x, y]), is_dominated) in done.iter().zip(places).zip(is_dominated) {
        if is_dominated {
            grey.points.push((x, y).into());
            continue;
        }
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < CLOSE;
        let twin = front.iter().any(|&(u, v)| near(u, x) && near(v, y));
        front.push((x, y));
        let point = Point {
            x,
            y,
            // Of methods beside each other the first is named.
            label: (!twin).then(|| row.method.clone()),
        };
        match kinds.iter_mut().find(|kind| kind.name == row.kind) {
            Some(kind) => kind.points.push(point),
            None => kinds.push(Series::dots(row.kind.clone(), vec![point])),
        }
    }
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut line = Series::curve("", front);
    (line.dots, line.grey) = (false, true);
    let mut series = vec![grey, line];
    series.extend(kinds);
    let floor = &scene.noise_floor;
    let (label, level) = match up {
        YAxis::Light => (
            "error against the reference: rms, linear light",
            Some(floor.rms_linear),
        ),
        YAxis::Flip => ("error against the reference: mean FLIP", Some(floor.flip)),
        YAxis::Coverage => ("extra and missing samples per million covered", None),
    };
    let x_label = match across {
        XAxis::Time => "ms a frame, one thread (median)",
        XAxis::Work => "operations of the machine a frame",
    };
    let axis = |label: &str| Axis {
        label: label.to_owned(),
        scale: Scale::Log,
    };
    Chart {
        title: format!("{}, {}x{}", scene.scene, scene.width, scene.height),
        x: axis(x_label),
        y: axis(label),
        series,
        level: match level {
            Some(level) => Some((level, "noise floor".to_owned())),
            None => Some((NONE, "none".to_owned())),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn domination() {
        let points = [
            [1.0, 5.0],
            [2.0, 2.0],
            [2.0, 3.0],
            [5.0, 1.0],
            [6.0, 1.0],
            [2.0, 2.0],
        ];
        let expected = [false, false, true, false, true, false];
        assert_eq!(dominated(&points), expected);
        assert_eq!(dominated(&[[f64::NAN, 0.0], [1.0, 1.0]]), [false, false]);
    }
}
