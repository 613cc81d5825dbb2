//! The program under bad conditions, drawn from a seed: little memory, small files, closed pipes, full disks, signals at
//! any time. It ends by itself with an exit code, or by the signal; it never panics; and whatever file there is, is whole.
#![cfg(unix)]

use std::fs::{self, File};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;
use shiftvox::graph::vxg;
use shiftvox::split_mix::SplitMix;

const LINES: [&[&str]; 6] = [
    &[
        "render",
        "gen:terrain,depth=7",
        "--size",
        "700",
        "-o",
        "a.png",
        "--aov",
        "depth,voxel",
        "--force",
        "--json",
    ],
    &["convert", "gen:terrain,depth=8", "a.vxg", "--force"],
    &[
        "convert",
        "gen:terrain,depth=8",
        "b.vxg",
        "--memory",
        "64M",
        "--force",
        "--json",
    ],
    &["info", "gen:menger,depth=4", "--json"],
    &[
        "turntable",
        "gen:menger,depth=3",
        "-o",
        "##.png",
        "--frames",
        "6",
        "--size",
        "300",
        "--force",
    ],
    &[
        "model",
        "gen:menger,depth=1",
        "--size",
        "48",
        "--vectors",
        "rows",
        "--vector-records",
        "200",
        "--force",
    ],
];
/// Runs, and the longest that all of them together may take.
const RUNS: u64 = 48;
const PATIENCE: Duration = Duration::from_secs(120);

fn start(folder: &Path, before: &str, line: &[&str], stdout: Stdio, stderr: File) -> Child {
    Command::new("sh")
        .args(["-c", &format!("{before} exec \"$0\" \"$@\"")])
        .arg(cargo_bin("shiftvox"))
        .args(line)
        .args(["--threads", "2"])
        .current_dir(folder)
        .stdout(stdout)
        .stderr(stderr)
        .spawn()
        .unwrap()
}

/// Waits, and sends a signal on the way.
fn wait(child: &mut Child, signal: Option<(i32, u64)>) -> ExitStatus {
    let started = Instant::now();
    let mut signal = signal;
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if let Some((number, _)) =
            signal.filter(|(_, ms)| started.elapsed().as_millis() as u64 >= *ms)
        {
            let sent = Command::new("kill")
                .args([format!("-{number}"), child.id().to_string()])
                .status();
            assert!(sent.is_ok());
            signal = None;
        }
        if started.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("it does not end");
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Fails where a file is not whole; says whether there are unfinished ones.
fn inspect(folder: &Path, what: &str) -> bool {
    let mut has_unfinished = false;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if name.ends_with(".tmp") {
            has_unfinished = true;
        } else if name.ends_with(".vxg") {
            vxg::verify(&path).unwrap_or_else(|e| panic!("{what}: {e}"));
        } else if name.ends_with(".png") {
            let bytes = fs::read(&path).unwrap();
            assert!(
                bytes.ends_with(b"IEND\xaeB`\x82"),
                "{what}: {name} is cut short"
            );
        } else if name.ends_with(".npy") {
            let entries = if name.contains("voxel") { 4 } else { 1 };
            let header = 128;
            assert_eq!(
                fs::metadata(&path).unwrap().len(),
                header + 700 * 700 * 4 * entries,
                "{what}: {name}"
            );
            assert!(folder.join("a.png").exists(), "{what}: {name} alone");
        } else if name == "rows" {
            assert!(path.join("manifest.json").exists(), "{what}: {name}");
        } else {
            assert_eq!(name, "stderr", "{what}");
        }
    }
    has_unfinished
}

#[test]
fn whatever_happens_it_ends_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let errors = folder.path().join("stderr");
    let (mut stopped, mut failed) = (0, 0);
    for run in 0..RUNS {
        let mut dice = SplitMix::new(run);
        let line = LINES[dice.below(LINES.len() as u64) as usize];
        let mut before = String::new();
        let (mut stdout, mut signal) = (Stdio::piped(), None);
        let condition = dice.below(6);
        match condition {
            0 => before = format!("ulimit -v {};", (60 + dice.below(300)) << 10),
            1 => before = format!("trap '' XFSZ; ulimit -f {};", dice.below(4000)),
            2 if Path::new("/dev/full").exists() => {
                stdout = File::options()
                    .write(true)
                    .open("/dev/full")
                    .unwrap()
                    .into();
            }
            3 => before = "exec >&-;".to_owned(),
            _ => signal = Some(([2, 15, 9, 1][dice.below(4) as usize], dice.below(400))),
        }
        let what = format!("run {run}: {before} {line:?}, {signal:?}");
        let mut child = start(
            folder.path(),
            &before,
            line,
            stdout,
            File::create(&errors).unwrap(),
        );
        // The reader is gone, or never was.
        drop(child.stdout.take());
        let status = wait(&mut child, signal);
        let told = fs::read_to_string(&errors).unwrap();
        assert!(!told.contains("panicked"), "{what}: {told}");
        match (status.code(), status.signal()) {
            (Some(0 | 1 | 5), None) => failed += u32::from(!status.success()),
            (None, Some(by)) if signal.is_some_and(|(sent, _)| sent == by) => stopped += 1,
            // Too little for the program to be loaded.
            (Some(126 | 127), None) if condition == 0 => {}
            _ => panic!("{what}: {status}: {told}"),
        }
        let was_killed = status.signal() == Some(9);
        assert!(
            !inspect(folder.path(), &what) || was_killed,
            "{what}: unfinished files, {status}"
        );
        // What was killed is tidied up by who writes there next.
        if was_killed {
            let mut next = start(
                folder.path(),
                "",
                LINES[5],
                Stdio::null(),
                File::create(&errors).unwrap(),
            );
            assert!(
                wait(&mut next, None).success(),
                "{what}: {}",
                fs::read_to_string(&errors).unwrap()
            );
            assert!(!inspect(folder.path(), &what), "{what}: left for ever");
        }
    }
    assert!(
        stopped > 0 && failed > 0,
        "{stopped} stopped, {failed} failed"
    );
}
