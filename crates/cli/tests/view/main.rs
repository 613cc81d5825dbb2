//! `view`: the page, its sockets and its permissions, also in a real browser.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod browser;
mod chromium;
mod pictures;
mod program;
mod refusals;
mod without_server;
