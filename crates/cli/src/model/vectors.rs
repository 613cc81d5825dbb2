//! `--vectors`: test vectors for who builds the hardware.

use hwmodel::Overflow;
use hwmodel::cycles::{Hardware, Organisation};

use super::args::ModelArgs;
use crate::console::Console;
use crate::error::{CliError, Kind};
use shiftvox::graph::{Graph, GraphView};
use shiftvox::picture::{Shading, lights};
use shiftvox::project::FrameSetup;
use shiftvox_lab::model::vectors::{self, FolderError, Request, VectorsError};

/// Fails before the work where something would be replaced.
pub(super) fn check(args: &ModelArgs) -> Result<(), CliError> {
    match &args.files.vectors {
        Some(folder) => Ok(vectors::check_free(folder, args.export.force)?),
        None => Ok(()),
    }
}

/// Lays a linked graph out as the memory of `frame.nodes.hex` holds it; it is then drawn and counted like this.
pub(super) fn lay_out(graph: &mut Graph, console: &Console) {
    if graph.links.is_empty() {
        return;
    }
    match graph.side_by_side() {
        Some(laid_out) => *graph = laid_out,
        None => console.note("too many links to lay children side by side: no frame.nodes.hex"),
    }
}

/// Writes the vectors that are asked for.
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
        // Turns are those of hardware that makes them one step after the other; of any other, the paper's.
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

impl From<FolderError> for CliError {
    fn from(error: FolderError) -> Self {
        match error {
            FolderError::Store(error) => error.into(),
            FolderError::Foreign { .. } => {
                Self::new(Kind::Run, error).advise("give another name, or empty the folder")
            }
        }
    }
}

impl From<VectorsError> for CliError {
    fn from(error: VectorsError) -> Self {
        match error {
            VectorsError::Engine(error) => error.into(),
            VectorsError::Folder(error) => error.into(),
            VectorsError::Store(error) => error.into(),
            VectorsError::Misfit(_) => Self::new(Kind::Limit, error),
            VectorsError::Unknown(_) | VectorsError::Manifest(_) => Self::new(Kind::Run, error),
        }
    }
}
