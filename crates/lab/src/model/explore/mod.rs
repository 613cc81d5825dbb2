//! Many hardware designs for one frame, measured in parallel.
//!
//! [`space`] describes the designs, and [`mod@front`] finds the Pareto-optimal ones. [`lines`] is the format of results.
//!
//! Points share results that depend on a part of them only: see `machine_key` and `Shared::ray_key`.

pub mod front;
pub mod lines;
pub mod space;

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::{Mutex, PoisonError};

use hwmodel::cycles::{CycleReport, Hardware, NoObserver};
use hwmodel::{Memory, OpClass, Overflow};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::ModelError;
use super::cost::Prices;
use super::design::LightDesign;
use super::fill_bits;
use super::frame::{self, Counted};
use super::ray_caster;
use super::verdict::{self, Verdict};
use crate::measure::CoverageError;
use crate::rival::{self, Cast, Rival};
use shiftvox::frame::Frame;
use shiftvox::graph::{Graph, Progress};
use shiftvox::machine::SimulateError;
use shiftvox::project::{Camera, FrameSetup, SetupOptions, stat};
use space::Point;

#[derive(Debug, Clone, Copy)]
pub struct Explored<'a> {
    pub graph: &'a Graph,
    pub camera: &'a Camera,
    /// Rules and words, where the points do not set others.
    pub options: &'a SetupOptions,
    pub overflow: Overflow,
    pub rival: &'a Rival,
    pub prices: &'a Prices,
}

impl Explored<'_> {
    fn camera(&self, point: &Point) -> Camera {
        let size = point.drawing.size;
        Camera {
            width: size.unwrap_or(self.camera.width),
            height: size.unwrap_or(self.camera.height),
            ..*self.camera
        }
    }

    fn setup(&self, point: &Point) -> OrReason<FrameSetup> {
        let (camera, options) = (self.camera(point), point.drawing.options(self.options));
        let Graph {
            placement, depth, ..
        } = self.graph;
        FrameSetup::new(&camera, placement, *depth, &options).map_err(|error| error.to_string())
    }
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
    pub area_nand2: f64,
    pub energy_pj: f64,
    /// Samples that differ from the exact picture in any way.
    pub wrong_samples: u64,
    /// Samples that differ from the serial machine's picture.
    pub differing_samples: u64,
    pub meets_clock: bool,
    pub limits: String,
    pub counts: PointCounts,
    pub operations_pj: f64,
    pub on_chip_pj: f64,
    pub leakage_pj: f64,
    pub clock_pj: f64,
    pub outer_pj: f64,
    pub units_nand2: f64,
    pub ray_caster: RivalFigures,
    /// On the energy of the frame.
    pub verdict: Verdict,
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
    pub cycles: u64,
    pub node_misses: u64,
    pub area_nand2: f64,
    pub energy_pj: f64,
    pub on_chip_pj: f64,
    pub wrong_samples: u64,
}

type OrReason<T> = Result<T, String>;

