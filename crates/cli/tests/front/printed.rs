//! Every command that README and docs print does what it says in a fresh folder, and says how to replace files.
//!
//! Commands are the lines that begin with `shiftvox` (`sed`, `mkdir`) in blocks of code. A block after `<!-- takes 5 min -->`
//! is long: it runs only where `SHIFTVOX_PRINTED` is `all`, and then with its large scenes. A block after `<!-- forms -->`
//! has placeholders.
#![cfg(unix)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use rayon::prelude::*;

use crate::program::{Folder, PROGRAM, ROOT};

/// Scenes and sizes, and the small ones that are taken in their place.
const SMALL: [(&str, &str); 10] = [
    ("gen:terrain,depth=10", "gen:terrain,depth=5"),
    ("gen:menger,depth=5", "gen:menger,depth=3"),
    ("gen:maze,depth=5", "gen:maze,depth=3"),
    ("assets/tree.vox", "gen:maze,depth=4"),
    ("model --", "model gen:maze,depth=3 --"),
    ("--depth 8", "--depth 6"),
    ("--depth 9", "--depth 7"),
    ("--size 128", "--size 32"),
    ("--size 48", "--size 24"),
    ("--samples 256", "--samples 16"),
];

/// The commands of a page, in order.
fn commands(page: &str, with_long: bool) -> Vec<String> {
    let (mut is_left_out, mut is_fenced) = (false, false);
    let mut found = Vec::new();
    for line in page.replace("\\\n", " ").lines() {
        is_fenced ^= line.starts_with("```");
        let is_code = is_fenced || line.starts_with("    ");
        if line.starts_with("<!-- takes ") {
            is_left_out = !with_long;
        } else if line.starts_with("<!-- forms") {
            is_left_out = true;
        } else if !is_code && !line.is_empty() {
            is_left_out = false;
        }
        let command = line.split(" # ").next().unwrap_or_default().trim();
        let is_run = |name: &&str| command.starts_with(name);
        if is_code && !is_left_out && ["shiftvox ", "sed ", "mkdir "].iter().any(is_run) {
            let fails = line.contains("exit code 3");
            let check = if fails { "; [ $? = 3 ]" } else { "" };
            found.push(format!("{command}{check}"));
        }
    }
    found
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

/// The number of a page's commands, and those that fail.
fn run(page: &Path) -> (usize, Vec<String>) {
    let folder = Folder::new();
    fs::create_dir(folder.at("tests")).unwrap();
    for name in ["assets", "tests/data"] {
        std::os::unix::fs::symlink(Path::new(ROOT).join(name), folder.at(name)).unwrap();
    }
    let programs = Path::new(PROGRAM).parent().unwrap().display();
    let path = format!("{programs}:{}", std::env::var("PATH").unwrap_or_default());
    let all = std::env::var_os("SHIFTVOX_PRINTED").is_some_and(|what| what == "all");
    let mut failed = Vec::new();
    let commands = commands(&fs::read_to_string(page).unwrap(), all);
    for printed in &commands {
        let small = SMALL.iter().filter(|_| !all);
        let small = small.fold(printed.clone(), |line, (of, by)| line.replace(of, by));
        let before = files(folder.path());
        let mut shell = Command::new("sh");
        shell.args(["-c", &small]).env("PATH", &path);
        let output = shell.current_dir(folder.path()).output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr);
        let has_written = files(folder.path()) > before && printed.starts_with("shiftvox");
        if !output.status.success() {
            failed.push(format!("{}: {small}\n{told}", page.display()));
        } else if has_written
            && !["--force", "--resume", " > "]
                .iter()
                .any(|word| printed.contains(word))
        {
            failed.push(format!("{}: {printed}: without --force", page.display()));
        }
    }
    (commands.len(), failed)
}

#[test]
fn printed_commands_run_and_may_run_again() {
    let docs = fs::read_dir(Path::new(ROOT).join("docs")).unwrap();
    let docs = docs.map(|entry| entry.unwrap().path());
    let docs = docs.filter(|path| path.extension().is_some_and(|ending| ending == "md"));
    let others = ["README.md", "CONTRIBUTING.md"].map(|name| Path::new(ROOT).join(name));
    let pages: Vec<PathBuf> = docs.chain(others).collect();
    let runs: Vec<_> = pages.par_iter().map(|page| run(page)).collect();
    let failed: Vec<&str> = runs
        .iter()
        .flat_map(|(_, failed)| failed)
        .map(String::as_str)
        .collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
    let ran: usize = runs.iter().map(|(ran, _)| ran).sum();
    assert!(ran > 50, "{ran} commands run");
}
