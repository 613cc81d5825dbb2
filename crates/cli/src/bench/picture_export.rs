//! Pictures, plots by scene and pages of the experiments that compare pictures.

use std::path::{Path, PathBuf};

use crate::console::Console;
use crate::error::CliError;
use crate::experiment::export::ExportArgs;
use crate::experiment::subjects::file_stem;
use crate::names;
use shiftvox::whole;
use shiftvox_lab::report::html::Page;
use shiftvox_lab::report::plot::{self, Panel};

/// What stands for a scene in the name of a file of plots.
const SCENE_FIELD: &str = "{scene}";

/// Fails before the work where a file would be replaced without `--force`.
pub(super) fn check(export: &ExportArgs, scenes: &[String]) -> Result<(), CliError> {
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
        whole::write(path, plot::svg(panels).as_bytes(), export.force)?;
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

/// The page's mention of a plot: one figure for each panel, drawn alone.
pub(super) fn plots(page: &mut Page, panels: &[Panel], caption: &str) -> Result<(), CliError> {
    for panel in panels {
        page.plot(&plot::svg(std::slice::from_ref(panel)), caption);
    }
    Ok(())
}
