//! Words, datapath, counters, the cycle model and prices.
#![allow(clippy::unwrap_used, reason = "tests")]

mod arithmetic;
mod caches;
mod common;
mod cost_tables;
mod costs;
mod costs_common;
mod counting;
mod cycles_by_hand;
mod cycles_common;
mod cycles_hardware;
mod cycles_properties;
mod cycles_traces;
mod division;
mod events;
mod formats;
mod traps;
