//! Makes and checks the tables and plots of the documents, from commands listed in `docs/evidence.toml`.
//!
//!     cargo run --release --example evidence -- --check            # what CI runs: exact figures of quick commands
//!     cargo run --release --example evidence -- --check NAME...    # these, however long they take
//!     cargo run --release --example evidence -- --write [NAME...]  # remakes these, or all
//!
//! A table stands in its page between `<!-- evidence: NAME -->` and `<!-- end: NAME -->`. Each of its rows runs commands
//! of `shiftvox` with `--json`, and each column selects one value of their output. Only this file knows about pages; it
//! sees the program as a reader does.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use serde::Deserialize;
use serde_json::Value;

/// `docs/evidence.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Registry {
    /// Texts for `{name}` in commands and cells.
    #[serde(default)]
    vars: BTreeMap<String, String>,
    #[serde(default)]
    table: BTreeMap<String, Table>,
    #[serde(default)]
    plot: BTreeMap<String, Plot>,
}

/// A Markdown table.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    page: PathBuf,
    /// Commands without `shiftvox` and `--json`. With several, paths begin with the number of one.
    run: Vec<String>,
    /// Whether CI runs them.
    #[serde(default)]
    quick: bool,
    /// Head, cell and pattern of each column.
    columns: Vec<(String, String, String)>,
    rows: Vec<BTreeMap<String, String>>,
}

/// A picture that a command writes.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Plot {
    /// A command that writes `{out}`.
    run: String,
    file: PathBuf,
    /// Whether CI compares the bytes.
    #[serde(default)]
    quick: bool,
}

type Row = Vec<String>;

struct Tool {
    root: PathBuf,
    program: PathBuf,
    registry: Registry,
    /// Output by command, so that tables share a run.
    outputs: BTreeMap<String, Value>,
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let mode = arguments.next().unwrap_or_default();
    let names: Vec<String> = arguments.collect();
    let done = match mode.as_str() {
        "--check" | "--write" => {
            Tool::open().and_then(|mut tool| tool.all(mode == "--write", &names))
        }
        _ => Err("usage: evidence --check|--write [NAME]...".into()),
    };
    match done {
        Ok(faults) if faults.is_empty() => ExitCode::SUCCESS,
        Ok(faults) => {
            eprintln!("{}", faults.join("\n"));
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("evidence: {error}");
            ExitCode::from(2)
        }
    }
}

