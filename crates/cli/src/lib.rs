//! The command line: one file per command. stdout is data, stderr everything else.

mod args;
mod batch;
mod bench;
mod compare;
mod console;
mod convert;
mod demo;
mod document;
mod engines;
pub mod error;
mod experiment;
mod far;
mod fatal_signals;
mod generate;
mod info;
mod manual;
mod methods;
mod model;
mod outputs;
mod render;
mod report;
mod reproduce;
mod scene_files;
mod scenes;
mod signals;
mod stress;
mod textured;
mod triangles;
mod turntable;
mod view;

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::LazyLock;

use clap::error::{ContextKind, ContextValue};
use clap::{ArgAction, ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};

use console::Console;
use error::{CliError, Kind};
use shiftvox::scene::{FORMATS, Source};

fn long_about() -> String {
    let formats: String = FORMATS
        .iter()
        .map(|format| format!("  {:<10} {}\n", format.ending, format.name))
        .collect();
    format!(
        "\
Draws voxel files and meshes, the same to the bit on every computer.

`shiftvox FILE` draws a scene to {{stem}}.png in this folder. Without arguments the program draws the bundled \
scene, writes the picture to out/demo.png (replacing an older one) and prints the cost.

Scenes are generators, such as gen:terrain,depth=10,seed=1, or files, whose format is recognised by \
their content. Meshes are voxelised at --depth. Formats:

{formats}
Exit codes: 0 done, 1 failed while running, 2 wrong command line, 3 a comparison or an expectation \
failed, 4 bad input, 5 a limit is exceeded. If a signal (Ctrl-C) stops the program, it removes \
unfinished files and ends by that signal, which shells show as 130."
    )
}

fn version() -> &'static str {
    static VERSION: LazyLock<String> = LazyLock::new(|| {
        let identity = shiftvox::IDENTITY;
        format!(
            "{}\nidentity of the pictures {identity}",
            env!("CARGO_PKG_VERSION")
        )
    });
    &VERSION
}

/// Draws voxel files and meshes, the same to the bit on every computer.
#[derive(Debug, Parser)]
#[command(name = "shiftvox", version = version(), max_term_width = 100, long_about = long_about())]
struct Cli {
    #[command(flatten)]
    common: CommonArgs,
    #[command(subcommand)]
    command: Option<Command>,
}

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
    /// Threads, 0 for all, which never change the output [default: 0, of measurements 1]. `bench time`
    /// takes a list such as 1,2
    #[arg(long, global = true, value_name = "N", value_delimiter = ',', action = ArgAction::Set, num_args = 1,
          value_parser = thread_count)]
    threads: Vec<u16>,
}

fn thread_count(text: &str) -> Result<u16, String> {
    let count = text.trim().parse().ok().filter(|count| *count <= 1024);
    count.ok_or_else(|| "expected 0 to 1024 threads".to_owned())
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Draw a picture of each scene
    Render(Box<render::RenderArgs>),
    /// Draw many frames around a scene
    Turntable(Box<turntable::TurntableArgs>),
    /// Show scenes in a browser on this computer
    ///
    /// Prints an address to open. The page moves the camera, changes settings, and shows the cost and
    /// the `render` command of each picture. For other computers see docs/view.md.
    View(Box<view::ViewArgs>),
    /// Draw a mesh as triangles: the reference picture of a mesh
    Triangles(Box<triangles::TrianglesArgs>),
    /// Describe a scene
    Info(info::InfoArgs),
    /// Convert a scene to another format
    Convert(convert::ConvertArgs),
    /// Make a scene and write it
    Generate(generate::GenerateArgs),
    /// Compare two pictures or two .npy buffers
    Compare(compare::CompareArgs),
    /// Model the light hardware: operations, cycles, memory, area, energy
    ///
    /// Draws one frame on the machine, counts its operations, simulates its cycles on hardware
    /// described in TOML, and prices both by tables with sources. -v prints more tables.
    Model(Box<model::ModelArgs>),
    /// Run an experiment
    Bench(bench::BenchArgs),
    /// Search word formats, cameras, scenes and rules for violated invariants
    ///
    /// Every frame is compared with the exact ray caster, the specification and bounds on its
    /// vertices' error. A failing case is printed as a command line, and the exit code is 3.
    Stress(Box<stress::StressArgs>),
    /// Reproduce the image-order paper's Table I, claims and figures, beside its numbers
    Reproduce(reproduce::ReproduceArgs),
    /// Print the completions of a shell
    Completions(manual::CompletionsArgs),
    /// Print the manual page
    Man(manual::ManArgs),
}

