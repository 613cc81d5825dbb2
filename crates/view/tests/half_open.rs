//! A browser is served while other clients open connections and send no request.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use shiftvox_view::{Answer, Program, Request, Server};

struct Empty;

impl Program for Empty {
    fn hello(&self) -> Value {
        json!({ "scenes": [] })
    }

    fn drawer(
        &self,
        _is_stale: impl Fn() -> bool + Send + Sync + 'static,
    ) -> impl FnMut(&Request) -> Result<Answer, String> {
        |_| Err("there are no scenes".to_owned())
    }
}

#[test]
fn half_open_connections_keep_no_browser_waiting() {
    let server = Server::bind(([127, 0, 0, 1], 0).into()).unwrap();
    let address = server.page_address();
    std::thread::spawn(move || server.serve(&Empty));
    let (host, path) = address["http://".len()..].split_once('/').unwrap();
    let connect = |request: String| {
        let mut stream = TcpStream::connect(host).unwrap();
        let patience = Duration::from_secs(30);
        stream.set_read_timeout(Some(patience)).unwrap();
        let _ = stream.write_all(request.as_bytes());
        stream
    };
    let half_open = || connect("GET / HTTP/1.1\r\nHost: ".to_owned());
    let mut others: Vec<TcpStream> = (0..300).map(|_| half_open()).collect();
    let asked = Instant::now();
    let page = connect(format!("GET /{path} HTTP/1.1\r\nHost: {host}\r\n\r\n"));
    // The server ends the latest of the others, too.
    for (mut stream, status, seconds) in [(page, 200, 5), (others.remove(299), 408, 8)] {
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        assert!(
            answer.starts_with(&format!("HTTP/1.1 {status} ")),
            "{answer}"
        );
        assert!(asked.elapsed() < Duration::from_secs(seconds));
    }
}
