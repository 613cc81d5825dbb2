//! Bars, whole and in parts.

use plotters::prelude::*;

use super::{Area, COLORS, PlotError, TITLE_HEIGHT, WIDTH, words};
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
const BAR_HEIGHT: u32 = 26;
/// Height of the legend of parts.
const LEGEND_HEIGHT: u32 = 48;
/// Where bars begin, and how long the longest is.
const BAR_LEFT: i32 = 300;
const BAR_LENGTH: f64 = 500.0;

pub(super) fn height(bars: usize) -> u32 {
    TITLE_HEIGHT + BAR_HEIGHT * bars as u32 + 16
}

pub(super) fn stacked_height(stacks: usize) -> u32 {
    height(stacks) + LEGEND_HEIGHT
}

pub(super) fn draw(area: &Area<'_>, title: &str, bars: &[Bar]) -> Result<(), PlotError> {
    words(area, title, (14, 12), 20)?;
    let longest = bars.iter().map(|bar| bar.value).fold(0.0, f64::max);
    for (place, bar) in bars.iter().enumerate() {
        let top = (TITLE_HEIGHT + BAR_HEIGHT * place as u32) as i32;
        let right = BAR_LEFT + length(bar.value, longest);
        let color = COLORS[place % COLORS.len()];
        rectangle(area, (BAR_LEFT, right), top, color)?;
        words(area, &bar.name, (14, top + 3), 14)?;
        let value = Cell::ms(bar.value).for_people();
        words(area, &value, (right + 6, top + 3), 14)?;
    }
    Ok(())
}

pub(super) fn draw_stacked(
    area: &Area<'_>,
    title: &str,
    parts: &[String],
    stacks: &[Stack],
) -> Result<(), PlotError> {
    words(area, title, (14, 12), 20)?;
    let sums: Vec<f64> = stacks
        .iter()
        .map(|stack| stack.values.iter().sum())
        .collect();
    let longest = sums.iter().copied().fold(0.0, f64::max);
    for (place, (stack, sum)) in stacks.iter().zip(&sums).enumerate() {
        let top = (TITLE_HEIGHT + BAR_HEIGHT * place as u32) as i32;
        words(area, &stack.name, (14, top + 3), 14)?;
        let mut before = 0.0;
        for (part, value) in stack.values.iter().enumerate() {
            let left = BAR_LEFT + length(before, longest);
            before += value;
            let right = BAR_LEFT + length(before, longest);
            if right > left {
                rectangle(area, (left, right), top, COLORS[part % COLORS.len()])?;
            }
        }
        let right = BAR_LEFT + length(*sum, longest);
        words(area, &Cell::ms(*sum).for_people(), (right + 6, top + 3), 14)?;
    }
    let first = (TITLE_HEIGHT + BAR_HEIGHT * stacks.len() as u32) as i32 + 8;
    let (mut left, mut top) = (14, first);
    for (part, name) in parts.iter().enumerate() {
        // About the width of a letter of this size.
        let width = 30 + 8 * name.chars().count() as i32;
        if left + width > WIDTH as i32 - 14 {
            left = 14;
            top += 22;
        }
        let color = COLORS[part % COLORS.len()];
        let key = Rectangle::new([(left, top), (left + 14, top + 14)], color.filled());
        area.draw(&key).map_err(PlotError::of)?;
        words(area, name, (left + 19, top), 13)?;
        left += width;
    }
    Ok(())
}

fn length(value: f64, longest: f64) -> i32 {
    if longest > 0.0 {
        (BAR_LENGTH * value / longest) as i32
    } else {
        0
    }
}

fn rectangle(
    area: &Area<'_>,
    (left, right): (i32, i32),
    top: i32,
    color: RGBColor,
) -> Result<(), PlotError> {
    let bottom = top + BAR_HEIGHT as i32 - 6;
    let corners = [(left, top), (right, bottom)];
    area.draw(&Rectangle::new(corners, color.filled()))
        .map_err(PlotError::of)
}
