use std::path::Path;

use super::generate::Spec;
use super::mesh::MeshReader;
use super::open::{self, OpenOptions};
use super::open_error::OpenError;
use super::{FileKind, ReadOptions, SceneError, Source};
use crate::graph::{BuildError, ExternalBuilder, ExternalOptions, ExternalReport, Progress, vxg};

#[derive(Debug)]
pub struct BuiltFile {
    pub voxels: u64,
    pub bytes: u64,
    pub warnings: Vec<String>,
    /// Cost of building; `None` for a cyclic scene, which has a few nodes.
    pub report: Option<ExternalReport>,
}

/// Builds a `.vxg` file of a scene within a limit of memory: the file that [`open_source`](super::open_source) and
/// [`vxg::write`] make. A `.vox` file, of at most 4 GB, is held in addition. A `.vxg` file is rejected as input.
pub fn build_file(
    source: Source,
    options: &OpenOptions,
    meshes: &dyn MeshReader,
    external: ExternalOptions,
    output: &Path,
    overwrite: bool,
    progress: &dyn Progress,
) -> Result<BuiltFile, OpenError> {
    let name = source.name();
    let failed = |error| OpenError::Build {
        source_name: name.clone(),
        error,
    };
    let mut builder = ExternalBuilder::new(external.clone());
    let mut warnings = Vec::new();
    let mut placement = open::UNIT;
    match source {
        Source::Generated(spec) => {
            let spec = Spec::parse(&spec)?;
            if let Some(graph) = spec.linked() {
                vxg::write(&graph, output, overwrite)?;
                return Ok(BuiltFile {
                    voxels: graph.voxels,
                    bytes: std::fs::metadata(output).map_or(0, |file| file.len()),
                    warnings,
                    report: None,
                });
            }
            let least = spec.least_voxels();
            if least >= u64::from(u32::MAX) {
                return Err(failed(BuildError::TooMany(least).into()));
            }
            builder.expect(least, output).map_err(failed)?;
            spec.voxels(&mut |voxel| builder.push(voxel), progress);
        }
        Source::File(file) if file.kind().is_some_and(FileKind::is_mesh) => {
            let folder = file.path().parent().map(Path::to_owned);
            let ready = meshes.read(file.mesh_file(folder)?, progress)?;
            if let Some(voxels) = ready.expected_voxels(progress) {
                if voxels >= u64::from(u32::MAX) {
                    return Err(failed(BuildError::TooMany(voxels).into()));
                }
                builder.expect(voxels, output).map_err(failed)?;
            }
            let mut external = external;
            external.memory = external.memory.saturating_sub(ready.bytes());
            builder = ExternalBuilder::new(external).of_mesh(ready.mesh_box());
            placement = ready.placement();
            let (found, _) = ready.voxels(&mut |v| builder.push(v), progress);
            warnings = found.warnings;
        }
        Source::File(file) => {
            let wanted = options.read.most_voxels;
            let read = ReadOptions {
                most_voxels: wanted.min(builder.most_voxels()),
                ..options.read.clone()
            };
            let found = file.read_voxels(&read, &mut |voxel| builder.push(voxel), progress);
            let found = match found {
                // The limit was the builder's room, not the caller's.
                Err(SceneError::TooMany { voxels, most, .. }) if most < wanted => {
                    builder.expect(voxels, output).map_err(failed)?;
                    found?
                }
                found => found?,
            };
            placement = open::placement(&found);
            warnings = found.warnings;
        }
    }
    let report = builder
        .finish(placement, output, overwrite, progress)
        .map_err(failed)?;
    Ok(BuiltFile {
        voxels: report.voxels,
        bytes: report.bytes,
        warnings,
        report: Some(report),
    })
}
