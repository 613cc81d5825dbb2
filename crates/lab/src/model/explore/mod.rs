//! Many hardware designs for one frame, measured in parallel.
//!
//! [`space`] describes the designs, and [`mod@front`] finds the Pareto-optimal ones. [`lines`] is the format of results.
//!
//! Points share results that depend on a part of them only: see `machine_key` and `ray_key`. Where parents lie on the
//! stack, a record's turn does not depend on the hardware. Those turns are recorded once, and only their cycles are
//! simulated per point.

pub mod front;
pub mod lines;
pub mod space;

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::{Mutex, PoisonError};

use hwmodel::cycles::{Cache, CycleReport, Hardware, NoObserver, Recording, StackHolds};
use hwmodel::{Memory, OpClass, Overflow};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::ModelError;
use super::cost::Prices;
use super::design::LightDesign;
use super::fill_bits;
use super::floor;
use super::frame::{self, Counted};
use super::range::{Range, Winner};
use super::ray_caster::{self, OrderEnergy, RayRun};
use super::ray_cycles::RayHardware;
use super::safe::Format;
use crate::float_rays::RayOrder;
use shiftvox::frame::Frame;
use shiftvox::graph::{Graph, Progress};
use shiftvox::machine::SimulateError;
use shiftvox::project::{Camera, FrameSetup, SetupOptions};
use space::Point;

#[derive(Debug, Clone, Copy)]
pub struct Explored<'a> {
    pub graph: &'a Graph,
    pub camera: &'a Camera,
    /// Rules and words, where the points do not set others.
    pub options: &'a SetupOptions,
    pub overflow: Overflow,
    /// The order of the ray caster's rays; by default, for each point the order of least energy.
    pub order: Option<RayOrder>,
    pub prices: &'a Prices,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "outcome", rename_all = "snake_case")]
pub enum PointOutcome {
    Drawn(Box<PointFigures>),
    Refused { reason: String },
}

/// The figures of a point. They equal those of `shiftvox model` for the same hardware.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointFigures {
    pub cycles: u64,
    pub time_ms: f64,
    pub area_nand2: Range,
    pub energy_pj: Range,
    /// Samples that differ from the exact picture in any way.
    pub wrong_samples: u64,
    /// Samples that differ from the serial machine's picture.
    pub differing_samples: u64,
    pub meets_clock: bool,
    pub limits: String,
    pub counts: PointCounts,
    pub operations_pj: Range,
    pub on_chip_pj: Range,
    pub outer_pj: Range,
    pub units_nand2: f64,
    pub format: Format,
    pub ray_caster: RivalFigures,
    pub less_energy: Winner,
    /// The design with less energy if both pay the same low, or the same high, price for outer memory.
    pub less_at_equal_prices: Winner,
    pub floor_pj: Range,
    /// Whether the floor exceeds half of the ray caster's energy at both ends of the prices.
    pub half_is_impossible: bool,
}

#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct PointCounts {
    pub records: u64,
    /// Records of the hardware: some are processed that are hidden by the time they would have their turn serially.
    pub hardware_records: u64,
    /// Operations without shifts.
    pub operations: u64,
    pub divide_steps: u64,
    pub record_bits: u32,
    pub deepest_stack: u64,
    pub node_reads: u64,
    pub node_misses: u64,
    pub fill_accesses: u64,
    pub fill_bits: u64,
    /// Samples covered, but empty in the exact picture.
    pub extra: u64,
    /// Samples empty, but covered in the exact picture.
    pub missing: u64,
    /// Samples that show another voxel than the exact picture.
    pub wrong_voxel: u64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RivalFigures {
    pub order: RayOrder,
    /// Cycles of the frame: a lower bound.
    pub cycles: u64,
    pub node_misses: u64,
    pub area_nand2: Range,
    pub energy_pj: Range,
    pub orders: Vec<OrderEnergy>,
}

type OrReason<T> = Result<T, String>;

/// Most bytes of all recorded turns.
const MOST_RECORDED: usize = 1 << 30;

