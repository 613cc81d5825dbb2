//! Results for people and programs: rows, tables, plots. Independent of the experiments.

pub mod plot;
pub mod table;

pub use table::{Cell, Row, Table, TextColumn, grouped, in_lines};
