//! The command line: one file per command, and what commands share.
//!
//! stdout is data, stderr everything else. Nothing here computes. Imports go one way; the order is
//! in `ARCHITECTURE.md`.

pub mod args;
mod bench;
pub mod compare;
mod config;
mod console;
pub mod convert;
mod demo;
mod document;
mod engines;
pub mod error;
mod experiment;
mod far;
mod fatal_signals;
pub mod generate;
pub mod info;
mod manual;
mod methods;
mod model;
mod names;
mod outputs;
pub mod render;
mod report;
mod reproduce;
mod scene_files;
mod scenes;
mod signals;
mod stress;
mod textured;
pub mod triangles;
pub mod turntable;
#[cfg(feature = "view")]
mod view;

use std::ffi::OsString;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::{ArgAction, CommandFactory, Parser, Subcommand};

use console::Console;
use error::{CliError, Kind};
use shiftvox::scene::FORMATS;

/// The second part of the help text.
fn long_about() -> String {
    let formats: String = FORMATS
        .iter()
        .map(|format| format!("  {:<8} {}\n", format.ending, format.name))
        .collect();
    format!(
        "\
Draws voxel files and meshes, the same to the bit on every computer.

Without a command it draws the bundled scene, writes the picture to out/demo.png (replacing an \
older one) and prints the cost.

Scenes are generators, such as gen:terrain,depth=10,seed=1, or files, whose format is recognised by \
their content. Meshes are voxelised at --depth. Formats:

{formats}
Exit codes: 0 done, 1 failed while running, 2 wrong command line, 3 a comparison or an expectation \
failed, 4 bad input, 5 a limit is exceeded. If a signal (Ctrl-C) stops the program, it removes \
unfinished files and ends by that signal, which shells show as 130."
    )
}

/// Draws voxel files and meshes, the same to the bit on every computer.
#[derive(Debug, Parser)]
#[command(name = "shiftvox", version, max_term_width = 100, long_about = long_about())]
pub struct Cli {
    #[command(flatten)]
    common: CommonArgs,
    #[command(subcommand)]
    command: Option<Command>,
}

/// Flags of every command.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Common")]
struct CommonArgs {
    /// No notes and no progress; errors are still printed
    #[arg(short, long, global = true)]
    quiet: bool,
    /// More notes
    #[arg(short, long, global = true, action = ArgAction::Count)]
    verbose: u8,
    /// Results as JSON on stdout
    #[arg(long, global = true)]
    json: bool,
    /// Threads, 0 for all; never changes a bit of output [default: 0; of measurements: 1].
    /// `bench time` takes a list, such as 1,2
    #[arg(long, global = true, value_name = "N")]
    threads: Option<args::ThreadCounts>,
    /// TOML file with flags by their long names; flags on the command line come first
    #[arg(long, global = true, value_name = "FILE")]
    config: Option<std::path::PathBuf>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Draw a picture of each scene
    Render(Box<render::RenderArgs>),
    /// Draw many frames around a scene
    Turntable(Box<turntable::TurntableArgs>),
    /// Look at scenes in a browser: a page on this computer
    ///
    /// Prints an address to open. The page turns, moves and zooms the camera, changes the settings
    /// of `render`, shows what a frame costs, and gives the `render` command of each picture.
    /// It is for this computer alone, and through an SSH tunnel for another (docs/view.md).
    #[cfg(feature = "view")]
    View(Box<view::ViewArgs>),
    /// Draw a mesh as triangles: the reference picture of a mesh
    Triangles(Box<triangles::TrianglesArgs>),
    /// Say what is in a scene
    Info(info::InfoArgs),
    /// Convert a scene to another format
    Convert(convert::ConvertArgs),
    /// Make a scene and write it
    Generate(generate::GenerateArgs),
    /// Compare two pictures or two .npy buffers
    Compare(compare::CompareArgs),
    /// Model the light hardware: operations, cycles, memory, area, energy
    ///
    /// Draws one frame on the machine, counts what it executes, runs it cycle by cycle on a
    /// hardware described in TOML, and prices it by tables whose every figure names its source.
    Model(Box<model::ModelArgs>),
    /// Run an experiment
    Bench(bench::BenchArgs),
    /// Sweep word formats, cameras, scenes and rules for what must never happen
    ///
    /// Every frame is held against the exact ray caster, the specification and bounds on its
    /// vertices' error. What fails is shrunk to one command line; exit code 3.
    Stress(Box<stress::StressArgs>),
    /// Reproduce the image-order paper's Table I, claims and figures, beside its numbers
    ///
    /// Runs a list of measurements (TOML). Hashes of pictures, records and operations are the same
    /// on every computer.
    Reproduce(reproduce::ReproduceArgs),
    /// Print the completions of a shell
    Completions(manual::CompletionsArgs),
    /// Print the manual page
    Man(manual::ManArgs),
}

