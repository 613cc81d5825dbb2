//! The Pareto front: the points that no other point dominates in time, area, energy and wrong samples.

use serde::Serialize;

use super::PointFigures;
use super::lines::PointLine;
use crate::report::plot::dominates;

/// The ratio from which a difference matters.
const WORTH: f64 = 1.1;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrontPoint {
    #[serde(flatten)]
    pub line: PointLine,
    /// Whether it stands out: no other such point is better by more than a tenth in one measure, and nowhere worse by that.
    pub stands_out: bool,
}

type Measured<'a> = (&'a PointLine, [f64; 4]);

fn measures(figures: &PointFigures) -> [f64; 4] {
    [
        figures.time_ms,
        figures.area_nand2,
        figures.energy_pj,
        figures.wrong_samples as f64,
    ]
}

/// The front of a scene's points, fastest first. Points whose units miss the clock are excluded. Of equal points only the
/// first is on the front.
pub fn front(points: &[PointLine]) -> Vec<FrontPoint> {
    let able = points.iter().filter_map(|line| {
        let figures = line.figures().filter(|of| of.meets_clock)?;
        Some((line, measures(figures)))
    });
    let mut able: Vec<Measured<'_>> = able.collect();
    // No measure is negative or not a number.
    able.sort_by(|a, b| {
        a.1.partial_cmp(&b.1)
            .unwrap_or(std::cmp::Ordering::Equal)
            .then(a.0.point.cmp(&b.0.point))
    });
    able.dedup_by(|later, first| first.1 == later.1);
    let mut kept = able.clone();
    kept.retain(|(_, own)| !able.iter().any(|(_, other)| dominates(other, own)));
    let standing_out = standing_out(&kept);
    let on_front = |(line, _): &Measured<'_>| FrontPoint {
        line: (*line).clone(),
        stands_out: standing_out.iter().any(|(of, _)| of.point == line.point),
    };
    kept.iter().map(on_front).collect()
}

/// The points that stand out. A slower point is removed first, if another stands for it.
fn standing_out<'a>(front: &[Measured<'a>]) -> Vec<Measured<'a>> {
    let mut left = front.to_vec();
    for (line, own) in front.iter().rev() {
        let stands_for_it = |(other, measures): &Measured<'_>| {
            // There may be no wrong samples, so one is added.
            let ratio = |k: usize| {
                let one = if k == 3 { 1.0 } else { 0.0 };
                (measures[k] + one) / (own[k] + one)
            };
            other.point != line.point
                && (0..4).all(|k| ratio(k) <= WORTH)
                && (0..4).any(|k| ratio(k) < 1.0 / WORTH)
        };
        if left.iter().any(stands_for_it) {
            left.retain(|(other, _)| other.point != line.point);
        }
    }
    left
}
