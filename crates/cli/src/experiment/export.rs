//! Results to stdout and to files.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::Value;

use super::subjects::file_stem;
use crate::console::Console;
use crate::document::document;
use crate::error::CliError;
use crate::outputs;
use shiftvox::whole;
use shiftvox_lab::report::plot::{self, Panel};
use shiftvox_lab::report::{Row, Table};

const SCENE_FIELD: &str = "{scene}";

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct ExportArgs {
    /// All results, as --json prints them
    #[arg(long, value_name = "FILE")]
    pub(crate) export_json: Option<PathBuf>,
    /// All columns, a row per measurement
    #[arg(long, value_name = "FILE")]
    pub(crate) export_csv: Option<PathBuf>,
    /// The plots; of bench, `{scene}` in the name makes a file per scene
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
    pub(crate) panels: Vec<Panel>,
}

impl Results {
    /// Results with a row per measurement. `fields`: the document's other fields.
    pub(crate) fn of_rows(
        command: &str,
        mut fields: Value,
        rows: &[Row],
        tables: Vec<Table>,
    ) -> Self {
        fields["rows"] = rows.iter().map(Row::json).collect();
        Self {
            document: document(command, fields),
            rows: Table::collect(command, rows),
            tables,
            panels: Vec::new(),
        }
    }
}

/// Fails if a file exists and may not be replaced, or if two outputs, of these and others, have one name.
pub(crate) fn check<'p>(
    args: &'p ExportArgs,
    others: impl IntoIterator<Item = &'p PathBuf>,
) -> Result<(), CliError> {
    let ExportArgs {
        export_json,
        export_csv,
        export_svg,
        force,
    } = args;
    let own = [export_json, export_csv, export_svg];
    let paths: Vec<&PathBuf> = own.into_iter().flatten().chain(others).collect();
    for (place, path) in paths.iter().enumerate() {
        whole::check_free(path, *force)?;
        if paths[..place].contains(path) {
            let message = format!("{}: two outputs to one file", path.display());
            return Err(CliError::usage(message));
        }
    }
    Ok(())
}

pub(crate) fn check_plots(args: &ExportArgs, scenes: &[String]) -> Result<(), CliError> {
    check(args, [])?;
    if let Some(path) = &args.export_svg {
        outputs::check_text(path)?;
    }
    for path in scenes.iter().filter_map(|scene| plot_path(args, scene)) {
        whole::check_free(&path, args.force)?;
    }
    Ok(())
}

fn plot_path(args: &ExportArgs, scene: &str) -> Option<PathBuf> {
    let text = args.export_svg.as_ref()?.to_str()?;
    let has_field = text.contains(SCENE_FIELD);
    has_field.then(|| text.replace(SCENE_FIELD, &file_stem(scene)).into())
}

/// [`write`], with plots by scene: in one file, or in a file each if the name has [`SCENE_FIELD`].
pub(crate) fn write_with_plots(
    mut results: Results,
    scenes: Vec<(String, Vec<Panel>)>,
    args: &ExportArgs,
    console: &Console,
) -> Result<(), CliError> {
    let mut args = args.clone();
    for (scene, panels) in scenes {
        match plot_path(&args, &scene) {
            Some(path) => file(&path, &plot::svg(&panels), &args, console)?,
            None => results.panels.extend(panels),
        }
    }
    args.export_svg = args
        .export_svg
        .filter(|path| !path.to_string_lossy().contains(SCENE_FIELD));
    write(&results, &args, console)
}

fn file(path: &Path, text: &str, args: &ExportArgs, console: &Console) -> Result<(), CliError> {
    whole::write(path, text.as_bytes(), args.force)?;
    console.written(path);
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
        Some(path) => file(path, &text(), args, console),
        None => Ok(()),
    };
    write(&args.export_json, &|| format!("{:#}\n", results.document))?;
    write(&args.export_csv, &|| results.rows.csv())?;
    write(&args.export_svg, &|| plot::svg(&results.panels))
}

pub(crate) fn print(tables: &[Table], console: &Console) -> Result<(), CliError> {
    let tables: Vec<String> = tables.iter().map(Table::text).collect();
    console.data(tables.join("\n\n"))
}
