//! The laboratory: bounds, stress, figures, test vectors.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod bounds;
#[path = "../../../../tests/machine/common/mod.rs"]
mod common;
mod figures;
#[path = "../../../../tests/machine/scenes/mod.rs"]
mod scenes;
mod stress;
mod vectors;
