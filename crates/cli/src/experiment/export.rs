//! Results to stdout and to files.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::Value;

use super::subjects::file_stem;
use crate::console::Console;
use crate::document::document;
use crate::error::CliError;
use crate::names;
use shiftvox::whole;
use shiftvox_lab::report::plot::{self, Panel};
use shiftvox_lab::report::{Row, Table};

/// The placeholder for a scene in the name of a plot's file.
const SCENE_FIELD: &str = "{scene}";

/// Files of results.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct ExportArgs {
    /// All results, as --json prints them
    #[arg(long, value_name = "FILE")]
    pub(crate) export_json: Option<PathBuf>,
    /// All columns, a row per measurement
    #[arg(long, value_name = "FILE")]
    pub(crate) export_csv: Option<PathBuf>,
    /// The tables, with computer and command
    #[arg(long, value_name = "FILE")]
    pub(crate) export_markdown: Option<PathBuf>,
    /// The plots; of bench, `{scene}` in the name makes a file per scene
    #[arg(long, value_name = "FILE")]
    pub(crate) export_svg: Option<PathBuf>,
    /// Replace existing files
    #[arg(long)]
    pub(crate) force: bool,
}

/// The results of an experiment.
pub(crate) struct Results {
    /// The JSON document.
    pub(crate) document: Value,
    /// One row per measurement: CSV.
    pub(crate) rows: Table,
    /// Tables for stdout and Markdown.
    pub(crate) tables: Vec<Table>,
    /// More tables for Markdown.
    pub(crate) more_tables: Vec<Table>,
    /// Text above the tables in Markdown.
    pub(crate) preface: String,
    /// The plots.
    pub(crate) panels: Vec<Panel>,
}

impl Results {
    /// The results of an experiment whose measurements are rows. `fields`: the others of the document.
    pub(crate) fn of_rows(
        command: &str,
        mut fields: Value,
        preface: String,
        rows: &[Row],
        tables: Vec<Table>,
    ) -> Self {
        fields["rows"] = rows.iter().map(Row::json).collect();
        Self {
            document: document(command, fields),
            rows: Table::collect(command, rows),
            tables,
            more_tables: Vec::new(),
            preface,
            panels: Vec::new(),
        }
    }
}

/// Fails before the work if a file would be replaced without `--force`, or two outputs have one
/// name.
pub(crate) fn check(args: &ExportArgs) -> Result<(), CliError> {
    check_with(args, [])
}

/// [`check`], with files that are written beside these.
pub(crate) fn check_with<'p>(
    args: &'p ExportArgs,
    others: impl IntoIterator<Item = &'p PathBuf>,
) -> Result<(), CliError> {
    let own = [
        &args.export_json,
        &args.export_csv,
        &args.export_markdown,
        &args.export_svg,
    ];
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

/// [`check`], where scenes have plots of their own.
pub(crate) fn check_plots(args: &ExportArgs, scenes: &[String]) -> Result<(), CliError> {
    check(args)?;
    scenes
        .iter()
        .try_for_each(|scene| match plot_path(args, scene) {
            Some(path) => Ok(whole::check_free(&path, args.force)?),
            None => Ok(()),
        })
}

/// The file of a scene's plots, if each scene has its own.
fn plot_path(args: &ExportArgs, scene: &str) -> Option<PathBuf> {
    let text = names::of_path(args.export_svg.as_ref()?);
    let has_field = text.contains(SCENE_FIELD);
    has_field.then(|| names::path(&text.replace(SCENE_FIELD, &file_stem(scene))))
}

/// [`write`], with plots by scene: in a file each, if the name asks for it, or in one file.
pub(crate) fn write_with_plots(
    results: &Results,
    scenes: &[(String, Vec<Panel>)],
    args: &ExportArgs,
    console: &Console,
) -> Result<(), CliError> {
    for (scene, panels) in scenes {
        if let Some(path) = plot_path(args, scene) {
            file(&path, &plot::svg(panels), args, console)?;
        }
    }
    let has_plots = scenes
        .iter()
        .any(|(scene, _)| plot_path(args, scene).is_some());
    if let Some(path) = args.export_svg.as_ref().filter(|_| !has_plots) {
        let all: Vec<Panel> = scenes
            .iter()
            .flat_map(|(_, panels)| panels.clone())
            .collect();
        file(path, &plot::svg(&all), args, console)?;
    }
    let args = ExportArgs {
        export_svg: None,
        ..args.clone()
    };
    write(results, &args, console)
}

fn file(path: &Path, text: &str, args: &ExportArgs, console: &Console) -> Result<(), CliError> {
    whole::write(path, text.as_bytes(), args.force)?;
    console.note(format!("{}: written", path.display()));
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
    let write = |path: &Option<PathBuf>, text: &dyn Fn() -> String| match path {
        Some(path) => file(path, &text(), args, console),
        None => Ok(()),
    };
    write(&args.export_json, &|| format!("{:#}\n", results.document))?;
    write(&args.export_csv, &|| results.rows.csv())?;
    write(&args.export_markdown, &|| {
        let tables = results.tables.iter().chain(&results.more_tables);
        let tables: Vec<String> = tables.map(Table::markdown).collect();
        format!("{}\n{}", results.preface, tables.join("\n"))
    })?;
    write(&args.export_svg, &|| plot::svg(&results.panels))
}

/// Prints tables one below the other.
pub(crate) fn print(tables: &[Table], console: &Console) -> Result<(), CliError> {
    let tables: Vec<String> = tables.iter().map(Table::text).collect();
    console.data(tables.join("\n\n"))
}