struct Shared<'a> {
    of: Explored<'a>,
    /// By side of the picture.
    exact: BTreeMap<Option<u32>, Frame>,
    /// Set-ups, and the machine's counts, by [`machine_key`].
    counted: BTreeMap<String, OrReason<(FrameSetup, Counted)>>,
    /// Rays, by [`Shared::ray_key`].
    rays: BTreeMap<String, Cast>,
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
            counted: BTreeMap::new(),
            rays: BTreeMap::new(),
        };
        // By key, a point that has it.
        let mut machines = BTreeMap::<String, &Point>::new();
        let mut casts = BTreeMap::<String, &Point>::new();
        for point in points {
            if let Entry::Vacant(place) = shared.exact.entry(point.drawing.size) {
                let setup = frame::exact_setup(of.graph, &of.camera(point), of.options.aa_log2)?;
                place.insert(frame::reference(&of.graph.view(), &setup)?);
            }
            machines.entry(machine_key(point)).or_insert(point);
            casts.entry(shared.ray_key(point)).or_insert(point);
        }
        let count = |(key, point): (String, &Point)| {
            let counted = of.setup(point).and_then(|setup| {
                let organisation = point.hardware.organisation;
                let counted = frame::count(of.graph, &setup, organisation, of.overflow);
                Ok((setup, counted.map_err(|error| error.to_string())?))
            });
            (key, counted)
        };
        let counted = machines.into_par_iter().map(count).collect();
        let cast = |(key, point): (String, &Point)| {
            let setup = of.setup(point).ok()?;
            let hardware = of.rival.beside(&point.hardware);
            Some(rival::cast(of.graph, &setup, of.rival, &hardware).map(|cast| (key, cast)))
        };
        let rays = casts.into_par_iter().filter_map(cast);
        let rays = rays.collect::<Result<_, ModelError>>()?;
        (shared.counted, shared.rays) = (counted, rays);
        progress.end();
        Ok(shared)
    }

    /// Everything on which rays and their cycles depend.
    fn ray_key(&self, point: &Point) -> String {
        let hardware = Hardware {
            name: String::new(),
            clock_mhz: 1.0,
            ..self.of.rival.beside(&point.hardware)
        };
        format!("{:?} {hardware:?}", point.drawing)
    }

    /// A point's frame as the serial machine draws it.
    fn drawn(&self, point: &Point) -> OrReason<&(FrameSetup, Counted)> {
        let counted = self.counted[&machine_key(point)].as_ref();
        counted.map_err(String::clone)
    }

    /// A frame on a point's hardware, and the samples that differ from the serial machine's.
    fn simulate(&self, point: &Point) -> Result<OrReason<(CycleReport, u64)>, ModelError> {
        let (setup, counted) = match self.drawn(point) {
            Ok(drawn) => drawn,
            Err(reason) => return Ok(Err(reason)),
        };
        let (hardware, overflow) = (&point.hardware, self.of.overflow);
        let view = self.of.graph.view();
        match frame::simulate(&view, setup, hardware, overflow, &mut NoObserver) {
            Ok((frame, simulated)) => Ok(Ok((simulated.cycles, counted.differing(&frame)))),
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
        let (setup, counted) = match self.drawn(point) {
            Ok(drawn) => drawn,
            Err(reason) => return Ok(PointOutcome::Refused { reason }),
        };
        let (graph, hardware, prices) = (self.of.graph, &point.hardware, self.of.prices);
        let exact = &self.exact[&point.drawing.size];
        let light = LightDesign::price(graph, setup, counted, cycles, hardware, prices)?;
        let cast = &self.rays[&self.ray_key(point)];
        let beside = self.of.rival.beside(hardware);
        let rays = ray_caster::price(cast, (self.of.rival, &beside), prices, exact)?;
        let error = CoverageError::between(&counted.frame.voxel, &exact.voxel);
        let counter = &counted.counter;
        Ok(PointOutcome::Drawn(Box::new(PointFigures {
            cycles: cycles.cycles,
            time_ms: cycles.cycles as f64 / (hardware.clock_mhz * 1e3),
            area_nand2: light.area.total,
            energy_pj: light.cost.total(),
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
                deepest_stack: stat(&counted.stats, "deepest_stack"),
                node_reads: counter.reads(Memory::Node),
                node_misses: cycles.node_cache.misses,
                fill_accesses: counter.reads(Memory::FillVector)
                    + counter.writes(Memory::FillVector),
                fill_bits: fill_bits::fill_store_bits(setup, hardware),
                extra: error.extra,
                missing: error.missing,
                wrong_voxel: error.wrong_voxel,
            },
            operations_pj: light.cost.operations.total,
            on_chip_pj: light.cost.on_chip.total,
            leakage_pj: light.cost.leakage.total,
            clock_pj: light.cost.clock.total,
            outer_pj: light.cost.outer.total,
            units_nand2: light.area.units.total,
            verdict: verdict::of_energy(&light.cost, &rays.cost, &prices.table),
            ray_caster: RivalFigures {
                cycles: rays.cycles.cycles,
                node_misses: rays.cycles.node_cache.misses,
                area_nand2: rays.area.total,
                energy_pj: rays.cost.total(),
                on_chip_pj: rays.cost.chip_total(),
                wrong_samples: rays.error.differing(),
            },
        })))
    }
}

/// Everything on which the machine's counts depend.
fn machine_key(point: &Point) -> String {
    format!("{:?} {:?}", point.drawing, point.hardware.organisation)
}
