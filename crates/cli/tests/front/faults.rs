//! Faults of the disk, drawn from a seed: a system call on the files of a run fails. The run ends by itself. It writes
//! all files, or it exits with 1, 4 or 5 and a message that names a file or its folder. Then each file is the earlier
//! one, or whole. Nothing else is left.
//!
//! `SHIFTVOX_FAULTS` is the number of faults.
#![cfg(target_os = "linux")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use rayon::prelude::*;
use shiftvox::split_mix::SplitMix;

use super::robust::wait;
use crate::program::{Folder, PROGRAM, ROOT};

/// Commands that write the same files in every run, into the folder `@`.
const LINES: [&str; 12] = [
    "render gen:terrain,depth=6 --size 300 -o @/a.png --aov depth,voxel",
    "convert gen:terrain,depth=7 @/b.vxg --memory 64M",
    "convert gen:sphere,depth=5 @/c.vxg",
    "convert gen:sphere,depth=4 @/d.vox",
    "convert gen:sphere,depth=4 @/e.ply",
    "convert assets/knot.obj @/f.vxg --depth 5 --opacities",
    "convert assets/knot.obj @/g.far --rays 1000 --leaf-triangles 500",
    "convert assets/knot.obj @/h.tvx --grid 8 --texels 4",
    "generate gen:menger,depth=3 -o @/i.vxg",
    "turntable gen:menger,depth=3 -o @/##.png --frames 3 --size 100",
    "triangles assets/knot.obj -o @/j.png --size 100 --aov depth",
    "model gen:menger,depth=1 --size 48 --vectors @/rows --vector-records 200",
];
const CALLS: &str = "openat,mkdir,statx,newfstatat,statfs,fstatfs,lseek,ftruncate,fallocate,write,pwrite64,\
                     read,pread64,mmap,fsync,fchmod,linkat,rename,renameat,renameat2";
const ERRORS: [&str; 5] = ["ENOSPC", "EIO", "EDQUOT", "EROFS", "EACCES"];

type Files = BTreeMap<PathBuf, Vec<u8>>;

/// All files below a folder, by their paths from `root`.
fn add_files(folder: &Path, root: &Path, all: &mut Files) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let is_left = path
            .file_name()
            .unwrap()
            .to_str()
            .unwrap()
            .ends_with(".tmp");
        assert!(!is_left, "{}", path.display());
        match fs::read(&path) {
            Ok(bytes) => _ = all.insert(path.strip_prefix(root).unwrap().to_owned(), bytes),
            Err(_) => add_files(&path, root, all),
        }
    }
}

/// A run under strace in a folder that has some files: its exit code, its files, its folder, its messages, and the
/// system calls of its threads.
fn run(line: &str, earlier: &Files, fault: &str) -> (i32, Files, [String; 3]) {
    let (work, notes) = (Folder::new(), Folder::new());
    for (name, bytes) in earlier {
        work.put(name.to_str().unwrap(), bytes);
    }
    let folder = work.path().to_str().unwrap().to_owned();
    let mut command = Command::new("strace");
    command.args(["-f", "-y", "-o"]).arg(notes.at("calls"));
    command.args(["-e", &format!("trace={CALLS}")]);
    command.args(fault.split_whitespace()).arg(PROGRAM);
    command.args(line.replace('@', &folder).split_whitespace());
    command.env("RAYON_NUM_THREADS", "1").current_dir(ROOT);
    command.stdout(Stdio::null());
    command.stderr(fs::File::create(notes.at("stderr")).unwrap());
    let status = wait(&mut command.spawn().unwrap(), None);
    let mut files = Files::new();
    add_files(work.path(), work.path(), &mut files);
    let [told, calls] = ["stderr", "calls"].map(|name| notes.text(name));
    (status.code().unwrap_or(-1), files, [folder, told, calls])
}

/// The calls on files of a folder: name, and number among the calls of that name in its thread.
fn calls_on(folder: &str, calls: &str) -> Vec<(String, u32)> {
    let mut counts = BTreeMap::new();
    let mut found = Vec::new();
    for line in calls.lines() {
        let (thread, call) = line.split_once(' ').unwrap();
        if let Some((name, arguments)) = call.trim_start().split_once('(') {
            let count = counts.entry((thread, name)).or_insert(0);
            *count += 1;
            let is_on = arguments.contains(folder);
            found.extend(is_on.then(|| (name.to_owned(), *count)));
        }
    }
    found
}

/// Injects faults into a command that finds earlier files, or none. Returns the calls, and whether the run failed.
fn inject(line: &str, has_earlier: bool, count: u64) -> Vec<(String, bool)> {
    let (_, new, _) = run(line, &Files::new(), "");
    let earlier = |name: &PathBuf| has_earlier.then(|| (name.clone(), b"earlier".to_vec()));
    let earlier: Files = new.keys().filter_map(earlier).collect();
    let line = format!("{line}{}", if has_earlier { " --force" } else { "" });
    let (code, files, [folder, told, calls]) = run(&line, &earlier, "");
    assert!(
        code == 0 && files == new && !new.is_empty(),
        "{line}: {told}"
    );
    let calls = calls_on(&folder, &calls);
    let mut dice = SplitMix::new(calls.len() as u64);
    let mut below = |end: usize| dice.below(end as u64) as usize;
    let mut injected = Vec::new();
    for _ in 0..count {
        let ((call, when), error) = (&calls[below(calls.len())], ERRORS[below(ERRORS.len())]);
        // A full disk stays full.
        let on = if call == "write" {
            ["", "+"][below(2)]
        } else {
            ""
        };
        let fault = format!("-e inject={call}:error={error}:when={when}{on}");
        let (code, files, [folder, told, calls]) = run(&line, &earlier, &fault);
        let faults = calls.matches("(INJECTED)").count();
        let is_whole = |(name, bytes)| {
            [&new, &earlier]
                .iter()
                .any(|of| of.get(name) == Some(bytes))
        };
        let is_right = match code {
            0 => files == new,
            // A second fault may be that of the message.
            1 | 4 | 5 => (faults > 1 || told.contains(&folder)) && files.iter().all(is_whole),
            _ => false,
        };
        let stay = earlier.keys().all(|name| files.contains_key(name));
        assert!(
            is_right && stay,
            "{line} {fault}: {code}, {told}, {:?}",
            files.keys()
        );
        injected.extend((faults > 0).then(|| (call.clone(), code != 0)));
    }
    injected
}

#[test]
#[ignore = "needs strace"]
fn faults_of_the_disk_are_told() {
    let all = std::env::var("SHIFTVOX_FAULTS").map_or(24, |count| count.parse().unwrap());
    let count = all / (2 * LINES.len() as u64) + 1;
    let lines = LINES.into_par_iter();
    let both = lines.flat_map_iter(|line| [true, false].map(|has| inject(line, has, count)));
    let (mut counts, mut failed) = (BTreeMap::new(), 0);
    for (call, has_failed) in both.collect::<Vec<_>>().concat() {
        *counts.entry(call).or_insert(0) += 1;
        failed += u64::from(has_failed);
    }
    let sum = counts.values().sum();
    println!("{sum} faults, {failed} runs that failed, by call: {counts:?}");
    assert!(sum >= all && failed * 3 > sum);
}
