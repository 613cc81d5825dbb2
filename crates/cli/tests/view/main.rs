//! `view`: the page, its sockets, who may ask what; in a real browser too, where there is one.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod browser;
mod chromium;
mod pictures;
mod program;
mod rate;
mod refusals;
