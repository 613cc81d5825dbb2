//! Curves and points over two axes.

use std::ops::Range;

use super::canvas::{Anchor, Canvas, Color};
use super::{COLORS, GREY, TITLE_HEIGHT, WIDTH, in_short};

pub(super) const HEIGHT: f64 = 540.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps; from zero, if all values are above it.
    Linear,
    /// Equal factors; values that are not above 0 are left out.
    Log,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    pub label: String,
    pub scale: Scale,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    pub x: f64,
    pub y: f64,
    pub label: Option<String>,
}

impl From<(f64, f64)> for Point {
    fn from((x, y): (f64, f64)) -> Self {
        Self { x, y, label: None }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    pub name: String,
    pub points: Vec<Point>,
    pub line: bool,
    pub dots: bool,
    pub grey: bool,
    /// Half the lengths of the points' error bars, in their order, or empty.
    pub deviations: Vec<f64>,
}

impl Series {
    pub fn curve(name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self {
            line: true,
            ..Self::dots(name, points.into_iter().map(Point::from).collect())
        }
    }

    pub fn dots(name: impl Into<String>, points: Vec<Point>) -> Self {
        Self {
            name: name.into(),
            points,
            line: false,
            dots: true,
            grey: false,
            deviations: Vec::new(),
        }
    }

    /// The series of a name, which may be new.
    pub fn of_name<'s>(all: &'s mut Vec<Self>, name: &str, line: bool) -> &'s mut Self {
        let found = all.iter().position(|series| series.name == name);
        let at = found.unwrap_or_else(|| {
            let dots = Self::dots(name, Vec::new());
            all.push(Self { line, ..dots });
            all.len() - 1
        });
        &mut all[at]
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    pub series: Vec<Series>,
    /// A level to compare with, such as a noise floor: a broken line, and its name.
    pub level: Option<(f64, String)>,
}

impl Chart {
    pub fn growth(title: &str, x: &str, y: &str, series: Vec<Series>) -> Self {
        let axis = |label: &str| Axis {
            label: label.to_owned(),
            scale: Scale::Log,
        };
        Self {
            title: title.to_owned(),
            x: axis(x),
            y: axis(y),
            series,
            level: None,
        }
    }
}

/// The powers of ten that enclose some values; a decade for none.
fn decades(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if !(low.is_finite() && high > 0.0) {
        return 1.0..10.0;
    }
    let floor = libm::floor(libm::log10(low));
    let ceil = libm::ceil(libm::log10(high)).max(floor + 1.0);
    libm::pow(10.0, floor)..libm::pow(10.0, ceil)
}

