//! The only place of the command line that makes engines.

use hwmodel::count::Counter;

use super::args::{EngineArgs, EngineName};
use super::error::CliError;
use crate::frame::Frame;
use crate::graph::GraphView;
use crate::lab::bench::{Candidate, Family, Variant};
use crate::lab::float_rays::FloatRays;
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

const MACHINE: Candidate = Candidate {
    name: "machine",
    about: "the paper's loop in machine words",
    work: "records",
    parallel: false,
    make: |_| Box::new(Machine::default()),
};

/// What the experiments take for the truth.
pub(super) const REFERENCE: Candidate = Candidate {
    name: "rays",
    about: "the exact reference, in wide integers",
    work: "nodes_tested",
    parallel: true,
    make: |_| Box::new(Rays),
};

/// A renderer that is not ours, for comparison.
const FLOAT_RAYS: Candidate = Candidate {
    name: "float-rays",
    about: "an ordinary ray caster in f32",
    work: "steps",
    parallel: false,
    make: |_| Box::new(FloatRays),
};

/// All engines that the experiments can measure.
pub(super) const CANDIDATES: &[Candidate] = &[MACHINE, REFERENCE, FLOAT_RAYS];

/// Those whose growth is measured where none is named.
pub(super) const SCALED: &[&str] = &["machine"];

/// What can be switched off, by engine.
pub(super) const FAMILIES: &[Family] = &[Family {
    whole: MACHINE,
    variants: MACHINE_VARIANTS,
}];

const MACHINE_VARIANTS: &[Variant] = &[
    Variant {
        name: "occlusion order off",
        about: "children in the order 0 to 7 for every eye: the picture is WRONG, far voxels hide near ones",
        adjust: |_| {},
        make: |_| {
            Box::new(Machine::new(MachineOptions {
                order: [0, 1, 2, 3, 4, 5, 6, 7],
                ..MachineOptions::default()
            }))
        },
    },
    Variant {
        name: "fill-vector rejection off",
        about: "hidden records go on down to their samples; the picture must be the same",
        adjust: |_| {},
        make: |_| {
            Box::new(Machine::new(MachineOptions {
                reject_filled: false,
                ..MachineOptions::default()
            }))
        },
    },
    Variant {
        name: "level of detail off",
        about: "--lod 0: down to the leaves, also below a pixel; the picture changes towards the exact one",
        adjust: |options| options.lod_px = 0.0,
        make: MACHINE.make,
    },
    Variant {
        name: "screen space off",
        about: "--tolerance 0: every record stays in clip space, no divides; the picture may change",
        adjust: |options| options.tolerance_px = 0.0,
        make: MACHINE.make,
    },
];
