//! A build that is stopped leaves no broken file, and nothing that is in the way.
#![cfg(target_os = "linux")]

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use shiftvox::split_mix::SplitMix;
use shiftvox_mesh::far::FarFile;

use crate::program::Folder;

/// A folder with a binary STL: a rough sheet of 20,000 triangles, of numbers that do not pack well.
fn folder() -> Folder {
    let folder = Folder::new();
    let mut dice = SplitMix::new(1);
    let mut bytes = vec![0; 80];
    bytes.extend(20_000u32.to_le_bytes());
    for i in 0..20_000 {
        let x = (i % 100) as f32 + 0.3 * dice.unit() as f32;
        let y = (i / 100) as f32 + 0.3 * dice.unit() as f32;
        let numbers = [0.0, 0.0, 1.0, x, y, 0.0, x + 1.0, y, 0.0, x, y + 1.0, 0.0];
        bytes.extend(numbers.into_iter().flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    folder.put("sheet.stl", bytes);
    folder
}

/// Triangles alone, as one leaf: built at once, megabytes to write.
const BUILD: &str = "convert sheet.stl sheet.far --leaf-triangles 4000000 --instances 10 --force";

fn start(folder: &Folder, line: &str) -> Child {
    let mut command = folder.command(line);
    command.stderr(Stdio::piped()).spawn().unwrap()
}

/// Whether a process has a file open in a folder that has no name yet, or a temporary one.
fn is_writing(process: u32, folder: &Folder) -> bool {
    let open = fs::read_dir(format!("/proc/{process}/fd")).into_iter();
    let targets = open
        .flatten()
        .flatten()
        .filter_map(|file| fs::read_link(file.path()).ok());
    targets.into_iter().any(|to| {
        let is_nameless = to.to_string_lossy().ends_with("(deleted)");
        to.starts_with(folder.path()) && (is_nameless || to.extension() == Some("tmp".as_ref()))
    })
}

/// Starts builds until one is caught by the signal while it writes.
fn stop_while_writing(folder: &Folder, signal: Signal) {
    for _ in 0..20 {
        folder.put("sheet.far", b"old");
        let mut child = start(folder, BUILD);
        let started = Instant::now();
        while !is_writing(child.id(), folder) && child.try_wait().unwrap().is_none() {
            assert!(started.elapsed().as_secs() < 120, "nothing is written");
            std::thread::sleep(Duration::from_millis(1));
        }
        // It fails where the process has ended by then.
        let _ = kill_process(Pid::from_child(&child), signal);
        let status = child.wait().unwrap();
        if folder.get("sheet.far") == b"old" {
            assert_eq!(status.signal(), Some(signal.as_raw()));
            return;
        }
        // It had written all before the signal came.
        FarFile::open(&folder.at("sheet.far"))
            .unwrap()
            .verify()
            .unwrap();
    }
    panic!("no build was caught while it wrote");
}

#[test]
fn a_stopped_build_leaves_the_old_file_and_nothing_else() {
    let folder = folder();
    for signal in [Signal::TERM, Signal::KILL] {
        stop_while_writing(&folder, signal);
        assert_eq!(folder.names(), ["sheet.far", "sheet.stl"]);
    }
    folder.run(BUILD, 0);
    assert_eq!(folder.names(), ["sheet.far", "sheet.stl"]);
}

#[test]
fn a_stopped_build_goes_on_to_the_same_bytes() {
    const BUILD: &str = "convert sheet.stl sheet.far --leaf-triangles 100 --grid 32 --rays 1500000";
    let folder = folder();
    folder.run(BUILD, 0);
    let expected = folder.get("sheet.far");
    fs::remove_file(folder.at("sheet.far")).unwrap();
    let line = format!("{BUILD} --resume");
    let unfinished = folder.at("sheet.far.unfinished");
    let length = || fs::metadata(&unfinished).map_or(0, |there| there.len());
    // Stopped after a third and after two, the last node cut short each time.
    for (thirds, signal) in [(1, Signal::TERM), (2, Signal::KILL)] {
        let enough = expected.len() as u64 * thirds / 3;
        let mut child = start(&folder, &line);
        while length() < enough && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        kill_process(Pid::from_child(&child), signal).unwrap();
        assert_eq!(child.wait().unwrap().signal(), Some(signal.as_raw()));
        assert!(length() >= enough && !folder.at("sheet.far").exists());
        let kept = fs::File::options().write(true).open(&unfinished).unwrap();
        kept.set_len(length() - 5).unwrap();
    }
    let [_, told] = folder.run(&format!("{line} --far-opacity none"), 1);
    assert!(
        told.contains("sheet.far.unfinished") && told.contains("other options"),
        "{told}"
    );
    assert!(length() > expected.len() as u64 / 2);
    let [_, told] = folder.run(&line, 0);
    assert!(told.contains("nodes were built before"), "{told}");
    assert!(folder.get("sheet.far") == expected);
    assert_eq!(folder.names(), ["sheet.far", "sheet.stl"]);
}

/// The most memory that a process had, bytes, until it has ended.
fn most_memory(process: u32) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let (_, most) = status.split_once("VmHWM:")?;
    let kibibytes: u64 = most.split_whitespace().next()?.parse().ok()?;
    Some(kibibytes * 1024)
}

#[test]
fn a_budget_of_memory_is_kept_and_changes_no_byte() {
    const BUDGET: u64 = 110 << 20;
    let folder = folder();
    // 800,000 triangles: 48 MB of clusters, which a budget leaves no room for.
    let line =
        "convert sheet.stl a.far --leaf-triangles 5000 --force -q --instances 40 --rays 30000";
    let convert = |more: &str| {
        let mut child = start(&folder, &format!("{line}{more}"));
        let mut most = None;
        while child.try_wait().unwrap().is_none() {
            most = most_memory(child.id()).max(most);
            std::thread::sleep(Duration::from_millis(2));
        }
        assert!(child.wait().unwrap().success());
        (folder.get("a.far"), most.unwrap())
    };
    let (expected, free) = convert("");
    let (built, bound) = convert(&format!(" --memory {BUDGET}"));
    assert!(built == expected && !expected.is_empty());
    // Within the budget, and by far less than without one.
    assert!(
        bound <= BUDGET && 4 * bound < 3 * free,
        "{bound} {BUDGET} {free}"
    );
    let [_, told] = folder.run(&format!("{line} --memory 64M"), 5);
    assert!(
        told.contains("sheet.stl") && told.contains("--memory"),
        "{told}"
    );
}
