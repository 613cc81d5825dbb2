//! What is refused, and that nothing else suffers from it.

use std::io::Read;
use std::net::{TcpListener, TcpStream};
use std::os::unix::process::ExitStatusExt;
use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tungstenite::Message;
use tungstenite::protocol::frame::coding::CloseCode;

use crate::program::{Page, Program, question};

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
    let wrong = format!("/?token={}0", &token[..31]);
    let short = format!("/?token={}", &token[..31]);
    let prefixed = format!("/?xtoken={token}");
    for path in [
        "/",
        "/?token=",
        &wrong,
        &short,
        &prefixed,
        "/socket",
        "/socket?token=x",
    ] {
        assert_eq!(program.status(path, &[&host]), 403, "{path}");
    }
    // As a tunnel is asked: another port.
    for name in ["127.0.0.1", "localhost", "localhost:9000", "[::1]:80"] {
        assert_eq!(
            program.status(&page, &[&format!("Host: {name}")]),
            200,
            "{name}"
        );
    }
    // A name that an attacker points here, another computer, two names, none.
    for name in [
        "evil.example",
        "localhost.evil.example",
        "192.168.1.7",
        "127.0.0.1.nip.io:80",
        "user@",
        "",
    ] {
        assert_eq!(
            program.status(&page, &[&format!("Host: {name}")]),
            403,
            "{name}"
        );
    }
    assert_eq!(program.status(&page, &[&host, "Host: evil.example"]), 400);
    assert_eq!(program.status(&page, &[]), 400);
    for path in [
        "/page.html",
        "/../Cargo.toml",
        "/assets/tree.vox",
        "/?token=/etc/passwd",
    ] {
        let status = program.status(&format!("{path}&token={token}"), &[&host]);
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
    assert!(
        policy.starts_with("default-src 'none'; script-src 'nonce-"),
        "{policy}"
    );
    assert!(
        policy.contains(&format!("connect-src ws://127.0.0.1:{port};")),
        "{policy}"
    );
    assert!(
        policy.contains("frame-ancestors 'none'") && !policy.contains("unsafe"),
        "{policy}"
    );
    for header in ["nosniff", "no-referrer", "no-store", "same-origin"] {
        assert!(head.contains(header), "{header}: {head}");
    }
    for from in [
        "https://",
        "http://",
        "src=",
        "@import",
        "url(",
        "innerHTML",
        "eval(",
    ] {
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
    for origin in [
        None,
        Some("null"),
        Some("http://evil.example"),
        Some(&secure),
        Some("http://127.0.0.1:1"),
        Some(""),
    ] {
        assert_eq!(
            refused(&host, origin, &program.token),
            Some(403),
            "{origin:?}"
        );
    }
    assert_eq!(refused(&host, Some(&own), &"0".repeat(32)), Some(403));
    assert_eq!(
        refused("evil.example", Some("http://evil.example"), &program.token),
        Some(403)
    );
    assert_eq!(
        refused(
            "localhost:9000",
            Some("http://localhost:9000"),
            &program.token
        ),
        None
    );
    let plain = program.status(
        &format!("/socket?token={}", program.token),
        &[&format!("Host: {host}"), &format!("Origin: {own}")],
    );
    assert!((400..500).contains(&plain), "{plain}");
}

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
        "\u{0}",
        "{\"seq\":1}",
        "{\"seq\":-1,\"ask\":\"picture\"}",
    ] {
        refused(text, "not understood");
    }
    let camera = |eye: Value, fov: Value| json!({ "eye": eye, "target": [0, 0, 0], "up": [0, 0, 1], "fov": fov });
    for (fields, reason) in [
        (json!({ "scene": 7 }), "no scene"),
        (json!({ "scene": "assets/tree.vox" }), "not understood"),
        (json!({ "file": "a.png" }), "not understood"),
        (json!({ "size": [0, 10] }), "1 to 32768"),
        (
            json!({ "size": [4_000_000_000u32, 4_000_000_000u32] }),
            "at most 4194304 pixels",
        ),
        (json!({ "size": [2049, 2048] }), "at most 4194304 pixels"),
        (json!({ "size": [2048, 2048], "aa": 4 }), "16777216 samples"),
        (json!({ "size": [1.5, 2] }), "not understood"),
        (json!({ "aa": 3 }), "aa"),
        (json!({ "aa": 4_000_000_000u32 }), "samples"),
        (json!({ "flags": { "output": "x.png" } }), "may not set"),
        (
            json!({ "flags": { "config": "/etc/passwd" } }),
            "may not set",
        ),
        (json!({ "flags": { "aov": "depth" } }), "may not set"),
        (json!({ "flags": { "coverage": "a b" } }), "no such value"),
        (
            json!({ "flags": { "lod": "1".repeat(100) } }),
            "no such value",
        ),
        (json!({ "flags": { "lod": "-1" } }), ""),
        (json!({ "flags": { "bits": "99" } }), ""),
        (
            json!({ "flags": { "coverage": "exact", "tolerance": "2" } }),
            "",
        ),
        (json!({ "flags": { "engine": "far" } }), ""),
        (
            json!({ "camera": camera(json!([null, 0, 0]), json!(40)) }),
            "not a finite number",
        ),
        (
            json!({ "camera": camera(json!([0, 0, 0]), json!(40)) }),
            "same point",
        ),
        (
            json!({ "camera": camera(json!([0, 0, 9]), json!(40)) }),
            "up direction",
        ),
        (
            json!({ "camera": camera(json!([9, 0, 0]), json!(180)) }),
            "field of view",
        ),
        (
            json!({ "camera": camera(json!([9, 0, 0]), json!(null)) }),
            "field of view",
        ),
        (
            json!({ "camera": camera(json!([1e300, 0, 0]), json!(40)) }),
            "",
        ),
        (json!({ "ask": "figures" }), "placed camera"),
    ] {
        refused(&question(fields).to_string(), reason);
    }
    refused(
        &question(json!({ "camera": camera(json!([9, 0, 0]), json!(40)) }))
            .to_string()
            .replace("[9,", "[1e999,"),
        "",
    );
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
    let mut page = program.page();
    for _ in 0..1000 {
        if page
            .socket
            .write(Message::text(question(json!({})).to_string()))
            .is_err()
        {
            break;
        }
    }
    let _ = page.socket.flush();
    let code = page.closed();
    assert!(
        code.is_none() || code == Some(CloseCode::Policy),
        "{code:?}"
    );
    let mut pings = program.page();
    for _ in 0..1000 {
        let _ = pings.socket.write(Message::Ping(Vec::new().into()));
    }
    let _ = pings.socket.flush();
    let started = Instant::now();
    let code = pings.closed();
    assert!(started.elapsed() < Duration::from_secs(20), "it stays open");
    assert!(
        code.is_none() || code == Some(CloseCode::Policy),
        "{code:?}"
    );
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

