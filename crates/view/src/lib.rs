//! Scenes on a page: a web page for a browser on this computer, and the server behind it.
//!
//! [`Server`] serves the page and its sockets over HTTP/1.1, with one thread per connection.
//! `server.rs` checks who asks, `socket.rs` exchanges messages with a page, and `request.rs` lists
//! what a page may ask. The crate draws nothing: a program that draws implements [`Program`].

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
    /// The fields of the first message: names of `scenes`, and the `flags`, the `size` and the
    /// samples per axis (`aa`) with which a page begins.
    fn hello(&self) -> Value;

    /// Answers the requests of one socket; an error is the reason of a refusal. The server drops
    /// it after 10 s without a request, to free its memory, and makes another when one comes.
    fn drawer(&self) -> impl FnMut(&Request) -> Result<Answer, String>;
}
