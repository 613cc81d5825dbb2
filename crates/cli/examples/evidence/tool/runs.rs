//! Commands, run once each: their JSON, their instructions, or their time and memory.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::{Value, json};

use super::registry::{Run, Vars, substitute};

/// The folder of the meshes that may not ship, for `{meshes}`.
pub(crate) fn meshes() -> Option<String> {
    std::env::var("SHIFTVOX_MESHES").ok()
}

/// A run with all variables in place.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Concrete {
    how: How,
    steps: Vec<String>,
    prepare: Vec<(String, String)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum How {
    Json,
    Instructions,
    Measured,
}

impl Concrete {
    /// Puts the variables of a row in place.
    pub(crate) fn new(run: &Run, vars: &Vars, prepare: &Vars) -> Self {
        let how = match run {
            Run::Command(_) | Run::Steps(_) => How::Json,
            Run::Instructions { .. } => How::Instructions,
            Run::Measured { .. } => How::Measured,
        };
        let steps: Vec<String> = run.steps().iter().map(|s| substitute(s, vars)).collect();
        let prepare = prepare
            .iter()
            .map(|(file, command)| (substitute(file, vars), substitute(command, vars)))
            .filter(|(file, _)| {
                steps
                    .iter()
                    .any(|s| s.contains(&format!("{{file:{file}}}")))
            })
            .collect();
        Self {
            how,
            steps,
            prepare,
        }
    }

    /// As a reader would type it.
    pub(crate) fn said(&self) -> String {
        said(&self.steps, self.how)
    }
}

/// A run with the names of its variables in capitals, for several rows at once.
pub(crate) fn template_said(run: &Run, page: &Vars) -> String {
    let how = match run {
        Run::Command(_) | Run::Steps(_) => How::Json,
        Run::Instructions { .. } => How::Instructions,
        Run::Measured { .. } => How::Measured,
    };
    let steps: Vec<String> = run.steps().iter().map(|s| substitute(s, page)).collect();
    said(&steps, how)
}

fn said(steps: &[String], how: How) -> String {
    let tool = match how {
        How::Instructions => "valgrind --tool=callgrind ",
        How::Measured => "/usr/bin/time -v ",
        How::Json => "",
    };
    let steps: Vec<String> = steps
        .iter()
        .map(|step| format!("{tool}shiftvox {}", placeholders(step)))
        .collect();
    format!("`{}`", steps.join(" && "))
}

/// Doubled braces are the program's own: `{{stem}}` is not a variable here.
fn doubled_apart(step: &str) -> String {
    step.replace("{{", "\u{1}").replace("}}", "\u{2}")
}

fn doubled_single(step: &str) -> String {
    step.replace('\u{1}', "{").replace('\u{2}', "}")
}

/// `{size}` as `SIZE`, and files without their folders.
fn placeholders(step: &str) -> String {
    let mut text = doubled_apart(&step.replace("{tmp}/", ""));
    // The innermost first.
    while let Some(from) = text.rfind('{') {
        let to = text[from..].find('}').map_or(text.len(), |to| from + to);
        let name = &text[from + 1..to];
        let shown = match name.strip_prefix("file:") {
            Some(file) => file.to_owned(),
            None => name.to_uppercase(),
        };
        text.replace_range(from..(to + 1).min(text.len()), &shown);
    }
    doubled_single(&text)
}

/// What was found out, by run.
#[derive(Debug)]
pub(crate) struct Runs {
    program: PathBuf,
    root: PathBuf,
    folder: tempfile::TempDir,
    found: BTreeMap<Concrete, Result<Value, String>>,
    numbers: BTreeMap<Concrete, usize>,
}

impl Runs {
    /// Nothing yet.
    pub(crate) fn new(program: &Path, root: &Path) -> Result<Self, String> {
        let folder = tempfile::tempdir().map_err(|e| format!("no temporary folder: {e}"))?;
        Ok(Self {
            program: program.to_owned(),
            root: root.to_owned(),
            folder,
            found: BTreeMap::new(),
            numbers: BTreeMap::new(),
        })
    }

    /// What a run says; it must have been run.
    pub(crate) fn value(&self, run: &Concrete) -> Result<&Value, String> {
        match self.found.get(run) {
            Some(Ok(value)) => Ok(value),
            Some(Err(error)) => Err(error.clone()),
            None => Err(format!("{} was not run", run.said())),
        }
    }

    /// A file that a run has written to its folder.
    pub(crate) fn file(&self, run: &Concrete, name: &str) -> Option<PathBuf> {
        let number = self.numbers.get(run)?;
        Some(self.folder.path().join(format!("run-{number}")).join(name))
    }

    /// Runs what was not run yet, `workers` at a time.
    pub(crate) fn run(&mut self, wanted: BTreeSet<Concrete>, workers: usize) -> Result<(), String> {
        let wanted: Vec<Concrete> = wanted
            .into_iter()
            .filter(|run| !self.found.contains_key(run))
            .collect();
        for (file, command) in wanted.iter().flat_map(|run| &run.prepare) {
            self.prepare(file, command)?;
        }
        for run in &wanted {
            let number = self.numbers.len();
            self.numbers.insert(run.clone(), number);
        }
        let next = AtomicUsize::new(0);
        let results = Mutex::new(Vec::new());
        let this = &*self;
        std::thread::scope(|scope| {
            for _ in 0..workers.clamp(1, wanted.len().max(1)) {
                scope.spawn(|| {
                    while let Some(run) = wanted.get(next.fetch_add(1, Ordering::Relaxed)) {
                        let clock = std::time::Instant::now();
                        let result = this.one(run, this.numbers[run]);
                        eprintln!("{:6.1} s  {}", clock.elapsed().as_secs_f64(), run.said());
                        if let Ok(mut results) = results.lock() {
                            results.push((run.clone(), result));
                        }
                    }
                });
            }
        });
        let results = results.into_inner().map_err(|e| e.to_string())?;
        self.found.extend(results);
        Ok(())
    }

