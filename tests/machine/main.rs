//! The machine and the oracle: order, exactness, rules, counts, golden pictures.

mod common;
mod counts;
mod exact;
mod files;
mod golden;
mod oracle;
mod order;
mod rules;
mod scenes;
mod vertex_error;
mod words;
