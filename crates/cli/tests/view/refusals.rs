//! Rejected requests, which disturb no other page.

use std::io::Read;
use std::net::{TcpListener, TcpStream};
use std::os::unix::process::ExitStatusExt;
use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::json;
use tungstenite::Message;
use tungstenite::protocol::frame::coding::CloseCode;

use crate::program::{Page, Program, question, shiftvox};

/// A page gets a picture.
fn assert_serves(program: &Program) {
    let (head, rgba) = program.page().ask(json!({}));
    assert_eq!(head["ask"], "picture", "{head}");
    assert_eq!(rgba.len(), 120 * 90 * 4);
}

fn scene() -> Program {
    Program::start(&["tests/data/axes.vox"])
}

#[test]
fn a_page_is_for_who_knows_the_token_and_asks_by_address() {
    let program = scene();
    let (port, token) = (program.port, program.token.clone());
    let host = format!("Host: 127.0.0.1:{port}");
    let page = format!("/?token={token}");
    let status = |path: &str, host: &str| program.status(path, &[&format!("Host: {host}")]);
    let own = format!("127.0.0.1:{port}");
    let begun = &token[..31];
    let wrong = format!(
        "/?token={begun}0 /?token={begun} /?xtoken={token} / /?token= /socket /socket?token=x"
    );
    for path in wrong.split(' ') {
        assert_eq!(status(path, &own), 403, "{path}");
    }
    // As through a tunnel: another port.
    for name in ["127.0.0.1", "localhost", "localhost:9000", "[::1]:80"] {
        assert_eq!(status(&page, name), 200, "{name}");
    }
    // A name that an attacker points here, another computer, two names, none.
    let foreign = "evil.example localhost.evil.example 192.168.1.7 127.0.0.1.nip.io:80 user@ ";
    for name in foreign.split(' ') {
        assert_eq!(status(&page, name), 403, "{name}");
    }
    assert_eq!(program.status(&page, &[&host, "Host: evil.example"]), 400);
    assert_eq!(program.status(&page, &[]), 400);
    for path in "/page.html /../Cargo.toml /assets/tree.vox /?token=/etc/passwd".split(' ') {
        let status = status(&format!("{path}&token={token}"), &own);
        assert!(status == 404 || status == 403, "{path}: {status}");
    }
    let posted = program.raw(&format!(
        "POST {page} HTTP/1.1\r\n{host}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"
    ));
    assert!(posted.starts_with("HTTP/1.1 405"), "{posted}");
    let long = format!("X: {}", "x".repeat(40_000));
    let refused = program.raw(&format!("GET {page} HTTP/1.1\r\n{host}\r\n{long}\r\n\r\n"));
    assert!(
        refused.is_empty() || refused.starts_with("HTTP/1.1 431"),
        "{refused}"
    );
    assert_serves(&program);
}

#[test]
fn the_page_loads_nothing_from_elsewhere() {
    let program = scene();
    let (port, token) = (program.port, &program.token);
    let ask = || {
        program.raw(&format!(
            "GET /?token={token} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n"
        ))
    };
    let answer = ask();
    let (head, page) = answer.split_once("\r\n\r\n").unwrap();
    let policy = head
        .lines()
        .find_map(|line| line.strip_prefix("content-security-policy: "))
        .unwrap();
    for part in [
        "default-src 'none'; script-src 'nonce-",
        &format!("connect-src ws://127.0.0.1:{port};"),
        "frame-ancestors 'none'",
    ] {
        assert!(policy.contains(part), "{policy}");
    }
    assert!(!policy.contains("unsafe"), "{policy}");
    for header in ["nosniff", "no-referrer", "no-store", "same-origin"] {
        assert!(head.contains(header), "{header}: {head}");
    }
    for from in "https:// http:// src= @import url( innerHTML eval(".split(' ') {
        assert!(!page.contains(from), "{from}");
    }
    assert!(!page.contains(token.as_str()) && !page.contains("{{nonce}}"));
    assert_ne!(answer, ask(), "a nonce is used once");
}

#[test]
fn a_socket_is_for_the_page_itself() {
    let program = scene();
    let host = format!("127.0.0.1:{}", program.port);
    let own = format!("http://{host}");
    let secure = format!("https://{host}");
    let refused =
        |host: &str, origin: Option<&str>, token: &str| program.socket(host, origin, token).err();
    let foreign = [
        "null",
        "http://evil.example",
        &secure,
        "http://127.0.0.1:1",
        "",
    ]
    .map(Some);
    for origin in foreign.into_iter().chain([None]) {
        assert_eq!(
            refused(&host, origin, &program.token),
            Some(403),
            "{origin:?}"
        );
    }
    let (evil, tunnel) = ("http://evil.example", "http://localhost:9000");
    assert_eq!(refused(&host, Some(&own), &"0".repeat(32)), Some(403));
    assert_eq!(
        refused("evil.example", Some(evil), &program.token),
        Some(403)
    );
    assert_eq!(
        refused("localhost:9000", Some(tunnel), &program.token),
        None
    );
    let plain = program.status(
        &format!("/socket?token={}", program.token),
        &[&format!("Host: {host}"), &format!("Origin: {own}")],
    );
    assert!((400..500).contains(&plain), "{plain}");
}

