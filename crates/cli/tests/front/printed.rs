//! Every command that README and docs print does what it says, in a fresh folder, and does it again.
//!
//! Commands are the lines that begin with `shiftvox` (`sed`, `mkdir`) in blocks of code. A block after `<!-- takes 5 min -->`
//! is long: it runs only where `SHIFTVOX_PRINTED` is `all`. A block after `<!-- forms -->` has placeholders.
#![cfg(unix)]

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use rayon::prelude::*;

/// The mark of a block of code.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mark {
    Runs,
    Long,
    Forms,
}

/// The commands of a page, in order.
fn commands(page: &str) -> Vec<(String, Mark)> {
    let mut found: Vec<(String, Mark)> = Vec::new();
    let (mut mark, mut is_fenced, mut is_continued) = (Mark::Runs, false, false);
    for line in page.lines() {
        let comment = line.strip_prefix("<!-- ");
        if comment.is_some_and(|text| text.starts_with("takes ")) {
            mark = Mark::Long;
        } else if comment.is_some_and(|text| text.starts_with("forms")) {
            mark = Mark::Forms;
        }
        let is_fence = line.starts_with("```");
        let code = match is_fenced {
            true => Some(line),
            false => line.strip_prefix("    "),
        };
        is_fenced ^= is_fence;
        let is_text =
            !is_fenced && code.is_none() && !line.is_empty() && comment.is_none() && !is_fence;
        if is_text || (is_fence && !is_fenced) {
            mark = Mark::Runs;
        }
        let Some(code) = code.filter(|_| !is_fence) else {
            continue;
        };
        let part = code.split(" # ").next().unwrap_or_default().trim();
        let (part, goes_on) = part
            .strip_suffix('\\')
            .map_or((part, false), |part| (part, true));
        if std::mem::replace(&mut is_continued, goes_on) {
            found.last_mut().unwrap().0 += part;
        } else if ["shiftvox ", "sed ", "mkdir "]
            .iter()
            .any(|name| part.starts_with(name))
        {
            let fails = code.contains("exit code 3");
            let check = if fails { "; [ $? = 3 ]" } else { "" };
            found.push((format!("{part}{check}"), mark));
        } else {
            is_continued = false;
        }
    }
    found
}

fn pages() -> Vec<PathBuf> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let docs = fs::read_dir(root.join("docs")).unwrap();
    let mut pages: Vec<PathBuf> = docs
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "md"))
        .collect();
    pages.sort();
    pages.insert(0, root.join("README.md"));
    pages.push(root.join("CONTRIBUTING.md"));
    pages
}

/// Files in a folder and below, without those of links.
fn files(folder: &Path) -> usize {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let counts = entries.map(|entry| match entry.file_type().unwrap().is_dir() {
        true => files(&entry.path()),
        false => 1,
    });
    counts.sum()
}

/// Runs the commands of a page in a folder of its own, and once more those that wrote something
/// and that `again` does not hold yet. Tells how many ran, and which failed.
fn run_page(page: &Path, again: &Mutex<HashSet<String>>) -> (usize, Vec<String>) {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let program = crate::common::program();
    let path = std::env::var("PATH").unwrap_or_default();
    let path = format!("{}:{path}", program.parent().unwrap().display());
    let all = std::env::var_os("SHIFTVOX_PRINTED").is_some_and(|what| what == "all");
    let folder = tempfile::tempdir().unwrap();
    for (from, to) in [("assets", "assets"), ("tests/data", "tests/data")] {
        fs::create_dir_all(folder.path().join(to).parent().unwrap()).unwrap();
        std::os::unix::fs::symlink(root.join(from), folder.path().join(to)).unwrap();
    }
    let commands = commands(&fs::read_to_string(page).unwrap());
    let mut writes = HashSet::new();
    let (mut ran, mut failed) = (0, Vec::new());
    for round in 1..=2 {
        for (command, mark) in &commands {
            if *mark == Mark::Forms || (*mark == Mark::Long && !all) {
                continue;
            }
            let is_wanted =
                || writes.contains(command) && again.lock().unwrap().insert(command.clone());
            if round == 2 && !is_wanted() {
                continue;
            }
            let before = files(folder.path());
            let output = Command::new("sh")
                .args(["-c", command])
                .current_dir(folder.path())
                .env("PATH", &path)
                .output()
                .unwrap();
            ran += 1;
            if files(folder.path()) > before {
                writes.insert(command);
            }
            if !output.status.success() {
                let told = String::from_utf8_lossy(&output.stderr);
                let at = page.display();
                failed.push(format!("{at}, round {round}: {command}\n{told}"));
            }
        }
    }
    (ran, failed)
}

#[test]
fn printed_commands_run_and_run_again() {
    let again = Mutex::default();
    let pages: Vec<_> = pages()
        .into_par_iter()
        .map(|page| run_page(&page, &again))
        .collect();
    let ran: usize = pages.iter().map(|(ran, _)| ran).sum();
    let failed: Vec<String> = pages.into_iter().flat_map(|(_, failed)| failed).collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
    assert!(ran > 40, "{ran} commands run");
}

#[test]
fn commands_are_found_with_what_is_said_of_them() {
    let page = "text\n\n    shiftvox a # b\n    cargo c\n\n<!-- takes 5 min -->\n\n    shiftvox d \\\n        e\n\nmore\n\n\
                <!-- forms -->\n```sh\nshiftvox F\n```\n```sh\nshiftvox g ####.png # exit code 3 if so\n```\n";
    let found = commands(page);
    let expected = [
        ("shiftvox a", Mark::Runs),
        ("shiftvox d e", Mark::Long),
        ("shiftvox F", Mark::Forms),
        ("shiftvox g ####.png; [ $? = 3 ]", Mark::Runs),
    ];
    assert_eq!(
        found,
        expected.map(|(command, mark)| (command.to_owned(), mark))
    );
}
