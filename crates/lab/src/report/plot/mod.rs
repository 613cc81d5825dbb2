//! Plots as SVG text: charts below each other.

mod canvas;
mod chart;
mod of_rows;

use canvas::{Anchor, Canvas, Color};

pub use chart::{Axis, Chart, Point, Scale, Series};
pub use of_rows::RowPlot;

pub(crate) use of_rows::dominates;

const WIDTH: f64 = 900.0;
const TITLE_HEIGHT: f64 = 44.0;
/// Colours that are distinguishable also to the colour-blind (Okabe and Ito), and two more.
const COLORS: [Color; 10] = [
    0x00_72b2, 0xd5_5e00, 0x00_9e73, 0xcc_79a7, 0xe6_9f00, 0x56_b4e9, 0x00_0000, 0x96_6e3c,
    0x78_78be, 0x8b_1a1a,
];
const GREY: Color = 0xa8_a8a8;

pub fn svg(charts: &[Chart]) -> String {
    let mut canvas = Canvas::default();
    for chart in charts {
        let names = chart::draw(&mut canvas, chart);
        canvas.top += chart::HEIGHT;
        canvas.top += legend(&mut canvas, &names);
    }
    let height = canvas.top.max(1.0);
    canvas.finish(WIDTH, height)
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
        // Points that are not above zero, or not finite, have no place.
        let points = [
            (64.0, 1.5, "first"),
            (128.0, 0.0, "gone"),
            (f64::INFINITY, 1.0, "gone"),
        ];
        let points = points.map(|(x, y, label)| {
            let label = Some(label.to_owned());
            Point { x, y, label }
        });
        let dots = Series::dots("one", points.into());
        let mut chart = Chart::growth("Growth", "pixels & <more>", "ms", vec![dots]);
        chart.level = Some((0.5, "noise".to_owned()));
        let text = svg(&[chart]);
        let parts = "Growth:pixels &amp; &lt;more&gt;:one:first:noise";
        assert!(parts.split(':').all(|part| text.contains(part)), "{text}");
        assert!(text.matches("<circle").count() == 1 && !text.contains("gone"));
    }

    #[test]
    fn numbers_are_short() {
        let numbers = [0.25, 10.0, 1e6, 0.0, -0.5, 8e4, 1.2e5, 0.1 * 12e5 + 2e4];
        let texts = ["0.25", "10", "1e6", "0", "-0.5", "8e4", "1.2e5", "1.4e5"];
        assert_eq!(numbers.map(in_short), texts);
    }
}
