//! Curves and points over two axes.

use std::ops::Range;

use super::canvas::{Anchor, Canvas, Color};
use super::{COLORS, GREY, TITLE_HEIGHT, WIDTH, in_short};

/// Height of a chart, pixels.
pub(super) const HEIGHT: f64 = 540.0;

/// How values lie along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps; from zero, if all values are above it.
    Linear,
    /// Equal factors; values that are not above 0 are left out.
    Log,
}

/// An axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Its label.
    pub label: String,
    /// How values lie along it.
    pub scale: Scale,
}

/// A point of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Along the axis across.
    pub x: f64,
    /// Along the axis up.
    pub y: f64,
    /// Its label.
    pub label: Option<String>,
}

impl From<(f64, f64)> for Point {
    fn from((x, y): (f64, f64)) -> Self {
        Self { x, y, label: None }
    }
}

/// Points of one name.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// The points, in the order in which they are joined.
    pub points: Vec<Point>,
    /// Whether they are joined by a line.
    pub line: bool,
    /// Whether each is a dot.
    pub dots: bool,
    /// Whether it is grey: there for comparison.
    pub grey: bool,
    /// Half the lengths of the points' error bars, in their order, or empty.
    pub deviations: Vec<f64>,
}

impl Series {
    /// Dots joined by a line.
    #[must_use]
    pub fn curve(name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self {
            line: true,
            ..Self::dots(name, points.into_iter().map(Point::from).collect())
        }
    }

    /// Dots alone.
    #[must_use]
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
}

/// A chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Its title.
    pub title: String,
    /// The axis across.
    pub x: Axis,
    /// The axis up.
    pub y: Axis,
    /// Its series.
    pub series: Vec<Series>,
    /// A level to compare with, such as a noise floor: a broken line, and its name.
    pub level: Option<(f64, String)>,
}

