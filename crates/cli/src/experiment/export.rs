//! Results to stdout and to files.

use std::path::PathBuf;

use clap::Args;
use serde_json::Value;

use crate::console::Console;
use crate::document::document;
use crate::error::CliError;
use shiftvox::whole;
use shiftvox_lab::report::plot::{self, Chart};
use shiftvox_lab::report::{Row, Table};

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct ExportArgs {
    /// All results, as --json prints them
    #[arg(long, value_name = "FILE")]
    pub(crate) export_json: Option<PathBuf>,
    /// All columns, a row per measurement
    #[arg(long, value_name = "FILE")]
    pub(crate) export_csv: Option<PathBuf>,
    /// The plots
    #[arg(long, value_name = "FILE")]
    pub(crate) export_svg: Option<PathBuf>,
    /// Replace existing files
    #[arg(long)]
    pub(crate) force: bool,
}

pub(crate) struct Results {
    pub(crate) document: Value,
    /// One row per measurement, for CSV.
    pub(crate) rows: Table,
    pub(crate) tables: Vec<Table>,
    pub(crate) charts: Vec<Chart>,
}

impl Results {
    /// Results with a row per measurement. `fields`: the document's other fields.
    pub(crate) fn of_rows(
        command: &str,
        mut fields: Value,
        rows: &[Row],
        tables: Vec<Table>,
        charts: Vec<Chart>,
    ) -> Self {
        fields["rows"] = rows.iter().map(Row::json).collect();
        Self {
            document: document(command, fields),
            rows: Table::collect(command, rows),
            tables,
            charts,
        }
    }
}

/// Fails if a file exists and may not be replaced, or if two outputs, of these and others, have one name.
pub(crate) fn check<'p>(
    args: &'p ExportArgs,
    others: impl IntoIterator<Item = &'p PathBuf>,
) -> Result<(), CliError> {
    let own = [&args.export_json, &args.export_csv, &args.export_svg];
    let paths: Vec<&PathBuf> = own.into_iter().flatten().chain(others).collect();
    for (place, path) in paths.iter().enumerate() {
        whole::check_free(path, args.force)?;
        if paths[..place].contains(path) {
            let message = format!("{}: two outputs to one file", path.display());
            return Err(CliError::usage(message));
        }
    }
    Ok(())
}

pub(crate) fn write(
    results: &Results,
    args: &ExportArgs,
    console: &Console,
) -> Result<(), CliError> {
    write_files(results, args, console)?;
    if console.json {
        console.hold(results.document.clone());
        return Ok(());
    }
    print(&results.tables, console)
}

pub(crate) fn write_files(
    results: &Results,
    args: &ExportArgs,
    console: &Console,
) -> Result<(), CliError> {
    let write = |path: &Option<PathBuf>, text: &dyn Fn() -> String| match path {
        Some(path) => console.write(path, text(), args.force),
        None => Ok(()),
    };
    write(&args.export_json, &|| format!("{:#}\n", results.document))?;
    write(&args.export_csv, &|| results.rows.csv())?;
    write(&args.export_svg, &|| plot::svg(&results.charts))
}

pub(crate) fn print(tables: &[Table], console: &Console) -> Result<(), CliError> {
    let tables: Vec<String> = tables.iter().map(Table::text).collect();
    console.data(tables.join("\n\n"))
}
