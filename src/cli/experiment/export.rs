//! Results to stdout and to files.

use std::path::PathBuf;

use clap::Args;
use comfy_table::CellAlignment;
use comfy_table::presets::NOTHING;
use serde_json::Value;

use crate::cli::console::Console;
use crate::cli::error::CliError;
use crate::report::plot::{self, Panel};
use crate::report::{Cell, Table};
use crate::whole;

/// Files that the results are written to.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Output")]
pub(in crate::cli) struct ExportArgs {
    /// All results, as --json prints them
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) export_json: Option<PathBuf>,
    /// A plot
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) export_svg: Option<PathBuf>,
    /// Replace files that exist
    #[arg(long)]
    pub(in crate::cli) force: bool,
}

/// The results of an experiment in all forms.
pub(in crate::cli) struct Results {
    /// The JSON document.
    pub(in crate::cli) document: Value,
    /// What people read.
    pub(in crate::cli) tables: Vec<Table>,
    /// The plot.
    pub(in crate::cli) panels: Vec<Panel>,
}

/// Fails before the work where a file would be replaced without `--force`, or two be one.
pub(in crate::cli) fn check(args: &ExportArgs) -> Result<(), CliError> {
    let paths: Vec<&PathBuf> = [&args.export_json, &args.export_svg]
        .into_iter()
        .flatten()
        .collect();
    for (place, path) in paths.iter().enumerate() {
        whole::check_free(path, args.force)?;
        if paths[..place].contains(path) {
            return Err(CliError::usage(format!(
                "{}: two exports to one file",
                path.display()
            )));
        }
    }
    Ok(())
}

/// Writes the files, then prints.
pub(in crate::cli) fn write(
    results: &Results,
    args: &ExportArgs,
    console: &Console,
) -> Result<(), CliError> {
    write_files(results, args, console)?;
    if console.json {
        return console.document(&results.document);
    }
    print(&results.tables, console)
}

/// Writes the files.
pub(in crate::cli) fn write_files(
    results: &Results,
    args: &ExportArgs,
    console: &Console,
) -> Result<(), CliError> {
    let file = |path: &Option<PathBuf>, text: &dyn Fn() -> Result<String, CliError>| {
        let Some(path) = path else { return Ok(()) };
        whole::write(path, text()?.as_bytes(), args.force)?;
        console.note(format!("{}: written", path.display()));
        Ok::<(), CliError>(())
    };
    file(&args.export_json, &|| {
        Ok(format!("{:#}\n", results.document))
    })?;
    file(&args.export_svg, &|| Ok(plot::svg(&results.panels)?))
}

/// The same where plots were written before, one file a scene.
pub(in crate::cli) fn write_without_plots(
    results: &Results,
    args: &ExportArgs,
    console: &Console,
) -> Result<(), CliError> {
    let args = ExportArgs {
        export_svg: None,
        ..args.clone()
    };
    write(results, &args, console)
}

/// What tables look like on a terminal, one below the other.
pub(in crate::cli) fn print(tables: &[Table], console: &Console) -> Result<(), CliError> {
    let tables: Vec<String> = tables.iter().map(in_text).collect();
    console.data(tables.join("\n\n"))
}

/// A table for a terminal, under its title: words to the left, numbers to the right.
fn in_text(table: &Table) -> String {
    let mut text = comfy_table::Table::new();
    text.load_style(NOTHING)
        .set_header(table.columns.iter().map(|name| name.replace('_', " ")));
    for row in &table.rows {
        text.add_row(row.iter().map(Cell::for_people));
    }
    for column in 0..table.columns.len() {
        if !table.is_of_words(column)
            && let Some(column) = text.column_mut(column)
        {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    format!("{}\n\n{}", table.title, text.trim_fmt())
}
