//! Plots as SVG text: charts and bars, below each other.

mod bars;
mod chart;

use plotters::coord::Shift;
use plotters::prelude::*;

pub use bars::{Bar, Stack};
pub use chart::{Axis, Chart, Point, Scale, Series};

/// One plot of a picture.
#[derive(Debug, Clone, PartialEq)]
pub enum Panel {
    /// Curves and points over two axes.
    Chart(Chart),
    /// Bars from zero.
    Bars {
        /// What stands above it.
        title: String,
        /// The bars, from the top.
        bars: Vec<Bar>,
    },
    /// Bars made of parts.
    Stacked {
        /// What stands above it.
        title: String,
        /// What the parts are called, in their order.
        parts: Vec<String>,
        /// The bars, from the top.
        stacks: Vec<Stack>,
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

/// Width of a picture, pixels.
const WIDTH: u32 = 900;
/// Height of a panel's title.
const TITLE_HEIGHT: u32 = 44;
/// Colours that are distinguishable also to the colour-blind (Okabe and Ito), and two more.
const COLORS: [RGBColor; 9] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
    RGBColor(150, 110, 60),
    RGBColor(120, 120, 190),
];
/// What is not of the first importance.
const GREY: RGBColor = RGBColor(168, 168, 168);

impl Panel {
    fn height(&self) -> u32 {
        match self {
            Self::Chart(_) => chart::HEIGHT,
            Self::Bars { bars, .. } => bars::height(bars.len()),
            Self::Stacked { stacks, .. } => bars::stacked_height(stacks.len()),
        }
    }
}

/// Draws panels below each other.
///
/// # Errors
/// When the plotting library fails; it has no reason to on these inputs.
pub fn svg(panels: &[Panel]) -> Result<String, PlotError> {
    let heights: Vec<u32> = panels.iter().map(Panel::height).collect();
    let mut text = String::new();
    {
        let size = (WIDTH, heights.iter().sum::<u32>().max(1));
        let mut rest = SVGBackend::with_string(&mut text, size).into_drawing_area();
        rest.fill(&WHITE).map_err(PlotError::of)?;
        for (panel, height) in panels.iter().zip(heights) {
            let (area, below) = rest.split_vertically(height);
            match panel {
                Panel::Chart(chart) => chart::draw(&area, chart)?,
                Panel::Bars { title, bars } => bars::draw(&area, title, bars)?,
                Panel::Stacked {
                    title,
                    parts,
                    stacks,
                } => bars::draw_stacked(&area, title, parts, stacks)?,
            }
            rest = below;
        }
        rest.present().map_err(PlotError::of)?;
    }
    Ok(text)
}

/// Words at a place.
fn words(area: &Area<'_>, text: &str, at: (i32, i32), size: u32) -> Result<(), PlotError> {
    let font = ("sans-serif", size).into_font();
    let text = Text::new(text.to_owned(), at, font);
    area.draw(&text).map_err(PlotError::of)
}

/// A number on an axis: `0.1`, `20`, `1e6`, `1.2e5`.
fn in_short(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    if (0.001..10_000.0).contains(&number.abs()) {
        // Enough digits for thousandths, none without information.
        let text = format!("{number:.3}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        // Three digits, or the ticks of an axis of few would be alike.
        let text = format!("{number:.2e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        let digits = digits.trim_end_matches('0').trim_end_matches('.');
        format!("{digits}e{power}")
    }
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
            Panel::Chart(Chart::growth("Growth", "pixels", "ms", series)),
            Panel::Bars {
                title: "Length <1>".to_owned(),
                bars: vec![Bar {
                    name: "a & b".to_owned(),
                    value: 12.5,
                }],
            },
            Panel::Stacked {
                title: "Parts".to_owned(),
                parts: vec!["first part".to_owned(), "second part".to_owned()],
                stacks: vec![Stack {
                    name: "pile".to_owned(),
                    values: vec![1.0, 3.0],
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
            "second part",
            "pile",
        ] {
            assert!(text.contains(part), "{part}");
        }
        // The point that is not above zero is left out.
        assert_eq!(text.matches("<circle").count(), 2);
        svg(&[]).unwrap();
    }

    #[test]
    fn numbers_are_short() {
        let texts = [0.25, 10.0, 1e6, 0.0, -0.5].map(in_short);
        assert_eq!(texts, ["0.25", "10", "1e6", "0", "-0.5"]);
        // Neighbours on one axis.
        let texts = [8e4, 1e5, 1.2e5, 0.1 * 12e5 + 2e4].map(in_short);
        assert_eq!(texts, ["8e4", "1e5", "1.2e5", "1.4e5"]);
    }
}
