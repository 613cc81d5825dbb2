//! Results for people and programs: tables, plots, pages. Knows nothing of
//! what is measured.

pub mod html;
pub mod plot;
pub mod table;

pub use table::{Cell, Row, Table, grouped};
