//! Every command under bad conditions, drawn from a seed: little memory, small files, folders that cannot be written,
//! closed pipes, signals at any time. It ends by itself with an exit code, or by the signal. It never panics, and every
//! file is whole.
//!
//! `SHIFTVOX_ROBUST` is the number of runs, where more than the usual few are wanted.
#![cfg(target_os = "linux")]

use std::fs::{self, File};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use rayon::prelude::*;
use rustix::process::{Pid, Signal, kill_process};
use shiftvox::graph::{Silent, vxg};
use shiftvox::picture::{npy, png};
use shiftvox::split_mix::SplitMix;
use shiftvox_mesh::far::FarFile;
use shiftvox_mesh::open::{OpenOptions, open_bytes};
use shiftvox_mesh::textured::TexturedFile;

use crate::program::{Folder, PROGRAM, ROOT};

/// Every command. `@` is the folder of the inputs.
const LINES: [&str; 30] = [
    "",
    "render gen:terrain,depth=6 --size 500 -o a.png --aov depth,voxel --force --json",
    "render @knot.obj --depth 5 --size 200 -o k.png --force",
    "render @knot.far --size 200 -o f.png --memory 1M --force",
    "render @knot.tvx --size 200 --hash --json",
    "convert @ball.vox t.vxg --force",
    "convert gen:terrain,depth=7 b.vxg --memory 64M --force --json",
    "convert @ball.vox c.vxg --memory 64M --force",
    "convert @knot.obj d.vxg --depth 5 --opacities --force",
    "convert @ball.vxg t.ply --force",
    "convert @ball.ply t.vox --force --json",
    "convert @knot.obj k.far --rays 1000 --leaf-triangles 500 --force",
    "convert @knot.obj k.tvx --grid 8 --texels 4 --force",
    "generate gen:menger,depth=3 -o g.vxg --force",
    "info gen:menger,depth=3 @ball.vxg @knot.far @knot.tvx --json",
    "turntable gen:menger,depth=3 -o ##.png --frames 4 --size 200 --aov normal --force",
    "triangles @knot.obj -o tri.png --size 200 --aov depth --force",
    "compare @a.png @b.png --threshold psnr_srgb=0 --diff d.png --force",
    "model gen:menger,depth=2 --size 48 --json",
    "model gen:menger,depth=1 --size 48 --vectors rows --vector-records 200 --force",
    "stress gen:menger,depth=1 --bits 32 --size 16 --rules 1 --viewpoints 0 --export-json s.json --force",
    "reproduce @list.toml --runs 1 --outdir r --force",
    "bench time gen:menger,depth=2 --size 64 --runs 1 --export-json time.json --force",
    "bench time gen:menger,depth=2 --scan size=16..32*2 --runs 1 --variants all --export-csv e.csv --export-svg e.svg --force",
    "bench quality gen:menger,depth=1 --size 16 --runs 1 --reference-samples 2 --methods exact:bits=32 --json",
    "bench quality gen:menger,depth=2 --size 16 --frames 3 --motions pan --reference-samples 2 --runs 1 --methods exact --export-svg f.svg --force",
    "bench quality @knot.obj --size 16 --runs 1 --warmup 0 --depth 4 --methods triangles,exact --json",
    "completions bash",
    "man bench quality",
    "render --help",
];
const INPUTS: [&str; 7] = [
    "generate gen:sphere,depth=4 -o ball.vox",
    "generate gen:sphere,depth=4 -o ball.vxg",
    "generate gen:sphere,depth=4 -o ball.ply",
    "render ball.vox --size 100 -o a.png",
    "render ball.vox --size 100 --zoom 2 -o b.png",
    "convert knot.obj knot.far --rays 1000 --leaf-triangles 500",
    "convert knot.obj knot.tvx --grid 8 --texels 4",
];
const LIST: &str = "[[run]]\ntable = \"t\"\nsettings = \"default\"\nengines = [\"fast\", \"machine\"]\n\
                    scenes = [\"gen:menger,depth=2\"]\nsizes = [16, 32]\n";
/// The longest that a run may take.
const PATIENCE: Duration = Duration::from_secs(120);

/// The bad condition of a run.
#[derive(Debug)]
struct Condition {
    /// The script of the shell that runs the command.
    script: String,
    /// A signal after so many milliseconds.
    signal: Option<(Signal, u64)>,
    /// Whether something reads what it prints.
    has_reader: bool,
}

const RUN: &str = "exec \"$0\" \"$@\"";

impl Condition {
    fn drawn(dice: &mut SplitMix) -> Self {
        let signals = [Signal::INT, Signal::TERM, Signal::KILL, Signal::HUP];
        let (mut signal, mut has_reader) = (None, true);
        let script = match dice.below(9) {
            0 | 1 => format!("ulimit -v {}; {RUN}", (40 + dice.below(160)) << 10),
            2 | 3 => format!("trap '' XFSZ; ulimit -f {}; {RUN}", dice.below(200)),
            // Not even root makes files there.
            4 => format!("cd /proc; {RUN}"),
            5 => match dice.below(3) {
                0 => format!("{RUN} > /dev/full"),
                1 => format!("{RUN} >&-"),
                _ => {
                    has_reader = false;
                    RUN.to_owned()
                }
            },
            _ => {
                signal = Some((signals[dice.below(4) as usize], dice.below(8).pow(2)));
                RUN.to_owned()
            }
        };
        Self {
            script,
            signal,
            has_reader,
        }
    }
}