    fn prepare(&self, file: &str, command: &str) -> Result<(), String> {
        let path = self.folder.path().join(file);
        if path.exists() {
            return Ok(());
        }
        eprintln!("         `shiftvox {}`", placeholders(command));
        let step = format!("{command} {}", path.display()).replace("{meshes}", "\u{3}");
        self.step(&step, Command::new(&self.program)).map(|_| ())
    }

    fn one(&self, run: &Concrete, number: usize) -> Result<Value, String> {
        let folder = self.folder.path().join(format!("run-{number}"));
        std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let mut value = Value::Null;
        for step in &run.steps {
            let mut step = step.replace("{tmp}", &folder.display().to_string());
            for (file, _) in &run.prepare {
                let path = self.folder.path().join(file);
                step = step.replace(&format!("{{file:{file}}}"), &path.display().to_string());
            }
            let step = doubled_apart(&step.replace("{meshes}", "\u{3}"));
            if let Some(at) = step.find('{') {
                return Err(format!("`{step}`: no variable for `{}`", &step[at..]));
            }
            let step = doubled_single(&step);
            value = match run.how {
                How::Json => {
                    let (stdout, _) = self.step(&step, Command::new(&self.program))?;
                    // Only the last step has to answer in JSON.
                    document(&stdout)
                }
                How::Instructions => self.instructions(&step)?,
                How::Measured => self.measured(&step)?,
            };
        }
        if value.is_null() {
            return Err(format!("{} did not answer in JSON", run.said()));
        }
        Ok(value)
    }

    fn instructions(&self, step: &str) -> Result<Value, String> {
        let mut command = Command::new("valgrind");
        command
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg(&self.program);
        let (_, stderr) = self.step(step, command)?;
        let collected = stderr
            .lines()
            .find_map(|line| line.split_once("Collected : "))
            .and_then(|(_, number)| number.trim().parse::<u64>().ok());
        collected
            .map(Value::from)
            .ok_or(format!("callgrind told no number for `{step}`"))
    }

    fn measured(&self, step: &str) -> Result<Value, String> {
        let mut command = Command::new("/usr/bin/time");
        command
            .args(["-f", "measured %e %U %S %M"])
            .arg(&self.program);
        let (_, stderr) = self.step(step, command)?;
        let numbers: Vec<f64> = stderr
            .lines()
            .find_map(|line| line.strip_prefix("measured "))
            .unwrap_or_default()
            .split(' ')
            .filter_map(|number| number.parse().ok())
            .collect();
        match numbers.as_slice() {
            [wall, user, system, kib] => Ok(json!({
                "wall_s": wall, "cpu_s": user + system, "peak_mb": kib * 1024.0 / 1e6,
            })),
            _ => Err(format!("/usr/bin/time told nothing of `{step}`")),
        }
    }

    fn step(&self, step: &str, mut command: Command) -> Result<(String, String), String> {
        // Only here, so that no page names the folder.
        let step = &step.replace("\u{3}", &meshes().unwrap_or_default());
        command
            .current_dir(&self.root)
            .args(step.split_whitespace());
        if !step.contains("--json") {
            command.arg("--json");
        }
        let output = command
            .output()
            .map_err(|e| format!("cannot run `{step}`: {e}"))?;
        let stdout = String::from_utf8_lossy(&output.stdout).into_owned();
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        // A comparison that differs says so by code 3, with its figures.
        if output.status.success() || output.status.code() == Some(3) {
            Ok((stdout, stderr))
        } else {
            let last: Vec<&str> = stderr.lines().rev().take(3).collect();
            Err(format!("`shiftvox {step}` failed: {}", last.join(" / ")))
        }
    }
}

/// A document, or an array of documents that are a line each.
fn document(text: &str) -> Value {
    let lines = || {
        let documents = text.lines().map(serde_json::from_str);
        let documents = documents.collect::<Result<Vec<Value>, _>>();
        documents.map_or(Value::Null, Value::Array)
    };
    match serde_json::from_str(text) {
        Ok(document) => document,
        Err(_) if text.trim().is_empty() => Value::Null,
        Err(_) => lines(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn documents_in_lines_are_an_array() {
        assert_eq!(document("{\n \"a\": 1\n}\n"), json!({ "a": 1 }));
        let two = document("{\"a\":1}\n{\"b\":2}\n");
        assert_eq!(two, json!([{ "a": 1 }, { "b": 2 }]));
        assert_eq!(document("words\n"), Value::Null);
        assert_eq!(document(""), Value::Null);
    }

    #[test]
    fn commands_as_a_reader_types_them() {
        let step = "render {file:{mesh}.far} --size {size} -o {tmp}/a-{{stem}}.png";
        assert_eq!(
            placeholders(step),
            "render MESH.far --size SIZE -o a-{stem}.png"
        );
    }
}
