//! Many hardware designs on one frame: which are worth building.
//!
//! [`space`] says which designs there are, [`explore`] measures them, [`mod@front`] finds those that
//! no other beats in time, area, energy and wrong samples; [`lines`] is how results are written,
//! one a line, so that a run can be gone on with, or shared among computers.
//!
//! What does not depend on the whole point is computed once for all points that have it in common:
//! the exact picture; what the machine counts, by width and organisation; the rays, by width, node
//! format and lines, for caches of all sizes at once; cycles, by all but name and clock. Where parents lie on
//! the stack, a record's turn does the same on every hardware: those turns are recorded once, and only
//! the cycles are simulated anew. The figures are those of `shiftvox model` for the same hardware.

pub mod front;
pub mod lines;
pub mod space;

use std::collections::BTreeMap;
use std::sync::Mutex;

use hwmodel::Overflow;
use hwmodel::cycles::{Cache, CycleReport, Hardware, NoObserver, Recording, StackHolds};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::cost::Prices;
use super::design::LightDesign;
use super::frame::{self, Counted};
use super::range::Range;
use super::ray_caster::{self, RayRun};
use super::ray_cycles::RayHardware;
use super::{ModelError, rules};
use crate::float_rays::RayOrder;
use shiftvox::frame::Frame;
use shiftvox::graph::{Graph, Progress};
use shiftvox::machine::SimulateError;
use shiftvox::project::{Camera, FrameSetup, SetupOptions};
use space::Point;

/// What is drawn, how, and by which prices.
#[derive(Debug, Clone, Copy)]
pub struct Explored<'a> {
    /// The scene.
    pub graph: &'a Graph,
    /// From where it is seen, with the picture's size.
    pub camera: &'a Camera,
    /// Rules and words; points may have another width.
    pub options: &'a SetupOptions,
    /// What becomes of words that overflow.
    pub overflow: Overflow,
    /// The order of the ray caster's rays; none: for each point the one of least energy.
    pub order: Option<RayOrder>,
    /// Prices.
    pub prices: &'a Prices,
}

/// What a point came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "outcome", rename_all = "snake_case")]
pub enum PointOutcome {
    /// The frame was drawn.
    Drawn(Box<PointFigures>),
    /// It cannot be.
    Refused {
        /// Why: no such frame in words of this width, a word or a stack that overflows.
        reason: String,
    },
}

/// The figures of a point, as `shiftvox model` has them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointFigures {
    /// Cycles of the frame.
    pub cycles: u64,
    /// Time of the frame at the hardware's clock, ms.
    pub time_ms: f64,
    /// Area, NAND2 equivalents.
    pub area_nand2: Range,
    /// Energy of the frame, pJ.
    pub energy_pj: Range,
    /// Samples that show other than the exact picture: something else, too much or nothing.
    pub wrong_samples: u64,
    /// Samples that the hardware's picture shows otherwise than the serial machine's.
    pub differing_samples: u64,
    /// Whether all units that the frame uses keep up with the clock.
    pub meets_clock: bool,
    /// What limits the frame.
    pub limits: String,
    /// The ray caster with the same caches, nodes and clock.
    pub ray_caster: RivalFigures,
}

/// The ray caster's figures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RivalFigures {
    /// The order of its rays.
    pub order: RayOrder,
    /// Cycles of the frame, no fewer than.
    pub cycles: u64,
    /// Area, NAND2 equivalents.
    pub area_nand2: Range,
    /// Energy of the frame, pJ.
    pub energy_pj: Range,
}

/// What is there, or the reason why it is not.
type OrReason<T> = Result<T, String>;

/// Most bytes of all recorded turns.
const MOST_RECORDED: usize = 1 << 30;

/// What points have in common, by what it depends on.
struct Shared<'a> {
    of: Explored<'a>,
    exact: Frame,
    /// By width of a word.
    setups: BTreeMap<Option<u32>, OrReason<FrameSetup>>,
    /// What the machine counts, by [`machine_key`].
    counted: BTreeMap<String, OrReason<Counted>>,
    /// Turns that are the same on every hardware, and the picture's samples that are not the
    /// serial machine's, by [`machine_key`].
    turns: BTreeMap<String, (Recording, u64)>,
    /// By [`ray_key`]: sizes of the node cache, and the rays of every order.
    rays: BTreeMap<String, (Vec<u32>, Vec<RayRun>)>,
    ray_hardware: RayHardware,
}

