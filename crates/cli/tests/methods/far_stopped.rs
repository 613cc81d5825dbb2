//! A build that is stopped leaves no broken file, and nothing that is in the way.
#![cfg(unix)]

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use shiftvox_mesh::far::FarFile;

/// A binary STL: a rough sheet of 20,000 triangles, of numbers that do not pack well.
fn stl() -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend(20_000u32.to_le_bytes());
    for i in 0..20_000 {
        let noise = |salt: u32| {
            let bits = (i as u32 * 4 + salt).wrapping_mul(0x9e37_79b1);
            (bits ^ bits >> 15).wrapping_mul(0x85eb_ca6b) as f32 / u32::MAX as f32
        };
        let x = (i % 100) as f32 + 0.3 * noise(0);
        let y = (i / 100) as f32 + 0.3 * noise(1);
        let corners = [[x, y, 0.0], [x + 1.0, y, 0.0], [x, y + 1.0, 0.0]];
        let numbers = [[0.0, 0.0, 1.0]].into_iter().chain(corners).flatten();
        bytes.extend(numbers.flat_map(|n: f32| n.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

/// Triangles alone, as one leaf: built at once, ten megabytes to write.
const BUILD: &str = "convert sheet.stl sheet.far --leaf-triangles 4000000 --instances 24 --force";

fn shiftvox(folder: &Path, line: &str) -> Command {
    let mut command = crate::common::command();
    command.current_dir(folder).args(line.split(' '));
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

fn start(folder: &Path) -> Child {
    shiftvox(folder, BUILD).spawn().unwrap()
}

fn send(child: &Child, signal: Signal) {
    // It fails where the process has ended by then, which the caller sees.
    let _ = kill_process(Pid::from_child(child), signal);
}

/// Files that are not finished.
fn unfinished(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let names = entries.map(|entry| entry.file_name().into_string().unwrap());
    names.filter(|name| name.ends_with(".tmp")).collect()
}

/// Starts builds until one is caught by the signal while it writes.
fn stop_while_writing(folder: &Path, signal: Signal) {
    for _ in 0..20 {
        let mut child = start(folder);
        let started = Instant::now();
        while unfinished(folder).is_empty() && child.try_wait().unwrap().is_none() {
            assert!(
                started.elapsed() < Duration::from_secs(120),
                "nothing is written"
            );
            std::thread::sleep(Duration::from_millis(1));
        }
        send(&child, signal);
        let status = child.wait().unwrap();
        let is_old = fs::read(folder.join("sheet.far")).unwrap() == b"old";
        if status.signal() == Some(signal.as_raw()) && is_old {
            return;
        }
        // It had written all before the signal came.
        assert!(!is_old, "{status}");
        let whole = FarFile::open(&folder.join("sheet.far")).unwrap();
        whole.verify().unwrap();
        fs::write(folder.join("sheet.far"), b"old").unwrap();
    }
    panic!("no build was caught while it wrote");
}

#[test]
fn a_stopped_build_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.stl"), stl()).unwrap();
    fs::write(at.join("sheet.far"), b"old").unwrap();
    stop_while_writing(at, Signal::TERM);
    assert_eq!(unfinished(at), [""; 0]);
    // Killed, it can tidy nothing up: the next build does.
    stop_while_writing(at, Signal::KILL);
    let left = unfinished(at);
    assert_eq!(left.len(), 1);
    assert!(left[0].starts_with(".shiftvox-sheet.far-"), "{left:?}");
    assert!(start(at).wait().unwrap().success());
    assert_eq!(unfinished(at), [""; 0]);
    assert!(FarFile::open(&at.join("sheet.far")).is_ok());
}

/// The most memory that a process had, bytes; Linux reports it, and keeps it until it has ended.
#[cfg(target_os = "linux")]
fn most_memory(process: u32) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kibibytes * 1024)
}

#[test]
#[cfg(target_os = "linux")]
fn a_budget_of_memory_is_kept_and_changes_no_byte() {
    const BUDGET: u64 = 110 << 20;
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("sheet.stl"), stl()).unwrap();
    let convert = |more: &str| {
        // 1,160,000 triangles: 70 MB of clusters, which a budget leaves no room for.
        let line = "convert sheet.stl a.far --leaf-triangles 5000 --force -q --instances 58 --rays";
        let mut command = shiftvox(at, &format!("{line} 3000000{more}"));
        let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
        let mut most = None;
        while child.try_wait().unwrap().is_none() {
            most = most_memory(child.id()).max(most);
            std::thread::sleep(Duration::from_millis(2));
        }
        let output = child.wait_with_output().unwrap();
        let told = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), told, most.unwrap())
    };
    let built = || fs::read(at.join("a.far")).unwrap();
    let (code, told, free) = convert("");
    assert_eq!(code, Some(0), "{told}");
    let expected = built();
    let (code, told, bound) = convert(&format!(" --memory {BUDGET}"));
    assert_eq!(code, Some(0), "{told}");
    assert!(built() == expected && !expected.is_empty());
    // Within the budget, and by far less than without one.
    assert!(
        bound <= BUDGET && 4 * bound < 3 * free,
        "{bound} {BUDGET} {free}"
    );
    let (code, told, _) = convert(" --memory 64M");
    assert_eq!(code, Some(5));
    assert!(
        told.contains("sheet.stl") && told.contains("--memory"),
        "{told}"
    );
}

#[test]
fn a_signal_that_is_ignored_stays_ignored() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("sheet.stl"), stl()).unwrap();
    // As `nohup` does it.
    let line = format!("trap '' HUP; exec \"$0\" {BUILD}");
    let mut command = Command::new("sh");
    command.current_dir(folder.path()).args(["-c", &line]);
    let program = crate::common::program();
    let mut child = command.arg(program).stderr(Stdio::null()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(100));
    send(&child, Signal::HUP);
    assert!(child.wait().unwrap().success());
}
