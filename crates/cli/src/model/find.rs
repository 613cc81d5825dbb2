//! Draws a frame on the machine, on the hardware and by rays.

use hwmodel::Overflow;
use hwmodel::cycles::{Hardware, Progress as Ticks, Recorder};

use super::args::ModelArgs;
use super::vectors;
use crate::console::Console;
use crate::error::{CliError, Kind};
use crate::experiment::subjects;
use shiftvox::frame::Frame;
use shiftvox::machine::{SimulateError, Simulated};
use shiftvox::project::{Camera, FrameSetup};
use shiftvox::whole;
use shiftvox_lab::bench::Subject;
use shiftvox_lab::model::cost::Prices;
use shiftvox_lab::model::frame::{self, Counted};
use shiftvox_lab::model::report::{Drawn, Report};
use shiftvox_lab::model::{ModelError, ray_caster};

/// A frame and its report.
pub(super) struct Found {
    pub(super) subject: Subject,
    pub(super) setup: FrameSetup,
    pub(super) counted: Counted,
    pub(super) report: Report,
}

/// Draws, counts and prices; writes vectors and the trace.
pub(super) fn find(
    args: &ModelArgs,
    name: &str,
    hardware: Hardware,
    prices: &Prices,
    console: &Console,
) -> Result<Found, CliError> {
    let size = (args.size.width, args.size.height);
    let scene = args.rules.scene_args(&args.scene);
    let mut subject = subjects::open(name, &args.camera, &scene, size, console)?;
    if args.files.vectors.is_some() {
        vectors::lay_out(&mut subject.graph, console);
    }
    let options = args.setup_options();
    let overflow = args.rules.overflow();
    let setup = subject.setup(size, &options)?;
    let graph = &subject.graph;
    let progress = console.progress();

    progress.begin("counting", 0);
    let counted = frame::count(graph, &setup, &hardware, overflow)?;
    progress.end();
    vectors::write(args, name, graph, &setup, overflow, &hardware, console)?;
    let records = counted.counter.records();
    let (picture, simulated) = simulate(
        args, &subject, &setup, &hardware, overflow, records, console,
    )?;

    progress.begin("the exact picture and the ray caster", 0);
    let camera = Camera {
        width: size.0,
        height: size.1,
        ..subject.camera
    };
    let true_setup = frame::true_setup(graph, &camera, &options)?;
    let exact = frame::reference(&graph.view(), &true_setup)?;
    let order = args.hardware.ray_order;
    let ray_caster = ray_caster::measure(graph, &setup, &hardware, prices, order, &exact)?;
    progress.end();
    let drawn = Drawn {
        graph,
        setup: &setup,
        counted: &counted,
        simulated,
        picture: &picture,
        exact: &exact,
        ray_caster,
    };
    let report = Report::new(drawn, hardware, prices)?;
    Ok(Found {
        subject,
        setup,
        counted,
        report,
    })
}

/// Draws the frame on the hardware, and writes the trace if it is requested.
fn simulate(
    args: &ModelArgs,
    subject: &Subject,
    setup: &FrameSetup,
    hardware: &Hardware,
    overflow: Overflow,
    records: u64,
    console: &Console,
) -> Result<(Frame, Simulated), CliError> {
    let view = subject.graph.view();
    let progress = console.progress();
    progress.begin("cycles", records);
    let mut reported = 0;
    let mut ticks = Ticks(|_, records: u64| {
        progress.advance(records.saturating_sub(reported));
        reported = records;
    });
    let drawn = match &args.files.trace {
        None => frame::simulate(&view, setup, hardware, overflow, &mut ticks)?,
        Some(path) => {
            let mut both = (Recorder::new(args.files.trace_records), ticks);
            let drawn = frame::simulate(&view, setup, hardware, overflow, &mut both)?;
            let mut text = Vec::new();
            both.0.write_chrome(hardware, &mut text)?;
            whole::write(path, &text, args.export.force)?;
            console.note(format!("{}: written", path.display()));
            drawn
        }
    };
    progress.end();
    Ok(drawn)
}

impl From<ModelError> for CliError {
    fn from(error: ModelError) -> Self {
        match error {
            ModelError::Setup(error) => error.into(),
            ModelError::Engine(error) | ModelError::Simulate(SimulateError::Workload(error)) => {
                error.into()
            }
            ModelError::Simulate(error) => Self::new(Kind::Limit, error),
            ModelError::Hardware(error) => Self::new(Kind::Input, error),
            ModelError::Cost(error) => Self::new(Kind::Input, error),
        }
    }
}
