//! The Pareto front: the points that no other point dominates in time, area, energy and wrong samples, and their trade-offs.

use serde::Serialize;

use super::PointFigures;
use super::lines::PointLine;

/// A measure of points; less is better.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Objective {
    /// Time of the frame.
    Time,
    /// Area.
    Area,
    /// Energy of the frame.
    Energy,
    /// Wrong samples.
    Error,
}

impl Objective {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Time, Self::Area, Self::Energy, Self::Error];

    /// The objective in a word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Area => "area",
            Self::Energy => "energy",
            Self::Error => "wrong samples",
        }
    }

    /// A point's figure.
    #[must_use]
    pub fn of(self, figures: &PointFigures) -> f64 {
        match self {
            Self::Time => figures.time_ms,
            Self::Area => figures.area_nand2.value,
            Self::Energy => figures.energy_pj.value,
            Self::Error => figures.wrong_samples as f64,
        }
    }

    /// How many times as much `b` has as `a`. Of samples, one is added to both: there may be none.
    fn ratio(self, a: &PointFigures, b: &PointFigures) -> f64 {
        let one = f64::from(u8::from(self == Self::Error));
        (self.of(b) + one) / (self.of(a) + one)
    }
}

/// A change of one figure from a point to another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Change {
    /// The figure.
    pub objective: Objective,
    /// How many times as much; of wrong samples, plus one.
    pub ratio: f64,
}

/// A trade-off: another point has less in one measure, and more in others.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Exchange {
    /// The other point.
    pub to: usize,
    /// The measure with less.
    pub gain: Change,
    /// The measures with more, most first.
    pub price: Vec<Change>,
}

/// The ratio from which a difference matters.
pub const WORTH: f64 = 1.1;

/// A point of the front.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrontPoint {
    /// The point.
    #[serde(flatten)]
    pub line: PointLine,
    /// Whether it stands out: no other such point is better by more than [`WORTH`] in one measure, and nowhere worse by that.
    pub stands_out: bool,
    /// For each figure that another point of the front has clearly less of, the best exchange: the one whose
    /// gain is largest beside its highest price. Among the points that stand out.
    pub gives_up: Vec<Exchange>,
}

impl FrontPoint {
    /// Its figures.
    ///
    /// # Panics
    /// Never: what was refused is on no front.
    #[must_use]
    pub fn figures(&self) -> &PointFigures {
        match self.line.figures() {
            Some(figures) => figures,
            None => unreachable!("what was refused is on no front"),
        }
    }
}

/// The front of a scene's points, fastest first. Points whose units miss the clock are excluded. Of equal points only the
/// first is on the front.
#[must_use]
pub fn front(points: &[PointLine]) -> Vec<FrontPoint> {
    let standing = |of: &PointFigures| Objective::ALL.map(|objective| objective.of(of));
    let able = points.iter().filter_map(|line| {
        let figures = line.figures().filter(|of| of.meets_clock)?;
        Some((line, figures))
    });
    let mut able: Vec<(&PointLine, &PointFigures)> = able.collect();
    able.sort_by(|a, b| compare(&standing(a.1), &standing(b.1)).then(a.0.point.cmp(&b.0.point)));
    able.dedup_by(|later, first| standing(first.1) == standing(later.1));
    let standings: Vec<[f64; 4]> = able.iter().map(|(_, of)| standing(of)).collect();
    let is_beaten = |own: &[f64; 4]| standings.iter().any(|other| dominates(other, own));
    let unbeaten = able
        .iter()
        .zip(&standings)
        .filter(|(_, own)| !is_beaten(own));
    let kept: Vec<_> = unbeaten.map(|(point, _)| *point).collect();
    let standing_out = standing_out(&kept);
    let with_exchanges = |&(line, figures): &(&PointLine, &PointFigures)| FrontPoint {
        line: line.clone(),
        stands_out: standing_out.iter().any(|(of, _)| of.point == line.point),
        gives_up: Objective::ALL
            .into_iter()
            .filter_map(|objective| best_exchange(objective, figures, &standing_out))
            .collect(),
    };
    kept.iter().map(with_exchanges).collect()
}

/// Whether `a` is nowhere worse than `b`, and somewhere better.
fn dominates(a: &[f64; 4], b: &[f64; 4]) -> bool {
    let pairs = || a.iter().zip(b);
    pairs().all(|(a, b)| a <= b) && pairs().any(|(a, b)| a < b)
}

/// The points that stand out. A slower point is removed first, if another stands for it.
fn standing_out<'a>(
    front: &[(&'a PointLine, &'a PointFigures)],
) -> Vec<(&'a PointLine, &'a PointFigures)> {
    let mut left = front.to_vec();
    for (line, own) in front.iter().rev() {
        let stands_for_it = |(other, figures): &(&PointLine, &PointFigures)| {
            let ratios = Objective::ALL.map(|objective| objective.ratio(own, figures));
            other.point != line.point
                && ratios.iter().all(|&ratio| ratio <= WORTH)
                && ratios.iter().any(|&ratio| ratio < 1.0 / WORTH)
        };
        if left.iter().any(stands_for_it) {
            left.retain(|(other, _)| other.point != line.point);
        }
    }
    left
}

fn compare(a: &[f64; 4], b: &[f64; 4]) -> std::cmp::Ordering {
    let pairs = a.iter().zip(b);
    let mut differing = pairs.map(|(a, b)| a.total_cmp(b)).filter(|o| o.is_ne());
    differing.next().unwrap_or(std::cmp::Ordering::Equal)
}

fn best_exchange(
    objective: Objective,
    own: &PointFigures,
    front: &[(&PointLine, &PointFigures)],
) -> Option<Exchange> {
    let exchange = |&(line, other): &(&PointLine, &PointFigures)| {
        let ratio = objective.ratio(own, other);
        if ratio >= 1.0 / WORTH {
            return None;
        }
        let changes = Objective::ALL.map(|objective| Change {
            objective,
            ratio: objective.ratio(own, other),
        });
        let mut price: Vec<Change> = changes.into_iter().filter(|of| of.ratio > 1.0).collect();
        price.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
        let highest = price.first().map_or(1.0, |of| of.ratio);
        let gain = Change { objective, ratio };
        let to = line.point;
        Some((highest * ratio, Exchange { to, gain, price }))
    };
    front
        .iter()
        .filter_map(exchange)
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, exchange)| exchange)
}

impl std::fmt::Display for Change {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} x {:.2}", self.objective.name(), self.ratio)
    }
}

impl std::fmt::Display for Exchange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Increases below 0.5 % are ignored.
        let price = self.price.iter().filter(|change| change.ratio >= 1.005);
        let price: Vec<String> = price.map(Change::to_string).collect();
        let price = match price.as_slice() {
            [] => "hardly anything".to_owned(),
            price => price.join(", "),
        };
        write!(f, "{} for {price}: #{}", self.gain, self.to)
    }
}