/// Turns that are the same on every hardware, and the samples that differ from the serial machine's.
type Turns = (Recording, u64);

struct Shared<'a> {
    of: Explored<'a>,
    /// By side of the picture.
    exact: BTreeMap<Option<u32>, Frame>,
    /// By drawing settings.
    setups: BTreeMap<String, OrReason<(FrameSetup, Format)>>,
    /// The machine's counts, by [`machine_key`].
    counted: BTreeMap<String, OrReason<(Counted, Option<Turns>)>>,
    /// Sizes of the node cache, and the rays in every order, by [`ray_key`].
    rays: BTreeMap<String, (Vec<u32>, Vec<RayRun>)>,
    ray_hardware: RayHardware,
}

/// Measures points. `sink` receives them in order, each as soon as all points before it are measured.
pub fn explore<E: From<ModelError> + Send>(
    of: Explored<'_>,
    points: &[Point],
    progress: &dyn Progress,
    sink: impl FnMut(&Point, PointOutcome) -> Result<(), E> + Send,
) -> Result<(), E> {
    let shared = Shared::new(of, points, progress)?;
    // Points that differ only in name and clock take the same cycles.
    let mut groups = Vec::<Vec<usize>>::new();
    let mut places = BTreeMap::new();
    for (at, point) in points.iter().enumerate() {
        let like = Hardware {
            name: String::new(),
            clock_mhz: 1.0,
            ..point.hardware.clone()
        };
        let place = *places
            .entry(format!("{:?} {like:?}", point.drawing))
            .or_insert(groups.len());
        if place == groups.len() {
            groups.push(Vec::new());
        }
        groups[place].push(at);
    }
    progress.begin("points", points.len() as u64);
    // Results that wait for earlier points, the next point, and the sink.
    let in_order = Mutex::new((BTreeMap::new(), 0, sink));
    // One after the other, so that the points for which the sink waits come first.
    let done = groups.into_iter().par_bridge().try_for_each(|group| {
        let simulated = shared.simulate(&points[group[0]])?;
        for at in group {
            let outcome = match &simulated {
                Ok(simulated) => shared.price(&points[at], simulated)?,
                Err(reason) => PointOutcome::Refused {
                    reason: reason.clone(),
                },
            };
            let mut in_order = in_order.lock().unwrap_or_else(PoisonError::into_inner);
            let (waiting, next, sink) = &mut *in_order;
            waiting.insert(at, outcome);
            while let Some(outcome) = waiting.remove(next) {
                *next += 1;
                sink(&points[*next - 1], outcome)?;
            }
            progress.advance(1);
        }
        Ok(())
    });
    progress.end();
    done
}

