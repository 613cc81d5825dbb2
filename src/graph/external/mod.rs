//! Scenes larger than memory: a `.vxg` file built by external sort.
//!
//! The file is the one that [`Builder`](super::Builder) and [`vxg::write`](super::vxg::write()) make of the same voxels,
//! byte for byte. The stages (`spec/graph.md` has the figures):
//!
//! 1. `gather`: voxels are pushed, sorted in runs as large as memory allows, and spilled;
//! 2. `runs`: the runs are merged in Morton order;
//! 3. `finest`: attributes and clusters of 4^3 voxels are written, those at a block's face also for the blocks beside it
//!    (`halo`);
//! 4. `finest` and `tree`: block by block, normals are estimated, and the nodes of each level written when complete;
//! 5. `join`: the levels become the sections of the file.

mod buffer_sizes;
mod finest;
mod gather;
mod halo;
mod join;
mod record;
mod runs;
mod scratch;
mod tree;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::pushed::extent;
use super::vxg::{self, VxgError};
use super::{BuildError, MeshBox, Placement, Progress, Voxel};
use crate::budget::{self, DiskShortage};
use crate::whole;
use buffer_sizes::BufferSizes;
use finest::Finest;
use gather::Gather;
use join::Built;
use scratch::Scratch;
use tree::TreeWriter;

/// Bytes per pushed voxel in a temporary file.
const RUN_BYTES: u64 = 16;
const GRAPH_BYTES: u64 = 5;

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct ExternalOptions {
    /// Limit of memory in bytes, including the program; exceeded below about 64 MB.
    pub memory: u64,
    /// Folder of the temporary files; about 22 bytes per voxel of a surface.
    pub temporary: PathBuf,
}

#[derive(Debug, thiserror::Error)]
pub enum ExternalError {
    #[error(transparent)]
    Build(#[from] BuildError),
    #[error(transparent)]
    Disk(#[from] DiskShortage),
    #[error("{}: temporary files: {source}", folder.display())]
    Temporary { folder: PathBuf, source: io::Error },
    #[error(transparent)]
    Write(#[from] VxgError),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExternalReport {
    pub voxels: u64,
    pub bytes: u64,
    pub runs: u64,
    /// Most bytes that temporary files took at once, without the result.
    pub temporary_bytes: u64,
    pub temporary_written: u64,
}

#[derive(Debug)]
pub struct ExternalBuilder {
    options: ExternalOptions,
    sizes: BufferSizes,
    scratch: Arc<Scratch>,
    gather: Gather,
    mesh: Option<MeshBox>,
}

impl ExternalBuilder {
    pub fn new(options: ExternalOptions) -> Self {
        let sizes = BufferSizes::new(options.memory);
        let scratch = Scratch::new(options.temporary.clone());
        Self {
            gather: Gather::new(sizes, Arc::clone(&scratch)),
            options,
            sizes,
            scratch,
            mesh: None,
        }
    }

    #[must_use]
    pub fn of_mesh(self, mesh: MeshBox) -> Self {
        Self {
            mesh: Some(mesh),
            ..self
        }
    }

    /// Fails where so many voxels, or their graph, take more disk than is free.
    pub fn expect(&self, voxels: u64, path: &Path) -> Result<(), ExternalError> {
        budget::check_disk(&self.options.temporary, voxels.saturating_mul(RUN_BYTES))?;
        let folder = path.parent().unwrap_or(path);
        budget::check_disk(folder, voxels.saturating_mul(GRAPH_BYTES))?;
        Ok(())
    }

    pub fn most_voxels(&self) -> u64 {
        budget::free_disk(&self.options.temporary).map_or(u64::MAX, |free| free / RUN_BYTES)
    }

    pub fn push(&mut self, voxel: Voxel) {
        self.gather.push(&voxel);
    }

    /// As [`Builder::finish`](super::Builder::finish). Fails also when `path` exists and `overwrite` is false. Temporary
    /// files are removed in any case.
    pub fn finish(
        self,
        placement_world: ([f64; 3], f64),
        path: &Path,
        overwrite: bool,
        progress: &dyn Progress,
    ) -> Result<ExternalReport, ExternalError> {
        let placement = Placement {
            origin_index: self.gather.min.map(i64::from),
            world_origin: placement_world.0,
            voxel_size: placement_world.1,
            mesh: self.mesh,
        };
        placement.check_world()?;
        if self.gather.pushed == 0 {
            return Err(BuildError::Empty.into());
        }
        let extent = extent(self.gather.min, self.gather.max)?;
        whole::check_free(path, overwrite).map_err(VxgError::from)?;
        let built = self.build(extent, progress)?;
        let outline = built.outline(placement)?;
        let inner = outline.level_start[built.depth as usize];
        let nodes = u64::from(outline.level_start[built.depth as usize + 1]);
        let report = ExternalReport {
            voxels: outline.voxels,
            bytes: 0,
            runs: built.runs,
            temporary_bytes: built.scratch.peak(),
            temporary_written: built.scratch.written(),
        };
        let lengths = [
            u64::from(inner),
            4 * u64::from(inner),
            0,
            3 * nodes,
            2 * nodes,
        ];
        let mut sections = built.sections();
        progress.begin("write the graph", lengths.iter().sum());
        let bytes = vxg::write_pieces(&outline, lengths, path, overwrite, |section, put| {
            sections.hand_on(section, &outline.level_start, &mut |bytes| {
                progress.advance(bytes.len() as u64);
                put(bytes)
            })
        })?;
        progress.end();
        Ok(ExternalReport { bytes, ..report })
    }

    fn build(self, extent: [u64; 3], progress: &dyn Progress) -> Result<Built, ExternalError> {
        let Self {
            options,
            sizes,
            scratch,
            gather,
            mesh: _,
        } = self;
        let refused = |source| ExternalError::Temporary {
            folder: options.temporary.clone(),
            source,
        };
        let longest = extent.iter().copied().max().unwrap_or(1);
        let depth = longest.next_power_of_two().trailing_zeros();
        let pushed = gather.pushed;
        let (sorted, runs) = gather.merged(progress).map_err(refused)?;
        progress.begin("merge voxels", pushed);
        let finest = Finest::take(sorted, depth, &sizes, &scratch, progress).map_err(refused)?;
        progress.end();
        let voxels = finest.voxels;
        if voxels >= u64::from(u32::MAX) {
            return Err(BuildError::TooMany(voxels).into());
        }
        let mut tree = TreeWriter::new(depth, &scratch, sizes.spool_bytes);
        let centre = extent.map(|side| side as f64 / 2.0);
        progress.begin("estimate normals, average", voxels);
        let [color, normal] = finest
            .finish(&mut tree, centre, &sizes, &scratch, progress)
            .map_err(refused)?;
        let (levels, counts) = tree.finish().map_err(refused)?;
        progress.end();
        Ok(Built {
            depth,
            runs: runs as u64,
            levels,
            counts,
            color,
            normal,
            scratch,
        })
    }
}
