//! What the model finds of a frame.

use hwmodel::Overflow;
use hwmodel::cycles::{Hardware, NoObserver, Progress as Ticks, Recorder, ScalingRow, TraceLimit};
use hwmodel::cycles::{LANES, scaling};
use hwmodel::memory::Widths;

use super::args::ModelArgs;
use super::{trace, vectors};
use crate::console::Console;
use crate::error::{CliError, Kind};
use crate::experiment::subjects;
use shiftvox::machine::Simulated;
use shiftvox::project::{FrameSetup, SetupOptions};
use shiftvox_lab::bench::Subject;
use shiftvox_lab::float_rays::RayOrder;
use shiftvox_lab::model::ModelError;
use shiftvox_lab::model::area::DesignArea;
use shiftvox_lab::model::caches::{self, CacheRow, Drawn};
use shiftvox_lab::model::claims::{self, Claim};
use shiftvox_lab::model::clock::ClockCheck;
use shiftvox_lab::model::compare::{self, ComparedLine, Design};
use shiftvox_lab::model::cost::{FrameCost, Prices};
use shiftvox_lab::model::design::LightDesign;
use shiftvox_lab::model::floor::{self, Floor, HalfRow};
use shiftvox_lab::model::frame::{self, Counted};
use shiftvox_lab::model::growth::{self, GrowthRow};
use shiftvox_lab::model::ray_caster::{self, RayCasterReport};
use shiftvox_lab::model::record::{self, NumberWidths};
use shiftvox_lab::model::rules::{self, RuleRow};
use shiftvox_lab::model::steps::{self, StepRow};
use shiftvox_lab::model::sweep::{self, FormatRow};

/// Everything that the model found of a scene.
pub(super) struct Findings {
    pub(super) name: String,
    pub(super) subject: Subject,
    pub(super) setup: FrameSetup,
    pub(super) hardware: Hardware,
    pub(super) widths: Widths,
    pub(super) counted: Counted,
    pub(super) simulated: Simulated,
    /// Samples that the hardware's picture shows otherwise than the serial machine's.
    pub(super) differing: u64,
    pub(super) cost: FrameCost,
    pub(super) area: DesignArea,
    pub(super) clock: ClockCheck,
    pub(super) comparison: Vec<ComparedLine>,
    pub(super) ray_caster: RayCasterReport,
    /// Wrong samples of the machine's picture.
    pub(super) wrong: shiftvox_lab::measure::CoverageError,
    pub(super) claims: Vec<Claim>,
    pub(super) rules: Vec<RuleRow>,
    pub(super) formats: Vec<FormatRow>,
    pub(super) lanes: Vec<ScalingRow>,
    pub(super) caches: Vec<CacheRow>,
    /// What every design must move, and half of the ray caster's energy beside it.
    pub(super) floor: Floor,
    pub(super) halves: Vec<HalfRow>,
    pub(super) steps: Vec<StepRow>,
    /// Bits of a record's numbers: seen, and proven.
    pub(super) numbers: Vec<NumberWidths>,
    pub(super) pictures: Vec<GrowthRow>,
    pub(super) objects: Vec<GrowthRow>,
}

