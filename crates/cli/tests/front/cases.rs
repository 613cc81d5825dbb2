//! Runs of the program as rows of files: `crates/cli/tests/cases/README.md` says how to read them.
#![cfg(target_os = "linux")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use rayon::prelude::*;
use serde_json::Value;

use crate::program::{Folder, PROGRAM, ROOT};

/// A case while it runs.
struct Case {
    folder: Folder,
    /// Kept outputs, by name.
    kept: BTreeMap<String, String>,
    /// The script of the shell that runs a command.
    script: String,
    /// The last output.
    stdout: String,
    stderr: String,
}

const ON_SMALL_DISK: &str = "exec unshare -m sh -c 'mount -t tmpfs -o size=1m none \"$PWD\" && cd \"$PWD\" || exit 99; \
                             \"$0\" \"$@\"; code=$?; ls -A >&2; exit $code' \"$0\" \"$@\"";

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

/// A rough sheet of so many vertices along each side, as a Wavefront file.
fn sheet(side: usize) -> String {
    let mut text = String::new();
    for (z, x) in (0..side).flat_map(|z| (0..side).map(move |x| (z, x))) {
        text += &format!("v {x} {} {z}\n", (x * z) % 3);
    }
    for (z, x) in (0..side - 1).flat_map(|z| (1..side).map(move |x| (z, x))) {
        let a = z * side + x;
        text += &format!("f {a} {} {} {}\n", a + 1, a + side + 1, a + side);
    }
    text
}

/// The value at a pointer. `*` means every entry of an array. Entries without a value there are left out.
fn at(document: &Value, pointer: &str) -> Option<Value> {
    let Some((array, rest)) = pointer.split_once("/*") else {
        return document.pointer(pointer).cloned();
    };
    let entries = document.pointer(array)?.as_array()?.iter();
    let entries = entries.filter_map(|entry| at(entry, rest));
    Some(entries.filter(|entry| !entry.is_null()).collect())
}

impl Case {
    fn run(&self, words: &str) -> Output {
        let (script, words) = match words.strip_prefix("$ ") {
            Some(script) => (script, ""),
            None => (&*self.script, words),
        };
        let mut command = Command::new("sh");
        command
            .args(["-c", script, PROGRAM])
            .args(words.split(' ').filter(|word| !word.is_empty()));
        command.current_dir(self.folder.path()).output().unwrap()
    }

    /// Whether `CODE command | fragment | out: fragment | not: fragment` does what it says.
    fn command(&mut self, code: i32, rest: &str) -> bool {
        let rest = format!(" {rest}");
        let mut parts = rest.split(" | ").map(str::trim);
        let output = self.run(parts.next().unwrap_or(""));
        let [stdout, stderr] = [output.stdout, output.stderr]
            .map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        // A failure has a message. A wrong line prints only a document.
        let may_print = code != 2 || rest.starts_with(" compare") || stdout.starts_with('{');
        let is_so = output.status.code() == Some(code)
            && !stderr.contains("panicked")
            && (code == 0 || !stderr.is_empty())
            && (may_print || stdout.is_empty())
            && parts.all(|part| match part.split_once(": ") {
                Some(("out", wanted)) => stdout.contains(wanted),
                Some(("not", unwanted)) => !stderr.contains(&unwanted.replace("\\n", "\n")),
                _ => stderr.contains(part),
            });
        (self.stdout, self.stderr) = (stdout.trim().to_owned(), stderr);
        is_so
    }

    /// `/pointer`, `! /pointer`, or `/pointer = value`, with `<`, `>`, `~` (contains), `#` (entries), `rises`.
    fn json(&self, line: &str) -> bool {
        let documents = serde_json::Deserializer::from_str(&self.stdout).into_iter();
        let mut documents: Vec<Value> = documents.map_while(Result::ok).collect();
        let document = match documents.len() {
            1 => documents.remove(0),
            _ => Value::Array(documents),
        };
        let mut words = line.splitn(3, ' ');
        let (first, relation) = (words.next().unwrap_or(""), words.next().unwrap_or("exists"));
        if first == "!" {
            return document.is_object() && at(&document, relation).is_none();
        }
        let found = at(&document, first).unwrap_or(Value::Null);
        let mut expected = words.next().unwrap_or("").to_owned();
        if expected.starts_with('/') {
            expected = at(&document, &expected).map_or(expected, |other| other.to_string());
        }
        let list = match &found {
            Value::Array(list) => list,
            _ => &vec![found.clone()],
        };
        let numbers: Vec<f64> = list.iter().filter_map(Value::as_f64).collect();
        let limit = || expected.parse::<f64>().unwrap();
        let text = found.to_string();
        match relation {
            "=" => text == expected,
            "~" => text.contains(&expected),
            "#" => found.is_array() && list.len() as f64 == limit(),
            "<" => !numbers.is_empty() && numbers.iter().all(|of| *of < limit()),
            ">" => !numbers.is_empty() && numbers.iter().all(|of| *of > limit()),
            "rises" => numbers.len() > 1 && numbers.is_sorted_by(|a, b| a < b),
            _ => !found.is_null(),
        }
    }

