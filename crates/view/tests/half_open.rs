//! A browser is served while other clients open connections and send no request.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use shiftvox_view::{Answer, Program, Request, Server};

/// A program without scenes.
struct Empty;

impl Program for Empty {
    fn hello(&self) -> Value {
        json!({ "scenes": [] })
    }

    fn drawer(&self) -> impl FnMut(&Request) -> Result<Answer, String> {
        |_| Err("there are no scenes".to_owned())
    }
}

#[test]
fn half_open_connections_keep_no_browser_waiting() {
    let server = Server::bind(([127, 0, 0, 1], 0).into()).unwrap();
    let address = server.page_address();
    std::thread::spawn(move || server.serve(&Empty));
    let (host, path) = address["http://".len()..].split_once('/').unwrap();
    let half_open = |_| {
        let mut stream = TcpStream::connect(host).unwrap();
        let _ = stream.write_all(b"GET / HTTP/1.1\r\nHost: ");
        stream
    };
    let mut others: Vec<TcpStream> = (0..300).map(half_open).collect();
    let asked = Instant::now();
    let mut stream = TcpStream::connect(host).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_secs(30)))
        .unwrap();
    let request = format!("GET /{path} HTTP/1.1\r\nHost: {host}\r\n\r\n");
    stream.write_all(request.as_bytes()).unwrap();
    let mut page = String::new();
    stream.read_to_string(&mut page).unwrap();
    let took = asked.elapsed();
    println!("answered in {took:?}");
    assert!(page.starts_with("HTTP/1.1 200"), "{page}");
    assert!(took < Duration::from_secs(5), "{took:?}");
    // The server ends the latest of the others, too.
    let latest = others.last_mut().unwrap();
    latest
        .set_read_timeout(Some(Duration::from_secs(30)))
        .unwrap();
    let mut answer = String::new();
    latest.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 408"), "{answer}");
    assert!(asked.elapsed() < Duration::from_secs(8));
}
