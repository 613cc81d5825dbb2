//! Bars from zero with an error bar at their end.

use super::canvas::{Anchor, Canvas};
use super::{COLORS, TITLE_HEIGHT};
use crate::report::table::Cell;

#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    pub name: String,
    /// Its length, 0 or more.
    pub value: f64,
    pub deviation: f64,
}

const BAR_HEIGHT: f64 = 26.0;
const BAR_LEFT: f64 = 300.0;
const BAR_LENGTH: f64 = 500.0;

pub(super) fn draw(canvas: &mut Canvas, title: &str, bars: &[Bar]) -> f64 {
    canvas.text(title, (14.0, 22.0), 20, Anchor::Start);
    let longest = bars.iter().map(|bar| bar.value).fold(0.0, f64::max);
    let at = |value: f64| BAR_LEFT + BAR_LENGTH * value / longest.max(f64::MIN_POSITIVE);
    for (place, bar) in bars.iter().enumerate() {
        let top = TITLE_HEIGHT + BAR_HEIGHT * place as f64;
        let middle = top + BAR_HEIGHT / 2.0 - 3.0;
        canvas.text(&bar.name, (14.0, middle), 14, Anchor::Start);
        if bar.value > 0.0 {
            let size = [at(bar.value) - BAR_LEFT, BAR_HEIGHT - 6.0];
            let color = COLORS[place % COLORS.len()];
            canvas.rectangle([BAR_LEFT, top, size[0], size[1]], color);
        }
        if bar.deviation > 0.0 {
            let ends = [bar.value - bar.deviation, bar.value + bar.deviation];
            canvas.line(&ends.map(|value| (at(value), middle)), 0, 2, "");
        }
        let value = Cell::ms(bar.value).for_people();
        canvas.text(&value, (at(bar.value) + 6.0, middle), 14, Anchor::Start);
    }
    TITLE_HEIGHT + BAR_HEIGHT * bars.len() as f64 + 8.0
}
