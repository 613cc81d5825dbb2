//! Curves and points over two axes.

use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;

use super::{Area, COLORS, GREY, PlotError, in_short};

/// Height of a chart, pixels.
pub(super) const HEIGHT: u32 = 540;

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
    /// What it measures.
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
    /// What stands beside it.
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
    /// What the legend calls it.
    pub name: String,
    /// The points, in the order in which they are joined.
    pub points: Vec<Point>,
    /// Whether they are joined by a line.
    pub line: bool,
    /// Whether each is a dot.
    pub dots: bool,
    /// Whether it is grey: there for comparison.
    pub grey: bool,
}

impl Series {
    /// Dots joined by a line.
    #[must_use]
    pub fn curve(name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self {
            name: name.into(),
            points: points.into_iter().map(Point::from).collect(),
            line: true,
            dots: true,
            grey: false,
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
        }
    }

    /// Named points, put together by name, in the order in which names come: curves.
    pub fn collect(points: impl IntoIterator<Item = (String, (f64, f64))>) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for (name, point) in points {
            match all.iter_mut().find(|series| series.name == name) {
                Some(series) => series.points.push(point.into()),
                None => all.push(Self::curve(name, [point])),
            }
        }
        all
    }
}

/// A chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// What stands above it.
    pub title: String,
    /// The axis across.
    pub x: Axis,
    /// The axis up.
    pub y: Axis,
    /// What is drawn.
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
fn decades(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
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
fn around(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (low, high) = values.fold((0.0f64, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if !high.is_finite() || high <= low {
        return low..low + 1.0;
    }
    let room = (high - low) / 16.0;
    (if low < 0.0 { low - room } else { 0.0 })..high + room
}

pub(super) fn draw(area: &Area<'_>, chart: &Chart) -> Result<(), PlotError> {
    let shown: Vec<(&Series, Vec<&Point>)> = chart
        .series
        .iter()
        .map(|series| {
            (
                series,
                series
                    .points
                    .iter()
                    .filter(|p| has_place(chart, p))
                    .collect(),
            )
        })
        .collect();
    let all = || shown.iter().flat_map(|(_, points)| points.iter().copied());
    let level = chart.level.iter().map(|(at, _)| *at);
    let level = level.filter(|&at| chart.y.scale == Scale::Linear || at > 0.0);
    let xs = || all().map(|p| p.x);
    let ys = || all().map(|p| p.y).chain(level.clone());
    match (chart.x.scale, chart.y.scale) {
        (Scale::Log, Scale::Log) => {
            let (x, y) = (decades(xs()), decades(ys()));
            on_axes(area, chart, &shown, x.clone().log_scale(), y.log_scale(), x)
        }
        (Scale::Log, Scale::Linear) => {
            let (x, y) = (decades(xs()), around(ys()));
            on_axes(area, chart, &shown, x.clone().log_scale(), y, x)
        }
        (Scale::Linear, Scale::Log) => {
            let (x, y) = (around(xs()), decades(ys()));
            on_axes(area, chart, &shown, x.clone(), y.log_scale(), x)
        }
        (Scale::Linear, Scale::Linear) => {
            let (x, y) = (around(xs()), around(ys()));
            on_axes(area, chart, &shown, x.clone(), y, x)
        }
    }
}

/// Whether a point lies on both axes.
fn has_place(chart: &Chart, point: &Point) -> bool {
    let on = |axis: &Axis, at: f64| at.is_finite() && (axis.scale == Scale::Linear || at > 0.0);
    on(&chart.x, point.x) && on(&chart.y, point.y)
}

/// What a label takes, pixels: left, right, top, bottom.
type Room = [i32; 4];

/// Height of a label, and width of one of its letters, pixels.
const LETTER: (i32, i32) = (13, 7);

/// Where a label of so many letters stands beside its point, from the point: the first place that
/// no other label takes and no dot is in, or at least no other label; `None` where there is none
/// between the ends of the plot.
fn free_place(
    at: (i32, i32),
    letters: usize,
    across: &std::ops::Range<i32>,
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

/// Draws on axes of any kind. `across`: the ends of the axis across.
fn on_axes<X, Y>(
    area: &Area<'_>,
    chart: &Chart,
    shown: &[(&Series, Vec<&Point>)],
    x: X,
    y: Y,
    across: std::ops::Range<f64>,
) -> Result<(), PlotError>
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let mut drawing = ChartBuilder::on(area)
        .caption(&chart.title, ("sans-serif", 20))
        .margin(14)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(x, y)
        .map_err(PlotError::of)?;
    drawing
        .configure_mesh()
        .x_desc(&chart.x.label)
        .y_desc(&chart.y.label)
        .light_line_style(RGBColor(235, 235, 235))
        .bold_line_style(RGBColor(205, 205, 205))
        .x_label_formatter(&|x| in_short(*x))
        .y_label_formatter(&|y| in_short(*y))
        .label_style(("sans-serif", 14))
        .draw()
        .map_err(PlotError::of)?;
    if let Some((at, name)) = &chart.level {
        let ends = [(across.start, *at), (across.end, *at)];
        let line = DashedLineSeries::new(ends, 6, 5, GREY.stroke_width(1));
        let drawn = drawing.draw_series(line).map_err(PlotError::of)?;
        drawn
            .label(name)
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], GREY));
    }
    let mut colored = 0;
    let mut labels: Vec<Room> = Vec::new();
    let (across_px, _) = drawing.plotting_area().get_pixel_range();
    let dots: Vec<(i32, i32)> = shown
        .iter()
        .filter(|(series, _)| series.dots)
        .flat_map(|(_, points)| points.iter().map(|p| drawing.backend_coord(&(p.x, p.y))))
        .collect();
    for (series, points) in shown {
        let (color, stroke) = if series.grey {
            (GREY, 1)
        } else {
            colored += 1;
            // The second time round the colours, lines are thin.
            let stroke = if colored <= COLORS.len() { 2 } else { 1 };
            (COLORS[(colored - 1) % COLORS.len()], stroke)
        };
        let style = color.stroke_width(stroke);
        let joined = if series.line { points.as_slice() } else { &[] };
        let line = LineSeries::new(joined.iter().map(|p| (p.x, p.y)), style);
        let drawn = drawing.draw_series(line).map_err(PlotError::of)?;
        if !series.name.is_empty() {
            drawn
                .label(&series.name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
        }
        if series.dots {
            let dots = points
                .iter()
                .map(|p| Circle::new((p.x, p.y), 3, color.filled()));
            drawing.draw_series(dots).map_err(PlotError::of)?;
        }
        let labelled: Vec<_> = points
            .iter()
            .filter_map(|p| {
                let label = p.label.clone()?;
                let at = drawing.backend_coord(&(p.x, p.y));
                let offset = free_place(at, label.chars().count(), &across_px, &mut labels, &dots)?;
                let text = Text::new(label, offset, ("sans-serif", 12).into_font());
                Some(EmptyElement::at((p.x, p.y)) + text)
            })
            .collect();
        drawing.draw_series(labelled).map_err(PlotError::of)?;
    }
    let places: Vec<(i32, i32)> = shown
        .iter()
        .flat_map(|(_, points)| points.iter().map(|p| drawing.backend_coord(&(p.x, p.y))))
        .collect();
    let corner = legend_corner(drawing.plotting_area().get_pixel_range(), &places);
    drawing
        .configure_series_labels()
        .position(corner)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(205, 205, 205))
        .label_font(("sans-serif", 13))
        .draw()
        .map_err(PlotError::of)
}

