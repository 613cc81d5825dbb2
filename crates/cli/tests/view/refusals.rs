//! Rejected requests, which disturb no other page.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::json;
use tungstenite::Message;
use tungstenite::protocol::frame::coding::CloseCode;

use crate::program::{Page, Program, command, question, run_command};

fn scene() -> Program {
    Program::start("tests/data/axes.vox")
}

/// A page gets a picture.
fn assert_serves(page: &mut Page) {
    let (head, rgba) = page.ask(json!({}));
    assert_eq!(head["ask"], "picture", "{head}");
    assert_eq!(rgba.len(), 120 * 90 * 4);
}

/// Statuses of requests with their headers. `PAGE` is the page's path, `HERE` its host.
const REQUESTS: &str = "\
200 GET PAGE | Host: HERE
200 GET PAGE | Host: 127.0.0.1
200 GET PAGE | Host: localhost
200 GET PAGE | Host: localhost:9000
200 GET PAGE | Host: [::1]:80
403 GET / | Host: HERE
403 GET /?token= | Host: HERE
403 GET /?token=SHORT | Host: HERE
403 GET /?token=OTHER | Host: HERE
403 GET /?xtoken=TOKEN | Host: HERE
403 GET /?token=/etc/passwd&token=TOKEN | Host: HERE
404 GET /page.html?token=TOKEN | Host: HERE
404 GET /../Cargo.toml?token=TOKEN | Host: HERE
404 GET /assets/tree.vox?token=TOKEN | Host: HERE
403 GET PAGE | Host: evil.example
403 GET PAGE | Host: localhost.evil.example
403 GET PAGE | Host: 192.168.1.7
403 GET PAGE | Host: 127.0.0.1.nip.io:80
403 GET PAGE | Host: user@
403 GET PAGE | Host:
400 GET PAGE | Host: HERE | Host: evil.example
400 GET PAGE
405 POST PAGE | Host: HERE | Content-Length: 0
101 GET SOCKET | Host: HERE | Origin: http://HERE | UPGRADE
101 GET SOCKET | Host: localhost:9000 | Origin: http://localhost:9000 | UPGRADE
400 GET SOCKET | Host: HERE | Origin: http://HERE
403 GET SOCKET | Host: HERE | UPGRADE
403 GET SOCKET | Host: HERE | Origin: | UPGRADE
403 GET SOCKET | Host: HERE | Origin: null | UPGRADE
403 GET SOCKET | Host: HERE | Origin: https://HERE | UPGRADE
403 GET SOCKET | Host: HERE | Origin: http://127.0.0.1:1 | UPGRADE
403 GET SOCKET | Host: HERE | Origin: http://evil.example | UPGRADE
403 GET SOCKET | Host: evil.example | Origin: http://evil.example | UPGRADE
403 GET /file?token=TOKEN | Host: HERE | Origin: http://evil.example | UPGRADE
403 GET /file | Host: HERE | Origin: http://HERE | UPGRADE
101 GET /file?token=TOKEN | Host: HERE | Origin: http://HERE | UPGRADE
403 GET /socket | Host: HERE | Origin: http://HERE | UPGRADE
403 GET /socket?token=OTHER | Host: HERE | Origin: http://HERE | UPGRADE";
const UPGRADE: &str = "Connection: Upgrade | Upgrade: websocket | Sec-WebSocket-Version: 13 | \
                       Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==";

#[test]
fn a_page_is_for_who_knows_the_token_and_asks_by_address() {
    let program = scene();
    let short = &program.token[..31];
    let other = if program.token.ends_with('0') { 1 } else { 0 };
    let requests = REQUESTS
        .replace("PAGE", "/?token=TOKEN")
        .replace("SOCKET", "/socket?token=TOKEN")
        .replace("OTHER", &format!("{short}{other}"))
        .replace("SHORT", short)
        .replace("TOKEN", &program.token)
        .replace("HERE", &program.host)
        .replace("UPGRADE", UPGRADE);
    for line in requests.lines() {
        let (status, request) = line.split_once(' ').unwrap();
        let answer = program.request(request);
        let begin = format!("HTTP/1.1 {status} ");
        assert!(answer.starts_with(&begin), "{request}: {answer}");
    }
    let long = format!("GET / | X: {}", "x".repeat(40_000));
    let refused = program.request(&long);
    let is_refused = refused.is_empty() || refused.starts_with("HTTP/1.1 431");
    assert!(is_refused, "{refused}");
    assert_serves(&mut program.page());
}