/// Draws, counts and measures.
pub(super) fn find(
    args: &ModelArgs,
    name: &str,
    hardware: Hardware,
    prices: &Prices,
    console: &Console,
) -> Result<Findings, CliError> {
    let size = (args.size.width, args.size.height);
    let mut subject = subjects::open(
        name,
        &args.camera,
        &args.rules.scene_args(&args.scene),
        size,
        console,
    )?;
    if args.files.vectors.is_some() {
        vectors::lay_out(&mut subject.graph, console);
    }
    let options = setup_options(args);
    let overflow = args.rules.overflow();
    let setup = subject.setup(size, &options)?;
    let graph = &subject.graph;
    let progress = console.progress();

    let camera = shiftvox::project::Camera {
        width: size.0,
        height: size.1,
        ..subject.camera
    };
    progress.begin("counting", 0);
    let counted = frame::count(graph, &setup, &hardware, overflow)?;
    progress.end();
    vectors::write(args, name, graph, &setup, overflow, &hardware, console)?;
    let (hardware_frame, simulated) = simulate(
        args, &subject, &setup, &hardware, overflow, &counted, console,
    )?;
    let differing = counted.differing(&hardware_frame);

    progress.begin("the exact picture and the ray caster", 0);
    let true_setup = rules::true_setup(graph, &camera, &options)?;
    let exact = frame::reference(&graph.view(), &true_setup)?;
    let order = args.hardware.ray_order;
    let ray_caster = ray_caster::measure(graph, &setup, &hardware, prices, order, &exact)?;
    let wrong = frame::error(&counted.frame, &exact);
    progress.end();

    let LightDesign {
        widths,
        cost,
        area,
        clock,
    } = LightDesign::price(
        graph,
        &setup,
        &counted,
        &simulated.cycles,
        &hardware,
        prices,
    )?;
    let light = Design {
        cost: &cost,
        area: &area,
        cycles: simulated.cycles.cycles,
        frames_per_second: simulated.cycles.frames_per_second,
    };
    let rival = Design {
        cost: &ray_caster.cost,
        area: &ray_caster.area,
        cycles: ray_caster.cycles.cycles,
        frames_per_second: ray_caster.cycles.frames_per_second,
    };
    let comparison = compare::lines(light, rival);
    let tables = &args.tables;
    let rules = if tables.rules || tables.all {
        rules::table(graph, &camera, &options, &hardware, prices, progress)?
    } else {
        Vec::new()
    };
    let formats = match tables.widths() {
        Some(widths) => sweep::table(
            graph, &camera, &options, &widths, &hardware, prices, progress,
        )?,
        None => Vec::new(),
    };
    let lanes = if tables.lanes || tables.all {
        progress.begin("1 to 64 lanes", LANES.len() as u64);
        let rows = scaling(&hardware, &LANES, |hardware| {
            let drawn = frame::simulate(&graph.view(), &setup, hardware, overflow, &mut NoObserver);
            progress.advance(1);
            drawn.map(|(_, simulated)| simulated.cycles)
        })?;
        progress.end();
        rows
    } else {
        Vec::new()
    };
    let caches = if tables.caches || tables.all {
        let drawn = Drawn {
            graph,
            setup: &setup,
            counted: &counted,
            exact: &exact,
        };
        let orders = order.map_or(RayOrder::ALL.to_vec(), |order| vec![order]);
        caches::table(drawn, overflow, &hardware, &orders, prices, progress)?
    } else {
        Vec::new()
    };
    let floor = floor::floor(graph, &exact, &hardware, &prices.table).map_err(ModelError::from)?;
    let halves = floor::halves(&caches, &floor);
    let steps = if tables.steps || tables.all {
        let drawn = (graph, &setup, &exact);
        steps::table(drawn, overflow, &hardware, prices, progress)?
    } else {
        Vec::new()
    };
    let numbers =
        record::number_widths(graph, &setup, hardware.organisation).map_err(ModelError::from)?;
    let (pictures, objects) = if tables.growth || tables.all {
        let sides = sides_to(size.0.max(size.1));
        let pictures = growth::pictures(name, graph, &camera, &sides, &options, progress)?;
        (pictures, objects(size, &options, console)?)
    } else {
        (Vec::new(), Vec::new())
    };
    let mut claims = claims::of_frame(&counted);
    claims.extend(claims::of_growth(&pictures, &objects));
    claims.extend(claims::of_hardware(&simulated, differing, &setup));
    Ok(Findings {
        name: name.to_owned(),
        setup,
        hardware,
        widths,
        counted,
        simulated,
        differing,
        cost,
        area,
        clock,
        comparison,
        ray_caster,
        wrong,
        claims,
        rules,
        formats,
        lanes,
        caches,
        floor,
        halves,
        steps,
        numbers,
        pictures,
        objects,
        subject,
    })
}

/// Draws the frame on the hardware, with progress, and writes the trace that was asked for.
fn simulate(
    args: &ModelArgs,
    subject: &Subject,
    setup: &FrameSetup,
    hardware: &Hardware,
    overflow: Overflow,
    counted: &Counted,
    console: &Console,
) -> Result<(shiftvox::frame::Frame, Simulated), CliError> {
    let view = subject.graph.view();
    let progress = console.progress();
    progress.begin("cycles", counted.counter.records());
    let mut reported = 0;
    let mut ticks = Ticks(|_, records: u64| {
        progress.advance(records.saturating_sub(reported));
        reported = records;
    });
    let drawn = match &args.files.trace {
        None => frame::simulate(&view, setup, hardware, overflow, &mut ticks)?,
        Some(path) => {
            let mut recorder = Recorder::new(TraceLimit {
                records: args.files.trace_records,
                ..TraceLimit::default()
            });
            let mut both = (&mut recorder, ticks);
            let drawn = frame::simulate(&view, setup, hardware, overflow, &mut both)?;
            trace::write(path, &recorder, hardware, args.export.force, console)?;
            drawn
        }
    };
    progress.end();
    Ok(drawn)
}

/// Sides of growing pictures: powers of two from 64 to `most`.
fn sides_to(most: u32) -> Vec<u32> {
    std::iter::successors(Some(64u32), |side| side.checked_mul(2))
        .take_while(|&side| side <= most.max(64))
        .collect()
}

/// Width of a word where nothing is said: that for which the shipped hardware is built.
const BITS: u32 = 32;

/// By which rules a frame is drawn, in which words.
pub(super) fn setup_options(args: &ModelArgs) -> SetupOptions {
    SetupOptions {
        bits: args.rules.bits.unwrap_or(BITS),
        ..args.rules.options(0)
    }
}

/// Terrains and sponges of growing depth, in one picture size.
const OBJECTS: [&str; 9] = [
    "gen:terrain,depth=6",
    "gen:terrain,depth=7",
    "gen:terrain,depth=8",
    "gen:terrain,depth=9",
    "gen:terrain,depth=10",
    "gen:terrain,depth=11",
    "gen:menger,depth=3",
    "gen:menger,depth=4",
    "gen:menger,depth=5",
];

fn objects(
    size: (u32, u32),
    options: &SetupOptions,
    console: &Console,
) -> Result<Vec<GrowthRow>, CliError> {
    let mut rows = Vec::new();
    let (camera, scene) = Default::default();
    for name in OBJECTS {
        let subject = subjects::open(name, &camera, &scene, size, console)?;
        let side = size.0.max(size.1);
        rows.push(growth::row(
            name,
            &subject.graph,
            &subject.camera,
            side,
            options,
        )?);
    }
    Ok(rows)
}

impl From<ModelError> for CliError {
    fn from(error: ModelError) -> Self {
        use shiftvox::machine::SimulateError;
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
