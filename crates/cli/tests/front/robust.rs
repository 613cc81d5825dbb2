//! Every command under bad conditions, drawn from a seed: little memory, small files, full disks, folders that cannot
//! be written, closed pipes, signals at any time. It ends by itself with an exit code, or by the signal. It never
//! panics, and every file is whole.
//!
//! `SHIFTVOX_ROBUST` is the number of runs, where more than the usual few are wanted.
#![cfg(unix)]

use std::fs::{self, File};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use shiftvox::graph::{Silent, vxg};
use shiftvox::split_mix::SplitMix;
use shiftvox_mesh::far::FarFile;
use shiftvox_mesh::open::{OpenOptions, open_bytes};
use shiftvox_mesh::textured::TexturedFile;

/// Every command, on inputs from `../in`.
const LINES: [&str; 30] = [
    "",
    "render gen:terrain,depth=7 --size 700 -o a.png --aov depth,voxel --force --json",
    "render ../in/knot.obj --depth 6 --size 200 -o k.png --force",
    "render ../in/knot.far --size 200 -o f.png --memory 1M --force",
    "render ../in/knot.tvx --size 200 --hash --json",
    "convert ../in/ball.vox t.vxg --force",
    "convert gen:terrain,depth=8 b.vxg --memory 64M --force --json",
    "convert ../in/ball.vox c.vxg --memory 64M --force",
    "convert ../in/knot.obj d.vxg --depth 6 --opacities --force",
    "convert ../in/ball.vxg t.ply --force",
    "convert ../in/ball.ply t.vox --force --json",
    "convert ../in/knot.obj k.far --rays 1000 --leaf-triangles 500 --force",
    "convert ../in/knot.obj k.tvx --grid 8 --texels 4 --force",
    "generate gen:menger,depth=4 -o g.vxg --force",
    "info gen:menger,depth=4 ../in/ball.vxg ../in/knot.far ../in/knot.tvx --json",
    "turntable gen:menger,depth=3 -o ##.png --frames 6 --size 300 --aov normal --force",
    "triangles ../in/knot.obj -o tri.png --size 300 --aov depth --force",
    "compare ../in/a.png ../in/b.png --threshold ssim=0 --diff d.png --force",
    "model gen:menger,depth=2 --size 48 --json",
    "model gen:menger,depth=1 --size 48 --vectors rows --vector-records 200 --force",
    "stress gen:menger,depth=1 --bits 32 --size 16 --rules 1 --viewpoints 0 --export-json s.json --force",
    "reproduce ../in/list.toml --runs 1 --outdir r --force",
    "bench time gen:menger,depth=2 --size 64 --runs 1 --export-json time.json --force",
    "bench time gen:menger,depth=2 --scan size=16..32*2 --runs 1 --variants all --export-csv e.csv --export-svg e.svg --force",
    "bench quality gen:menger,depth=1 --size 16 --runs 1 --reference-samples 2 --methods exact:bits=32 --json",
    "bench quality gen:menger,depth=2 --size 16 --frames 3 --motions pan --reference-samples 2 --runs 1 --methods exact --export-svg f.svg --force",
    "bench quality ../in/knot.obj --size 16 --runs 1 --warmup 0 --depth 4 --methods triangles,exact --json",
    "completions bash",
    "man bench quality",
    "render --help",
];
/// Makes the inputs.
const INPUTS: [&str; 7] = [
    "generate gen:sphere,depth=4 -o ball.vox",
    "generate gen:sphere,depth=4 -o ball.vxg",
    "generate gen:sphere,depth=4 -o ball.ply",
    "render ball.vox --size 100 -o a.png",
    "render ball.vox --size 100 --zoom 2 -o b.png",
    "convert knot.obj knot.far --rays 1000 --leaf-triangles 500",
    "convert knot.obj knot.tvx --grid 8 --texels 4",
];
/// The longest that a run may take.
const PATIENCE: Duration = Duration::from_secs(120);

/// The bad condition of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
enum Condition {
    /// A limit of address space, MB.
    Memory(u64),
    /// A limit of each file, blocks of 512 bytes.
    FileSize(u64),
    /// A disk of so many KB.
    SmallDisk(u64),
    ReadOnly,
    StdoutFull,
    StdoutClosed,
    ReaderGone,
    /// A signal after so many milliseconds.
    Signal(i32, u64),
}

impl Condition {
    fn drawn(dice: &mut SplitMix) -> Self {
        match dice.below(10) {
            0 | 1 => Self::Memory(40 + dice.below(160)),
            2 => Self::FileSize(dice.below(200)),
            3 => Self::SmallDisk(4 + dice.below(200)),
            4 => Self::ReadOnly,
            5 => Self::StdoutFull,
            6 => [Self::StdoutClosed, Self::ReaderGone][dice.below(2) as usize],
            _ => Self::Signal([2, 15, 9, 1][dice.below(4) as usize], dice.below(16).pow(2)),
        }
    }

