//! Runs of the program as rows of files: `crates/cli/tests/cases/README.md` says how to read them.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use rayon::prelude::*;
use serde_json::Value;

/// The longest that a command may take.
const PATIENCE: Duration = Duration::from_secs(60);

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// A case while it runs.
struct Case {
    folder: tempfile::TempDir,
    /// Kept outputs, by name.
    kept: BTreeMap<String, String>,
    /// Limit of address space, MB. 0: no limit.
    memory: u32,
    is_on_small_disk: bool,
    last: Option<Output>,
}

fn stdout_of(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).trim().to_owned()
}

/// The text with `N(part)` after a `%` written out N times.
fn repeated(text: &str) -> String {
    let mut parts = text.split('%');
    let mut all = parts.next().unwrap_or("").to_owned();
    for part in parts {
        let (times, rest) = part.split_once('(').unwrap();
        let (unit, rest) = rest.split_once(')').unwrap();
        all += &unit.repeat(times.parse().unwrap());
        all += rest;
    }
    all
}

fn holds(is_so: bool, why: impl FnOnce() -> String) -> Result<(), String> {
    if is_so { Ok(()) } else { Err(why()) }
}

impl Case {
    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        fs::read(self.at(name)).map_err(|error| format!("{name}: {error}"))
    }

    fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// Runs a command to its end.
    fn run(&self, words: &str) -> Result<Output, String> {
        let mount = "mount -t tmpfs -o size=1m none \"$PWD\" && cd \"$PWD\" || exit 99";
        let script = match (self.memory, self.is_on_small_disk) {
            (0, false) => "exec \"$0\" \"$@\"".to_owned(),
            (0, true) => format!("{mount}; \"$0\" \"$@\"; code=$?; ls -A >&2; exit $code"),
            (megabytes, _) => format!(
                "ulimit -v {}; exec \"$0\" \"$@\" --threads 2",
                megabytes << 10
            ),
        };
        let mut command = match self.is_on_small_disk {
            false => Command::new("sh"),
            true => {
                let mut command = Command::new("unshare");
                command.args(["-m", "sh"]);
                command
            }
        };
        let (stdout, stderr) = (
            tempfile::NamedTempFile::new().unwrap(),
            tempfile::NamedTempFile::new().unwrap(),
        );
        let mut child = command
            .args(["-c", &script])
            .arg(crate::common::program())
            .args(words.split_whitespace())
            .current_dir(self.folder.path())
            .stdin(Stdio::null())
            .stdout(stdout.reopen().unwrap())
            .stderr(stderr.reopen().unwrap())
            .spawn()
            .unwrap();
        let started = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait().unwrap() {
                break status;
            }
            if started.elapsed() > PATIENCE {
                child.kill().unwrap();
                return Err("it does not end".to_owned());
            }
            std::thread::sleep(Duration::from_millis(2));
        };
        let read = |file: &tempfile::NamedTempFile| fs::read(file.path()).unwrap();
        Ok(Output {
            status,
            stdout: read(&stdout),
            stderr: read(&stderr),
        })
    }

    /// `CODE command | fragment | out: fragment | not: fragment`
    fn command(&mut self, code: i32, rest: &str) -> Result<(), String> {
        let rest = format!(" {rest}");
        let mut parts = rest.split(" | ").map(str::trim);
        let output = self.run(parts.next().unwrap_or(""))?;
        let (stdout, stderr) = (stdout_of(&output), String::from_utf8_lossy(&output.stderr));
        let all = || format!("{}\n{stdout}\n{stderr}", output.status);
        holds(
            output.status.code() == Some(code) && !stderr.contains("panicked"),
            all,
        )?;
        // A failure has a message. A wrong line prints only a document.
        let may_print = code != 2 || rest.starts_with(" compare") || stdout.starts_with('{');
        holds(code == 0 || !stderr.is_empty(), all)?;
        holds(may_print || stdout.is_empty(), all)?;
        for part in parts {
            let is_so = match part.split_once(": ") {
                Some(("out", wanted)) => stdout.contains(wanted),
                Some(("not", unwanted)) => !stderr.contains(&unwanted.replace("\\n", "\n")),
                _ => stderr.contains(part),
            };
            holds(is_so, || format!("{part:?}: {}", all()))?;
        }
        self.last = Some(output);
        Ok(())
    }

    /// `/pointer`, `! /pointer`, or `/pointer = value`, with `!=`, `<`, `>`, `~` (contains), `#` (entries).
    fn json(&self, line: &str) -> Result<(), String> {
        let text = stdout_of(self.last.as_ref().ok_or("no command")?);
        let document: Value =
            serde_json::from_str(&text).map_err(|error| format!("{error}: {text}"))?;
        let mut words = line.splitn(3, ' ');
        let (first, relation) = (words.next().unwrap_or(""), words.next().unwrap_or("exists"));
        if first == "!" {
            return holds(document.pointer(relation).is_none(), || text.clone());
        }
        let found = document.pointer(first).unwrap_or(&Value::Null);
        let expected = words.next().unwrap_or("");
        let number = || expected.parse::<f64>().unwrap_or(f64::NAN);
        let found_text = found.to_string();
        let is_so = match relation {
            "=" => found_text == expected,
            "!=" => found_text != expected,
            "<" => found.as_f64().is_some_and(|found| found < number()),
            ">" => found.as_f64().is_some_and(|found| found > number()),
            "#" => found
                .as_array()
                .is_some_and(|list| list.len() as f64 == number()),
            "~" => found_text.contains(expected),
            _ => !found.is_null(),
        };
        holds(is_so, || format!("{found} in {text}"))
    }

    fn step(&mut self, line: &str) -> Result<(), String> {
        let line = self
            .kept
            .iter()
            .fold(line.to_owned(), |line, (name, text)| {
                line.replace(&format!("{{{name}}}"), text)
            });
        let (word, rest) = line.split_once(' ').unwrap_or((&line, ""));
        let mut words = rest.split(' ');
        let mut next = || words.next().unwrap_or("");
        if let Ok(code) = word.parse() {
            return self.command(code, rest);
        }
        let last = self.last.as_ref().map(stdout_of).unwrap_or_default();
        match word {
            // Before commands.
            "put" => {
                let (name, text) = rest.split_once(' ').unwrap_or((rest, ""));
                let path = self.at(name);
                fs::create_dir_all(path.parent().unwrap()).unwrap();
                fs::write(path, repeated(&text.replace("\\n", "\n"))).unwrap();
            }
            "copy" => {
                let name = Path::new(rest).file_name().unwrap();
                fs::copy(Path::new(ROOT).join(rest), self.folder.path().join(name)).unwrap();
            }
            "sheet" => fs::write(
                self.at(next()),
                crate::common::sheet(next().parse().unwrap()),
            )
            .unwrap(),
            "fifo" => drop(Command::new("mkfifo").arg(self.at(rest)).status().unwrap()),
            "cut" | "flip" => {
                // A new file of the first bytes, or of all with one changed, counted from the end.
                let (name, from, at) = (next(), next(), next());
                let mut bytes = self.read(from)?;
                let at: usize = at.parse().unwrap();
                match word {
                    "cut" => bytes.truncate(at),
                    _ => *bytes.iter_mut().rev().nth(at).unwrap() ^= 4,
                }
                fs::write(self.at(name), bytes).unwrap();
            }
            "memory" => self.memory = rest.parse().unwrap(),
            "disk" => self.is_on_small_disk = true,
            // After a command.
            "keep" => drop(self.kept.insert(rest.to_owned(), last)),
            "prints" => holds(last == rest, || last.clone())?,
            "differs" => holds(last != rest, || last.clone())?,
            "lines" => holds(last.lines().count().to_string() == rest, || last.clone())?,
            "quiet" => holds(
                self.last
                    .as_ref()
                    .is_some_and(|last| last.stderr.is_empty()),
                || "stderr".to_owned(),
            )?,
            "files" => {
                let expected: Vec<&str> = rest.split_whitespace().collect();
                holds(self.files() == expected, || format!("{:?}", self.files()))?;
            }
            "has" | "lacks" => {
                let (name, text) = rest.split_once(' ').unwrap();
                let bytes = self.read(name)?;
                let has = String::from_utf8_lossy(&bytes).contains(text);
                holds(has == (word == "has"), || rest.to_owned())?;
            }
            "read" => {
                let stdout = self.read(rest)?;
                self.last = Some(Output {
                    stdout,
                    ..self.last.take().ok_or("no command")?
                });
            }
            "same" => holds(self.read(next())? == self.read(next())?, || rest.to_owned())?,
            "unlike" => holds(self.read(next())? != self.read(next())?, || rest.to_owned())?,
            _ => self.json(&line)?,
        }
        Ok(())
    }
}

