//! Plots as SVG text: curves on logarithmic axes, and bars.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::table::Cell;

/// Points of one name.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What the legend calls it.
    pub name: String,
    /// The points, in the order in which they are joined. Those not above 0 are left out.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    /// Named points, put together by name, in the order in which names come.
    pub fn collect(points: impl IntoIterator<Item = (String, (f64, f64))>) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for (name, point) in points {
            match all.iter_mut().find(|series| series.name == name) {
                Some(series) => series.points.push(point),
                None => all.push(Self {
                    name,
                    points: vec![point],
                }),
            }
        }
        all
    }
}

/// A bar with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// What stands beside it.
    pub name: String,
    /// Its length, milliseconds, 0 or more.
    pub value: f64,
}

/// One plot of a picture.
#[derive(Debug, Clone, PartialEq)]
pub enum Panel {
    /// Curves; both axes are logarithmic.
    Curves {
        /// What stands above it.
        title: String,
        /// What is across.
        x_label: String,
        /// What is up.
        y_label: String,
        /// The curves.
        series: Vec<Series>,
    },
    /// Bars from zero.
    Bars {
        /// What stands above it.
        title: String,
        /// The bars, from the top.
        bars: Vec<Bar>,
    },
}

/// A plot that could not be drawn.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("cannot draw the plot: {0}")]
pub struct PlotError(String);

