//! Makes and checks the tables and plots of the documents, from commands listed in `docs/evidence.toml`.
//!
//! ```text
//! cargo run --release --example evidence -- --check [NAME...]  # these, or all tables, as in CI
//! cargo run --release --example evidence -- --write [NAME...]  # remakes these, or all
//! ```
//!
//! A table is between `<!-- evidence: NAME -->` and `<!-- end: NAME -->` in its page. Each of its rows runs `shiftvox`
//! with `--json`, and each column selects one value of the output.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use rayon::prelude::*;
use serde::Deserialize;
use serde_json::Value;
use shiftvox_lab::report::grouped;

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
    /// A command without `shiftvox` and `--json`.
    run: String,
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
}

type Row = Vec<String>;
type Outcome<T> = Result<T, Box<dyn Error>>;

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
    fn open() -> Outcome<Self> {
        let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).to_owned();
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let build = "build --release --quiet --bin shiftvox --example evidence";
        let mut build_all = Command::new(cargo);
        build_all.args(build.split(' ')).current_dir(&root);
        if !build_all.status().is_ok_and(|status| status.success()) {
            return Err("shiftvox does not build".into());
        }
        // This program is target/release/examples/evidence.
        let here = std::env::current_exe()?;
        let folder = here.parent().and_then(Path::parent);
        let folder = folder.ok_or("no folder of programs")?;
        Ok(Self {
            program: folder.join(format!("shiftvox{}", std::env::consts::EXE_SUFFIX)),
            registry: toml::from_str(&fs::read_to_string(root.join("docs/evidence.toml"))?)?,
            root,
            outputs: BTreeMap::new(),
        })
    }

    /// Writes the named tables and plots, or all; checks the named ones, or all tables. Returns the differences.
    fn all(&mut self, writes: bool, names: &[String]) -> Outcome<Vec<String>> {
        let tables = std::mem::take(&mut self.registry.table);
        let plots = std::mem::take(&mut self.registry.plot);
        let known = |name: &&String| tables.contains_key(*name) || plots.contains_key(*name);
        if let Some(unknown) = names.iter().find(|name| !known(name)) {
            return Err(format!("docs/evidence.toml has no `{unknown}`").into());
        }
        let wanted = |name: &String| names.is_empty() || names.contains(name);
        let mut faults = Vec::new();
        for (name, table) in &tables {
            let path = self.root.join(&table.page);
            let text = fs::read_to_string(&path)?;
            let begin = format!("<!-- evidence: {name} -->\n");
            let end = format!("<!-- end: {name} -->");
            let inside = text.split_once(&begin);
            let inside = inside.and_then(|(head, rest)| Some((head, rest.split_once(&end)?)));
            let Some((head, (block, tail))) = inside else {
                return Err(format!("{} has no block `{name}`", path.display()).into());
            };
            if !wanted(name) {
                continue;
            }
            eprintln!("{name}");
            let rows = self.rows(table).map_err(|e| format!("{name}: {e}"))?;
            if writes {
                let made = self.markdown(table, &rows)?;
                fs::write(path, [head, &begin, &made, &end, tail].concat())?;
            } else {
                faults.extend(differences(name, table, &rows, block));
            }
        }
        let all_plots = writes || !names.is_empty();
        for (name, plot) in plots.iter().filter(|(name, _)| all_plots && wanted(name)) {
            eprintln!("{name}");
            let file = self.root.join(&plot.file);
            let made = tempfile::Builder::new().suffix(".svg").tempfile()?;
            let made = made.into_temp_path();
            let run = plot.run.replace("{out}", &made.to_string_lossy());
            self.run(&format!("{run} --force"))?;
            if writes {
                fs::copy(&made, &file)?;
            } else if fs::read(&made)? != fs::read(&file)? {
                faults.push(format!("{name}: {} differs", plot.file.display()));
            }
        }
        Ok(faults)
    }

    /// The cells of all rows.
    fn rows(&mut self, table: &Table) -> Outcome<Vec<Row>> {
        let runs = table.rows.iter().map(|vars| self.filled(&table.run, vars));
        let new: BTreeSet<String> = runs.filter(|run| !self.outputs.contains_key(run)).collect();
        let made = new.into_par_iter().map(|run| {
            let output = self.run(&format!("{run} --json"))?;
            let output = serde_json::from_slice(&output).map_err(|error| error.to_string())?;
            Ok((run, output))
        });
        self.outputs
            .extend(made.collect::<Result<Vec<(String, Value)>, String>>()?);
        let mut rows = Vec::new();
        for vars in &table.rows {
            let run = self.filled(&table.run, vars);
            let cell = |(_, cell, pattern): &(String, String, String)| -> Outcome<String> {
                let cell = self.filled(cell, vars);
                let Some(path) = cell.strip_prefix('.') else {
                    return Ok(cell);
                };
                let value = select(&self.outputs[&run], path)?;
                show(value, pattern)
            };
            rows.push(table.columns.iter().map(cell).collect::<Outcome<Row>>()?);
        }
        Ok(rows)
    }

    /// A text with its variables. Those of a row may contain those of the registry.
    fn filled(&self, text: &str, vars: &BTreeMap<String, String>) -> String {
        let all = vars.iter().chain(&self.registry.vars);
        all.fold(text.to_owned(), |text, (name, value)| {
            text.replace(&format!("{{{name}}}"), value)
        })
    }

    /// Stdout of a command.
    fn run(&self, command: &str) -> Result<Vec<u8>, String> {
        let mut process = Command::new(&self.program);
        process.args(command.split_whitespace()).arg("--quiet");
        let output = process.current_dir(&self.root).output();
        let output = output.map_err(|error| error.to_string())?;
        match output.status.success() {
            true => Ok(output.stdout),
            false => {
                let reason = String::from_utf8_lossy(&output.stderr);
                Err(format!("shiftvox {command}: {reason}"))
            }
        }
    }

    /// A table with its foot: the command and the commit.
    fn markdown(&self, table: &Table, rows: &[Row]) -> Outcome<String> {
        let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
        let columns = || table.columns.iter();
        let mut text = line(columns().map(|(head, ..)| head.as_str()).collect());
        let ruler = |pattern: &str| if pattern.is_empty() { "---" } else { "--:" };
        text += &line(columns().map(|(.., pattern)| ruler(pattern)).collect());
        for row in rows {
            text += &line(row.iter().map(String::as_str).collect());
        }
        let command = self.filled(&table.run, &BTreeMap::new());
        let mut log = Command::new("git");
        log.args(["log", "-1", "--format=%h, %cs"]);
        let log = log.current_dir(&self.root).output()?;
        let commit = String::from_utf8_lossy(&log.stdout);
        let commit = commit.trim();
        let foot = format!("<sub>`shiftvox {command}`; commit {commit}.</sub>");
        // Markdown is wrapped at 120 columns.
        let mut column = 120;
        for word in foot.split(' ') {
            let fits = column + 1 + word.len() <= 120;
            column = if fits { column + 1 } else { 0 } + word.len();
            text += if fits { " " } else { "\n" };
            text += word;
        }
        Ok(text + "\n")
    }
}