impl Chart {
    /// Curves over two logarithmic axes.
    #[must_use]
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
/// Grid lines, and the frame of the legend.
const LINES: Color = 0xdc_dcdc;

/// An axis with its ends.
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

pub(super) fn draw(canvas: &mut Canvas, chart: &Chart) {
    let level = chart.level.iter().map(|(at, _)| *at);
    let level = level.filter(|&at| chart.y.scale == Scale::Linear || at > 0.0);
    let points = |series: &'_ Series| -> Vec<Point> {
        let points = series.points.iter();
        points
            .filter(|point| has_place(chart, point))
            .cloned()
            .collect()
    };
    let shown: Vec<(&Series, Vec<Point>)> = chart
        .series
        .iter()
        .map(|series| (series, points(series)))
        .collect();
    let all = || shown.iter().flat_map(|(_, points)| points);
    let x = Scaled::new(chart.x.scale, all().map(|p| p.x));
    let y = Scaled::new(chart.y.scale, all().map(|p| p.y).chain(level.clone()));
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
    canvas.line(
        &[(corner.0, DOWN.start), corner, (ACROSS.end, corner.1)],
        0,
        1,
        "",
    );
    let middle = (ACROSS.start + ACROSS.end) / 2.0;
    canvas.text(
        &chart.x.label,
        (middle, DOWN.end + 40.0),
        14,
        Anchor::Middle,
    );
    canvas.upwards(&chart.y.label, (20.0, (DOWN.start + DOWN.end) / 2.0), 14);
    let mut legend: Vec<(&str, Color, u32)> = Vec::new();
    if let (Some((_, name)), Some(at)) = (&chart.level, level.clone().next()) {
        let at = below(at);
        canvas.line(&[(ACROSS.start, at), (ACROSS.end, at)], GREY, 1, "6 5");
        legend.push((name, GREY, 1));
    }
    let mut labels: Vec<Room> = Vec::new();
    let pixel = |p: &Point| {
        let (x, y) = place(p);
        (x as i32, y as i32)
    };
    let dots: Vec<(i32, i32)> = shown
        .iter()
        .filter(|(series, _)| series.dots)
        .flat_map(|(_, points)| points.iter().map(pixel))
        .collect();
    let mut colored = 0;
    for (series, points) in &shown {
        let (color, stroke) = if series.grey {
            (GREY, 1)
        } else {
            colored += 1;
            // The second time round the colours, lines are thin.
            let stroke = if colored <= COLORS.len() { 2 } else { 1 };
            (COLORS[(colored - 1) % COLORS.len()], stroke)
        };
        let places: Vec<(f64, f64)> = points.iter().map(place).collect();
        if series.line && places.len() > 1 {
            canvas.line(&places, color, stroke, "");
        }
        if !series.name.is_empty() {
            legend.push((&series.name, color, stroke));
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
        for point in points {
            let Some(label) = &point.label else { continue };
            let (at, letters) = (pixel(point), label.chars().count());
            let across = ACROSS.start as i32..ACROSS.end as i32;
            if let Some((x, y)) = free_place(at, letters, &across, &mut labels, &dots) {
                // Its line has its upper left corner there.
                let at = (f64::from(at.0 + x), f64::from(at.1 + y) + 7.0);
                canvas.text(label, at, 12, Anchor::Start);
            }
        }
    }
    let places: Vec<(i32, i32)> = all().map(pixel).collect();
    draw_legend(canvas, &legend, &places);
}

/// Height of a line of the legend.
const LINE: f64 = 18.0;

fn draw_legend(canvas: &mut Canvas, legend: &[(&str, Color, u32)], places: &[(i32, i32)]) {
    let letters = legend.iter().map(|(name, ..)| name.chars().count()).max();
    let Some(letters) = letters else { return };
    let (width, height) = (
        44.0 + 7.0 * letters as f64,
        LINE * legend.len() as f64 + 8.0,
    );
    let across = ACROSS.start as i32..ACROSS.end as i32;
    let (is_right, is_lower) = legend_corner((across, DOWN.start as i32..DOWN.end as i32), places);
    let left = match is_right {
        true => ACROSS.end - width - 6.0,
        false => ACROSS.start + 6.0,
    };
    let top = match is_lower {
        true => DOWN.end - height - 6.0,
        false => DOWN.start + 6.0,
    };
    canvas.rectangle([left, top, width, height], LINES);
    canvas.rectangle(
        [left + 1.0, top + 1.0, width - 2.0, height - 2.0],
        0xff_ffff,
    );
    for (number, (name, color, stroke)) in legend.iter().enumerate() {
        let middle = top + 4.0 + LINE * (number as f64 + 0.5);
        canvas.line(
            &[(left + 8.0, middle), (left + 26.0, middle)],
            *color,
            *stroke,
            "",
        );
        canvas.text(name, (left + 32.0, middle), 13, Anchor::Start);
    }
}

/// Whether a point lies on both axes.
fn has_place(chart: &Chart, point: &Point) -> bool {
    let on = |axis: &Axis, at: f64| at.is_finite() && (axis.scale == Scale::Linear || at > 0.0);
    on(&chart.x, point.x) && on(&chart.y, point.y)
}

/// The rectangle of a label, pixels: left, right, top, bottom.
type Room = [i32; 4];

/// Height of a label, and width of one of its letters, pixels.
const LETTER: (i32, i32) = (13, 7);

/// The offset of a label of so many letters from its point: the first free place. A place without
/// labels and dots is best, a place without labels is second. `None` if there is no place within
/// the plot.
fn free_place(
    at: (i32, i32),
    letters: usize,
    across: &Range<i32>,
    labels: &mut Vec<Room>,
    dots: &[(i32, i32)],
) -> Option<(i32, i32)> {
    let (height, letter) = LETTER;
    // A label is a line.
    let width = letter * letters as i32;
    let sides = [6, -width - 4, -width / 2];
    let heights = [-6, -20, 8];
    let offsets = heights
        .iter()
        .flat_map(|&y| sides.iter().map(move |&x| (x, y)));
    let room = |(x, y): (i32, i32)| {
        let (left, top) = (at.0 + x, at.1 + y);
        [left, left + width, top, top + height]
    };
    let is_apart = |[l, r, t, b]: Room| {
        let others = labels.iter();
        others
            .into_iter()
            .all(|o| r <= o[0] || o[1] <= l || b <= o[2] || o[3] <= t)
    };
    let has_dot = |[l, r, t, b]: Room| {
        let mut dots = dots.iter().filter(|dot| **dot != at);
        dots.any(|&(x, y)| l - 3 < x && x < r + 3 && t - 3 < y && y < b + 3)
    };
    // Over its own dot there is no place.
    let own = |&(x, y): &(i32, i32)| y == -6 && x == -width / 2;
    let is_within = |[l, r, ..]: Room| across.start <= l && r <= across.end;
    let able: Vec<(i32, i32)> = offsets
        .filter(|o| !own(o) && is_within(room(*o)) && is_apart(room(*o)))
        .collect();
    let free = able.iter().find(|o| !has_dot(room(**o)));
    let chosen = *free.or(able.first())?;
    labels.push(room(chosen));
    Some(chosen)
}

/// The corner of the plotting area with the fewest points in it, as whether it is right and whether
/// it is lower; of equal ones the upper left comes first. Everything in pixels of the picture.
fn legend_corner((across, down): (Range<i32>, Range<i32>), places: &[(i32, i32)]) -> (bool, bool) {
    // The size of a legend of seven lines.
    const ROOM: (i32, i32) = (240, 180);
    let is_near = |at: i32, ends: &Range<i32>, is_end: bool, room: i32| match is_end {
        true => (ends.end - room..ends.end).contains(&at),
        false => (ends.start..ends.start + room).contains(&at),
    };
    let points = |&(is_right, is_lower): &(bool, bool)| {
        let near = places.iter().filter(|(x, y)| {
            is_near(*x, &across, is_right, ROOM.0) && is_near(*y, &down, is_lower, ROOM.1)
        });
        near.count()
    };
    let corners = [(false, false), (true, false), (false, true), (true, true)];
    corners.into_iter().min_by_key(points).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legends_go_where_no_points_are() {
        let area = || (60..880, 40..500);
        let corner = |places: &[(i32, i32)]| legend_corner(area(), places);
        assert_eq!(corner(&[]), (false, false));
        let upper = [(100, 60), (800, 60)];
        assert_eq!(corner(&upper[..1]), (true, false));
        assert_eq!(corner(&upper), (false, true));
    }

    #[test]
    fn labels_move_aside_for_each_other_and_for_dots() {
        let mut labels = Vec::new();
        let dots = [(100, 100), (120, 98)];
        // A dot is on its right: it goes left; the next one above; then each where it has room.
        let first = free_place((100, 100), 3, &(0..900), &mut labels, &dots);
        assert_eq!(first, Some((-25, -6)));
        let places: Vec<_> = (0..8)
            .map(|_| free_place((100, 100), 3, &(0..900), &mut labels, &dots))
            .collect();
        assert!(places.iter().flatten().count() >= 4, "{places:?}");
        assert_eq!(places.last(), Some(&None));
        // At the end of the plot there is room on the left alone.
        let at_end = free_place((100, 300), 3, &(0..110), &mut labels, &[]);
        assert_eq!(at_end, Some((-25, -6)));
        for (i, a) in labels.iter().enumerate() {
            for b in &labels[..i] {
                assert!(a[1] <= b[0] || b[1] <= a[0] || a[3] <= b[2] || b[3] <= a[2]);
            }
        }
    }

    #[test]
    fn axes_end_at_powers_of_ten() {
        assert_eq!(decades([3.0, 40.0].into_iter()), 1.0..100.0);
        assert_eq!(decades([10.0].into_iter()), 10.0..100.0);
        assert_eq!(decades(std::iter::empty()), 1.0..10.0);
    }

    #[test]
    fn ticks_are_round() {
        let ticks = |scale, ends: Range<f64>| Scaled { scale, ends }.ticks();
        assert_eq!(
            ticks(Scale::Linear, 0.0..34.0),
            [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0]
        );
        assert_eq!(
            ticks(Scale::Log, 1.0..100.0),
            [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]
        );
        assert_eq!(ticks(Scale::Log, 1.0..1e5).len(), 6);
    }

    #[test]
    fn plain_axes_begin_at_zero() {
        assert_eq!(around([16.0, 32.0].into_iter()), 0.0..34.0);
        assert_eq!(around([-1.0, 15.0].into_iter()), -2.0..16.0);
        assert_eq!(around(std::iter::empty()), 0.0..1.0);
    }

    #[test]
    fn points_without_a_place_are_left_out() {
        let point = |x, y, label: &str| Point {
            x,
            y,
            label: Some(label.to_owned()),
        };
        let points = vec![
            (1.0, 2.0).into(),
            (0.0, 2.0).into(),
            point(2.0, f64::INFINITY, "gone"),
            point(3.0, 4.0, "here"),
        ];
        let chart = Chart {
            level: Some((0.5, "noise".to_owned())),
            ..Chart::growth("t", "x", "y", vec![Series::dots("s", points)])
        };
        let text = super::super::svg(&[super::super::Panel::Chart(chart)]);
        assert_eq!(text.matches("<circle").count(), 2);
        assert!(text.contains("here") && text.contains("noise") && !text.contains("gone"));
    }
}
