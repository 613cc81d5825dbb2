//! A web page of scenes for a browser on this computer, and the server behind it.
//!
//! `Server` serves the page and its sockets over HTTP/1.1, with one thread per connection. A program that draws
//! implements [`Program`]. A page without a server exchanges the same messages with a worker.

#![forbid(unsafe_code)]

mod message;
mod request;
#[cfg(feature = "server")]
mod server;
#[cfg(feature = "server")]
mod socket;

use serde_json::Value;

pub use message::{answer, command, hello, message, picked};
pub use request::{Ask, Camera, FLAGS, Flags, Request, check_size};
#[cfg(feature = "server")]
pub use server::Server;

/// The page. The server replaces `{{nonce}}` by a random number, which its policy of scripts names.
pub const PAGE: &str = include_str!("page.html");

/// The fields of an answer, and the bytes of its picture if it has one.
pub type Answer = (Value, Vec<u8>);

/// A program that draws for pages.
pub trait Program: Sync {
    /// The first message: names of `scenes`, and the `flags`, `size` and samples per axis (`aa`) with which a page
    /// begins.
    fn hello(&self) -> Value;

    /// Adds a dropped file to the end of the list of scenes; an error is the reason of a refusal.
    fn open(&self, _name: &str, _bytes: &[u8]) -> Result<(), String> {
        Err("this program takes no files".to_owned())
    }

    /// Answers the requests of one socket; an error is the reason of a refusal. It is dropped after 10 s without one.
    /// When `is_stale`, which should be asked every few milliseconds, the answer to the current request is of no use.
    fn drawer(
        &self,
        is_stale: impl Fn() -> bool + Send + Sync + 'static,
    ) -> impl FnMut(&Request) -> Result<Answer, String>;
}
