//! `model`: the cost of a frame on the light hardware.

mod args;
mod brief;
mod explore;
mod output;
mod vectors;

pub(super) use args::ModelArgs;
pub(super) use brief::brief;

use hwmodel::cycles::{Hardware, Observer, OuterRequest, write_ramulator};

use super::console::Console;
use super::error::CliError;
use super::experiment::subjects;
use shiftvox::frame::Frame;
use shiftvox::graph::Progress;
use shiftvox::machine::Simulated;
use shiftvox::project::FrameSetup;
use shiftvox_lab::bench::Subject;
use shiftvox_lab::model::cost::Prices;
use shiftvox_lab::model::frame::{self, Counted};
use shiftvox_lab::model::ray_caster;
use shiftvox_lab::model::report::{Drawn, Report};
use shiftvox_lab::rival::Rival;

pub(super) fn run(args: &ModelArgs, console: &Console) -> Result<(), CliError> {
    if let Some(space) = &args.explore.explore {
        return explore::run(space, args, console);
    }
    if args.hardware.print_hw {
        return console.data(args.hardware_text()?.trim_end());
    }
    if args.hardware.print_rival {
        return console.data(args.hardware.rival_text()?.trim_end());
    }
    if args.export.export_svg.is_some() {
        return Err(CliError::usage(
            "--export-svg plots explorations: it needs --explore",
        ));
    }
    output::check(args)?;
    vectors::check(args)?;
    let hardware = args.hardware()?;
    let prices = args.hardware.prices()?;
    let rival = args.hardware.rival()?;
    let names = subjects::names_or(&args.scenes, &[subjects::BUNDLED]);
    let [name] = names.as_slice() else {
        return Err(CliError::usage("model looks at one scene at a time"));
    };
    let found = find(args, name, hardware, (&rival, &prices), console).map_err(|e| e.at(name))?;
    output::write(&found, args, console)
}

struct Found {
    subject: Subject,
    setup: FrameSetup,
    counted: Counted,
    report: Report,
}

fn find(
    args: &ModelArgs,
    name: &str,
    hardware: Hardware,
    (rival, prices): (&Rival, &Prices),
    console: &Console,
) -> Result<Found, CliError> {
    let size = args.size.pair();
    let scene = args.rules.scene_args(&args.scene);
    let mut subject = subjects::open(name, &args.camera, &scene, size, console)?;
    if args.files.vectors.is_some() {
        vectors::lay_out(&mut subject.graph, console);
    }
    let options = args.setup_options();
    let setup = subject.setup(size, &options)?;
    let graph = &subject.graph;
    let progress = console.progress();

    progress.begin("counting", 0);
    let counted = frame::count(graph, &setup, hardware.organisation, args.rules.overflow())?;
    progress.end();
    vectors::write(args, name, graph, &setup, &hardware, console)?;
    progress.begin("cycles", counted.counter.records());
    let (picture, simulated) = simulate(args, &subject, &setup, &hardware, console)?;
    progress.begin("the exact picture and the ray caster", 0);
    let exact_setup = frame::exact_setup(graph, &subject.camera, options.aa_log2)?;
    let exact = frame::reference(&graph.view(), &exact_setup)?;
    let designs = (rival, &hardware);
    let ray_caster = ray_caster::measure(graph, &setup, designs, prices, &exact)?;
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

fn simulate(
    args: &ModelArgs,
    subject: &Subject,
    setup: &FrameSetup,
    hardware: &Hardware,
    console: &Console,
) -> Result<(Frame, Simulated), CliError> {
    let (view, overflow) = (subject.graph.view(), args.rules.overflow());
    let trace = args.files.export_ramulator.as_ref();
    let mut watch = Watch {
        progress: console.progress(),
        reported: 0,
        requests: trace.map(|_| Vec::new()),
    };
    let drawn = frame::simulate(&view, setup, hardware, overflow, &mut watch)?;
    if let (Some(path), Some(requests)) = (trace, watch.requests) {
        let mut text = Vec::new();
        write_ramulator(requests, &mut text)?;
        console.write(path, text, args.export.force)?;
    }
    Ok(drawn)
}

struct Watch<'c> {
    progress: &'c dyn Progress,
    reported: u64,
    /// Those to outer memory, if they are wanted.
    requests: Option<Vec<OuterRequest>>,
}

impl Observer for Watch<'_> {
    fn watches_requests(&self) -> bool {
        self.requests.is_some()
    }

    fn requests(&mut self, requests: Vec<OuterRequest>) {
        self.requests = Some(requests);
    }

    fn progress(&mut self, _: u64, records: u64) {
        self.progress.advance(records.saturating_sub(self.reported));
        self.reported = records;
    }
}
