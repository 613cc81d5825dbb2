//! Pictures, plots by scene and pages of the experiments that compare pictures.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::console::Console;
use crate::cli::error::{CliError, Kind};
use crate::cli::experiment::export::ExportArgs;
use crate::cli::experiment::subjects::file_stem;
use crate::cli::names;
use crate::measure::difference;
use crate::picture::png;
use crate::report::html::Page;
use crate::report::plot::{self, Panel};
use crate::whole;

/// A page beside the files of every experiment.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Output")]
pub(super) struct PagesArgs {
    /// One page with tables, plots and pictures, which needs no other file
    #[arg(long, value_name = "FILE")]
    pub(super) export_html: Option<PathBuf>,
}

/// What stands for a scene in the name of a file of plots.
const SCENE_FIELD: &str = "{scene}";

/// Fails before the work where a file would be replaced without `--force`.
pub(super) fn check(
    args: &PagesArgs,
    export: &ExportArgs,
    scenes: &[String],
) -> Result<(), CliError> {
    if let Some(path) = &args.export_html {
        whole::check_free(path, export.force)?;
        let others = [&export.export_json, &export.export_svg];
        if others.into_iter().flatten().any(|other| other == path) {
            let message = format!("{}: two exports to one file", path.display());
            return Err(CliError::usage(message));
        }
    }
    for path in svg_paths(export, scenes) {
        whole::check_free(&path, export.force)?;
    }
    Ok(())
}

/// Where each scene's plots go: where the name says `{scene}`, each to a file of its own.
fn svg_paths(export: &ExportArgs, scenes: &[String]) -> Vec<PathBuf> {
    let Some(path) = export.export_svg.as_ref() else {
        return Vec::new();
    };
    let text = names::of_path(path);
    if !text.contains(SCENE_FIELD) {
        return vec![path.clone()];
    }
    let of = |scene: &String| names::path(&text.replace(SCENE_FIELD, &file_stem(scene)));
    scenes.iter().map(of).collect()
}

/// Writes plots by scene: one file, or one for each.
pub(super) fn write_plots(
    export: &ExportArgs,
    scenes: &[(String, Vec<Panel>)],
    console: &Console,
) -> Result<(), CliError> {
    let names: Vec<String> = scenes.iter().map(|(name, _)| name.clone()).collect();
    let paths = svg_paths(export, &names);
    let write = |path: &Path, panels: &[Panel]| {
        whole::write(path, plot::svg(panels)?.as_bytes(), export.force)?;
        console.note(format!("{}: written", path.display()));
        Ok::<(), CliError>(())
    };
    if let ([path], true) = (&paths[..], scenes.len() != 1) {
        let all: Vec<Panel> = scenes
            .iter()
            .flat_map(|(_, panels)| panels.clone())
            .collect();
        return write(path, &all);
    }
    paths
        .iter()
        .zip(scenes)
        .try_for_each(|(path, (_, panels))| write(path, panels))
}

/// Writes a page, if one is wanted.
pub(super) fn write_page(
    args: &PagesArgs,
    export: &ExportArgs,
    page: impl FnOnce() -> Result<Page, CliError>,
    console: &Console,
) -> Result<(), CliError> {
    let Some(path) = &args.export_html else {
        return Ok(());
    };
    whole::write(path, page()?.finish().as_bytes(), export.force)?;
    console.note(format!("{}: written", path.display()));
    Ok(())
}

/// The page's mention of a plot: one figure for each panel, drawn alone.
pub(super) fn plots(page: &mut Page, panels: &[Panel], caption: &str) -> Result<(), CliError> {
    for panel in panels {
        page.plot(&plot::svg(std::slice::from_ref(panel))?, caption);
    }
    Ok(())
}

/// Columns between the pictures of a strip.
const GAP: usize = 4;

/// Result, reference and difference of one size side by side, as a PNG file.
pub(super) fn strip(
    (width, height): (u32, u32),
    result: &[[u8; 4]],
    reference: &[[u8; 4]],
) -> Result<Vec<u8>, CliError> {
    let apart = difference((width, height, result), (width, height, reference));
    let apart = apart.map_err(|e| CliError::new(Kind::Run, e))?;
    side_by_side(width as usize, [result, reference, &apart].into_iter())
}

/// Pictures of one size side by side, as a PNG file. `width`: pixels across of each.
pub(super) fn side_by_side<'p>(
    width: usize,
    pictures: impl Iterator<Item = &'p [[u8; 4]]> + Clone,
) -> Result<Vec<u8>, CliError> {
    let height = pictures.clone().next().map_or(0, <[_]>::len) / width.max(1);
    let mut strip = Vec::new();
    for y in 0..height {
        for (place, picture) in pictures.clone().enumerate() {
            if place > 0 {
                strip.extend([[255; 4]; GAP]);
            }
            strip.extend(&picture[y * width..(y + 1) * width]);
        }
    }
    let across = strip.len() / height.max(1);
    png::encode(across as u32, height as u32, &strip).map_err(|e| CliError::new(Kind::Run, e))
}
