//! Blocks in Markdown, between `<!-- evidence: NAME -->` and `<!-- end: NAME -->`.

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;
use std::process::Command;

use super::registry::{Block, Kind, Page};
use super::runs::{Concrete, template_said};

/// The lines between the two marks of each block.
pub(crate) fn blocks(text: &str) -> Result<Vec<(String, Range<usize>)>, String> {
    let mut found: Vec<(String, Range<usize>)> = Vec::new();
    let mut open: Option<(String, usize)> = None;
    for (number, line) in text.lines().enumerate() {
        if let Some(name) = mark(line, "evidence") {
            if let Some((before, _)) = open {
                return Err(format!("line {}: {before} has no end", number + 1));
            }
            if found.iter().any(|(known, _)| *known == name) {
                return Err(format!("line {}: {name} is there twice", number + 1));
            }
            open = Some((name, number + 1));
        } else if let Some(name) = mark(line, "end") {
            match open.take() {
                Some((begun, start)) if begun == name => found.push((name, start..number)),
                _ => return Err(format!("line {}: the end of {name}, not begun", number + 1)),
            }
        }
    }
    match open {
        Some((name, _)) => Err(format!("{name} has no end")),
        None => Ok(found),
    }
}

fn mark(line: &str, word: &str) -> Option<String> {
    let inner = line
        .trim()
        .strip_prefix("<!--")?
        .strip_suffix("-->")?
        .trim();
    let name = inner.strip_prefix(word)?.trim_start().strip_prefix(':')?;
    Some(name.trim().to_owned())
}

/// The foot's first part, which follows from the registry: how the block is remade.
pub(crate) fn how(page: &Page, block: &Block) -> String {
    let mut commands: Vec<String> = Vec::new();
    for run in block.runs.values() {
        let all: BTreeSet<Concrete> = block
            .rows
            .iter()
            .map(|row| Concrete::new(run, &row.vars(&page.vars), &page.prepare))
            .collect();
        let said = match all.first() {
            Some(one) if all.len() == 1 => one.said(),
            _ => template_said(run, &page.vars),
        };
        if !commands.contains(&said) {
            commands.push(said);
        }
    }
    format!(
        "Remade by `cargo run --release --example evidence -- --write {}`, which runs {}.",
        block.name,
        commands.join(", ")
    )
}

/// Whether a block shows times.
pub(crate) fn has_times(block: &Block) -> bool {
    block.columns.iter().any(|c| c.kind != Kind::Exact)
        || block.pictures.iter().any(|p| p.kind != Kind::Exact)
}

/// Commit, date and machine, now.
pub(crate) fn now(root: &Path) -> String {
    let said = |program: &str, args: &[&str]| {
        Command::new(program)
            .args(args)
            .current_dir(root)
            .output()
            .ok()
            .map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned())
            .unwrap_or_default()
    };
    let commit = said("git", &["rev-parse", "--short=8", "HEAD"]);
    let sources = [
        "status",
        "--porcelain",
        "--",
        "src",
        "hwmodel",
        "assets",
        "Cargo.lock",
    ];
    let changed = if said("git", &sources).is_empty() {
        ""
    } else {
        " and changes to it"
    };
    let date = said("date", &["-u", "+%F"]);
    let rustc = said("rustc", &["--version"]);
    let rustc = rustc.split(' ').take(2).collect::<Vec<_>>().join(" ");
    let threads = std::thread::available_parallelism().map_or(0, std::num::NonZero::get);
    let processor = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let processor = processor
        .lines()
        .find_map(|line| line.strip_prefix("model name"))
        .and_then(|rest| rest.split_once(':'))
        .map_or("a processor without name", |(_, name)| name.trim());
    format!("commit {commit}{changed}, {date}, {processor}, {threads} threads, {rustc}")
}

/// The processes that wait for a processor, in the mean of the last minute.
pub(crate) fn load() -> String {
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    load.split(' ').next().unwrap_or("unknown").to_owned()
}