#[test]
fn the_page_loads_nothing_from_elsewhere() {
    let program = scene();
    let Program { host, token, .. } = &program;
    let ask = || program.request(&format!("GET /?token={token} | Host: {host}"));
    let answer = ask();
    let (head, page) = answer.split_once("\r\n\r\n").unwrap();
    let mut lines = head.lines();
    let policy = lines.find_map(|line| line.strip_prefix("content-security-policy: "));
    let policy = policy.unwrap();
    for part in [
        "default-src 'none'; script-src 'nonce-",
        &format!("connect-src 'self' ws://{host};"),
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

/// Fields of a question, and a part of the refusal. 12345 is beyond the numbers.
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
{"flags":{"coverage":"/etc/passwd"}} -> no such value
{"flags":{"lod":"1 --outdir=x"}} -> no such value
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
{"camera":{"eye":[12345,0,0],TO,"fov":40}} -> not understood
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
        r#"{"seq":1}"#,
        r#"{"seq":-1,"ask":"picture"}"#,
    ] {
        refused(text, "not understood");
    }
    for line in QUESTIONS.lines() {
        let (fields, reason) = line.split_once(" -> ").unwrap();
        let fields = fields.replace("TO", r#""target":[0,0,0],"up":[0,0,1]"#);
        let question = question(serde_json::from_str(&fields).unwrap());
        refused(&question.to_string().replace("12345", "1e999"), reason);
    }
    assert_serves(&mut page);
}

#[test]
fn long_messages_and_floods_close_their_socket_alone() {
    let program = scene();
    let mut other = program.page();
    let question = Message::text(question(json!({})).to_string());
    for (message, times, code) in [
        (Message::text("x".repeat(5000)), 1, CloseCode::Size),
        (Message::binary(vec![0; 10]), 1, CloseCode::Unsupported),
        (question, 1000, CloseCode::Policy),
        (Message::Ping(Vec::new().into()), 1000, CloseCode::Policy),
    ] {
        let mut page = program.page();
        for _ in 0..times {
            let _ = page.socket.write(message.clone());
        }
        let _ = page.socket.flush();
        let started = Instant::now();
        let closed = page.closed();
        assert!(started.elapsed() < Duration::from_secs(20), "it stays open");
        // A flood may break the connection before the reason arrives.
        let is_flood = times > 1;
        assert!(
            closed == Some(code) || is_flood && closed.is_none(),
            "{closed:?}"
        );
    }
    assert_serves(&mut other);
    assert_serves(&mut program.page());
}

#[test]
fn of_questions_that_wait_the_newest_is_answered() {
    let program = Program::start("gen:menger,depth=5");
    let mut page = program.page();
    for seq in 1..=100 {
        page.send(question(json!({ "seq": seq, "size": [1024, 1024] })));
    }
    let mut answers = 1;
    while page.answer().0["seq"] != 100 {
        answers += 1;
    }
    assert!(answers < 60, "{answers} of 100 pictures were sent");
}

#[test]
fn a_slow_link_gets_a_large_picture() {
    let program = scene();
    let mut page = program.page();
    page.send(question(json!({ "size": [2048, 2048] })));
    // The stream itself, below the messages; a second without anything is its end.
    let stream = page.socket.get_mut();
    let second = Duration::from_secs(1);
    stream.set_read_timeout(Some(second)).unwrap();
    let mut part = vec![0; 32 << 10];
    let mut count = 0;
    for _ in 0..130 {
        count += stream.read(&mut part).unwrap_or_default();
        std::thread::sleep(second / 10);
    }
    let mut rest = Vec::new();
    let _ = stream.read_to_end(&mut rest);
    count += rest.len();
    assert!(count > 4 * 2048 * 2048, "{count} bytes came");
}

#[test]
fn dropped_files_are_taken_or_refused_with_the_reason() {
    let program = scene();
    let dropped = |name: &str, bytes: &[u8]| {
        let mut page = program.socket("file").unwrap();
        page.send(name);
        page.socket.send(Message::binary(bytes.to_vec())).unwrap();
        page.answer().0
    };
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let tree = std::fs::read(root.join("assets/tree.vox")).unwrap();
    let mesh = std::fs::read(root.join("assets/knot.obj")).unwrap();
    let long = "x".repeat(300);
    for (name, bytes, reason) in [
        ("wrong.vox", &b"nonsense"[..], "wrong.vox"),
        ("", &[], ""),
        ("/etc/passwd", &[], ""),
        ("half.vox", &tree[..1000], ""),
        ("knot.obj", &mesh, "mesh"),
        (&long, &tree, "not a name"),
    ] {
        let head = dropped(name, bytes);
        let said = head["error"].as_str().unwrap_or_else(|| panic!("{head}"));
        println!("{name:.10}: {said}");
        assert!(said.contains(reason), "{head}");
    }
    // The head of a frame announces one byte too many.
    let mut page = program.socket("file").unwrap();
    page.send("large.vox");
    let length = ((256u64 << 20) + 1).to_be_bytes();
    let head = [&[0x82, 0xff][..], &length, &[0; 4]].concat();
    page.socket.get_mut().write_all(&head).unwrap();
    let said = page.answer().0;
    assert_eq!(said["error"], "the file is too large", "{said}");

    // A page that was open draws the new scene, and the program takes a limited number.
    let mut page = program.page();
    for count in 2..=17 {
        let head = dropped("assets/tree.vox", &tree);
        assert_eq!(head["scenes"].as_array().unwrap().len(), count, "{head}");
    }
    let said = dropped("assets/tree.vox", &tree);
    assert!(
        said["error"].as_str().unwrap().contains("too many"),
        "{said}"
    );
    let (head, _) = page.ask(json!({ "scene": 16, "hash": true }));
    let (_, hash) = run_command(head["command"].as_str().unwrap());
    assert_eq!(head["hash"], hash);
    assert_serves(&mut page);
}

#[test]
fn a_browser_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let [script, seen] = ["browser", "seen"].map(|name| folder.path().join(name));
    let text = format!(
        "#!/bin/sh\necho \"$1\" >{}.new\nmv {0}.new {0}\n",
        seen.display()
    );
    std::fs::write(&script, text).unwrap();
    std::fs::set_permissions(&script, std::fs::Permissions::from_mode(0o755)).unwrap();
    let mut view = command("view tests/data/axes.vox --quiet --open");
    view.env("BROWSER", script).stdout(Stdio::piped());
    let mut child = view.spawn().unwrap();
    let mut address = String::new();
    let mut printed = BufReader::new(child.stdout.take().unwrap());
    printed.read_line(&mut address).unwrap();
    let until = Instant::now() + Duration::from_secs(10);
    while !seen.exists() && Instant::now() < until {
        std::thread::sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(std::fs::read_to_string(seen).unwrap(), address);
}

#[test]
fn a_token_that_others_can_read_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("token");
    let line = format!("tests/data/axes.vox --token-file {}", file.display());
    let first = Program::start(&line).token.clone();
    let mode = std::fs::metadata(&file).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
    assert_eq!(Program::start(&line).token, first);
    let refused = || {
        let mut view = command(&format!("view {line}"));
        let mut child = view
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // The first line is an address, or there is none.
        let mut printed = String::new();
        let mut lines = BufReader::new(child.stdout.take().unwrap());
        lines.read_line(&mut printed).unwrap();
        let _ = child.kill();
        assert_eq!(printed, "");
        let output = child.wait_with_output().unwrap();
        String::from_utf8(output.stderr).unwrap()
    };
    std::fs::write(&file, "short").unwrap();
    assert!(refused().contains("32 hexadecimal digits"));
    std::fs::write(&file, first).unwrap();
    std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o640)).unwrap();
    assert!(refused().contains("other users can read it"));
}