impl Cli {
    fn threads(&self) -> Result<usize, CliError> {
        match (&self.common.threads[..], &self.command) {
            ([], Some(Command::Render(args))) if args.is_small() => Ok(1),
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
    match run(std::env::args_os().collect()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if error.kind != Kind::Pipe {
                console::report_error(&error);
            }
            ExitCode::from(error.kind.code())
        }
    }
}

fn parse(line: &[OsString]) -> Result<(Cli, ArgMatches), clap::Error> {
    let matches = Cli::command().try_get_matches_from(line).or_else(|error| {
        match scene_place(line, &error) {
            Some(place) => {
                let (before, scenes) = line.split_at(place);
                let render = &[OsString::from("render")];
                Cli::command().try_get_matches_from([before, render, scenes].concat())
            }
            None => Err(error),
        }
    })?;
    Ok((Cli::from_arg_matches(&matches)?, matches))
}

/// Where a command line names a scene instead of a command.
fn scene_place(line: &[OsString], error: &clap::Error) -> Option<usize> {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else {
        return None;
    };
    let is_scene =
        Path::new(word).exists() || Source::is_generated(word) || word.contains(['.', '/']);
    let place = line.iter().position(|of| of == word.as_str())?;
    let is_marked = place > 1 && line[place - 1] == "--";
    is_scene.then_some(place - usize::from(is_marked))
}

fn run(line: Vec<OsString>) -> Result<(), CliError> {
    // Also where the rest of the command line is wrong.
    let json = line
        .iter()
        .take_while(|word| *word != "--")
        .any(|word| word == "--json");
    fatal_signals::install(json);
    signals::tidy_up_when_stopped();
    let (cli, matches) = match parse(&line) {
        Ok(parsed) => parsed,
        Err(error) if error.exit_code() == 0 => {
            error.print()?;
            return Ok(io::stdout().flush()?);
        }
        Err(error) => {
            let _ = error.print();
            let message = error.render().to_string();
            let _ = Console::new(true, 0, json).end(Err(CliError::usage(message.trim_end())));
            std::process::exit(error.exit_code());
        }
    };
    let console = Console::new(cli.common.quiet, cli.common.verbose, cli.common.json);
    let result = cli
        .threads()
        .and_then(|threads| pool(threads).build_global().map_err(no_threads))
        .and_then(|()| run_command(cli, &matches, &console));
    console.end(result)
}

/// Runs a command in this process, for bindings to other languages. Returns its `--json` output: one
/// document, or one per line. Only errors that do not stop the work are printed.
///
/// # Errors
/// As the program fails.
pub fn documents(words: impl IntoIterator<Item = OsString>) -> Result<String, CliError> {
    let line: Vec<OsString> = [OsString::from("shiftvox")]
        .into_iter()
        .chain(words)
        .collect();
    let (cli, matches) = parse(&line).map_err(|error| {
        let message = error.render().to_string();
        CliError::usage(message.trim_end().trim_start_matches("error: "))
    })?;
    let without = match cli.command {
        Some(Command::View(_)) => "view",
        Some(Command::Completions(_)) => "completions",
        Some(Command::Man(_)) => "man",
        _ => "",
    };
    if !without.is_empty() {
        return Err(CliError::usage(format!("{without}: it prints no JSON")));
    }
    let threads = cli.threads()?;
    let console = Console::keeping();
    let run = || run_command(cli, &matches, &console);
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

fn run_command(cli: Cli, matches: &ArgMatches, console: &Console) -> Result<(), CliError> {
    match cli.command {
        None => demo::run(console),
        Some(Command::Render(args)) => render::run(&args, console),
        Some(Command::Turntable(args)) => turntable::run(&args, console),
        Some(Command::View(args)) => view::run(*args, matches, console),
        Some(Command::Triangles(args)) => triangles::run(&args, console),
        Some(Command::Info(args)) => info::run(&args, console),
        Some(Command::Convert(args)) => convert::run(&args, console),
        Some(Command::Generate(args)) => generate::run(&args, console),
        Some(Command::Compare(args)) => compare::run(&args, console),
        Some(Command::Model(args)) => model::run(&args, console),
        Some(Command::Bench(args)) => bench::run(&args, &cli.common.threads, console),
        Some(Command::Stress(args)) => stress::run(&args, console),
        Some(Command::Reproduce(args)) => reproduce::run(&args, console),
        Some(Command::Completions(args)) => manual::completions(&args, Cli::command()),
        Some(Command::Man(args)) => manual::man(&args, Cli::command()),
    }
}