/// From zero, or below the least, to a little above the greatest.
fn around(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((0.0f64, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if !high.is_finite() || high <= low {
        return low..low + 1.0;
    }
    let room = (high - low) / 16.0;
    (if low < 0.0 { low - room } else { 0.0 })..high + room
}

/// Pixels of the plot: across, and down from its upper edge.
const ACROSS: Range<f64> = 88.0..WIDTH - 18.0;
const DOWN: Range<f64> = TITLE_HEIGHT..HEIGHT - 58.0;
const LINES: Color = 0xdc_dcdc;

struct Scaled {
    scale: Scale,
    ends: Range<f64>,
}

impl Scaled {
    fn new(scale: Scale, values: impl Iterator<Item = f64>) -> Self {
        let ends = match scale {
            Scale::Log => decades(values),
            Scale::Linear => around(values),
        };
        Self { scale, ends }
    }

    /// Where a value lies: 0 at the beginning, 1 at the end.
    fn share(&self, value: f64) -> f64 {
        let along = |value: f64| match self.scale {
            Scale::Log => libm::log10(value),
            Scale::Linear => value,
        };
        let (from, to) = (along(self.ends.start), along(self.ends.end));
        (along(value) - from) / (to - from)
    }

    /// Values with a grid line and a number. A logarithmic axis has powers of ten, and twice and five
    /// times these if it has few decades. A linear axis has about eight multiples of one, two or
    /// five times a power of ten.
    fn ticks(&self) -> Vec<f64> {
        let Range { start, end } = self.ends;
        if self.scale == Scale::Log {
            let decades = libm::round(libm::log10(end / start)) as i32;
            let first = libm::round(libm::log10(start)) as i32;
            let steps: &[f64] = if decades <= 3 {
                &[1.0, 2.0, 5.0]
            } else {
                &[1.0]
            };
            let each = 1 + decades / 12;
            let powers = (0..=decades).step_by(each as usize);
            let ticks = powers.flat_map(|power| {
                let power = libm::pow(10.0, f64::from(first + power));
                steps.iter().map(move |step| step * power)
            });
            return ticks.filter(|tick| *tick <= end * 1.001).collect();
        }
        let rough = (end - start) / 8.0;
        let power = libm::pow(10.0, libm::floor(libm::log10(rough)));
        let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
        let step = steps.into_iter().find(|step| *step >= rough);
        let step = step.unwrap_or(rough);
        let first = libm::ceil(start / step) as i64;
        let last = libm::floor(end / step) as i64;
        (first..=last).map(|tick| tick as f64 * step).collect()
    }
}

pub(super) fn draw<'c>(canvas: &mut Canvas, chart: &'c Chart) -> Vec<(&'c str, Color)> {
    let level = chart.level.as_ref();
    let level = level.filter(|level| chart.y.scale == Scale::Linear || level.0 > 0.0);
    let shown: Vec<(&Series, Vec<&Point>)> = chart
        .series
        .iter()
        .map(|of| {
            (
                of,
                of.points.iter().filter(|p| has_place(chart, p)).collect(),
            )
        })
        .collect();
    let all = || shown.iter().flat_map(|(_, points)| points);
    let x = Scaled::new(chart.x.scale, all().map(|p| p.x));
    let levels = level.iter().map(|level| level.0);
    let y = Scaled::new(chart.y.scale, all().map(|p| p.y).chain(levels));
    let right_of = |value| ACROSS.start + x.share(value) * (ACROSS.end - ACROSS.start);
    let below = |value| DOWN.end - y.share(value) * (DOWN.end - DOWN.start);
    let place = |p: &Point| (right_of(p.x), below(p.y));
    canvas.text(&chart.title, (WIDTH / 2.0, 24.0), 20, Anchor::Middle);
    for tick in x.ticks() {
        let at = right_of(tick);
        canvas.line(&[(at, DOWN.start), (at, DOWN.end)], LINES, 1, "");
        canvas.text(&in_short(tick), (at, DOWN.end + 14.0), 14, Anchor::Middle);
    }
    for tick in y.ticks() {
        let at = below(tick);
        canvas.line(&[(ACROSS.start, at), (ACROSS.end, at)], LINES, 1, "");
        canvas.text(&in_short(tick), (ACROSS.start - 6.0, at), 14, Anchor::End);
    }
    let corner = (ACROSS.start, DOWN.end);
    let axes = [(corner.0, DOWN.start), corner, (ACROSS.end, corner.1)];
    canvas.line(&axes, 0, 1, "");
    let middle = ((ACROSS.start + ACROSS.end) / 2.0, DOWN.end + 40.0);
    canvas.text(&chart.x.label, middle, 14, Anchor::Middle);
    canvas.upwards(&chart.y.label, (20.0, (DOWN.start + DOWN.end) / 2.0), 14);
    let mut legend: Vec<(&str, Color)> = Vec::new();
    if let Some((level, name)) = level {
        let at = below(*level);
        canvas.line(&[(ACROSS.start, at), (ACROSS.end, at)], GREY, 1, "6 5");
        legend.push((name, GREY));
    }
    let dotted = shown.iter().filter(|(series, _)| series.dots);
    let dots = dotted.flat_map(|(_, points)| points).map(|p| {
        let (x, y) = place(p);
        [x - 3.0, x + 3.0, y - 3.0, y + 3.0]
    });
    let mut labels = Labels {
        dots: dots.collect(),
        placed: Vec::new(),
    };
    let mut colors = COLORS.into_iter().cycle();
    for (series, points) in &shown {
        let color = match series.grey {
            true => GREY,
            false => colors.next().unwrap_or(GREY),
        };
        let places: Vec<(f64, f64)> = points.iter().map(|p| place(p)).collect();
        if series.line && places.len() > 1 {
            canvas.line(&places, color, if series.grey { 1 } else { 2 }, "");
        }
        if !series.name.is_empty() {
            legend.push((&series.name, color));
        }
        if series.dots {
            places.iter().for_each(|&at| canvas.dot(at, color));
        }
        for (point, deviation) in series.points.iter().zip(&series.deviations) {
            let ends = [point.y - deviation, point.y + deviation];
            if has_place(chart, point) && (chart.y.scale == Scale::Linear || ends[0] > 0.0) {
                let across = right_of(point.x);
                canvas.line(&ends.map(|end| (across, below(end))), color, 1, "");
            }
        }
        for (point, &at) in points.iter().zip(&places) {
            let Some(label) = &point.label else { continue };
            if let Some((x, y)) = labels.place(at, label.chars().count()) {
                canvas.text(label, (x, y + LETTER.1 / 2.0), 12, Anchor::Start);
            }
        }
    }
    legend
}

fn has_place(chart: &Chart, point: &Point) -> bool {
    let on = |axis: &Axis, at: f64| at.is_finite() && (axis.scale == Scale::Linear || at > 0.0);
    on(&chart.x, point.x) && on(&chart.y, point.y)
}

type Room = [f64; 4];

/// Width of a label's letter, and its height, pixels.
const LETTER: (f64, f64) = (7.0, 13.0);

struct Labels {
    dots: Vec<Room>,
    placed: Vec<Room>,
}

impl Labels {
    /// The upper left corner of a label beside its dot: the first place without labels and dots, or
    /// else without labels. `None` if there is none within the plot.
    fn place(&mut self, (x, y): (f64, f64), letters: usize) -> Option<(f64, f64)> {
        let width = LETTER.0 * letters as f64;
        let (right, left, over) = (6.0, -width - 4.0, -width / 2.0);
        let level = [(right, -6.0), (left, -6.0)];
        let others = [-20.0, 8.0].map(|down| [right, left, over].map(|across| (across, down)));
        let offsets = level.into_iter().chain(others.into_iter().flatten());
        let room = |(dx, dy): (f64, f64)| [x + dx, x + dx + width, y + dy, y + dy + LETTER.1];
        let is_apart = |rooms: &[Room], [l, r, t, b]: Room| {
            let apart = |o: &Room| r <= o[0] || o[1] <= l || b <= o[2] || o[3] <= t;
            rooms.iter().all(apart)
        };
        let able: Vec<Room> = offsets
            .map(room)
            .filter(|o| ACROSS.start <= o[0] && o[1] <= ACROSS.end && is_apart(&self.placed, *o))
            .collect();
        let free = able.iter().find(|o| is_apart(&self.dots, **o));
        let chosen = *free.or(able.first())?;
        self.placed.push(chosen);
        Some((chosen[0], chosen[2]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_move_aside_for_each_other_and_for_dots() {
        let mut labels = Labels {
            dots: [(97.0, 97.0), (117.0, 95.0), (860.0, 298.0)]
                .map(|(x, y)| [x, x + 6.0, y, y + 6.0])
                .into(),
            placed: Vec::new(),
        };
        let places = [(); 9].map(|()| labels.place((120.0, 98.0), 3));
        assert_eq!((places[0], places[8]), (Some((126.0, 92.0)), None));
        assert!(places.iter().flatten().count() >= 4, "{places:?}");
        for (i, a) in labels.placed.iter().enumerate() {
            let is_apart = |b: &Room| a[1] <= b[0] || b[1] <= a[0] || a[3] <= b[2] || b[3] <= a[2];
            assert!(labels.placed[..i].iter().all(is_apart), "{a:?}");
        }
        // At the end of the plot there is room on the left alone, and a dot there sends it up.
        assert_eq!(labels.place((879.0, 400.0), 3), Some((854.0, 394.0)));
        assert_eq!(labels.place((879.0, 300.0), 3), Some((854.0, 280.0)));
    }

    #[test]
    fn axes_have_round_ends_and_ticks() {
        let (log, linear) = (Scale::Log, Scale::Linear);
        for (scale, values, ends, ticks) in [
            (
                log,
                &[3., 40.][..],
                1.0..100.0,
                &[1., 2., 5., 10., 20., 50., 100.][..],
            ),
            (log, &[10., 1e5], 10.0..1e5, &[1e1, 1e2, 1e3, 1e4, 1e5]),
            (log, &[10.], 10.0..100.0, &[10., 20., 50., 100.]),
            (log, &[], 1.0..10.0, &[1., 2., 5., 10.]),
            (
                linear,
                &[16., 32.],
                0.0..34.0,
                &[0., 5., 10., 15., 20., 25., 30.],
            ),
            (linear, &[-1., 15.], -2.0..16.0, &[0., 5., 10., 15.]),
        ] {
            let scaled = Scaled::new(scale, values.iter().copied());
            assert_eq!((&scaled.ticks()[..], scaled.ends), (ticks, ends));
        }
    }
}
