//! Test vectors of the machine's blocks, for whoever builds them in hardware.
//!
//! For the first records of a frame, all that went into and came out of each
//! block, as `$readmemh` files: one row a line, a file of inputs and one of
//! outputs a block, and a manifest that names every bit. The rows are what
//! the machine itself computed while it drew, and then for inputs that no
//! frame brings: ends of ranges, ties, random numbers. `docs/vectors.md`
//! describes their use.

mod blending;
mod blocks;
mod description;
mod folder;
mod frame_image;
mod manifest;
mod manifest_fields;
mod ports;
mod readme;
mod recorder;
mod rows;
mod turns;

use std::path::Path;

use hwmodel::Overflow;
use hwmodel::cycles::Organisation;

pub use blocks::describe;
pub use description::{Description, absence};
pub use folder::{FolderError, check_free};
pub use ports::{Field, Ports};

use recorder::Recorder;
use shiftvox::frame::Frame;
use shiftvox::graph::{GraphView, NodeLayout};
use shiftvox::machine::{Machine, MachineOptions};
use shiftvox::project::{EngineError, FrameSetup};
use shiftvox::whole::{self, WholeError};

/// Version of the manifest and of what blocks there are.
pub const SCHEMA: u32 = 5;

/// Rounds of inputs that are made for the blocks, beside those of the frame.
const DIRECTED_ROUNDS: u32 = 200;

/// What is to be recorded, and where.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// The scene's name, for the manifest.
    pub scene: &'a str,
    /// Records from the frame's first on; what leads to the first is recorded too.
    pub records: u64,
    /// What a result that does not fit its word becomes.
    pub overflow: Overflow,
    /// What the record loop keeps where: turns are those of a machine organised like this.
    pub organisation: Organisation,
    /// The folder; its parents are made.
    pub folder: &'a Path,
    /// Whether older vectors there are replaced.
    pub overwrite: bool,
}

/// What was recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Recorded {
    /// Blocks with rows.
    pub blocks: usize,
    /// Rows of all blocks.
    pub rows: u64,
}

/// Why there are no vectors. Whatever stood in the folder's place still does.
#[derive(Debug, thiserror::Error)]
pub enum VectorsError {
    /// The machine could not finish the frame.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The folder cannot be written.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// A file in it cannot.
    #[error(transparent)]
    Store(#[from] WholeError),
    /// A value is too large for the wires that the manifest gives it: a
    /// constant of the frame beyond its word.
    #[error("a value at block {0} does not fit its wires: use wider words")]
    Misfit(&'static str),
    /// A block that is missing from the manifest.
    #[error("the machine has no block {0}")]
    Unknown(u32),
    /// The manifest has no text.
    #[error("{0}")]
    Manifest(#[from] serde_json::Error),
}

/// Draws a frame and records the borders of the machine's blocks.
///
/// # Errors
/// See [`VectorsError`].
pub fn write(
    graph: &GraphView<'_>,
    setup: &FrameSetup,
    request: &Request<'_>,
) -> Result<Recorded, VectorsError> {
    folder::write(request.folder, request.overwrite, |folder| {
        let mut frame = Frame::new(setup.width, setup.height, false);
        // What is left of it under the frame's rules, as the machine has it.
        let organisation = match setup.options.coverage.draws_outlines() {
            true => request.organisation,
            false => request.organisation.without_outlines(),
        };
        let layout = NodeLayout::new(graph, organisation.leaf_masks, organisation.bricks);
        let mut machine = Machine::new(MachineOptions {
            overflow: request.overflow,
            organisation,
            ..MachineOptions::default()
        });
        let recorder = Recorder::new(folder, setup, request.records, organisation.stack)?;
        let (stats, mut recorder) = machine.render_probed(graph, setup, &mut frame, recorder)?;
        recorder.begin_directed();
        let recorder = machine.show_directed(graph, setup, recorder, DIRECTED_ROUNDS);
        let (recordings, turns) = recorder.finish()?;
        let found = (&recordings[..], turns.as_ref());
        let manifest = manifest::document(setup, request, graph.mask.len(), &stats, found);
        let text = serde_json::to_string_pretty(&manifest)? + "\n";
        whole::write(&folder.join(folder::MANIFEST), text.as_bytes(), false)?;
        let write =
            |name: &str, text: &str| whole::write(&folder.join(name), text.as_bytes(), false);
        write(folder::PARAMETERS, &readme::parameters(setup))?;
        write(
            frame_image::CONSTANTS,
            &frame_image::constants(setup, graph, &layout),
        )?;
        if let Some(nodes) = frame_image::nodes(graph, &layout) {
            write(frame_image::NODES, &nodes)?;
        }
        for recording in recordings.iter().filter(|recording| recording.rows > 0) {
            let name = format!("{}_tb.{}", recording.description.name, folder::VERILOG);
            write(&name, &readme::testbench(setup.format, recording))?;
        }
        let readme = readme::text(setup.format, &recordings);
        whole::write(&folder.join(folder::README), readme.as_bytes(), false)?;
        Ok(Recorded {
            blocks: recordings.iter().filter(|r| r.rows > 0).count(),
            rows: recordings.iter().map(|r| r.rows).sum(),
        })
    })
}