/// Fields of a question, and a part of the refusal.
const QUESTIONS: &str = r#"{"scene":7} -> no scene
{"scene":"assets/tree.vox"} -> not understood
{"file":"a.png"} -> not understood
{"size":[0,10]} -> 1 to 32768
{"size":[4000000000,4000000000]} -> at most 4194304 pixels
{"size":[2049,2048]} -> at most 4194304 pixels
{"size":[2048,2048],"aa":4} -> 16777216 samples
{"size":[1.5,2]} -> not understood
{"aa":3} -> aa
{"aa":4000000000} -> samples
{"flags":{"output":"x.png"}} -> may not set
{"flags":{"config":"/etc/passwd"}} -> may not set
{"flags":{"aov":"depth"}} -> may not set
{"flags":{"coverage":"a b"}} -> no such value
{"flags":{"lod":"1111111111111111111111111111111111111111111111111111111111111111111111111111111111"}} -> no such value
{"flags":{"lod":"-1"}} -> 
{"flags":{"bits":"99"}} -> 
{"flags":{"coverage":"exact","tolerance":"2"}} -> 
{"flags":{"engine":"far"}} -> 
{"camera":{"eye":[null,0,0],TO,"fov":40}} -> not a finite number
{"camera":{"eye":[0,0,0],TO,"fov":40}} -> same point
{"camera":{"eye":[0,0,9],TO,"fov":40}} -> up direction
{"camera":{"eye":[9,0,0],TO,"fov":180}} -> field of view
{"camera":{"eye":[9,0,0],TO,"fov":null}} -> field of view
{"camera":{"eye":[1e300,0,0],TO,"fov":40}} -> 
{"ask":"figures"} -> placed camera"#;