    /// The shell's script around the command. `None` where this system cannot run it.
    fn script(self, can: Can) -> Option<String> {
        let run = "exec \"$0\" \"$@\"";
        Some(match self {
            Self::Memory(megabytes) => format!("ulimit -v {}; {run}", megabytes << 10),
            Self::FileSize(blocks) => format!("trap '' XFSZ; ulimit -f {blocks}; {run}"),
            // The disk is gone when the shell ends: what is on it is looked at as a copy.
            Self::SmallDisk(kilobytes) if can.mount => format!(
                "exec unshare -m sh -c 'mount -t tmpfs -o size={kilobytes}k none \"$PWD\" && cd \"$PWD\" || exit 99; \
                 rm -r ../left; \"$0\" \"$@\"; code=$?; cp -a . ../left; exit $code' \"$0\" \"$@\""
            ),
            // Nothing is closed to root.
            Self::ReadOnly if can.drop_root => {
                "exec setpriv --reuid 65534 --regid 65534 --clear-groups \"$0\" \"$@\"".to_owned()
            }
            Self::ReadOnly if !can.is_root => run.to_owned(),
            Self::StdoutFull if Path::new("/dev/full").exists() => format!("{run} > /dev/full"),
            Self::StdoutClosed => format!("{run} >&-"),
            Self::ReaderGone | Self::Signal(..) => run.to_owned(),
            _ => return None,
        })
    }
}

/// The rights of a test on this system.
#[derive(Debug, Clone, Copy)]
struct Can {
    mount: bool,
    is_root: bool,
    drop_root: bool,
}

impl Can {
    fn found(folder: &Path) -> Self {
        let does = |script: &str| {
            let mut shell = Command::new("sh");
            shell.args(["-c", script]).arg(crate::common::program());
            let status = shell.current_dir(folder).stderr(Stdio::null()).status();
            status.is_ok_and(|status| status.success())
        };
        Self {
            mount: does("unshare -m sh -c 'mount -t tmpfs -o size=64k none \"$PWD\"'"),
            is_root: does("[ $(id -u) = 0 ]"),
            drop_root: does(
                "setpriv --reuid 65534 --regid 65534 --clear-groups \"$0\" --version > /dev/null",
            ),
        }
    }
}

fn start(folder: &Path, script: &str, line: &str) -> Child {
    let stderr = File::create(folder.join("../stderr")).unwrap();
    Command::new("sh")
        .args(["-c", script])
        .arg(crate::common::program())
        .args(line.split_whitespace())
        .env("RAYON_NUM_THREADS", "2")
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(stderr)
        .spawn()
        .unwrap()
}

/// Waits, and sends a signal on the way.
fn wait(child: &mut Child, mut signal: Option<(i32, u64)>) -> ExitStatus {
    let started = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if let Some((number, ms)) = signal
            && started.elapsed().as_millis() as u64 >= ms
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

/// The numbers that a `.npy` has by its header.
fn npy_entries(bytes: &[u8]) -> u64 {
    let header = String::from_utf8_lossy(&bytes[..128]).into_owned();
    let shape = header.split("'shape': (").nth(1).unwrap();
    let sides = shape.split(')').next().unwrap().split(", ");
    sides
        .map(|side| side.trim_matches(',').parse::<u64>().unwrap())
        .product()
}

/// Fails where a file is not whole; says whether there are unfinished ones.
fn inspect(folder: &Path, what: &str) -> bool {
    let mut has_unfinished = false;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if name.ends_with(".tmp") {
            has_unfinished = true;
            continue;
        }
        if name == "rows" {
            assert!(path.join("manifest.json").exists(), "{what}: {name}");
        }
        if path.is_dir() {
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
                open_bytes(&bytes, &name, &OpenOptions::default(), &Silent).is_ok()
            }
            Some("png") => bytes.ends_with(b"IEND\xaeB`\x82"),
            Some("npy") => {
                // Each belongs to a picture.
                let picture = name.split('.').next().unwrap();
                folder.join(format!("{picture}.png")).exists()
                    && bytes.len() as u64 == 128 + 4 * npy_entries(&bytes)
            }
            Some("json") => serde_json::from_slice::<serde_json::Value>(&bytes).is_ok(),
            Some("svg") => ends(b"</svg>"),
            Some("html") => ends(b"</html>"),
            Some("csv" | "md" | "toml" | "hex" | "jsonl") => bytes.ends_with(b"\n"),
            _ => panic!("{what}: {name} should not be there"),
        };
        assert!(is_whole, "{what}: {name} is not whole");
    }
    has_unfinished
}

