//! Test vectors of the machine's blocks, for hardware designers.
//!
//! For the first records of a frame, the inputs and outputs of every block: one file per block, one row per line of JSON,
//! and a manifest that describes every bit. The rows are computed by the machine while it draws. Further rows follow for
//! inputs that frames seldom have: ends of ranges, ties, random numbers. `docs/vectors.md` describes the format.

mod blocks;
mod folder;
mod frame_image;
mod manifest;
mod ports;
mod recorder;

use std::path::Path;

use hwmodel::Overflow;
use hwmodel::cycles::Organisation;

pub use folder::check_free;

use super::frame::machine;
use recorder::Recorder;
use shiftvox::frame::Frame;
use shiftvox::graph::{GraphView, NodeLayout, PackedNormal};
use shiftvox::project::{EngineError, FrameSetup};
use shiftvox::whole::{self, WholeError};

/// Version of the manifest and of what blocks there are.
pub const SCHEMA: u32 = 6;

/// Rounds of inputs that are made for the blocks.
const DIRECTED_ROUNDS: u32 = 200;

#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    pub scene: &'a str,
    /// Of the nodes.
    pub color: &'a [[u8; 3]],
    pub normal: &'a [PackedNormal],
    /// Number of records, from the first. The object's first push is recorded, too.
    pub records: u64,
    pub overflow: Overflow,
    pub organisation: Organisation,
    pub folder: &'a Path,
    pub overwrite: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Recorded {
    pub blocks: usize,
    pub rows: u64,
}

/// Why there are no vectors.
#[derive(Debug, thiserror::Error)]
pub enum VectorsError {
    #[error(transparent)]
    Engine(#[from] EngineError),
    #[error(transparent)]
    Store(#[from] WholeError),
    #[error("a value at block {0} does not fit its wires: use wider words")]
    Misfit(&'static str),
}

pub fn write(
    graph: &GraphView<'_>,
    setup: &FrameSetup,
    request: &Request<'_>,
) -> Result<Recorded, VectorsError> {
    folder::write(request.folder, request.overwrite, |folder| {
        let mut frame = Frame::new(setup.width, setup.height, false);
        // The part of it that the frame's rules allow, as in the machine.
        let organisation = match setup.options.coverage.draws_outlines() {
            true => request.organisation,
            false => request.organisation.without_outlines(),
        };
        let layout = NodeLayout::new(graph, organisation.leaf_masks, organisation.bricks);
        let mut machine = machine(request.overflow, organisation);
        let recorder = Recorder::new(folder, setup, request.records, organisation.stack)?;
        let (stats, mut recorder) = machine.render_probed(graph, setup, &mut frame, recorder)?;
        recorder.begin_directed();
        let recorder = machine.show_directed(graph, setup, recorder, DIRECTED_ROUNDS)?;
        let (recordings, turns) = recorder.finish()?;
        let found = (&recordings[..], turns.as_ref());
        let manifest = manifest::document(setup, request, graph.mask.len(), &stats, found);
        let mut files = vec![
            (folder::MANIFEST, format!("{manifest:#}\n")),
            (
                frame_image::CONSTANTS,
                frame_image::constants(setup, graph, &layout),
            ),
            (
                frame_image::ATTRIBUTES,
                frame_image::attributes(request.color, request.normal),
            ),
        ];
        files.extend(frame_image::nodes(graph, &layout).map(|nodes| (frame_image::NODES, nodes)));
        for (name, text) in files {
            whole::write(&folder.join(name), text.as_bytes(), false)?;
        }
        Ok(Recorded {
            blocks: recordings.iter().filter(|r| r.rows > 0).count(),
            rows: recordings.iter().map(|r| r.rows).sum(),
        })
    })
}