impl<'a> Shared<'a> {
    fn new(
        of: Explored<'a>,
        points: &[Point],
        progress: &dyn Progress,
    ) -> Result<Self, ModelError> {
        progress.begin("what points have in common", 0);
        let mut shared = Self {
            of,
            exact: BTreeMap::new(),
            setups: BTreeMap::new(),
            counted: BTreeMap::new(),
            rays: BTreeMap::new(),
            ray_hardware: RayHardware::shipped(),
        };
        // By key, a point that has it; of rays, with all sizes of its cache.
        let mut machines = BTreeMap::<String, &Point>::new();
        let mut casts = BTreeMap::<String, (&Point, Vec<u32>)>::new();
        for point in points {
            let size = point.drawing.size;
            let camera = Camera {
                width: size.unwrap_or(of.camera.width),
                height: size.unwrap_or(of.camera.height),
                ..*of.camera
            };
            let options = point.drawing.options(of.options);
            if let Entry::Vacant(place) = shared.exact.entry(size) {
                let setup = frame::true_setup(of.graph, &camera, of.options)?;
                place.insert(frame::reference(&of.graph.view(), &setup)?);
            }
            let setup = || {
                let placement = &of.graph.placement;
                let setup = FrameSetup::new(&camera, placement, of.graph.depth, &options)
                    .map_err(|error| error.to_string())?;
                let format = Format::new(of.graph, &camera, &setup);
                Ok((setup, format))
            };
            let key = format!("{:?}", point.drawing);
            shared.setups.entry(key).or_insert_with(setup);
            machines.entry(machine_key(point)).or_insert(point);
            let cast = casts.entry(ray_key(point));
            let (_, sizes) = cast.or_insert_with(|| (point, Vec::new()));
            let bytes = point.hardware.node_cache.bytes;
            if !sizes.contains(&bytes) {
                sizes.push(bytes);
            }
        }
        let is_recorded = |point: &&&Point| {
            let organisation = point.hardware.organisation;
            organisation.stack != StackHolds::Children && !point.hardware.sequential
        };
        let most_bytes = MOST_RECORDED / machines.values().filter(is_recorded).count().max(1);
        let count = |(key, point): (String, &Point)| {
            let draw = || -> OrReason<_> {
                let (setup, _) = shared.setup(point)?;
                let counted = frame::count(of.graph, setup, &point.hardware, of.overflow)
                    .map_err(|error| error.to_string())?;
                let view = of.graph.view();
                // A failure here recurs in the simulation and is reported there.
                let kind = point.hardware.organisation;
                let turns = frame::record_turns(&view, setup, kind, of.overflow, most_bytes);
                let turns = turns.ok().flatten();
                let turns = turns.map(|(frame, turns)| (turns, counted.differing(&frame)));
                Ok((counted, turns))
            };
            (key, draw())
        };
        let counted = machines.into_par_iter().map(count).collect();
        let orders = of.order.map_or(RayOrder::ALL.to_vec(), |order| vec![order]);
        let cast = |(key, (point, sizes)): (String, (&Point, Vec<u32>))| {
            let (setup, _) = shared.setup(point).ok()?;
            let exact = &shared.exact[&point.drawing.size];
            let cast = |&order: &RayOrder| {
                ray_caster::cast(of.graph, setup, &point.hardware, &sizes, order, exact)
            };
            let runs = orders.iter().map(cast).collect::<Result<_, ModelError>>();
            Some(runs.map(|runs| (key, (sizes, runs))))
        };
        let rays = casts.into_par_iter().filter_map(cast);
        let rays = rays.collect::<Result<_, ModelError>>()?;
        (shared.counted, shared.rays) = (counted, rays);
        progress.end();
        Ok(shared)
    }

    fn setup(&self, point: &Point) -> OrReason<(&FrameSetup, &Format)> {
        let setup = self.setups[&format!("{:?}", point.drawing)].as_ref();
        setup
            .map(|(setup, format)| (setup, format))
            .map_err(String::clone)
    }

    /// A point's frame as the serial machine draws it, and its turns.
    fn drawn(&self, point: &Point) -> OrReason<(&FrameSetup, &Format, &Counted, Option<&Turns>)> {
        let (setup, format) = self.setup(point)?;
        let counted = self.counted[&machine_key(point)].as_ref();
        let (counted, turns) = counted.map_err(String::clone)?;
        Ok((setup, format, counted, turns.as_ref()))
    }

    /// A frame on a point's hardware, and the samples that differ from the serial machine's.
    fn simulate(&self, point: &Point) -> Result<OrReason<(CycleReport, u64)>, ModelError> {
        let (setup, _, counted, turns) = match self.drawn(point) {
            Ok(drawn) => drawn,
            Err(reason) => return Ok(Err(reason)),
        };
        let (hardware, overflow) = (&point.hardware, self.of.overflow);
        let view = self.of.graph.view();
        // Recorded turns do not keep the order of their steps.
        let report = match turns.filter(|_| !hardware.sequential) {
            Some((turns, differing)) => {
                frame::replay(turns, &view, setup, hardware).map(|cycles| (cycles, *differing))
            }
            None => frame::simulate(&view, setup, hardware, overflow, &mut NoObserver)
                .map(|(frame, simulated)| (simulated.cycles, counted.differing(&frame))),
        };
        match report {
            Ok(report) => Ok(Ok(report)),
            Err(ModelError::Simulate(
                error @ (SimulateError::Workload(_) | SimulateError::StackOverflow { .. }),
            )) => Ok(Err(error.to_string())),
            Err(error) => Err(error),
        }
    }

