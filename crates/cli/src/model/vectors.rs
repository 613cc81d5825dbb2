//! `--vectors`: test vectors for hardware designers.

use hwmodel::Overflow;
use hwmodel::cycles::{Hardware, Organisation};

use super::args::ModelArgs;
use crate::console::Console;
use crate::error::{CliError, Kind};
use shiftvox::graph::{Graph, GraphView};
use shiftvox::picture::{Shading, lights};
use shiftvox::project::FrameSetup;
use shiftvox_lab::model::vectors::{self, Request, VectorsError};

/// Fails before the work if the folder would be replaced.
pub(super) fn check(args: &ModelArgs) -> Result<(), CliError> {
    match &args.files.vectors {
        Some(folder) => Ok(vectors::check_free(folder, args.export.force)?),
        None => Ok(()),
    }
}

/// Lays out a linked graph as in the memory of `frame.nodes.hex`. It is drawn and counted like that.
pub(super) fn lay_out(graph: &mut Graph, console: &Console) {
    if graph.links.is_empty() {
        return;
    }
    match graph.side_by_side() {
        Some(laid_out) => *graph = laid_out,
        None => console.note("too many links to lay children side by side: no frame.nodes.hex"),
    }
}

/// Writes the requested vectors.
pub(super) fn write(
    args: &ModelArgs,
    scene: &str,
    graph: &Graph,
    setup: &FrameSetup,
    overflow: Overflow,
    hardware: &Hardware,
    console: &Console,
) -> Result<(), CliError> {
    let Some(folder) = &args.files.vectors else {
        return Ok(());
    };
    let request = Request {
        scene,
        records: args.files.vector_records,
        overflow,
        // Only sequential hardware has turns of its own; others have the paper's.
        organisation: match hardware.sequential {
            true => hardware.organisation,
            false => Organisation::default(),
        },
        folder,
        overwrite: args.export.force,
    };
    // The same light as in the frame that is counted.
    let light = lights(graph, setup, Shading::Lambert);
    let lit = GraphView {
        light: &light,
        ..graph.view()
    };
    let recorded = vectors::write(&lit, setup, &request)?;
    console.note(format!(
        "{}: {} rows of {} blocks written",
        folder.display(),
        recorded.rows,
        recorded.blocks
    ));
    Ok(())
}

impl From<VectorsError> for CliError {
    fn from(error: VectorsError) -> Self {
        match error {
            VectorsError::Engine(error) => error.into(),
            VectorsError::Store(error) => error.into(),
            VectorsError::Misfit(_) => Self::new(Kind::Limit, error),
            VectorsError::Foreign { .. } => {
                Self::new(Kind::Run, error).advise("give another name, or empty the folder")
            }
            VectorsError::Manifest(_) => Self::new(Kind::Run, error),
        }
    }
}