impl Tool {
    fn open() -> Result<Self, String> {
        let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).to_owned();
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let build = [
            "build",
            "--release",
            "--quiet",
            "--bin",
            "shiftvox",
            "--example",
            "evidence",
        ];
        let built = Command::new(cargo).args(build).current_dir(&root).status();
        if !built.is_ok_and(|status| status.success()) {
            return Err("shiftvox does not build".into());
        }
        // This program is target/release/examples/evidence.
        let here = std::env::current_exe().map_err(|e| e.to_string())?;
        let folder = here
            .parent()
            .and_then(Path::parent)
            .ok_or("no folder of programs")?;
        let text = read(&root.join("docs/evidence.toml"))?;
        Ok(Self {
            program: folder.join(format!("shiftvox{}", std::env::consts::EXE_SUFFIX)),
            root,
            registry: toml::from_str(&text).map_err(|e| format!("docs/evidence.toml: {e}"))?,
            outputs: BTreeMap::new(),
        })
    }

    /// Writes or checks what is named, or everything that is quick enough. Returns what differs.
    fn all(&mut self, writes: bool, names: &[String]) -> Result<Vec<String>, String> {
        let registry = std::mem::take(&mut self.registry.table);
        let plots = std::mem::take(&mut self.registry.plot);
        let known = |name: &String| registry.contains_key(name) || plots.contains_key(name);
        if let Some(unknown) = names.iter().find(|&name| !known(name)) {
            return Err(format!("docs/evidence.toml has no `{unknown}`"));
        }
        let wanted = |name: &String, quick| match names {
            [] => writes || quick,
            names => names.contains(name),
        };
        let mut faults = Vec::new();
        for (name, table) in &registry {
            // A missing block is a fault even where its commands take too long for CI.
            let (text, block) = self.block(name, table)?;
            if !wanted(name, table.quick) {
                continue;
            }
            eprintln!("{name}");
            let rows = self.rows(table).map_err(|e| format!("{name}: {e}"))?;
            if writes {
                let made = self.markdown(table, &rows)?;
                let (begin, end) = marks(name);
                let page =
                    text.replacen(&(begin.clone() + &block + &end), &(begin + &made + &end), 1);
                fs::write(self.root.join(&table.page), page).map_err(|e| e.to_string())?;
            } else {
                faults.extend(differences(name, table, &rows, &block));
            }
        }
        for (name, plot) in plots.iter().filter(|(name, plot)| wanted(name, plot.quick)) {
            eprintln!("{name}");
            let file = self.root.join(&plot.file);
            let made = tempfile::Builder::new().suffix(".svg").tempfile();
            let made = made.map_err(|e| e.to_string())?.into_temp_path();
            let run = plot.run.replace("{out}", &made.to_string_lossy());
            self.run(&format!("{run} --force"))?;
            if writes {
                fs::copy(&made, &file).map_err(|e| e.to_string())?;
            } else if fs::read(&made).ok() != fs::read(&file).ok() {
                faults.push(format!(
                    "{name}: {} is another picture now",
                    plot.file.display()
                ));
            }
        }
        Ok(faults)
    }

    /// The page, and its text between the marks of a table.
    fn block(&self, name: &str, table: &Table) -> Result<(String, String), String> {
        let text = read(&self.root.join(&table.page))?;
        let (begin, end) = marks(name);
        let inside = text
            .split_once(&begin)
            .and_then(|(_, rest)| rest.split_once(&end));
        let block = inside.map(|(block, _)| block.to_owned());
        let block = block.ok_or(format!("{} has no block `{name}`", table.page.display()))?;
        Ok((text, block))
    }

    /// The cells of all rows.
    fn rows(&mut self, table: &Table) -> Result<Vec<Row>, String> {
        let mut rows = Vec::new();
        for vars in &table.rows {
            let runs: Vec<String> = table.run.iter().map(|run| self.filled(run, vars)).collect();
            for run in &runs {
                if !self.outputs.contains_key(run) {
                    let output = self.run(&format!("{run} --json"))?;
                    let value =
                        serde_json::from_slice(&output).map_err(|e| format!("{run}: {e}"))?;
                    self.outputs.insert(run.clone(), value);
                }
            }
            let cell = |(_, cell, pattern): &(String, String, String)| {
                let cell = self.filled(cell, vars);
                // A path begins with the number of its run, or with a dot for the only one.
                let Some((run, path)) = cell
                    .split_once('.')
                    .filter(|(run, _)| run.is_empty() || run.parse::<usize>().is_ok())
                else {
                    return Ok(cell);
                };
                let number = run.parse().unwrap_or(0);
                let output = runs.get(number).map(|run| &self.outputs[run]);
                let value = select(output.ok_or("no such run")?, path)?;
                show(value, pattern.trim_start_matches('~'))
            };
            rows.push(
                table
                    .columns
                    .iter()
                    .map(cell)
                    .collect::<Result<Row, String>>()?,
            );
        }
        Ok(rows)
    }

    /// A text with its variables.
    fn filled(&self, text: &str, vars: &BTreeMap<String, String>) -> String {
        let mut text = text.to_owned();
        // A variable of a row may contain one of the registry.
        for (name, value) in vars.iter().chain(&self.registry.vars) {
            text = text.replace(&format!("{{{name}}}"), value);
        }
        text
    }

    /// Stdout of a command.
    fn run(&self, command: &str) -> Result<Vec<u8>, String> {
        let mut process = Command::new(&self.program);
        process
            .args(command.split_whitespace())
            .arg("--quiet")
            .current_dir(&self.root);
        let output = process.output().map_err(|e| e.to_string())?;
        match output.status.success() {
            true => Ok(output.stdout),
            false => Err(format!(
                "shiftvox {command}: {}",
                String::from_utf8_lossy(&output.stderr)
            )),
        }
    }

    /// A table with its foot: commands, and for times the computer.
    fn markdown(&self, table: &Table, rows: &[Row]) -> Result<String, String> {
        let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
        let mut text = line(
            table
                .columns
                .iter()
                .map(|(head, ..)| head.as_str())
                .collect(),
        );
        let ruler = |(_, _, pattern): &(String, String, String)| {
            if pattern.is_empty() { "---" } else { "--:" }
        };
        text += &line(table.columns.iter().map(ruler).collect());
        for row in rows {
            text += &line(row.iter().map(String::as_str).collect());
        }
        let commands: Vec<String> = table
            .run
            .iter()
            .map(|run| {
                let vars = &self.registry.vars;
                format!(
                    "`shiftvox {}`",
                    vars.iter().fold(run.clone(), |text, (name, value)| {
                        text.replace(&format!("{{{name}}}"), value)
                    })
                )
            })
            .collect();
        let said = |program: &str, arguments: &[&str]| {
            let output = Command::new(program)
                .args(arguments)
                .current_dir(&self.root)
                .output();
            output
                .map(|o| String::from_utf8_lossy(&o.stdout).trim().to_owned())
                .map_err(|e| format!("{program}: {e}"))
        };
        let commit = said("git", &["log", "-1", "--format=%h, %cs"])?;
        let is_timed = table
            .columns
            .iter()
            .any(|(_, _, pattern)| pattern.starts_with('~'));
        let cpu = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let cpu = cpu
            .lines()
            .find_map(|line| line.strip_prefix("model name\t: "));
        let computer = match cpu.filter(|_| is_timed) {
            Some(cpu) => format!(", {cpu}, {}", said("rustc", &["-V"])?),
            None => String::new(),
        };
        let foot = format!(
            "<sub>{}; commit {commit}{computer}.</sub>",
            commands.join(", ")
        );
        // Markdown is wrapped at 120 columns.
        let mut column = 0;
        for word in foot.split(' ') {
            let gap = match column {
                0 => "\n",
                at if at + 1 + word.len() > 120 => "\n",
                _ => " ",
            };
            column = if gap == " " { column + 1 } else { 0 } + word.len();
            text += gap;
            text += word;
        }
        Ok(text + "\n")
    }
}