    fn price(
        &self,
        point: &Point,
        (cycles, differing_samples): &(CycleReport, u64),
    ) -> Result<PointOutcome, ModelError> {
        let (setup, format, counted, _) = match self.drawn(point) {
            Ok(drawn) => drawn,
            Err(reason) => return Ok(PointOutcome::Refused { reason }),
        };
        let (graph, hardware, prices) = (self.of.graph, &point.hardware, self.of.prices);
        let exact = &self.exact[&point.drawing.size];
        let light = LightDesign::price(graph, setup, counted, cycles, hardware, prices)?;
        let (sizes, runs) = &self.rays[&ray_key(point)];
        let bytes = hardware.node_cache.bytes;
        let at = sizes.iter().position(|&size| size == bytes).unwrap_or(0);
        let rays = ray_caster::cheapest(runs, at, hardware, &self.ray_hardware, prices)?;
        let error = frame::error(&counted.frame, exact);
        let accesses = counted.counter.accesses_by(|cell| cell.memory);
        let of = |memory: Memory| accesses.get(&memory).copied().unwrap_or_default();
        let fill = of(Memory::FillVector);
        let counter = &counted.counter;
        let (energy, rival) = (light.cost.total(), rays.cost.total());
        let floor_pj = floor::floor(graph, exact, hardware, &prices.table)?.energy_pj;
        let half = rival.times(0.5);
        Ok(PointOutcome::Drawn(Box::new(PointFigures {
            cycles: cycles.cycles,
            time_ms: cycles.cycles as f64 / (hardware.clock_mhz * 1e3),
            area_nand2: light.area.range(),
            energy_pj: energy,
            wrong_samples: error.differing(),
            differing_samples: *differing_samples,
            meets_clock: light.clock.misses().next().is_none(),
            limits: cycles.bottleneck.resource.clone(),
            counts: PointCounts {
                records: counter.records(),
                hardware_records: cycles.records,
                operations: counter.ops() - counter.ops_of(OpClass::Shift),
                divide_steps: counter.ops_of(OpClass::DivideStep),
                record_bits: counted.record_bits(),
                deepest_stack: counted.stat("deepest_stack"),
                node_reads: of(Memory::Node).reads,
                node_misses: cycles.node_cache.misses,
                fill_accesses: fill.reads + fill.writes,
                fill_bits: fill_bits::fill_store_bits(setup, hardware),
                extra: error.extra,
                missing: error.missing,
                wrong_voxel: error.wrong_voxel,
            },
            operations_pj: Range::from(&light.cost.operations),
            on_chip_pj: Range::from(&light.cost.on_chip),
            outer_pj: Range::from(&light.cost.outer),
            units_nand2: light.area.units.total,
            format: *format,
            less_energy: Winner::by_ranges(energy, rival),
            less_at_equal_prices: Winner::at_equal_prices(energy, rival),
            floor_pj,
            half_is_impossible: floor_pj.low > half.low && floor_pj.high > half.high,
            ray_caster: RivalFigures {
                order: rays.order,
                cycles: rays.cycles.cycles,
                node_misses: rays.node_misses,
                area_nand2: rays.area.range(),
                energy_pj: rival,
                orders: rays.orders,
            },
        })))
    }
}

/// Everything on which the machine's counts depend.
fn machine_key(point: &Point) -> String {
    format!("{:?} {:?}", point.drawing, point.hardware.organisation)
}

/// Everything on which the rays' counts depend, except the size of the node cache.
fn ray_key(point: &Point) -> String {
    let hardware = &point.hardware;
    let format = |of: &Cache| (of.ways, of.line_bytes, of.entry_bytes);
    format!(
        "{:?} {} {} {} {:?} {:?}",
        point.drawing,
        hardware.organisation.leaf_masks,
        hardware.organisation.bricks,
        hardware.attribute_cache.bytes,
        format(&hardware.node_cache),
        format(&hardware.attribute_cache)
    )
}