/// Cells that are not those of the page.
fn differences(name: &str, table: &Table, rows: &[Row], block: &str) -> Vec<String> {
    let heads = table.columns.iter();
    let heads: Row = heads.map(|(head, ..)| head.clone()).collect();
    let cells = |line: &str| -> Row {
        let cells = line.trim_matches('|').split('|');
        cells.map(|cell| cell.trim().to_owned()).collect()
    };
    let is_row = |line: &&str| {
        line.starts_with('|') && !line.trim_start_matches(['|', ' ']).starts_with("--")
    };
    let mut lines = block.lines().filter(is_row);
    let mut faults = Vec::new();
    for (n, row) in std::iter::once(&heads).chain(rows).enumerate() {
        let there: Row = lines.next().map(cells).unwrap_or_default();
        for (k, cell) in row.iter().enumerate() {
            let found = there.get(k).map_or("nothing", String::as_str);
            if found != cell {
                let head = &heads[k];
                faults.push(format!(
                    "{name}, row {n}, {head}: the page has {found}, now {cell}"
                ));
            }
        }
    }
    if lines.next().is_some() {
        faults.push(format!("{name}: the page has more rows"));
    }
    faults
}

/// The value at a path such as `cost.total` or `rows[engine=fast][size=512].extra`. Filters must fit one element.
fn select<'v>(mut value: &'v Value, path: &str) -> Outcome<&'v Value> {
    for step in path.split('.') {
        let mut parts = step.split('[');
        let name = parts.next().unwrap_or_default();
        let found = value.get(name);
        value = found.ok_or_else(|| format!("`{path}`: no `{name}`"))?;
        let filters = parts.filter_map(|part| part.trim_end_matches(']').split_once('='));
        let filters: Vec<(&str, &str)> = filters.collect();
        if filters.is_empty() {
            continue;
        }
        let text = |of: &Value| of.as_str().map_or_else(|| of.to_string(), str::to_owned);
        let fits = |element: &&Value| {
            let mut filters = filters.iter();
            filters.all(|(key, wanted)| text(&element[key]) == *wanted)
        };
        let array = value.as_array();
        let array = array.ok_or_else(|| format!("`{path}`: no array"))?;
        let found: Vec<&Value> = array.iter().filter(fits).collect();
        let [one] = found[..] else {
            return Err(format!("`{path}`: {} elements fit", found.len()).into());
        };
        value = one;
    }
    Ok(value)
}

/// Prints a value by a pattern: `.2` decimals, `/1e6` divides before.
fn show(value: &Value, pattern: &str) -> Outcome<String> {
    let number = match value {
        Value::Null => return Ok("-".into()),
        Value::Bool(is_so) => return Ok(if *is_so { "yes" } else { "no" }.into()),
        Value::String(text) => return Ok(text.clone()),
        value => value.as_f64().ok_or(format!("{value} is no figure"))?,
    };
    let (decimals, divisor) = pattern.split_once('/').unwrap_or((pattern, "1"));
    let number = number / divisor.parse::<f64>()?;
    let decimals: usize = decimals.trim_start_matches('.').parse()?;
    let text = format!("{:.decimals$}", number.abs());
    let (whole, rest) = text.split_at(text.find('.').unwrap_or(text.len()));
    let sign = if number.is_sign_negative() { "-" } else { "" };
    Ok(format!("{sign}{}{rest}", grouped(whole.parse::<u128>()?)))
}