/// Measures points. `sink` gets them in their order, each as soon as those before it are there.
///
/// # Errors
/// When the camera sees nothing, the cost tables lack a figure, or the sink fails.
pub fn explore<E: From<ModelError> + Send>(
    of: Explored<'_>,
    points: &[Point],
    progress: &dyn Progress,
    sink: impl FnMut(&Point, PointOutcome) -> Result<(), E> + Send,
) -> Result<(), E> {
    let shared = Shared::new(of, points, progress)?;
    // Points that differ in name and clock alone take the same cycles.
    let mut groups = Vec::<Vec<usize>>::new();
    let mut places = BTreeMap::new();
    for (at, point) in points.iter().enumerate() {
        let like = Hardware {
            name: String::new(),
            clock_mhz: 1.0,
            ..point.hardware.clone()
        };
        let place = *places
            .entry(format!("{:?} {like:?}", point.bits))
            .or_insert(groups.len());
        if place == groups.len() {
            groups.push(Vec::new());
        }
        groups[place].push(at);
    }
    progress.begin("points", points.len() as u64);
    let in_order = Mutex::new(InOrder {
        waiting: BTreeMap::new(),
        next: 0,
        sink,
    });
    // In turn, not in halves: those that the sink waits for come first.
    let done = groups.into_iter().par_bridge().try_for_each(|group| {
        let simulated = shared.simulate(&points[group[0]])?;
        for at in group {
            let outcome = match &simulated {
                Ok(simulated) => shared.price(&points[at], simulated)?,
                Err(reason) => PointOutcome::Refused {
                    reason: reason.clone(),
                },
            };
            let mut in_order = in_order
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner);
            in_order.put(at, outcome, points)?;
            progress.advance(1);
        }
        Ok(())
    });
    progress.end();
    done
}

/// Hands outcomes on in the order of their points.
struct InOrder<S> {
    waiting: BTreeMap<usize, PointOutcome>,
    next: usize,
    sink: S,
}

impl<E, S: FnMut(&Point, PointOutcome) -> Result<(), E>> InOrder<S> {
    fn put(&mut self, at: usize, outcome: PointOutcome, points: &[Point]) -> Result<(), E> {
        self.waiting.insert(at, outcome);
        while let Some(outcome) = self.waiting.remove(&self.next) {
            let point = &points[self.next];
            self.next += 1;
            (self.sink)(point, outcome)?;
        }
        Ok(())
    }
}

impl<'a> Shared<'a> {
    fn new(
        of: Explored<'a>,
        points: &[Point],
        progress: &dyn Progress,
    ) -> Result<Self, ModelError> {
        progress.begin("what points have in common", 0);
        let true_setup = rules::true_setup(of.graph, of.camera, of.options)?;
        let mut shared = Self {
            of,
            exact: frame::reference(&of.graph.view(), &true_setup)?,
            setups: BTreeMap::new(),
            counted: BTreeMap::new(),
            turns: BTreeMap::new(),
            rays: BTreeMap::new(),
            ray_hardware: RayHardware::shipped(),
        };
        // By key, a point that has it; of rays, with all sizes of its cache.
        let mut machines = BTreeMap::<String, &Point>::new();
        let mut casts = BTreeMap::<String, (&Point, Vec<u32>)>::new();
        for point in points {
            let setup = || {
                let options = SetupOptions {
                    bits: point.bits.unwrap_or(of.options.bits),
                    ..*of.options
                };
                let placement = &of.graph.placement;
                FrameSetup::new(of.camera, placement, of.graph.depth, &options)
                    .map_err(|error| error.to_string())
            };
            shared.setups.entry(point.bits).or_insert_with(setup);
            machines.entry(machine_key(point)).or_insert(point);
            let cast = casts.entry(ray_key(point));
            let (_, sizes) = cast.or_insert_with(|| (point, Vec::new()));
            let bytes = point.hardware.node_cache.bytes;
            if !sizes.contains(&bytes) {
                sizes.push(bytes);
            }
        }
        let machines: Vec<_> = machines.into_iter().collect();
        let is_recorded = |point: &&Point| {
            let organisation = point.hardware.organisation;
            organisation.stack != StackHolds::Children && !point.hardware.sequential
        };
        let recorded = machines.iter().map(|(_, point)| *point);
        let most_bytes = MOST_RECORDED / recorded.filter(is_recorded).count().max(1);
        let count = |(key, point): (String, &Point)| {
            let hardware = &point.hardware;
            let draw = || -> Result<_, String> {
                let setup = shared.setup(point)?;
                let counted = frame::count(of.graph, setup, hardware, of.overflow)
                    .map_err(|error| error.to_string())?;
                let view = of.graph.view();
                // What fails here fails in the simulation too, and is told there.
                let kind = hardware.organisation;
                let turns = frame::record_turns(&view, setup, kind, of.overflow, most_bytes);
                let turns = turns.ok().flatten();
                let turns = turns.map(|(frame, turns)| (turns, counted.differing(&frame)));
                Ok((counted, turns))
            };
            match draw() {
                Ok((counted, turns)) => (key, Ok(counted), turns),
                Err(reason) => (key, Err(reason), None),
            }
        };
        let drawn: Vec<_> = machines.into_par_iter().map(count).collect();
        let orders = of.order.map_or(RayOrder::ALL.to_vec(), |order| vec![order]);
        let cast = |(key, (point, sizes)): (String, (&Point, Vec<u32>))| {
            let Ok(setup) = shared.setup(point) else {
                return Ok(None);
            };
            let cast = |&order: &RayOrder| {
                let hardware = &point.hardware;
                ray_caster::cast(of.graph, setup, hardware, &sizes, order, &shared.exact)
            };
            let runs = orders.iter().map(cast).collect::<Result<_, ModelError>>()?;
            Ok(Some((key, (sizes, runs))))
        };
        let casts: Vec<_> = casts.into_iter().collect();
        let rays: Vec<_> = casts
            .into_par_iter()
            .map(cast)
            .collect::<Result<_, ModelError>>()?;
        for (key, counted, turns) in drawn {
            shared.turns.extend(turns.map(|turns| (key.clone(), turns)));
            shared.counted.insert(key, counted);
        }
        shared.rays = rays.into_iter().flatten().collect();
        progress.end();
        Ok(shared)
    }

