//! The model's results as tables.

mod cost;
mod frame;
mod repeats;

pub use cost::{area, breakdown, clock, comparison, side_by_side};
pub use frame::{
    bounds, classes, levels, memories, miss_curve, numbers, operations_by_stage, record,
    records_by_kind, shifts, stages,
};
pub use repeats::{caches, claims, formats, growth, halves, lanes, rules, steps};

use crate::report::Cell;

/// A number with some digits after the point.
fn number(value: f64, digits: usize) -> Cell {
    if value.is_finite() {
        Cell::Number(value, digits)
    } else {
        Cell::None
    }
}

fn percent(share: f64) -> Cell {
    number(100.0 * share, 1)
}

/// Picojoules as microjoules.
fn micro(pj: f64) -> Cell {
    number(pj / 1e6, 3)
}
