//! `--vectors`: test vectors for hardware designers.

use hwmodel::cycles::{Hardware, Organisation};

use super::args::ModelArgs;
use crate::console::Console;
use crate::error::CliError;
use shiftvox::graph::Graph;
use shiftvox::picture::{Shading, lights};
use shiftvox::project::FrameSetup;
use shiftvox_lab::model::vectors::{self, Request};

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

pub(super) fn write(
    args: &ModelArgs,
    scene: &str,
    graph: &Graph,
    setup: &FrameSetup,
    hardware: &Hardware,
    console: &Console,
) -> Result<(), CliError> {
    let Some(folder) = &args.files.vectors else {
        return Ok(());
    };
    let request = Request {
        scene,
        color: &graph.color,
        normal: &graph.normal,
        records: args.files.vector_records,
        overflow: args.rules.overflow(),
        // Hardware that is not sequential has the paper's turns.
        organisation: match hardware.sequential {
            true => hardware.organisation,
            false => Organisation::default(),
        },
        folder,
        overwrite: args.export.force,
    };
    let light = lights(graph, setup, Shading::Lambert)?;
    let lit = graph.lit(&light);
    let recorded = vectors::write(&lit, setup, &request)?;
    let (rows, blocks) = (recorded.rows, recorded.blocks);
    console.note(format!(
        "{}: {rows} rows of {blocks} blocks written",
        folder.display()
    ));
    Ok(())
}
