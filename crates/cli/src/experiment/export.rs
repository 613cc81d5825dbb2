//! Results to stdout and to files.

use std::path::PathBuf;

use clap::Args;
use comfy_table::CellAlignment;
use comfy_table::presets::NOTHING;
use serde_json::Value;

use crate::console::Console;
use crate::error::CliError;
use shiftvox::whole;
use shiftvox_lab::report::plot::{self, Panel};
use shiftvox_lab::report::{Cell, Table};

/// Files that the results are written to.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct ExportArgs {
    /// All results, as --json prints them
    #[arg(long, value_name = "FILE")]
    pub(crate) export_json: Option<PathBuf>,
    /// A row for each measurement
    #[arg(long, value_name = "FILE")]
    pub(crate) export_csv: Option<PathBuf>,
    /// The tables, with machine and command
    #[arg(long, value_name = "FILE")]
    pub(crate) export_markdown: Option<PathBuf>,
    /// A plot
    #[arg(long, value_name = "FILE")]
    pub(crate) export_svg: Option<PathBuf>,
    /// Replace files that exist
    #[arg(long)]
    pub(crate) force: bool,
}

/// The results of an experiment in all forms.
pub(crate) struct Results {
    /// The JSON document.
    pub(crate) document: Value,
    /// The measurements, one a row: CSV.
    pub(crate) rows: Table,
    /// What people read: stdout and Markdown.
    pub(crate) tables: Vec<Table>,
    /// What Markdown has beside those.
    pub(crate) more_tables: Vec<Table>,
    /// What stands above the tables in Markdown.
    pub(crate) preface: String,
    /// The plot.
    pub(crate) panels: Vec<Panel>,
}

impl ExportArgs {
    /// All files.
    fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        let all = [
            &self.export_json,
            &self.export_csv,
            &self.export_markdown,
            &self.export_svg,
        ];
        all.into_iter().flatten()
    }
}

/// Fails before the work where a file would be replaced without `--force`, or two be one.
pub(crate) fn check(args: &ExportArgs) -> Result<(), CliError> {
    check_with(args, [])
}

/// [`check`], with files that are written beside these.
pub(crate) fn check_with<'p>(
    args: &'p ExportArgs,
    others: impl IntoIterator<Item = &'p PathBuf>,
) -> Result<(), CliError> {
    let paths: Vec<&PathBuf> = args.paths().chain(others).collect();
    for (place, path) in paths.iter().enumerate() {
        whole::check_free(path, args.force)?;
        if paths[..place].contains(path) {
            return Err(CliError::usage(format!(
                "{}: two outputs to one file",
                path.display()
            )));
        }
    }
    Ok(())
}

/// Writes the files, then prints.
pub(crate) fn write(
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
pub(crate) fn write_files(
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
    file(&args.export_csv, &|| Ok(results.rows.csv()))?;
    file(&args.export_markdown, &|| {
        let tables = results.tables.iter().chain(&results.more_tables);
        let tables = tables.map(Table::markdown);
        let tables: Vec<String> = tables.collect();
        Ok(format!("{}\n{}", results.preface, tables.join("\n")))
    })?;
    file(&args.export_svg, &|| Ok(plot::svg(&results.panels)))
}

/// The same where plots were written before, one file a scene.
pub(crate) fn write_without_plots(
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
pub(crate) fn print(tables: &[Table], console: &Console) -> Result<(), CliError> {
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
