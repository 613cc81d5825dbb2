//! Heat maps: tiles in rows and columns, shaded by a number or marked as bad.

use plotters::prelude::*;

use super::{Area, PlotError, TITLE_HEIGHT, WIDTH, words};

/// One tile.
#[derive(Debug, Clone, PartialEq)]
pub enum HeatCell {
    /// From 0 (white) to 1 (dark), and what stands in it.
    Shade(f64, String),
    /// Bad: red, and what stands in it.
    Bad(String),
    /// Nothing was measured.
    Empty,
}

/// Tiles in rows and columns.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMap {
    /// What stands above it.
    pub title: String,
    /// What stands above the columns.
    pub columns: Vec<String>,
    /// The rows: what stands before them, and their tiles.
    pub rows: Vec<(String, Vec<HeatCell>)>,
    /// What stands below it: what shade and numbers mean.
    pub legend: String,
}

const TILE_HEIGHT: u32 = 24;
const LEFT: i32 = 220;

pub(super) fn height(map: &HeatMap) -> u32 {
    TITLE_HEIGHT + TILE_HEIGHT * (map.rows.len() as u32 + 1) + 36
}

/// From white to a dark blue, by equal steps of lightness.
fn shade(value: f64) -> RGBColor {
    let value = value.clamp(0.0, 1.0);
    let mix = |light: f64, dark: f64| (light + (dark - light) * value) as u8;
    RGBColor(mix(247.0, 8.0), mix(251.0, 64.0), mix(255.0, 129.0))
}

pub(super) fn draw(area: &Area<'_>, map: &HeatMap) -> Result<(), PlotError> {
    words(area, &map.title, (14, 12), 20)?;
    let room = WIDTH as i32 - LEFT - 14;
    let width = (room / map.columns.len().max(1) as i32).clamp(1, 90);
    let top_of = |row: usize| (TITLE_HEIGHT + TILE_HEIGHT * row as u32) as i32;
    let left_of = |column: usize| LEFT + width * column as i32;
    for (column, name) in map.columns.iter().enumerate() {
        words(area, name, (left_of(column) + 4, top_of(0) + 4), 13)?;
    }
    for (row, (name, tiles)) in map.rows.iter().enumerate() {
        let top = top_of(row + 1);
        words(area, name, (14, top + 4), 13)?;
        for (column, tile) in tiles.iter().enumerate() {
            let (color, text, dark) = match tile {
                HeatCell::Shade(value, text) => (shade(*value), text.as_str(), *value > 0.55),
                HeatCell::Bad(text) => (RGBColor(200, 60, 40), text.as_str(), true),
                HeatCell::Empty => (RGBColor(236, 236, 236), "", false),
            };
            let left = left_of(column);
            let corners = [
                (left, top),
                (left + width - 2, top + TILE_HEIGHT as i32 - 2),
            ];
            area.draw(&Rectangle::new(corners, color.filled()))
                .map_err(PlotError::of)?;
            let ink = if dark { &WHITE } else { &BLACK };
            let font = ("sans-serif", 12).into_font().color(ink);
            let text = Text::new(text.to_owned(), (left + 4, top + 5), font);
            area.draw(&text).map_err(PlotError::of)?;
        }
    }
    words(area, &map.legend, (14, top_of(map.rows.len() + 1) + 8), 13)
}