#[test]
fn questions_that_make_no_sense_are_answered_with_the_reason() {
    let program = scene();
    let mut page = program.page();
    let mut refused = |text: &str, reason: &str| {
        page.send(text);
        let (head, body) = page.answer();
        assert_eq!(head["ask"], "error", "{text}: {head}");
        let said = head["error"].as_str().unwrap();
        assert!(said.contains(reason), "{text}: {said}");
        assert!(body.is_empty());
    };
    for text in [
        "",
        "{",
        "[]",
        "null",
        "\0",
        "{\"seq\":1}",
        "{\"seq\":-1,\"ask\":\"picture\"}",
    ] {
        refused(text, "not understood");
    }
    for line in QUESTIONS.lines() {
        let (fields, reason) = line.split_once(" -> ").unwrap();
        let fields = fields.replace("TO", r#""target":[0,0,0],"up":[0,0,1]"#);
        refused(
            &question(serde_json::from_str(&fields).unwrap()).to_string(),
            reason,
        );
    }
    let camera = json!({ "eye": [9, 0, 0], "target": [0, 0, 0], "up": [0, 0, 1], "fov": 40 });
    let far = question(json!({ "camera": camera })).to_string();
    refused(&far.replace("[9,", "[1e999,"), "");
    let (head, _) = page.ask(json!({}));
    assert_eq!(head["ask"], "picture");
}

#[test]
fn long_messages_and_floods_close_their_socket_alone() {
    let program = scene();
    let mut other = program.page();
    let mut page = program.page();
    page.send(&"x".repeat(5000));
    assert_eq!(page.closed(), Some(CloseCode::Size));
    let mut page = program.page();
    page.socket.send(Message::binary(vec![0; 10])).unwrap();
    assert_eq!(page.closed(), Some(CloseCode::Unsupported));
    for message in [
        Message::text(question(json!({})).to_string()),
        Message::Ping(Vec::new().into()),
    ] {
        let mut page = program.page();
        for _ in 0..1000 {
            let _ = page.socket.write(message.clone());
        }
        let _ = page.socket.flush();
        let started = Instant::now();
        let code = page.closed();
        assert!(started.elapsed() < Duration::from_secs(20), "it stays open");
        assert!(
            code.is_none_or(|code| code == CloseCode::Policy),
            "{code:?}"
        );
    }
    let (head, _) = other.ask(json!({}));
    assert_eq!(head["ask"], "picture");
    assert_serves(&program);
}

#[test]
fn of_questions_that_wait_the_newest_is_answered() {
    let program = Program::start(&["gen:menger,depth=5"]);
    let mut page = program.page();
    for seq in 1..=100 {
        page.send(&question(json!({ "seq": seq, "size": [1024, 1024] })).to_string());
    }
    let mut answers = 0;
    loop {
        let (head, _) = page.answer();
        answers += 1;
        if head["seq"] == 100 {
            break;
        }
    }
    assert!(answers < 60, "{answers} of 100 pictures were sent");
}

/// Reads of a stream what comes, a little at a time for so many seconds, then all: how many bytes.
fn read_slowly(stream: &mut TcpStream, seconds: u32) -> usize {
    let mut part = vec![0; 32 << 10];
    let mut count = 0;
    for _ in 0..10 * seconds {
        count += stream.read(&mut part).unwrap_or_default();
        std::thread::sleep(Duration::from_millis(100));
    }
    let mut rest = Vec::new();
    let _ = stream.read_to_end(&mut rest);
    count + rest.len()
}

#[test]
fn a_slow_link_gets_a_large_picture() {
    let program = scene();
    let mut page = program.page();
    page.send(&question(json!({ "size": [2048, 2048] })).to_string());
    // The stream itself, below the messages; a second without anything is its end.
    let stream = page.socket.get_mut();
    stream
        .set_read_timeout(Some(Duration::from_secs(1)))
        .unwrap();
    let count = read_slowly(stream, 13);
    assert!(count > 4 * 2048 * 2048, "{count} bytes came");
}

/// Opens a page as soon as there is a place for it.
fn page_in_time(program: &Program, seconds: u64) -> Page {
    let until = Instant::now() + Duration::from_secs(seconds);
    loop {
        match program.try_page() {
            Ok(page) => return page,
            Err(status) => assert!(Instant::now() < until, "{status}: the places stay taken"),
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_page_that_leaves_or_does_not_read_loses_its_place() {
    let program = scene();
    let mut pages: Vec<Page> = (0..8).map(|_| program.page()).collect();
    assert_eq!(program.try_page().err(), Some(503));
    let (head, _) = pages[7].ask(json!({}));
    assert_eq!(head["ask"], "picture");
    pages.remove(0);
    pages.push(page_in_time(&program, 10));
    // More than the buffers of a connection hold.
    pages[0].send(&question(json!({ "size": [2048, 2048] })).to_string());
    page_in_time(&program, 25);
    let (head, _) = pages[7].ask(json!({}));
    assert_eq!(head["ask"], "picture");
}

#[test]
fn pages_that_vanish_leave_nothing() {
    let program = scene();
    for round in 0..24u32 {
        let mut page = page_in_time(&program, 10);
        page.send(&question(json!({ "size": [1024, 1024] })).to_string());
        // Before the picture is drawn, and while it is sent: more than the system holds for a socket.
        let wait = Duration::from_millis(u64::from(round % 4) * 15);
        std::thread::sleep(wait);
        drop(page);
    }
    assert_serves(&program);
}

#[test]
fn a_port_in_use_and_wrong_flags_are_told() {
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let told = |line: &str| {
        let output = shiftvox(&format!("view {line}"));
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), text, output.stdout)
    };
    let (code, text, stdout) = told(&format!("tests/data/axes.vox --port {port}"));
    assert_eq!(code, Some(1), "{text}");
    assert!(
        text.contains(&format!("cannot listen on 127.0.0.1:{port}")) && text.contains("--port"),
        "{text}"
    );
    assert!(stdout.is_empty());
    for (line, expected) in [
        ("no-such-file.vox", 4),
        ("--quiet", 2),
        ("tests/data/axes.vox --port 70000", 2),
        ("tests/data/axes.vox --bind localhost", 2),
        ("tests/data/axes.vox --aov depth", 2),
        ("tests/data/axes.vox --far-opacity six", 2),
        ("tests/data/axes.vox --bind 192.0.2.1", 1),
        ("tests/data/axes.vox --size 2049x2048", 5),
        ("tests/data/axes.vox --size 2048 --aa 4", 5),
    ] {
        let (code, text, _) = told(line);
        assert_eq!(code, Some(expected), "{line}: {text}");
        assert!(!text.contains("panicked"), "{text}");
    }
}

#[test]
fn a_signal_ends_it_at_once() {
    let mut program = scene();
    let mut page = program.page();
    page.send(&question(json!({ "size": [1024, 1024] })).to_string());
    let pid = program.child.id().to_string();
    let started = Instant::now();
    // Not Ctrl-C's: whoever runs the tests in the background may have had that ignored.
    assert!(
        Command::new("kill")
            .args(["-TERM", &pid])
            .status()
            .unwrap()
            .success()
    );
    assert_eq!(program.child.wait().unwrap().signal(), Some(15));
    assert!(started.elapsed() < Duration::from_secs(5));
    // The port is free again.
    TcpListener::bind(("127.0.0.1", program.port)).unwrap();
}
