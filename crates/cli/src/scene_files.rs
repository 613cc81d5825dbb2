//! Scenes written to files.

use std::path::Path;

use serde_json::json;

use super::console::Console;
use super::error::{CliError, Kind};
use super::report;
use super::scenes::Scene;
use shiftvox::budget;
use shiftvox::graph::{Graph, Progress, Voxel, vxg};
use shiftvox::scene;
use shiftvox::whole;

/// Least bytes of a node in a `.vxg`, of a voxel in a `.ply` and in a `.vox`.
const NODE_BYTES: u64 = 5;
const PLY_BYTES: u64 = 27;
const VOX_BYTES: u64 = 4;

#[derive(Debug)]
pub(super) struct Written {
    /// Voxels or triangles.
    pub(super) what: &'static str,
    pub(super) count: u64,
    pub(super) bytes: u64,
    pub(super) warnings: Vec<String>,
}

impl Written {
    pub(super) fn report(&self, command: &str, input: &str, output: &Path, console: &Console) {
        for warning in &self.warnings {
            console.note(format!("{}: {warning}", output.display()));
        }
        console.note(format!(
            "{}: {} {}, {} bytes",
            output.display(),
            report::grouped(self.count),
            self.what,
            report::grouped(self.bytes)
        ));
        let fields = json!({
            "input": input,
            "output": output.display().to_string(),
            self.what: self.count,
            "bytes": self.bytes,
            "warnings": self.warnings,
        });
        console.report(command, fields);
    }
}

pub(super) fn check_ending(output: &Path) -> Result<(), CliError> {
    match output.extension().and_then(|e| e.to_str()) {
        Some("vxg" | "vox" | "ply") => Ok(()),
        _ => Err(CliError::usage(format!(
            "{}: cannot tell the format to write from the ending",
            output.display()
        ))
        .advise("end the name in .vxg, .vox or .ply; of a mesh also in .far or .tvx")),
    }
}

pub(super) fn write(
    scene: &Scene,
    output: &Path,
    force: bool,
    progress: &dyn Progress,
) -> Result<Written, CliError> {
    let graph = &scene.graph;
    let mut warnings = Vec::new();
    let ending = output.extension().and_then(|e| e.to_str()).unwrap_or("");
    let least = match ending {
        "vxg" => NODE_BYTES * graph.len() as u64,
        "ply" => graph.voxels.saturating_mul(PLY_BYTES),
        _ => graph.voxels.saturating_mul(VOX_BYTES),
    };
    budget::check_disk(whole::folder_of(output), least)?;
    progress.begin("writing", 0);
    match ending {
        "vxg" => whole::write_with(output, force, |file| {
            vxg::write_to(graph, file).map_err(std::io::Error::other)
        })?,
        "vox" => {
            let mut writer = scene::VoxWriter::new();
            for voxel in voxels(graph)? {
                writer.add(voxel);
            }
            whole::write_with(output, force, |file| {
                let written = writer.write(file)?;
                if written.colors_given > written.colors_kept {
                    warnings.push(format!(
                        "{} colours were reduced to the {} that a .vox holds",
                        written.colors_given, written.colors_kept
                    ));
                }
                Ok(())
            })?;
        }
        "ply" => {
            let all = voxels(graph)?;
            whole::write_with(output, force, |file| {
                scene::write_ply(file, all, true).map(|_| ())
            })?;
        }
        _ => check_ending(output)?,
    }
    let side = graph.placement.voxel_size;
    if ending != "vxg" && side != 1.0 {
        warnings.push(format!(
            "a .{ending} holds no size of voxels, and theirs is {side}; a .vxg keeps it"
        ));
    }
    progress.end();
    let bytes = std::fs::metadata(output).map_or(0, |m| m.len());
    Ok(Written {
        what: "voxels",
        count: graph.voxels,
        bytes,
        warnings,
    })
}

/// The finest voxels of a graph at their file indices; a large leaf is many.
fn voxels(graph: &Graph) -> Result<impl Iterator<Item = Voxel> + '_, CliError> {
    let voxels = graph.finest_voxels();
    voxels.map_err(|error| {
        let error = CliError::new(Kind::Limit, error.to_string());
        error.advise("write a .vxg, or convert a scene of fewer levels")
    })
}
