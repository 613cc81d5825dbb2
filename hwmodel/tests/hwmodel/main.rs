//! Words, datapath, counters, the cycle model and prices.
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;
mod costs;
mod counting;
mod cycles_by_hand;
mod cycles_hardware;
mod cycles_properties;
mod words;
