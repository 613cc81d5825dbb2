//! A web page of scenes for a browser on this computer, and the server behind it.
//!
//! [`Server`] serves the page and its sockets over HTTP/1.1, with one thread per connection. A program that draws
//! implements [`Program`].

#![forbid(unsafe_code)]

mod request;
mod server;
mod socket;

use serde_json::Value;

pub use request::{Ask, Camera, FLAGS, Flags, Request, check_size};
pub use server::Server;

/// The fields of an answer, and the bytes of its picture if it has one.
pub type Answer = (Value, Vec<u8>);

/// A program that draws for pages.
pub trait Program: Sync {
    /// The first message: names of `scenes`, and the `flags`, `size` and samples per axis (`aa`) with which a page
    /// begins.
    fn hello(&self) -> Value;

    /// Answers the requests of one socket; an error is the reason of a refusal. It is dropped after 10 s without one.
    fn drawer(&self) -> impl FnMut(&Request) -> Result<Answer, String>;
}