/// Waits, and sends a signal on the way.
pub(crate) fn wait(child: &mut Child, mut signal: Option<(Signal, u64)>) -> ExitStatus {
    let started = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        assert!(started.elapsed() < PATIENCE, "it does not end");
        let is_due = |(_, ms): &mut (Signal, u64)| started.elapsed().as_millis() as u64 >= *ms;
        if let Some((signal, _)) = signal.take_if(is_due) {
            let _ = kill_process(Pid::from_child(child), signal);
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Fails where a file is not whole. Says whether there were unfinished ones, and removes them.
fn inspect(folder: &Path, what: &str) -> bool {
    let mut has_unfinished = false;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if name.ends_with(".tmp") {
            let _ = fs::remove_file(&path).or_else(|_| fs::remove_dir_all(&path));
            has_unfinished = true;
            continue;
        }
        if path.is_dir() {
            assert!(
                name != "rows" || path.join("manifest.json").exists(),
                "{what}: {name}"
            );
            has_unfinished |= inspect(&path, what);
            continue;
        }
        let bytes = fs::read(&path).unwrap();
        let ends = |end: &[u8]| bytes.trim_ascii_end().ends_with(end);
        let is_whole = match path.extension().and_then(|ending| ending.to_str()) {
            Some("vxg") => vxg::verify(&path).is_ok(),
            Some("far") => FarFile::open(&path).is_ok_and(|file| file.verify().is_ok()),
            Some("tvx") => TexturedFile::open(&path).is_ok_and(|file| file.verify().is_ok()),
            Some("vox" | "ply") => {
                open_bytes(&bytes, name, &OpenOptions::default(), &Silent).is_ok()
            }
            Some("png") => png::decode(&bytes).is_ok(),
            // Each belongs to a picture.
            Some("npy") => {
                let stem = name.split('.').next().unwrap();
                npy::decode(&bytes).is_ok() && folder.join(format!("{stem}.png")).exists()
            }
            Some("json") => serde_json::from_slice::<serde_json::Value>(&bytes).is_ok(),
            Some("svg") => ends(b"</svg>"),
            Some("csv" | "md" | "hex" | "jsonl") => bytes.ends_with(b"\n"),
            _ => false,
        };
        assert!(is_whole, "{what}: {name} is not whole");
    }
    has_unfinished
}

/// The runs of some seeds: how many a signal stopped, and how many were refused.
fn runs(seeds: impl Iterator<Item = u64>) -> [u64; 2] {
    let inputs = Folder::new();
    inputs.put("list.toml", LIST);
    for name in ["knot.obj", "knot.mtl"] {
        let asset = Path::new(ROOT).join("assets").join(name);
        inputs.put(name, fs::read(asset).unwrap());
    }
    for line in INPUTS {
        inputs.run(line, 0);
    }
    let work = Folder::new();
    let start = |script: &str, line: &str, stdout: Stdio| {
        let mut shell = Command::new("sh");
        let line = line.replace('@', &format!("{}/", inputs.path().display()));
        shell
            .args(["-c", script, PROGRAM])
            .args(line.split_whitespace());
        shell.env("RAYON_NUM_THREADS", "2").current_dir(work.path());
        let stderr = File::create(inputs.at("stderr")).unwrap();
        shell
            .stdin(Stdio::null())
            .stdout(stdout)
            .stderr(stderr)
            .spawn()
            .unwrap()
    };
    let mut counts = [0; 2];
    for seed in seeds {
        // Every command in turn.
        let line = LINES[seed as usize % LINES.len()];
        let condition = Condition::drawn(&mut SplitMix::new(seed));
        let what = format!("run {seed}: {condition:?}: shiftvox {line}");
        let Condition {
            script,
            signal,
            has_reader,
        } = condition;
        let stdout = if has_reader {
            Stdio::null()
        } else {
            Stdio::piped()
        };
        let mut child = start(&script, line, stdout);
        drop(child.stdout.take());
        let status = wait(&mut child, signal);
        let told = inputs.text("stderr");
        assert!(!told.contains("panicked"), "{what}: {told}");
        match (status.code(), status.signal()) {
            (Some(0), None) => {}
            (Some(1 | 5), None) => {
                counts[1] += 1;
                let is_told = !told.is_empty() || script.contains(">&-");
                assert!(is_told, "{what}: nothing is told");
            }
            (None, Some(by)) if signal.is_some_and(|(sent, _)| sent.as_raw() == by) => {
                counts[0] += 1
            }
            // Too little for the program to be loaded.
            (Some(126 | 127), None) if script.starts_with("ulimit -v") => {}
            _ => panic!("{what}: {status}: {told}"),
        }
        let is_killed = status.signal() == Some(9);
        assert!(
            !inspect(work.path(), &what) || is_killed,
            "{what}: unfinished files"
        );
    }
    counts
}

#[test]
fn whatever_happens_it_ends_in_order() {
    let usual = 2 * LINES.len() as u64;
    let all = std::env::var("SHIFTVOX_ROBUST").map_or(usual, |runs| runs.parse().unwrap());
    let halves: Vec<_> = [0, 1]
        .into_par_iter()
        .map(|first| runs((first..all).step_by(2)))
        .collect();
    let [stopped, refused] = [0, 1].map(|end| halves[0][end] + halves[1][end]);
    assert!(stopped > 0 && refused > 5, "{halves:?}");
}
