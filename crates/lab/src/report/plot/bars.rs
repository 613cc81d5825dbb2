//! Bars, whole and in parts.

use super::canvas::{Anchor, Canvas, Color};
use super::{COLORS, TITLE_HEIGHT, WIDTH};
use crate::report::table::Cell;

/// A bar with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// What stands beside it.
    pub name: String,
    /// Its length, 0 or more.
    pub value: f64,
}

/// A bar made of parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    /// What stands beside it.
    pub name: String,
    /// The lengths of its parts, 0 or more.
    pub values: Vec<f64>,
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
        let color = COLORS[place % COLORS.len()];
        let top = row(canvas, place, &bar.name, bar.value, longest);
        part(canvas, top, [0.0, length(bar.value, longest)], color);
    }
}

pub(super) fn draw_stacked(canvas: &mut Canvas, title: &str, parts: &[String], stacks: &[Stack]) {
    canvas.text(title, (14.0, 22.0), 20, Anchor::Start);
    let sums = stacks.iter().map(|stack| stack.values.iter().sum());
    let longest = sums.fold(0.0, f64::max);
    for (place, stack) in stacks.iter().enumerate() {
        let sum = stack.values.iter().sum();
        let top = row(canvas, place, &stack.name, sum, longest);
        let mut before = 0.0;
        for (number, value) in stack.values.iter().enumerate() {
            let ends = [before, before + value].map(|end| length(end, longest));
            before += value;
            if ends[1] > ends[0] {
                part(canvas, top, ends, COLORS[number % COLORS.len()]);
            }
        }
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

/// Names of a bar and its value; returns its top.
fn row(canvas: &mut Canvas, place: usize, name: &str, value: f64, longest: f64) -> f64 {
    let top = TITLE_HEIGHT + BAR_HEIGHT * place as f64;
    let middle = top + BAR_HEIGHT / 2.0 - 3.0;
    canvas.text(name, (14.0, middle), 14, Anchor::Start);
    let right = BAR_LEFT + length(value, longest) + 6.0;
    canvas.text(
        &Cell::ms(value).for_people(),
        (right, middle),
        14,
        Anchor::Start,
    );
    top
}

fn part(canvas: &mut Canvas, top: f64, [left, right]: [f64; 2], color: Color) {
    canvas.rectangle(
        [BAR_LEFT + left, top, right - left, BAR_HEIGHT - 6.0],
        color,
    );
}

fn length(value: f64, longest: f64) -> f64 {
    if longest > 0.0 {
        BAR_LENGTH * value / longest
    } else {
        0.0
    }
}