/// Opens a page as soon as there is a place for it.
fn page_in_time(program: &Program, seconds: u64) -> Page {
    let until = Instant::now() + Duration::from_secs(seconds);
    loop {
        if let Some(page) = program.try_page() {
            return page;
        }
        assert!(Instant::now() < until, "the places stay taken");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_page_that_leaves_or_does_not_read_loses_its_place() {
    let program = scene();
    let mut pages: Vec<Page> = (0..8).map(|_| program.page()).collect();
    let Program { host, token, .. } = &program;
    let socket = format!("GET /socket?token={token} | Host: {host} | Origin: http://{host}");
    let answer = program.request(&format!("{socket} | {UPGRADE}"));
    assert!(answer.starts_with("HTTP/1.1 503"), "{answer}");
    assert_serves(&mut pages[7]);
    // Pages leave before their pictures are drawn, and while these are sent.
    for round in 0..24 {
        pages[0].send(question(json!({ "size": [1024, 1024] })));
        std::thread::sleep(Duration::from_millis(round % 4 * 15));
        pages.remove(0);
        let last = pages.len() - 1;
        pages.insert(last, page_in_time(&program, 10));
    }
    // More than the buffers of a connection hold.
    pages[0].send(question(json!({ "size": [2048, 2048] })));
    page_in_time(&program, 25);
    assert_serves(&mut pages[7]);
}

#[test]
fn half_open_connections_keep_no_browser_waiting() {
    let program = scene();
    let half_open = |_| {
        let mut stream = program.stream();
        let _ = stream.write_all(b"GET / HTTP/1.1\r\nHost: ");
        stream
    };
    let mut others: Vec<TcpStream> = (0..300).map(half_open).collect();
    let asked = Instant::now();
    let Program { host, token, .. } = &program;
    let page = program.request(&format!("GET /?token={token} | Host: {host}"));
    assert!(page.starts_with("HTTP/1.1 200 "), "{page}");
    assert!(asked.elapsed() < Duration::from_secs(5));
    // The server ends the latest of the others, too.
    let mut answer = String::new();
    others[299].read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 408 "), "{answer}");
    assert!(asked.elapsed() < Duration::from_secs(8));
}

#[test]
fn a_signal_ends_it_at_once() {
    let mut program = scene();
    let mut page = program.page();
    page.send(question(json!({ "size": [1024, 1024] })));
    let started = Instant::now();
    // Not Ctrl-C's: whoever runs the tests in the background may have had that ignored.
    let mut kill = Command::new("kill");
    let killed = kill
        .args(["-TERM", &program.child.id().to_string()])
        .status();
    assert!(killed.unwrap().success());
    assert_eq!(program.child.wait().unwrap().signal(), Some(15));
    assert!(started.elapsed() < Duration::from_secs(5));
    // The port is free again.
    TcpListener::bind(&program.host).unwrap();
}