    /// Whether a step does what it says.
    fn step(&mut self, line: &str) -> bool {
        let kept = self.kept.iter();
        let line = kept.fold(line.to_owned(), |line, (name, text)| {
            line.replace(&format!("{{{name}}}"), text)
        });
        let (word, rest) = line.split_once(' ').unwrap_or((&line, ""));
        let (name, text) = rest.split_once(' ').unwrap_or((rest, ""));
        if let Ok(code) = word.parse() {
            return self.command(code, rest);
        }
        let folder = &self.folder;
        match word {
            // Before commands.
            "put" => folder.put(name, repeated(&text.replace("\\n", "\n"))),
            "copy" => {
                let name = rest.rsplit('/').next().unwrap_or(rest);
                folder.put(name, fs::read(Path::new(ROOT).join(rest)).unwrap());
            }
            "sheet" => folder.put(name, sheet(text.parse().unwrap())),
            "cut" | "flip" => {
                // A new file of the first bytes, or of all with one changed, counted from the end.
                let (from, at) = text.split_once(' ').unwrap();
                let (mut bytes, at) = (folder.get(from), at.parse().unwrap());
                match word {
                    "cut" => bytes.truncate(at),
                    _ => *bytes.iter_mut().rev().nth(at).unwrap() ^= 4,
                }
                folder.put(name, bytes);
            }
            "edit" => {
                let (from, change) = text.split_once(' ').unwrap();
                let (old, new) = change.split_once(" => ").unwrap();
                let text = folder.text(from);
                folder.put(name, text.replacen(old, new, 1));
                return text.contains(old);
            }
            "memory" => {
                let kibibytes = rest.parse::<u32>().unwrap() << 10;
                self.script = format!("ulimit -v {kibibytes}; exec \"$0\" \"$@\" --threads 2");
            }
            "disk" => self.script = ON_SMALL_DISK.to_owned(),
            // After a command.
            "keep" => drop(self.kept.insert(rest.to_owned(), self.stdout.clone())),
            "prints" => return self.stdout == rest,
            "differs" => return self.stdout != rest,
            "lines" => return self.stdout.lines().count().to_string() == rest,
            "quiet" => return self.stderr.is_empty(),
            "files" => return folder.names() == rest.split_whitespace().collect::<Vec<_>>(),
            "has" => return String::from_utf8_lossy(&folder.get(name)).contains(text),
            "read" => self.stdout = folder.text(rest),
            "same" => return folder.get(name) == folder.get(text),
            "unlike" => return folder.get(name) != folder.get(text),
            _ => return self.json(&line),
        }
        true
    }
}

/// Asserts that all steps of files do what they say.
fn check(files: &[&str]) {
    let read = |file: &&str| {
        let path = Path::new(ROOT).join("crates/cli/tests/cases").join(file);
        let text = fs::read_to_string(path).unwrap();
        text.split("\n== ")
            .skip(1)
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let cases: Vec<String> = files.iter().flat_map(read).collect();
    let failure = |text: &String| {
        let mut case = Case {
            folder: Folder::new(),
            kept: BTreeMap::new(),
            script: "exec \"$0\" \"$@\"".to_owned(),
            stdout: String::new(),
            stderr: String::new(),
        };
        let (name, steps) = text.split_once('\n')?;
        let steps = steps.lines().map(str::trim);
        let mut steps = steps.filter(|step| !step.is_empty() && !step.starts_with('#'));
        let failed = steps.find(|step| !case.step(step))?;
        let (stdout, stderr, names) = (case.stdout, case.stderr, case.folder.names());
        Some(format!("{name}: {failed}\n{stdout}\n{stderr}\n{names:?}"))
    };
    let failures: Vec<String> = cases.par_iter().filter_map(failure).collect();
    assert!(
        cases.len() >= files.len() && failures.is_empty(),
        "{}",
        failures.join("\n")
    );
}

#[test]
fn lines_do_what_they_say() {
    check(&[
        "refused.txt",
        "pictures.txt",
        "meshes.txt",
        "models.txt",
        "experiments.txt",
    ]);
}

#[test]
#[ignore = "needs the right to mount, for a small disk, and the program `script`"]
fn small_disks_and_terminals() {
    check(&["disk.txt"]);
}