#[test]
fn a_page_that_does_not_read_loses_its_place() {
    let program = scene();
    let mut pages: Vec<Page> = (0..8).map(|_| program.page()).collect();
    assert_eq!(program.try_page().err(), Some(503));
    // More than the buffers of a connection hold.
    pages[0].send(&question(json!({ "size": [2048, 2048] })).to_string());
    let until = Instant::now() + Duration::from_secs(25);
    while program.try_page().is_err() {
        assert!(Instant::now() < until, "the place stays taken");
        std::thread::sleep(Duration::from_millis(100));
    }
    let (head, _) = pages[7].ask(json!({}));
    assert_eq!(head["ask"], "picture");
}

#[test]
fn pages_have_a_number() {
    let program = scene();
    let mut pages: Vec<Page> = (0..8).map(|_| program.page()).collect();
    assert_eq!(program.try_page().err(), Some(503));
    let (head, _) = pages[7].ask(json!({}));
    assert_eq!(head["ask"], "picture");
    pages.remove(0);
    let until = Instant::now() + Duration::from_secs(10);
    while program.try_page().is_err() {
        assert!(
            Instant::now() < until,
            "the place of a page that went stays taken"
        );
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn pages_that_vanish_leave_nothing() {
    let program = scene();
    for round in 0..24u32 {
        let mut page = program.try_page();
        let until = Instant::now() + Duration::from_secs(10);
        while page.is_err() && Instant::now() < until {
            std::thread::sleep(Duration::from_millis(20));
            page = program.try_page();
        }
        let mut page = page.unwrap();
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
    let told = |words: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_shiftvox"));
        let command = command
            .arg("view")
            .args(words)
            .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
        let output = command.output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), text, output.stdout)
    };
    let (code, text, stdout) = told(&["tests/data/axes.vox", "--port", &port]);
    assert_eq!(code, Some(1), "{text}");
    assert!(
        text.contains(&format!("cannot listen on 127.0.0.1:{port}")) && text.contains("--port"),
        "{text}"
    );
    assert!(stdout.is_empty());
    for (words, expected) in [
        (&["no-such-file.vox"][..], 4),
        (&[][..], 2),
        (&["tests/data/axes.vox", "--port", "70000"], 2),
        (&["tests/data/axes.vox", "--bind", "localhost"], 2),
        (&["tests/data/axes.vox", "--aov", "depth"], 2),
        (&["tests/data/axes.vox", "--far-opacity", "six"], 2),
        (&["tests/data/axes.vox", "--bind", "192.0.2.1"], 1),
        (&["tests/data/axes.vox", "--size", "2049x2048"], 5),
        (&["tests/data/axes.vox", "--size", "2048", "--aa", "4"], 5),
    ] {
        let (code, text, _) = told(words);
        assert_eq!(code, Some(expected), "{words:?}: {text}");
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