    /// A point's frame set-up.
    fn setup(&self, point: &Point) -> OrReason<&FrameSetup> {
        match self.setups.get(&point.bits) {
            Some(setup) => setup.as_ref().map_err(Clone::clone),
            None => unreachable!("every point's frame is set up"),
        }
    }

    /// A point's frame as the machine draws it, serially.
    fn drawn(&self, point: &Point) -> OrReason<(&FrameSetup, &Counted)> {
        let setup = self.setup(point)?;
        match self.counted.get(&machine_key(point)) {
            Some(Ok(counted)) => Ok((setup, counted)),
            Some(Err(reason)) => Err(reason.clone()),
            None => unreachable!("every point's machine has drawn"),
        }
    }

    /// A frame on a point's hardware, and the samples that it shows otherwise than the serial machine's.
    fn simulate(&self, point: &Point) -> Result<OrReason<(CycleReport, u64)>, ModelError> {
        let (setup, counted) = match self.drawn(point) {
            Ok(drawn) => drawn,
            Err(reason) => return Ok(Err(reason)),
        };
        let (hardware, overflow) = (&point.hardware, self.of.overflow);
        let view = self.of.graph.view();
        // Recorded turns do not keep the order of their steps.
        let turns = self.turns.get(&machine_key(point));
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
        let (setup, counted) = match self.drawn(point) {
            Ok(drawn) => drawn,
            Err(reason) => return Ok(PointOutcome::Refused { reason }),
        };
        let (hardware, prices) = (&point.hardware, self.of.prices);
        let light = LightDesign::price(self.of.graph, setup, counted, cycles, hardware, prices)?;
        let Some((sizes, runs)) = self.rays.get(&ray_key(point)) else {
            unreachable!("every point that is drawn has rays beside it");
        };
        let bytes = hardware.node_cache.bytes;
        let at = sizes.iter().position(|&size| size == bytes).unwrap_or(0);
        let rays = ray_caster::cheapest(runs, at, hardware, &self.ray_hardware, prices)?;
        Ok(PointOutcome::Drawn(Box::new(PointFigures {
            cycles: cycles.cycles,
            time_ms: cycles.cycles as f64 / (hardware.clock_mhz * 1e3),
            area_nand2: light.area.range(),
            energy_pj: Range::new(light.cost.total()),
            wrong_samples: frame::error(&counted.frame, &self.exact).differing(),
            differing_samples: *differing_samples,
            meets_clock: light.clock.misses().next().is_none(),
            limits: cycles.bottleneck.resource.clone(),
            ray_caster: RivalFigures {
                order: rays.order,
                cycles: rays.cycles.cycles,
                area_nand2: rays.area.range(),
                energy_pj: Range::new(rays.cost.total()),
            },
        })))
    }
}

/// What the machine's counts depend on.
fn machine_key(point: &Point) -> String {
    format!("{:?} {:?}", point.bits, point.hardware.organisation)
}

/// What the rays' counts depend on, but for the size of the node cache.
fn ray_key(point: &Point) -> String {
    let hardware = &point.hardware;
    let format = |of: &Cache| (of.ways, of.line_bytes, of.entry_bytes);
    format!(
        "{:?} {} {} {} {:?} {:?}",
        point.bits,
        hardware.organisation.leaf_masks,
        hardware.organisation.bricks,
        hardware.attribute_cache.bytes,
        format(&hardware.node_cache),
        format(&hardware.attribute_cache)
    )
}
