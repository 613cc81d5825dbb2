//! Control characters, terminals, full disks, and mapped files that change, which rows of `cases` cannot express.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{Assert, Run};
use crate::program::{folder, run, shiftvox, stderr_of, stdout_of, words};

fn sh(folder: &Path, script: &str) -> Assert {
    let mut command = Command::new("sh");
    command.current_dir(folder).args(["-c", script]);
    command.arg(crate::common::program()).assert()
}

#[test]
fn names_are_shown_escaped() {
    let folder = folder();
    let odd = "t\x1b[2J.vox";
    run(
        folder.path(),
        &["generate", "gen:sphere,depth=3", "-o", odd],
    )
    .success();
    let draw = ["render", odd, "--size", "16", "-o", "{stem}.png"];
    let told = run(folder.path(), &draw).success();
    assert!(!stderr_of(&told).contains('\x1b'), "{}", stderr_of(&told));
    assert!(folder.path().join("t\x1b[2J.png").exists());
    run(folder.path(), &draw).code(1);
    let missing = run(folder.path(), &["info", "\x1b[31mred.vox"]).code(4);
    assert!(
        !stderr_of(&missing).contains('\x1b'),
        "{}",
        stderr_of(&missing)
    );
}

#[test]
fn a_picture_and_its_buffers_are_all_written_or_none() {
    let folder = folder();
    let count = || fs::read_dir(folder.path()).unwrap().count();
    // The picture fits, its depths do not; the signal of a file that is too large ends nothing.
    let draw = "ulimit -f 256; exec \"$0\" render gen:sphere,depth=3 --size 512 --aov depth -o a.png --force";
    assert!(stderr_of(&sh(folder.path(), draw).code(1)).contains("a."));
    assert_eq!(count(), 0);
    let names = ["a.png", "a.depth.npy"].map(|name| folder.path().join(name));
    for name in &names {
        fs::write(name, b"old").unwrap();
    }
    sh(folder.path(), &format!("trap '' XFSZ; {draw}")).code(1);
    assert!(names.iter().all(|name| fs::read(name).unwrap() == b"old"));
    assert_eq!(count(), 2);
}

#[test]
#[ignore = "needs the program `script`, which makes a terminal"]
fn progress_is_for_terminals_that_can_draw_it() {
    let folder = folder();
    let drawn = |term: &str| {
        let line = "\"$PROGRAM\" convert gen:terrain,depth=8 a.vxg --force";
        let script = format!(
            "PROGRAM=\"$0\" TERM={term} SHELL=/bin/sh script -qec '{line}' /dev/null < /dev/null"
        );
        stdout_of(&sh(folder.path(), &script).success())
    };
    assert!(
        ["", "dumb"]
            .iter()
            .all(|term| !drawn(term).contains(['\x1b', '%']))
    );
    assert!(drawn("xterm").contains('%'));
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_told_by_help_too() {
    let folder = folder();
    for line in [
        "--help",
        "render --help",
        "--version",
        "man",
        "info gen:sphere,depth=2",
    ] {
        sh(folder.path(), &format!("exec \"$0\" {line} > /dev/full")).code(1);
    }
    sh(folder.path(), "\"$0\" --help | true").success();
}

#[test]
#[cfg(target_os = "linux")]
fn a_mapped_file_that_is_cut_short_is_told() {
    let folder = folder();
    run(folder.path(), &words("convert gen:terrain,depth=7 a.vxg")).success();
    let mut child = shiftvox(folder.path())
        .args(words(
            "render a.vxg --repeat 1000000 --size 128 -o a.png --json",
        ))
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
    let file = fs::File::options()
        .write(true)
        .open(folder.path().join("a.vxg"));
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
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