/// What a foot says of its times; those of the same run as its figures are `of the same run, load 0.5`.
pub(crate) fn times_of(lines: &[&str]) -> Option<String> {
    let foot = foot(lines);
    let (before, times) = foot.split_once(" Times: ")?;
    let times = times.trim_end_matches("</sub>").trim_end_matches('.');
    match times.strip_prefix("of the same run, ") {
        Some(load) => {
            let (_, figures) = before.split_once(" Figures: ")?;
            Some(format!("{}, {load}", figures.trim_end_matches('.')))
        }
        None => Some(times.to_owned()),
    }
}

/// A block's foot in one line.
pub(crate) fn foot(lines: &[&str]) -> String {
    let from = lines.iter().position(|line| line.starts_with("<sub>"));
    let lines = from.map_or(&[][..], |from| &lines[from..]);
    let words: Vec<&str> = lines
        .iter()
        .flat_map(|line| line.split_whitespace())
        .collect();
    words.join(" ")
}

/// What is wrong with a foot.
pub(crate) fn foot_fault(page: &Page, block: &Block, lines: &[&str]) -> Option<String> {
    let foot = foot(lines);
    let wanted = format!("<sub>{} Figures: commit ", how(page, block));
    let Some(rest) = foot.strip_prefix(&wanted) else {
        return Some("its foot does not name the commands that the registry has".to_owned());
    };
    let parts: Vec<&str> = rest.split(" Times: ").collect();
    let dated = |part: &&str| {
        part.split([',', ' ']).any(|word| {
            word.len() == 10 && word.starts_with("20") && word.matches('-').count() == 2
        })
    };
    if !parts
        .iter()
        .all(|part| part.starts_with("of the same run, ") || dated(part))
    {
        return Some("its foot has no date".to_owned());
    }
    if has_times(block) && parts.len() != 2 {
        return Some("its foot does not say when its times were taken".to_owned());
    }
    None
}

/// Breaks a line at 120 columns.
pub(crate) fn wrap(text: &str) -> String {
    let mut wrapped = String::new();
    let mut width = 0;
    for word in text.split(' ') {
        let length = word.chars().count();
        if width > 0 && width + 1 + length > 120 {
            wrapped.push('\n');
            width = 0;
        } else if width > 0 {
            wrapped.push(' ');
            width += 1;
        }
        wrapped += word;
        width += length;
    }
    wrapped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_of_a_page() {
        let page = "a\n<!-- evidence: one -->\n| x |\n<!-- end: one -->\nb\n";
        assert_eq!(blocks(page), Ok(vec![("one".to_owned(), 2..3)]));
        for wrong in [
            "<!-- evidence: one -->\n",
            "<!-- end: one -->\n",
            "<!-- evidence: one -->\n<!-- end: two -->\n",
            "<!-- evidence: one -->\n<!-- evidence: two -->\n<!-- end: two -->\n",
        ] {
            assert!(blocks(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn lines_end_at_120_columns() {
        let text = "word ".repeat(100);
        let wrapped = wrap(text.trim());
        assert!(wrapped.lines().all(|line| line.len() <= 120));
        assert_eq!(wrapped.split_whitespace().count(), 100);
    }

    #[test]
    fn times_of_a_foot() {
        let lines = [
            "| a |",
            "",
            "<sub>Remade. Figures: commit 1, 2026-01-01. Times: commit 0,",
            "2025-01-01.</sub>",
        ];
        assert_eq!(times_of(&lines), Some("commit 0, 2025-01-01".to_owned()));
        let lines = [
            "<sub>Remade. Figures: commit 1, rustc 1.95.0. Times: of the same run, load 2.5.</sub>",
        ];
        assert_eq!(
            times_of(&lines),
            Some("commit 1, rustc 1.95.0, load 2.5".to_owned())
        );
    }
}
