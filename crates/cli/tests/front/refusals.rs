//! Terminals, and mapped files that change.
#![cfg(unix)]

use std::fs;
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::program::Folder;

#[test]
#[ignore = "needs the program `script`, which makes a terminal"]
fn progress_is_for_terminals_that_can_draw_it() {
    let folder = Folder::new();
    let drawn = |term: &str| {
        let line = "\"$PROGRAM\" convert gen:terrain,depth=8 a.vxg --force";
        let script = format!(
            "PROGRAM=\"$0\" TERM={term} SHELL=/bin/sh script -qec '{line}' /dev/null < /dev/null"
        );
        let [stdout, _] = folder.sh(&script, 0);
        stdout
    };
    for term in ["", "dumb"] {
        assert!(!drawn(term).contains(['\x1b', '%']));
    }
    assert!(drawn("xterm").contains('%'));
}

#[test]
#[cfg(target_os = "linux")]
fn a_mapped_file_that_is_cut_short_is_told() {
    let folder = Folder::new();
    folder.run("convert gen:terrain,depth=7 a.vxg", 0);
    let mut command = folder.command("render a.vxg --repeat 1000000 --size 128 -o a.png --json");
    let mut child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let started = Instant::now();
    let maps = format!("/proc/{}/maps", child.id());
    while !fs::read_to_string(&maps)
        .unwrap_or_default()
        .contains("a.vxg")
    {
        assert!(started.elapsed() < Duration::from_secs(20), "never mapped");
        assert!(child.try_wait().unwrap().is_none());
    }
    std::thread::sleep(Duration::from_millis(200));
    let file = fs::File::options().write(true).open(folder.at("a.vxg"));
    file.unwrap().set_len(512).unwrap();
    let output = child.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{told}");
    assert!(
        told.contains("a.vxg: ") && told.contains("cut short"),
        "{told}"
    );
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["exit_code"], 4);
    assert_eq!(folder.names(), ["a.vxg"]);
}
