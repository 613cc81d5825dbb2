//! Bars from zero, whole or in parts, with an error bar at their end.

use super::canvas::{Anchor, Canvas};
use super::{COLORS, TITLE_HEIGHT};
use crate::report::table::Cell;

/// A bar made of parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    /// Its label.
    pub name: String,
    /// The lengths of its parts, 0 or more.
    pub values: Vec<f64>,
}

/// A bar of one part.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// Its label.
    pub name: String,
    /// Its length, 0 or more.
    pub value: f64,
    /// Half the length of its error bar, or 0.
    pub deviation: f64,
}

const BAR_HEIGHT: f64 = 26.0;
const BAR_LEFT: f64 = 300.0;
const BAR_LENGTH: f64 = 500.0;

pub(super) fn height(bars: usize) -> f64 {
    TITLE_HEIGHT + BAR_HEIGHT * bars as f64 + 8.0
}

/// Draws bars: the number of the first part's colour, the bar, half of its error bar.
pub(super) fn draw(canvas: &mut Canvas, title: &str, bars: &[(usize, Stack, f64)]) {
    canvas.text(title, (14.0, 22.0), 20, Anchor::Start);
    let sum = |stack: &Stack| stack.values.iter().sum::<f64>();
    let longest = bars.iter().map(|bar| sum(&bar.1)).fold(0.0, f64::max);
    let at = |value: f64| BAR_LEFT + BAR_LENGTH * value / longest.max(f64::MIN_POSITIVE);
    for (place, (first_color, stack, deviation)) in bars.iter().enumerate() {
        let top = TITLE_HEIGHT + BAR_HEIGHT * place as f64;
        let middle = top + BAR_HEIGHT / 2.0 - 3.0;
        canvas.text(&stack.name, (14.0, middle), 14, Anchor::Start);
        let mut end = 0.0;
        for (number, value) in stack.values.iter().enumerate() {
            let (left, right) = (at(end), at(end + value));
            end += value;
            if right > left {
                let color = COLORS[(first_color + number) % COLORS.len()];
                canvas.rectangle([left, top, right - left, BAR_HEIGHT - 6.0], color);
            }
        }
        if *deviation > 0.0 {
            let ends = [end - deviation, end + deviation].map(|value| (at(value), middle));
            canvas.line(&ends, 0, 2, "");
        }
        let value = Cell::ms(end).for_people();
        canvas.text(&value, (at(end) + 6.0, middle), 14, Anchor::Start);
    }
}