impl PlotError {
    fn of(error: impl std::fmt::Display) -> Self {
        Self(error.to_string())
    }
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Width of a picture, and height of a panel of curves, pixels.
const WIDTH: u32 = 900;
const CURVES_HEIGHT: u32 = 540;
/// Height of a bar with its gap, and of a panel's title.
const BAR_HEIGHT: u32 = 26;
const TITLE_HEIGHT: u32 = 44;
/// Where bars begin, and how long the longest is.
const BAR_LEFT: i32 = 300;
const BAR_LENGTH: f64 = 500.0;
/// Colours that are told apart also by the colour-blind (Okabe and Ito).
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

/// Draws panels below each other.
///
/// # Errors
/// When the plotting library fails; it has no reason to on these inputs.
pub fn svg(panels: &[Panel]) -> Result<String, PlotError> {
    let heights: Vec<u32> = panels.iter().map(height).collect();
    let mut text = String::new();
    {
        let size = (WIDTH, heights.iter().sum::<u32>().max(1));
        let mut rest = SVGBackend::with_string(&mut text, size).into_drawing_area();
        rest.fill(&WHITE).map_err(PlotError::of)?;
        for (panel, height) in panels.iter().zip(heights) {
            let (area, below) = rest.split_vertically(height);
            match panel {
                Panel::Curves {
                    title,
                    x_label,
                    y_label,
                    series,
                } => curves(&area, title, x_label, y_label, series)?,
                Panel::Bars { title, bars } => draw_bars(&area, title, bars)?,
            }
            rest = below;
        }
        rest.present().map_err(PlotError::of)?;
    }
    Ok(text)
}

fn height(panel: &Panel) -> u32 {
    match panel {
        Panel::Curves { .. } => CURVES_HEIGHT,
        Panel::Bars { bars, .. } => TITLE_HEIGHT + BAR_HEIGHT * bars.len() as u32 + 16,
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

fn curves(
    area: &Area<'_>,
    title: &str,
    x_label: &str,
    y_label: &str,
    series: &[Series],
) -> Result<(), PlotError> {
    let shown: Vec<(&str, Vec<(f64, f64)>)> = series
        .iter()
        .map(|series| {
            let points = series.points.iter().copied();
            let above = points.filter(|(x, y)| *x > 0.0 && *y > 0.0);
            (series.name.as_str(), above.collect())
        })
        .collect();
    let all = || shown.iter().flat_map(|(_, points)| points.iter().copied());
    let x = decades(all().map(|p| p.0));
    let y = decades(all().map(|p| p.1));
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 20))
        .margin(14)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(x.log_scale(), y.log_scale())
        .map_err(PlotError::of)?;
    chart
        .configure_mesh()
        .x_desc(x_label)
        .y_desc(y_label)
        .light_line_style(RGBColor(235, 235, 235))
        .bold_line_style(RGBColor(205, 205, 205))
        .x_label_formatter(&|x| in_short(*x))
        .y_label_formatter(&|y| in_short(*y))
        .label_style(("sans-serif", 14))
        .draw()
        .map_err(PlotError::of)?;
    for (place, (name, points)) in shown.iter().enumerate() {
        let color = COLORS[place % COLORS.len()];
        // The second time round the colours, lines are thin.
        let stroke = if place < COLORS.len() { 2 } else { 1 };
        let style = color.stroke_width(stroke);
        let line = LineSeries::new(points.iter().copied(), style);
        chart
            .draw_series(line)
            .map_err(PlotError::of)?
            .label(*name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
        let dots = points.iter().map(|&at| Circle::new(at, 3, color.filled()));
        chart.draw_series(dots).map_err(PlotError::of)?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(205, 205, 205))
        .label_font(("sans-serif", 13))
        .draw()
        .map_err(PlotError::of)
}

/// A number on an axis: `0.1`, `20`, `1e6`.
fn in_short(number: f64) -> String {
    if (0.001..10_000.0).contains(&number) {
        // Enough digits for thousandths, none that say nothing.
        let text = format!("{number:.3}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{number:.0e}")
    }
}

fn draw_bars(area: &Area<'_>, title: &str, bars: &[Bar]) -> Result<(), PlotError> {
    let font = |size: u32| ("sans-serif", size).into_font();
    let words = |text: String, at: (i32, i32), size| Text::new(text, at, font(size));
    area.draw(&words(title.to_owned(), (14, 12), 20))
        .map_err(PlotError::of)?;
    let longest = bars.iter().map(|bar| bar.value).fold(0.0, f64::max);
    for (place, bar) in bars.iter().enumerate() {
        let top = (TITLE_HEIGHT + BAR_HEIGHT * place as u32) as i32;
        let bottom = top + BAR_HEIGHT as i32 - 6;
        let share = if longest > 0.0 {
            bar.value / longest
        } else {
            0.0
        };
        let right = BAR_LEFT + (BAR_LENGTH * share) as i32;
        let color = COLORS[place % COLORS.len()];
        area.draw(&Rectangle::new(
            [(BAR_LEFT, top), (right, bottom)],
            color.filled(),
        ))
        .map_err(PlotError::of)?;
        area.draw(&words(bar.name.clone(), (14, top + 3), 14))
            .map_err(PlotError::of)?;
        let value = Cell::ms(bar.value).for_people();
        area.draw(&words(value, (right + 6, top + 3), 14))
            .map_err(PlotError::of)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_all_names_and_points() {
        let named = |name: &str, point| (name.to_owned(), point);
        let series = Series::collect([
            named("one", (64.0, 1.5)),
            named("two", (64.0, 0.0)),
            named("one", (128.0, 20.0)),
        ]);
        assert_eq!(series.len(), 2);
        let text = svg(&[
            Panel::Curves {
                title: "Growth".to_owned(),
                x_label: "pixels".to_owned(),
                y_label: "ms".to_owned(),
                series,
            },
            Panel::Bars {
                title: "Length <1>".to_owned(),
                bars: vec![Bar {
                    name: "a & b".to_owned(),
                    value: 12.5,
                }],
            },
        ])
        .unwrap();
        assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"));
        for part in [
            "Growth",
            "one",
            "two",
            "Length &lt;1&gt;",
            "a &amp; b",
            "12.5",
        ] {
            assert!(text.contains(part), "{part}");
        }
        // The point that is not above zero is left out.
        assert_eq!(text.matches("<circle").count(), 2);
        svg(&[]).unwrap();
    }

    #[test]
    fn axes_end_at_powers_of_ten() {
        assert_eq!(decades([3.0, 40.0].into_iter()), 1.0..100.0);
        assert_eq!(decades([10.0].into_iter()), 10.0..100.0);
        assert_eq!(decades(std::iter::empty()), 1.0..10.0);
        let texts = [0.25, 10.0, 1e6, 0.0].map(in_short);
        assert_eq!(texts, ["0.25", "10", "1e6", "0e0"]);
    }
}
