//! Results for people and programs: rows, tables, plots, pages. Independent of the experiments.

pub mod html;
pub mod plot;
pub mod table;

pub use table::{Cell, Row, Table, grouped};
