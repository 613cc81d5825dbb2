//! Bars, whole and in parts, with an error bar at their end.

use super::canvas::{Anchor, Canvas};
use super::{COLORS, TITLE_HEIGHT, WIDTH};
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

/// Height of a bar with its gap.
const BAR_HEIGHT: f64 = 26.0;
/// Height of the legend of parts.
const LEGEND_HEIGHT: f64 = 48.0;
/// Where bars begin, and how long the longest is.
const BAR_LEFT: f64 = 300.0;
const BAR_LENGTH: f64 = 500.0;

pub(super) fn height(bars: usize) -> f64 {
    TITLE_HEIGHT + BAR_HEIGHT * bars as f64 + 16.0
}

pub(super) fn stacked_height(stacks: usize) -> f64 {
    height(stacks) + LEGEND_HEIGHT
}

pub(super) fn draw(canvas: &mut Canvas, title: &str, bars: &[Bar]) {
    canvas.text(title, (14.0, 22.0), 20, Anchor::Start);
    let longest = bars.iter().map(|bar| bar.value).fold(0.0, f64::max);
    for (place, bar) in bars.iter().enumerate() {
        one(canvas, place, &bar.name, &[bar.value], longest, place);
        if bar.deviation > 0.0 {
            let middle = TITLE_HEIGHT + BAR_HEIGHT * (place as f64 + 0.5) - 3.0;
            let at = |value| (BAR_LEFT + length(value, longest), middle);
            let ends = [bar.value - bar.deviation, bar.value + bar.deviation].map(at);
            canvas.line(&ends, 0, 2, "");
        }
    }
}

pub(super) fn draw_stacked(canvas: &mut Canvas, title: &str, parts: &[String], stacks: &[Stack]) {
    canvas.text(title, (14.0, 22.0), 20, Anchor::Start);
    let sums = stacks.iter().map(|stack| stack.values.iter().sum());
    let longest = sums.fold(0.0, f64::max);
    for (place, stack) in stacks.iter().enumerate() {
        one(canvas, place, &stack.name, &stack.values, longest, 0);
    }
    let (mut left, mut top) = (14.0, TITLE_HEIGHT + BAR_HEIGHT * stacks.len() as f64 + 8.0);
    for (number, name) in parts.iter().enumerate() {
        // About the width of a letter of this size.
        let width = 30.0 + 8.0 * name.chars().count() as f64;
        if left + width > WIDTH - 14.0 {
            left = 14.0;
            top += 22.0;
        }
        canvas.rectangle([left, top, 14.0, 14.0], COLORS[number % COLORS.len()]);
        canvas.text(name, (left + 19.0, top + 7.0), 13, Anchor::Start);
        left += width;
    }
}

/// A bar with its name and the sum of its parts; colours begin at a number.
fn one(
    canvas: &mut Canvas,
    place: usize,
    name: &str,
    values: &[f64],
    longest: f64,
    first_color: usize,
) {
    let top = TITLE_HEIGHT + BAR_HEIGHT * place as f64;
    let middle = top + BAR_HEIGHT / 2.0 - 3.0;
    canvas.text(name, (14.0, middle), 14, Anchor::Start);
    let mut before = 0.0;
    for (number, value) in values.iter().enumerate() {
        let (left, right) = (length(before, longest), length(before + value, longest));
        before += value;
        if right > left {
            let color = COLORS[(first_color + number) % COLORS.len()];
            let place = [BAR_LEFT + left, top, right - left, BAR_HEIGHT - 6.0];
            canvas.rectangle(place, color);
        }
    }
    let right = BAR_LEFT + length(before, longest) + 6.0;
    let value = Cell::ms(before).for_people();
    canvas.text(&value, (right, middle), 14, Anchor::Start);
}

fn length(value: f64, longest: f64) -> f64 {
    if longest > 0.0 {
        BAR_LENGTH * value / longest
    } else {
        0.0
    }
}
