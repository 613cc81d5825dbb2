//! Remakes and checks the tables and plots of README and docs: `docs/evidence/README.md` says how.
//!
//!     cargo run --release --example evidence -- --check             # text, and all figures that take seconds
//!     cargo run --release --example evidence -- --check NAME...     # figures of blocks or pages, however long
//!     cargo run --release --example evidence -- --write [NAME...]   # remakes all, or these
//!
//! It is an example and no command of `shiftvox`, because it is of use to nobody who does not change these pages, and it
//! sees the program as a reader does: by its command line and its JSON.

mod tool;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use tool::{Tool, Wanted};

const USAGE: &str = "usage: evidence --check|--write|--list [--all] [--no-times] [BLOCK|PAGE]...

  --check     text rules; then figures that are the same in every run, of blocks that take seconds
  --write     remakes tables, plots and feet
  --list      every block, with the commit of its figures
  --text      with --check: the text rules alone
  --all       with --check and without names: blocks that take long, too
  --quick     with --write and without names: only blocks that take seconds
  --no-times  with --write: leaves times and instructions, and what their foot says, as they are

SHIFTVOX_MESHES names the folder of the meshes that may not ship.";

fn main() -> ExitCode {
    match run() {
        Ok(faults) if faults.is_empty() => ExitCode::SUCCESS,
        Ok(faults) => {
            for fault in &faults {
                eprintln!("{fault}");
            }
            eprintln!("{} faults", faults.len());
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("evidence: {error}");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<Vec<String>, String> {
    let mut flags = Vec::new();
    let mut names = Vec::new();
    for argument in std::env::args().skip(1) {
        if argument.starts_with('-') {
            flags.push(argument);
        } else {
            names.push(argument);
        }
    }
    let known = [
        "--check",
        "--write",
        "--list",
        "--text",
        "--all",
        "--quick",
        "--no-times",
    ];
    if let Some(unknown) = flags.iter().find(|flag| !known.contains(&flag.as_str())) {
        return Err(format!("what is {unknown}?\n{USAGE}"));
    }
    let has = |flag: &str| flags.iter().any(|given| given == flag);
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let tool = Tool::open(root, &program(root)?)?;
    if has("--list") {
        print!("{}", tool.list()?);
        return Ok(Vec::new());
    }
    let wanted = |long| Wanted {
        names: names.clone(),
        long,
        times: !has("--no-times"),
    };
    if has("--write") {
        return tool.write(&wanted(!has("--quick")));
    }
    if !has("--check") {
        return Err(USAGE.to_owned());
    }
    let mut faults = if names.is_empty() {
        tool.text_faults()?
    } else {
        Vec::new()
    };
    if !has("--text") {
        faults.extend(tool.figure_faults(&wanted(has("--all")), 2)?);
    }
    Ok(faults)
}

/// The program as it is now, built beside this one.
fn program(root: &Path) -> Result<PathBuf, String> {
    let built = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        // With the example, so that dependencies are built with the same features and once.
        .args([
            "build",
            "--release",
            "--quiet",
            "--bin",
            "shiftvox",
            "--example",
            "evidence",
        ])
        .current_dir(root)
        .status()
        .map_err(|e| format!("cannot run cargo: {e}"))?;
    if !built.success() {
        return Err("shiftvox does not build".to_owned());
    }
    let here = std::env::current_exe().map_err(|e| format!("where is this program? {e}"))?;
    // target/release/examples/evidence
    let folder = here
        .parent()
        .and_then(Path::parent)
        .ok_or("no folder of programs")?;
    Ok(folder.join(format!("shiftvox{}", std::env::consts::EXE_SUFFIX)))
}
