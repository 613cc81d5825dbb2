//! The few figures of a frame that `view` shows beside it.

use std::ffi::OsString;

use clap::Parser;
use hwmodel::cycles::NoObserver;
use serde_json::{Value, json};

use super::args::ModelArgs;
use crate::error::CliError;
use shiftvox::graph::Graph;
use shiftvox::project::{Camera, FrameSetup};
use shiftvox_lab::model::design::LightDesign;
use shiftvox_lab::model::frame;

#[derive(Parser)]
#[command(no_binary_name = true)]
struct Line {
    #[command(flatten)]
    args: ModelArgs,
}

/// Records, operations, cycles and energy of a frame, as `model` finds them with these flags.
pub(crate) fn brief(
    flags: impl Iterator<Item = OsString>,
    graph: &Graph,
    camera: &Camera,
) -> Result<Value, CliError> {
    let Line { args } = Line::try_parse_from(flags).map_err(CliError::of_words)?;
    let (hardware, prices) = (args.hardware()?, args.hardware.prices()?);
    let (options, overflow) = (args.setup_options(), args.rules.overflow());
    let setup = FrameSetup::new(camera, &graph.placement, graph.depth, &options)?;
    let counted = frame::count(graph, &setup, hardware.organisation, overflow)?;
    let (view, observer) = (graph.view(), &mut NoObserver);
    let (_, simulated) = frame::simulate(&view, &setup, &hardware, overflow, observer)?;
    let cycles = &simulated.cycles;
    let design = LightDesign::price(graph, &setup, &counted, cycles, &hardware, &prices)?;
    // From pJ.
    let energy = design.cost.total() * 1e-6;
    Ok(json!({
        "hardware": hardware.name,
        "bits": setup.format.bits(),
        "records": counted.counter.records(),
        "operations": counted.counter.ops(),
        "cycles": cycles.cycles,
        "clock_mhz": cycles.clock_mhz,
        "frames_per_second": cycles.frames_per_second,
        "energy_uj": energy,
    }))
}
