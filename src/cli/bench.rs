//! `bench`: the experiments.

use clap::{Args, Subcommand};
use serde_json::json;

use super::console::Console;
use super::error::{CliError, Kind};
use super::report;
use crate::lab::vertex_error;

/// Arguments of `bench`.
#[derive(Debug, Args)]
pub(super) struct BenchArgs {
    #[command(subcommand)]
    experiment: Experiment,
}

/// What is measured.
#[derive(Debug, Subcommand)]
enum Experiment {
    /// How far the paper's screen-space midpoints are from exact projection
    VertexError,
}

pub(super) fn run(args: &BenchArgs, console: &Console) -> Result<(), CliError> {
    match args.experiment {
        Experiment::VertexError => {
            let table = vertex_error::standard_table().map_err(|e| CliError::new(Kind::Run, e))?;
            if console.json {
                return console.document(&report::document(
                    "bench vertex-error",
                    json!({ "table": table }),
                ));
            }
            console.data(table.to_string())
        }
    }
}
