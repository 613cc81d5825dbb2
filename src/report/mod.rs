//! Results for people and programs: tables, plots, pages. Knows nothing of
//! what is measured.

#[cfg(feature = "cli")]
pub mod html;
#[cfg(feature = "cli")]
pub mod plot;
pub mod table;

pub use table::{Cell, Table, grouped};