impl Cli {
    /// Threads of the pool that all work shares, 0 for all.
    fn threads(&self) -> Result<usize, CliError> {
        let given = self.common.threads.as_ref().map_or(&[][..], |t| &t.0);
        match (given, &self.command) {
            ([], _) => Ok(0),
            (&[one], _) => Ok(usize::from(one)),
            // Experiments make a pool for each number and use this one to prepare.
            (_, Some(Command::Bench(args))) if args.takes_thread_list() => Ok(0),
            _ => Err(CliError::usage(
                "--threads takes one number here; lists are for bench time",
            )),
        }
    }
}

/// Runs the program on the process's arguments.
#[must_use]
pub fn main() -> ExitCode {
    signals::tidy_up_when_stopped();
    let result = run(std::env::args_os().collect());
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if error.kind != Kind::Pipe {
                console::report_error(&error);
            }
            error.exit_code()
        }
    }
}

/// Whether a command line asks for JSON, also where the rest of it is wrong.
fn wants_json(command_line: &[OsString]) -> bool {
    let mut flags = command_line.iter().take_while(|word| *word != "--");
    flags.any(|word| word == "--json")
}

fn run(command_line: Vec<OsString>) -> Result<(), CliError> {
    let early = Console::new(true, 0, wants_json(&command_line));
    fatal_signals::install(early.json);
    let expanded = match config::expand(command_line) {
        Ok(expanded) => expanded,
        Err(error) => return early.end(Err(error)),
    };
    let cli = match Cli::try_parse_from(&expanded.line) {
        Ok(cli) => cli,
        Err(error) if error.exit_code() == 0 => {
            // Help and version.
            error.print()?;
            return Ok(io::stdout().flush()?);
        }
        Err(error) => {
            if let Some(blamed) = expanded.blame(&error) {
                return early.end(Err(blamed));
            }
            // To stderr, and with `--json` to stdout too; a closed pipe is nobody's fault.
            let _ = error.print();
            let message = error.render().to_string();
            let _ = early.end(Err(CliError::usage(message.trim_end())));
            std::process::exit(error.exit_code());
        }
    };
    let console = Console::new(cli.common.quiet, cli.common.verbose, cli.common.json);
    let result = cli
        .threads()
        .and_then(|threads| pool(threads).build_global().map_err(no_threads))
        .and_then(|()| run_command(cli, expanded.scenes, &console));
    console.end(result)
}

/// Runs a command in this process, for bindings to other languages: returns what it prints with
/// `--json`, one document or a line for each. Nothing is printed but errors after which the work
/// goes on.
///
/// # Errors
/// As the program fails.
pub fn documents(words: impl IntoIterator<Item = OsString>) -> Result<String, CliError> {
    let line = [OsString::from("shiftvox")].into_iter().chain(words);
    let cli = Cli::try_parse_from(line).map_err(|error| {
        let message = error.render().to_string();
        CliError::usage(message.trim_end().trim_start_matches("error: "))
    })?;
    let threads = cli.threads()?;
    let console = Console::keeping();
    let run = || run_command(cli, Vec::new(), &console);
    match threads {
        0 => run(),
        threads => pool(threads).build().map_err(no_threads)?.install(run),
    }?;
    console.end(Ok(()))?;
    Ok(console.kept())
}

fn pool(threads: usize) -> rayon::ThreadPoolBuilder {
    rayon::ThreadPoolBuilder::new().num_threads(threads)
}

fn no_threads(error: rayon::ThreadPoolBuildError) -> CliError {
    CliError::new(Kind::Limit, format!("cannot start the threads: {error}"))
}

fn run_command(cli: Cli, scenes: Vec<String>, console: &Console) -> Result<(), CliError> {
    match cli.command {
        None => demo::run(console),
        Some(Command::Render(args)) => render::run(&args, scenes, console),
        Some(Command::Turntable(args)) => turntable::run(&args, scenes, console),
        #[cfg(feature = "view")]
        Some(Command::View(args)) => view::run(*args, scenes, console),
        Some(Command::Triangles(args)) => triangles::run(&args, console),
        Some(Command::Info(args)) => info::run(&args, scenes, console),
        Some(Command::Convert(args)) => convert::run(&args, console),
        Some(Command::Generate(args)) => generate::run(&args, console),
        Some(Command::Compare(args)) => compare::run(&args, console),
        Some(Command::Model(args)) => model::run(&args, scenes, console),
        Some(Command::Bench(args)) => {
            bench::run(&args, scenes, cli.common.threads.as_ref(), console)
        }
        Some(Command::Stress(args)) => stress::run(&args, scenes, console),
        Some(Command::Reproduce(args)) => reproduce::run(&args, console),
        Some(Command::Completions(args)) => manual::completions(&args, Cli::command()),
        Some(Command::Man(args)) => manual::man(&args, Cli::command()),
    }
}