/// Runs that a signal stopped, that were refused, and that a limit refused.
type Counts = [u64; 3];

/// Runs of the seeds that fall to one thread, in a shelter of its own.
fn runs(seeds: impl Iterator<Item = u64>) -> Counts {
    let shelter = tempfile::tempdir().unwrap();
    let at = |name: &str| shelter.path().join(name);
    for folder in ["in", "work", "left"] {
        fs::create_dir(at(folder)).unwrap();
    }
    let open = |mode| fs::set_permissions(at("work"), fs::Permissions::from_mode(mode)).unwrap();
    fs::set_permissions(shelter.path(), fs::Permissions::from_mode(0o755)).unwrap();
    let assets = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("assets");
    for name in ["knot.obj", "knot.mtl"] {
        fs::copy(assets.join(name), at("in").join(name)).unwrap();
    }
    let list = "[[run]]\ntable = \"t\"\nsettings = \"default\"\nengines = [\"fast\", \"machine\"]\n\
        scenes = [\"gen:menger,depth=2\"]\nsizes = [16, 32]\n";
    fs::write(at("in").join("list.toml"), list).unwrap();
    for line in INPUTS {
        let made = wait(&mut start(&at("in"), "exec \"$0\" \"$@\"", line), None);
        assert!(
            made.success(),
            "{line}: {}",
            fs::read_to_string(at("stderr")).unwrap()
        );
    }
    let can = Can::found(&at("work"));
    let mut counts = Counts::default();
    for seed in seeds {
        let mut dice = SplitMix::new(seed);
        // Every command in turn.
        let line = LINES[seed as usize % LINES.len()];
        let condition = Condition::drawn(&mut dice);
        let what = format!("run {seed}: {condition:?}: shiftvox {line}");
        let Some(script) = condition.script(can) else {
            continue;
        };
        if condition == Condition::ReadOnly {
            open(0o555);
        }
        let mut child = start(&at("work"), &script, line);
        let mut signal = None;
        match condition {
            Condition::ReaderGone => drop(child.stdout.take()),
            Condition::Signal(number, ms) => signal = Some((number, ms)),
            _ => {}
        }
        // Its output is read as it comes.
        let reader = child.stdout.take().map(|mut stdout| {
            std::thread::spawn(move || std::io::copy(&mut stdout, &mut std::io::sink()))
        });
        let status = wait(&mut child, signal);
        reader.map(|thread| thread.join().unwrap());
        open(0o755);
        let told = fs::read_to_string(at("stderr")).unwrap();
        assert!(!told.contains("panicked"), "{what}: {told}");
        match (status.code(), status.signal()) {
            (Some(0), None) => {}
            (Some(code @ (1 | 5)), None) => {
                counts[1] += 1;
                counts[2] += u64::from(code == 5);
                assert!(
                    !told.is_empty() || condition == Condition::StdoutClosed,
                    "{what}: nothing is told"
                );
            }
            (None, Some(by)) if signal.is_some_and(|(sent, _)| sent == by) => counts[0] += 1,
            // Too little for the program to be loaded.
            (Some(126 | 127), None) if matches!(condition, Condition::Memory(_)) => {}
            _ => panic!("{what}: {status}: {told}"),
        }
        let looked_at = match condition {
            Condition::SmallDisk(_) => at("left"),
            _ => at("work"),
        };
        let was_killed = status.signal() == Some(9);
        let is_tidy = !inspect(&looked_at, &what);
        assert!(is_tidy || was_killed, "{what}: unfinished files, {status}");
        // The next run there removes the files of a killed one.
        if was_killed && !is_tidy {
            let status = wait(
                &mut start(&at("work"), "exec \"$0\" \"$@\" > /dev/null", line),
                None,
            );
            let told = fs::read_to_string(at("stderr")).unwrap();
            assert!(status.success(), "{what}: {told}");
            assert!(!inspect(&at("work"), &what), "{what}: left for ever");
        }
    }
    counts
}

#[test]
fn whatever_happens_it_ends_in_order() {
    let usual = 4 * LINES.len() as u64;
    let all = std::env::var("SHIFTVOX_ROBUST").map_or(usual, |runs| runs.parse().unwrap());
    let both = std::thread::scope(|scope| {
        let threads = [0, 1].map(|first| scope.spawn(move || runs((first..all).step_by(2))));
        threads.map(|thread| thread.join().unwrap())
    });
    let [stopped, refused, limits] = [0, 1, 2].map(|end| both[0][end] + both[1][end]);
    assert!(stopped > 0 && refused > 10 && limits > 0, "{both:?}");
}