/// Runs the cases of a file; what failed.
fn failures(file: &str) -> Vec<String> {
    let path = Path::new(ROOT).join("crates/cli/tests/cases").join(file);
    let text = fs::read_to_string(path).unwrap();
    let cases: Vec<&str> = text.split("\n== ").skip(1).collect();
    assert!(!cases.is_empty());
    let run = |case: &&str| {
        let (name, steps) = case.split_once('\n')?;
        let mut case = Case {
            folder: tempfile::tempdir().unwrap(),
            kept: BTreeMap::new(),
            memory: 0,
            is_on_small_disk: false,
            last: None,
        };
        let mut steps = steps
            .lines()
            .map(str::trim)
            .filter(|step| !step.is_empty() && !step.starts_with('#'));
        steps.find_map(|step| {
            case.step(step)
                .err()
                .map(|error| format!("{file}, {name}: {step}\n{error}"))
        })
    };
    cases.par_iter().filter_map(run).collect()
}

fn check(files: &[&str]) {
    let failures: Vec<String> = files.iter().flat_map(|file| failures(file)).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn lines_exit_with_their_codes() {
    check(&[
        "refused.txt",
        "pictures.txt",
        "meshes.txt",
        "models.txt",
        "experiments.txt",
    ]);
}

#[test]
#[ignore = "needs the right to mount, for a small disk"]
fn small_disks_are_told_before_the_work() {
    check(&["disk.txt"]);
}
