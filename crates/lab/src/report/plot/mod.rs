//! Plots as SVG text: charts and bars, below each other.

mod bars;
mod canvas;
mod chart;
mod of_rows;

use canvas::{Anchor, Canvas, Color};

pub use bars::{Bar, Stack};
pub use chart::{Axis, Chart, Point, Scale, Series};
pub use of_rows::RowPlot;

pub(crate) use of_rows::dominates;

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

const WIDTH: f64 = 900.0;
const TITLE_HEIGHT: f64 = 44.0;
/// Colours that are distinguishable also to the colour-blind (Okabe and Ito), and two more.
const COLORS: [Color; 9] = [
    0x00_72b2, 0xd5_5e00, 0x00_9e73, 0xcc_79a7, 0xe6_9f00, 0x56_b4e9, 0x00_0000, 0x96_6e3c,
    0x78_78be,
];
const GREY: Color = 0xa8_a8a8;

/// Draws panels below each other.
#[must_use]
pub fn svg(panels: &[Panel]) -> String {
    let mut canvas = Canvas::default();
    for panel in panels {
        let (height, names) = draw(&mut canvas, panel);
        canvas.top += height;
        canvas.top += legend(&mut canvas, &names);
    }
    let height = canvas.top.max(1.0);
    canvas.finish(WIDTH, height)
}

/// Draws a panel. Returns its height, and the names and colours of its legend.
fn draw<'p>(canvas: &mut Canvas, panel: &'p Panel) -> (f64, Vec<(&'p str, Color)>) {
    match panel {
        Panel::Chart(chart) => (chart::HEIGHT, chart::draw(canvas, chart)),
        Panel::Bars { title, bars } => {
            let whole = |(place, bar): (usize, &Bar)| {
                let (name, values) = (bar.name.clone(), vec![bar.value]);
                (place, Stack { name, values }, bar.deviation)
            };
            let bars: Vec<_> = bars.iter().enumerate().map(whole).collect();
            bars::draw(canvas, title, &bars);
            (bars::height(bars.len()), Vec::new())
        }
        Panel::Stacked {
            title,
            parts,
            stacks,
        } => {
            let bars: Vec<_> = stacks.iter().map(|of| (0, of.clone(), 0.0)).collect();
            bars::draw(canvas, title, &bars);
            let names = parts.iter().map(String::as_str);
            let names = names.zip(COLORS.into_iter().cycle()).collect();
            (bars::height(bars.len()), names)
        }
    }
}

fn legend(canvas: &mut Canvas, names: &[(&str, Color)]) -> f64 {
    let (mut left, mut top) = (14.0, 0.0);
    for (name, color) in names {
        // About the width of a letter of this size.
        let width = 30.0 + 8.0 * name.chars().count() as f64;
        if left + width > WIDTH - 14.0 {
            (left, top) = (14.0, top + 22.0);
        }
        canvas.rectangle([left, top, 14.0, 14.0], *color);
        canvas.text(name, (left + 19.0, top + 7.0), 13, Anchor::Start);
        left += width;
    }
    top + if names.is_empty() { 8.0 } else { 34.0 }
}

/// A number on an axis: `0.1`, `20`, `1e6`, `1.2e5`.
fn in_short(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    if (0.001..10_000.0).contains(&number.abs()) {
        // Enough digits for thousandths, none without information.
        let text = format!("{number:.3}");
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    // Fewer than three digits could make neighbouring ticks equal.
    let text = format!("{number:.2e}");
    let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
    let digits = digits.trim_end_matches('0').trim_end_matches('.');
    format!("{digits}e{power}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_all_names_and_points() {
        let point = |x, y, label: &str| Point {
            x,
            y,
            label: Some(label.to_owned()),
        };
        let points = vec![
            (64.0, 1.5).into(),
            (128.0, 0.0).into(),
            point(64.0, f64::INFINITY, "gone"),
            point(90.0, 4.0, "here"),
        ];
        let chart = Chart {
            level: Some((0.5, "noise".to_owned())),
            ..Chart::growth("Growth", "pixels", "ms", vec![Series::dots("one", points)])
        };
        let text = svg(&[
            Panel::Chart(chart),
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
        let parts = "Growth:pixels:one:here:noise:Length &lt;1&gt;:a &amp; b:12.5:second part:pile";
        for part in parts.split(':') {
            assert!(text.contains(part), "{part}");
        }
        // Points that are not above zero, or not finite, have no place.
        assert_eq!(text.matches("<circle").count(), 2);
        assert!(!text.contains("gone"));
        // The parts of the stack are a quarter and three of the longest bar; 92 percent of a bar is
        // its least with its error.
        for length in ["width=\"125.0\"", "width=\"375.0\"", "760.0,", "840.0,"] {
            assert!(text.contains(length), "{length}");
        }
        assert!(svg(&[]).contains("</svg>"));
    }

    #[test]
    fn numbers_are_short() {
        let numbers = [
            0.25,
            10.0,
            1e6,
            0.0,
            -0.5,
            8e4,
            1e5,
            1.2e5,
            0.1 * 12e5 + 2e4,
        ];
        let texts = [
            "0.25", "10", "1e6", "0", "-0.5", "8e4", "1e5", "1.2e5", "1.4e5",
        ];
        assert_eq!(numbers.map(in_short), texts);
    }
}
