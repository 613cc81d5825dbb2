//! The machine and the oracle: order, exactness, rules, counts, golden pictures.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod alpha;
mod certified;
mod common;
mod counts;
mod cycles_by_hand;
mod differential;
#[path = "../../crates/web/src/frame_hash.rs"]
mod frame_hash;
mod golden;
mod oracle;
mod order;
mod ortho;
mod rules;
mod scene_table;
mod scenes;
mod viewer;
mod widths;
mod words;
