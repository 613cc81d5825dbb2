//! Plots as SVG text: charts and bars, below each other.

mod bars;
mod canvas;
mod chart;
mod of_rows;

use canvas::{Canvas, Color};

pub use bars::{Bar, Stack};
pub use chart::{Axis, Chart, Point, Scale, Series};
pub use of_rows::{ColumnAxis, RowPlot, dominated, dominates};

/// One plot of a picture.
#[derive(Debug, Clone, PartialEq)]
pub enum Panel {
    /// Curves and points over two axes.
    Chart(Chart),
    /// Bars from zero.
    Bars {
        /// Its title.
        title: String,
        /// The bars, from the top.
        bars: Vec<Bar>,
    },
    /// Bars made of parts.
    Stacked {
        /// Its title.
        title: String,
        /// The names of the parts, in their order.
        parts: Vec<String>,
        /// The bars, from the top.
        stacks: Vec<Stack>,
    },
}

/// Width of a picture, pixels.
const WIDTH: f64 = 900.0;
/// Height of a panel's title.
const TITLE_HEIGHT: f64 = 44.0;
/// Colours that are distinguishable also to the colour-blind (Okabe and Ito), and two more.
const COLORS: [Color; 9] = [
    0x00_72b2, 0xd5_5e00, 0x00_9e73, 0xcc_79a7, 0xe6_9f00, 0x56_b4e9, 0x00_0000, 0x96_6e3c,
    0x78_78be,
];
/// The colour of series for comparison.
const GREY: Color = 0xa8_a8a8;

impl Panel {
    fn height(&self) -> f64 {
        match self {
            Self::Chart(_) => chart::HEIGHT,
            Self::Bars { bars, .. } => bars::height(bars.len()),
            Self::Stacked { stacks, .. } => bars::stacked_height(stacks.len()),
        }
    }
}

/// Draws panels below each other.
#[must_use]
pub fn svg(panels: &[Panel]) -> String {
    let mut canvas = Canvas::default();
    for panel in panels {
        match panel {
            Panel::Chart(chart) => chart::draw(&mut canvas, chart),
            Panel::Bars { title, bars } => bars::draw(&mut canvas, title, bars),
            Panel::Stacked {
                title,
                parts,
                stacks,
            } => bars::draw_stacked(&mut canvas, title, parts, stacks),
        }
        canvas.top += panel.height();
    }
    let height = canvas.top.max(1.0);
    canvas.finish(WIDTH, height)
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
        // Fewer than three digits could make neighbouring ticks equal.
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
        let series = vec![
            Series::curve("one", [(64.0, 1.5), (128.0, 20.0)]),
            Series::curve("two", [(64.0, 0.0)]),
        ];
        let text = svg(&[
            Panel::Chart(Chart::growth("Growth", "pixels", "ms", series)),
            Panel::Bars {
                title: "Length <1>".to_owned(),
                bars: vec![Bar {
                    name: "a & b".to_owned(),
                    value: 12.5,
                    deviation: 1.0,
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
        ]);
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
        assert!(svg(&[]).contains("</svg>"));
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