/// Cells that are not those of the page. Times (`~`) are not compared.
fn differences(name: &str, table: &Table, rows: &[Row], block: &str) -> Vec<String> {
    let heads: Row = table
        .columns
        .iter()
        .map(|(head, ..)| head.clone())
        .collect();
    let cells = |line: &str| {
        line.trim_matches('|')
            .split('|')
            .map(|cell| cell.trim().to_owned())
            .collect()
    };
    let mut lines = block.lines().filter(|line| {
        line.starts_with('|') && !line.starts_with("|--") && !line.starts_with("| --")
    });
    let mut faults = Vec::new();
    for (n, row) in std::iter::once(&heads).chain(rows).enumerate() {
        let there: Row = lines.next().map(cells).unwrap_or_default();
        for (k, cell) in row.iter().enumerate() {
            let is_time = n > 0 && table.columns[k].2.starts_with('~');
            let found = there.get(k).map_or("nothing", String::as_str);
            if !is_time && found != cell {
                faults.push(format!(
                    "{name}, row {n}, {}: the page has {found}, now {cell}",
                    heads[k]
                ));
            }
        }
    }
    if lines.next().is_some() {
        faults.push(format!("{name}: the page has more rows"));
    }
    faults
}

/// The value at a path such as `rows[engine=fast][size=512].extra` or `rows[0].cycles`. A filter must fit one element.
fn select<'v>(value: &'v Value, path: &str) -> Result<&'v Value, String> {
    let fault = |what: &str| format!("`{path}`: {what}");
    let mut value = value;
    let mut among: Option<Vec<&Value>> = None;
    for step in path
        .replace('[', "\u{0}[")
        .replace('.', "\u{0}")
        .split('\u{0}')
        .filter(|step| !step.is_empty())
    {
        let Some(filter) = step
            .strip_prefix('[')
            .and_then(|step| step.strip_suffix(']'))
        else {
            if let Some(found) = among.take() {
                value = one(&found).ok_or_else(|| fault("not one element before `{step}`"))?;
            }
            value = value
                .get(step)
                .ok_or_else(|| fault(&format!("no `{step}`")))?;
            continue;
        };
        let found = match among.take() {
            Some(found) => found,
            None => value
                .as_array()
                .ok_or_else(|| fault("no array"))?
                .iter()
                .collect(),
        };
        among = Some(match filter.split_once('=') {
            None => found
                .get(filter.parse::<usize>().map_err(|e| fault(&e.to_string()))?)
                .copied()
                .into_iter()
                .collect(),
            Some((key, wanted)) => {
                let fits = |element: &&Value| match &element[key] {
                    Value::String(text) => text == wanted,
                    other => format!("{other}") == wanted,
                };
                found.into_iter().filter(fits).collect()
            }
        });
    }
    match among {
        Some(found) => one(&found).ok_or_else(|| fault(&format!("{} elements fit", found.len()))),
        None => Ok(value),
    }
}

fn one<'v>(found: &[&'v Value]) -> Option<&'v Value> {
    match found {
        [one] => Some(one),
        _ => None,
    }
}

/// Prints a value by a pattern: `.2` decimals, `s3` significant digits, `/1e6` divides before.
fn show(value: &Value, pattern: &str) -> Result<String, String> {
    let number = match value {
        Value::Null => return Ok("-".into()),
        Value::Bool(is_so) => return Ok(if *is_so { "yes" } else { "no" }.into()),
        Value::String(text) => return Ok(text.clone()),
        value => value.as_f64().ok_or(format!("{value} is no figure"))?,
    };
    let wrong = |_| format!("what is the pattern `{pattern}`?");
    let (format, divisor) = pattern.split_once('/').unwrap_or((pattern, "1"));
    let number = number / divisor.parse::<f64>().map_err(|e| wrong(e.to_string()))?;
    let decimals = match (format.strip_prefix('s'), format.strip_prefix('.')) {
        (Some(digits), _) => {
            let digits: i32 = digits.parse().map_err(|_| wrong(String::new()))?;
            let magnitude = if number == 0.0 {
                0
            } else {
                number.abs().log10().floor() as i32
            };
            (digits - 1 - magnitude).max(0) as usize
        }
        (_, Some(digits)) => digits.parse().map_err(|_| wrong(String::new()))?,
        _ => 0,
    };
    let text = format!("{number:.decimals$}");
    let whole = text.find('.').unwrap_or(text.len());
    let mut grouped = String::new();
    for (at, digit) in text.chars().enumerate() {
        let is_thousand = at < whole && at > 0 && (whole - at) % 3 == 0 && !grouped.ends_with('-');
        if is_thousand {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    Ok(grouped)
}

/// The lines around a table in its page.
fn marks(name: &str) -> (String, String) {
    (
        format!("<!-- evidence: {name} -->\n"),
        format!("<!-- end: {name} -->"),
    )
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}
