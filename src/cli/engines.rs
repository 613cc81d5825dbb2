//! The only place of the command line that makes engines.

use hwmodel::count::Counter;

use super::args::{EngineArgs, EngineName};
use super::error::CliError;
use crate::frame::Frame;
use crate::graph::GraphView;
use crate::machine::{Machine, MachineOptions};
use crate::project::{Engine, FrameSetup};
use crate::rays::Rays;

/// The engine of a name.
///
/// # Errors
/// When this build does not have it.
pub(super) fn engine(args: &EngineArgs) -> Result<Box<dyn Engine>, CliError> {
    match args.engine {
        EngineName::Fast => Err(CliError::usage("--engine fast is not in this version")
            .advise("use --engine machine (the same picture) or --engine rays")),
        EngineName::Machine => Ok(Box::new(machine(args))),
        EngineName::Rays => Ok(Box::new(Rays)),
    }
}

fn machine(args: &EngineArgs) -> Machine {
    Machine::new(MachineOptions {
        overflow: args.overflow(),
        ..MachineOptions::default()
    })
}

/// Draws one frame on the machine and counts its operations.
///
/// # Errors
/// When the frame cannot be finished.
pub(super) fn count_operations(
    args: &EngineArgs,
    graph: &GraphView<'_>,
    setup: &FrameSetup,
) -> Result<Counter, CliError> {
    let mut frame = Frame::new(setup.width, setup.height, false);
    let (_, counter) = machine(args).render_probed(graph, setup, &mut frame, Counter::new())?;
    Ok(counter)
}