/// The corner of the plotting area with the fewest points in it; of equal
/// ones the upper left comes first. Everything in pixels of the picture.
fn legend_corner(
    (across, down): (std::ops::Range<i32>, std::ops::Range<i32>),
    places: &[(i32, i32)],
) -> SeriesLabelPosition {
    // The room of a legend of seven lines.
    const ROOM: (i32, i32) = (240, 180);
    let left = across.start..across.start + ROOM.0;
    let right = across.end - ROOM.0..across.end;
    let upper = down.start..down.start + ROOM.1;
    let lower = down.end - ROOM.1..down.end;
    let corners = [
        (&left, &upper, SeriesLabelPosition::UpperLeft),
        (&right, &upper, SeriesLabelPosition::UpperRight),
        (&left, &lower, SeriesLabelPosition::LowerLeft),
        (&right, &lower, SeriesLabelPosition::LowerRight),
    ];
    let within = |x: &std::ops::Range<i32>, y: &std::ops::Range<i32>| {
        let inside = places
            .iter()
            .filter(|p| x.contains(&p.0) && y.contains(&p.1));
        inside.count()
    };
    corners
        .into_iter()
        .min_by_key(|(x, y, _)| within(x, y))
        .map_or(SeriesLabelPosition::UpperLeft, |corner| corner.2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legends_go_where_no_points_are() {
        let area = || (60..880, 40..500);
        let corner = |places: &[(i32, i32)]| format!("{:?}", legend_corner(area(), places));
        let is = |p: SeriesLabelPosition| format!("{p:?}");
        assert_eq!(corner(&[]), is(SeriesLabelPosition::UpperLeft));
        let upper = [(100, 60), (800, 60)];
        assert_eq!(corner(&upper[..1]), is(SeriesLabelPosition::UpperRight));
        assert_eq!(corner(&upper), is(SeriesLabelPosition::LowerLeft));
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
    fn plain_axes_begin_at_zero() {
        assert_eq!(around([16.0, 32.0].into_iter()), 0.0..34.0);
        assert_eq!(around([-1.0, 15.0].into_iter()), -2.0..16.0);
        assert_eq!(around(std::iter::empty()), 0.0..1.0);
    }

    #[test]
    fn points_without_a_place_are_left_out() {
        let chart = Chart {
            level: Some((0.5, "noise".to_owned())),
            ..Chart::growth(
                "t",
                "x",
                "y",
                vec![Series::dots(
                    "s",
                    vec![
                        (1.0, 2.0).into(),
                        (0.0, 2.0).into(),
                        Point {
                            x: 2.0,
                            y: f64::INFINITY,
                            label: Some("gone".to_owned()),
                        },
                        Point {
                            x: 3.0,
                            y: 4.0,
                            label: Some("here".to_owned()),
                        },
                    ],
                )],
            )
        };
        let text = super::super::svg(&[super::super::Panel::Chart(chart)]).unwrap();
        assert_eq!(text.matches("<circle").count(), 2);
        assert!(text.contains("here") && text.contains("noise") && !text.contains("gone"));
    }
}
