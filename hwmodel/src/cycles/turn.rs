//! A record's turn, as the cycle model needs it.

use super::hardware::{Hardware, Independence};
use super::memories::{Access, Latencies};
use crate::{MAX_STAGES, Memory, OpClass, Operand, Probe, Stage, StageLevel};

pub(super) const STAGES: usize = MAX_STAGES;
pub(super) const CLASSES: usize = OpClass::ALL.len();
/// Widths that are counted separately; wider ones count as this less one.
pub(super) const WIDTHS: usize = 128;

/// The simulated work: records, one turn each, called in the order of simulated time.
pub trait Workload {
    /// Ends the simulation.
    type Error;

    /// Makes the first records.
    fn start(&mut self, children: &mut Vec<Child>) -> Result<(), Self::Error>;

    /// Executes a record's turn and adds its children, nearest first, at most eight.
    fn turn(&mut self, item: u32, children: &mut Vec<Child>) -> Result<(), Self::Error>;

    /// Number of tiles, which replace the start on hardware that [hands them out](Hardware::hands_out_tiles).
    fn tiles(&self) -> u32 {
        0
    }

    /// As [`start`](Self::start), for a tile.
    fn begin_tile(&mut self, _: u32, _: &mut Vec<Child>) -> Result<(), Self::Error> {
        Ok(())
    }

    /// The log that the turns write.
    fn log(&mut self) -> &mut TurnLog;
}

/// A new record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Child {
    /// The workload's number.
    pub item: u32,
    /// In the occlusion order, 0 (nearest) to 7.
    pub place: u8,
    /// Within its parent's.
    pub image_node: ImageNode,
}

impl Child {
    /// The only child of its record.
    pub fn only(item: u32) -> Self {
        Self {
            item,
            place: 0,
            image_node: ImageNode::default(),
        }
    }
}

/// A node of a quadtree: level (0 = root), column and row among `2^level`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[expect(missing_docs, reason = "names of the fields say what they are")]
pub struct ImageNode {
    pub level: u32,
    pub x: u32,
    pub y: u32,
}

impl ImageNode {
    /// Whether neither region contains the other.
    #[inline]
    pub fn is_disjoint(self, other: Self) -> bool {
        let (up, down) = (
            other.level.saturating_sub(self.level),
            self.level.saturating_sub(other.level),
        );
        self.x >> down != other.x >> up || self.y >> down != other.y >> up
    }
}

/// `{7} {6, 5, 3} {4, 2, 1} {0}` in the image-order paper's octants.
const CLASS_OF_PLACE: [u8; 8] = [0, 1, 1, 1, 2, 2, 2, 3];

impl Independence {
    /// Whether `later` does not wait for its sibling `earlier`.
    #[inline]
    pub fn allows(self, earlier: &Child, later: &Child) -> bool {
        let class = |child: &Child| CLASS_OF_PLACE[usize::from(child.place & 7)];
        let classes = || class(earlier) == class(later);
        let image = || earlier.image_node.is_disjoint(later.image_node);
        match self {
            Self::None => false,
            Self::Classes => classes(),
            Self::Image => image(),
            Self::Both => classes() || image(),
        }
    }
}

/// Bit of a stage with memory accesses; the bits below are classes.
const ACCESSED: u16 = 1 << CLASSES;

#[derive(Debug, Clone, Copy, Default)]
struct Done {
    operations: u64,
    passes: u64,
}

/// The probe of a turn: passes through units, and accesses, by stage.
#[derive(Debug)]
pub struct TurnLog {
    done: [[Done; CLASSES]; STAGES],
    accesses: [Vec<Access>; STAGES],
    met: [u16; STAGES],
    hardware: Hardware,
    /// The stages that had work so far.
    stages: [Option<Stage>; STAGES],
    passes_of: Box<[[[u8; WIDTHS]; CLASSES]; STAGES]>,
    units: [[Issue; CLASSES]; STAGES],
    latencies: Latencies,
    child_level: u32,
    most_passes: [[u64; CLASSES]; STAGES],
    sequential: bool,
    over: TurnVisits,
    stage: Stage,
    beside: bool,
}

#[derive(Debug, Clone, Copy, Default)]
struct Issue {
    count: u64,
    latency: u64,
    interval: u64,
}

impl TurnLog {
    /// A log for turns on sound hardware.
    pub fn new(hardware: &Hardware) -> Self {
        Self {
            done: Default::default(),
            accesses: Default::default(),
            met: [0; STAGES],
            hardware: hardware.clone(),
            stages: [None; STAGES],
            passes_of: Box::new([[[0; WIDTHS]; CLASSES]; STAGES]),
            units: [[Issue::default(); CLASSES]; STAGES],
            latencies: Latencies::new(hardware),
            child_level: 0,
            most_passes: [[0; CLASSES]; STAGES],
            sequential: hardware.sequential,
            over: TurnVisits::default(),
            stage: Stage::default(),
            beside: false,
        }
    }

    /// Looks up the units of a stage when it first has work.
    #[cold]
    #[inline(never)]
    fn learn(&mut self, stage: Stage) {
        self.stages[stage.number()] = Some(stage);
        for class in OpClass::ALL {
            let Some(unit) = self.hardware.unit(stage, class) else {
                continue;
            };
            self.units[stage.number()][class as usize] = Issue {
                count: u64::from(unit.count),
                latency: u64::from(unit.latency),
                interval: u64::from(unit.interval),
            };
            let by_width = &mut self.passes_of[stage.number()][class as usize];
            for (bits, passes) in by_width.iter_mut().enumerate() {
                *passes = (bits as u32).div_ceil(unit.width.max(1)).max(1) as u8;
            }
        }
    }

    /// On sequential hardware this ends the visit of another stage.
    #[inline(always)]
    fn enter(&mut self, stage: Stage) {
        if self.stages[stage.number()].is_none() {
            self.learn(stage);
        }
        if self.sequential && self.stage != stage {
            self.end_step(stage);
        }
    }

    fn end_step(&mut self, next: Stage) {
        let last = std::mem::replace(&mut self.stage, next);
        if self.met[last.number()] != 0
            && let Some(last) = self.stages[last.number()]
        {
            let mut over = std::mem::take(&mut self.over);
            self.take_stage(last, &mut over);
            self.over = over;
        }
    }

    #[inline]
    fn access(&mut self, memory: Memory, address: u64, stage: Stage, write: bool) {
        self.enter(stage);
        self.met[stage.number()] |= ACCESSED;
        self.accesses[stage.number()].push(Access {
            address,
            memory,
            write,
        });
    }

    pub(super) fn most_passes(&self) -> &[[u64; CLASSES]; STAGES] {
        &self.most_passes
    }

    #[inline]
    pub(super) fn take(&mut self, plan: &mut TurnVisits) {
        plan.visits.clear();
        plan.accesses.clear();
        plan.alone = 0;
        plan.worst = 0;
        let changed = self.sequential && self.take_steps(plan);
        plan.child_level = self.child_level;
        plan.changed_to_screen = changed;
        for stage in 0..STAGES {
            if self.met[stage] != 0
                && let Some(stage) = self.stages[stage]
            {
                self.take_stage(stage, plan);
            }
        }
    }

    fn take_steps(&mut self, plan: &mut TurnVisits) -> bool {
        self.end_step(Stage::default());
        std::mem::swap(&mut self.over, plan);
        self.over.changed_to_screen = false;
        std::mem::take(&mut plan.changed_to_screen)
    }

    #[inline]
    fn take_stage(&mut self, stage: Stage, plan: &mut TurnVisits) {
        let (mut occupied, mut latency) = (1, 0);
        let mut sum = Done::default();
        let of = stage.number();
        let mut classes = std::mem::take(&mut self.met[of]) & !ACCESSED;
        plan.changed_to_screen |= classes & 1 << OpClass::DivideStep as u16 != 0;
        while classes != 0 {
            let class = classes.trailing_zeros() as usize % CLASSES;
            classes &= classes - 1;
            let done = std::mem::take(&mut self.done[of][class]);
            let unit = &self.units[of][class];
            if done.passes > 0 {
                let most = &mut self.most_passes[of][class];
                *most = done.passes.max(*most);
                let issues = if done.passes <= unit.count {
                    1
                } else if done.passes <= u64::from(u32::MAX) {
                    // Division of 32 bits is several times faster.
                    u64::from((done.passes as u32).div_ceil(unit.count as u32))
                } else {
                    done.passes.div_ceil(unit.count)
                };
                occupied = occupied.max(issues * unit.interval);
                latency = latency.max(unit.latency);
            }
            sum.operations += done.operations;
            sum.passes += done.passes;
        }
        let first = plan.accesses.len();
        let accesses = &mut self.accesses[stage.number()];
        let mut alone = occupied + latency;
        if self.sequential {
            let reads = accesses.iter().filter(|access| !access.write).count() as u64;
            let operated = if sum.operations == 0 { 0 } else { occupied };
            // Each read takes one of the operations' cycles, to inspect its result.
            latency += operated.max(reads) - reads;
            occupied = 0;
            plan.worst += reads + latency;
            alone = reads + latency;
            for &access in accesses.iter() {
                alone += self.latencies.alone(access);
                plan.worst += self.latencies.worst(access);
            }
            alone = alone.max(1);
        } else {
            plan.worst += alone;
            for &access in accesses.iter() {
                alone = alone.max(self.latencies.alone(access));
                plan.worst += self.latencies.worst(access);
            }
        }
        plan.accesses.append(accesses);
        plan.alone += alone;
        plan.visits.push(Visit {
            stage,
            occupied,
            latency,
            alone,
            accesses: first..plan.accesses.len(),
            operations: sum.operations,
            passes: sum.passes,
        });
    }
}

impl Probe for TurnLog {
    #[inline(always)]
    fn op_on(&mut self, operand: Operand, class: OpClass, bits: u32, place: StageLevel) {
        if operand != Operand::Control {
            self.op(class, bits, place, 1);
        }
    }

    #[inline(always)]
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        let at = match self.beside {
            true => self.stage,
            false => place.stage,
        };
        self.enter(at);
        let (stage, class) = (at.number(), class as usize);
        let width = (bits as usize).min(WIDTHS - 1);
        let passes = self.passes_of[stage][class][width];
        let done = &mut self.done[stage][class];
        done.operations += u64::from(times);
        done.passes += u64::from(passes) * u64::from(times);
        self.met[stage] |= 1 << class;
    }

    #[inline]
    fn next_step(&mut self, idle: u32, place: StageLevel) {
        if !self.sequential {
            return;
        }
        self.end_step(place.stage);
        if idle > 0 {
            let cycles = u64::from(idle);
            let over = &mut self.over;
            over.worst += cycles;
            over.alone += cycles;
            let none = over.accesses.len();
            over.visits.push(Visit {
                stage: place.stage,
                occupied: 0,
                latency: cycles,
                alone: cycles,
                accesses: none..none,
                operations: 0,
                passes: 0,
            });
        }
    }

    #[inline]
    fn beside(&mut self, begins: bool) {
        self.beside = self.sequential && begins;
    }

    #[inline]
    fn record(&mut self, _: u64, level: u32) {
        self.child_level = level + 1;
    }

    #[inline]
    fn read(&mut self, memory: Memory, address: u64, place: StageLevel) {
        self.access(memory, address, place.stage, false);
    }

    #[inline]
    fn write(&mut self, memory: Memory, address: u64, place: StageLevel) {
        self.access(memory, address, place.stage, true);
    }
}

#[derive(Debug, Clone)]
pub(super) struct Visit {
    pub(super) stage: Stage,
    pub(super) occupied: u64,
    pub(super) latency: u64,
    /// Cycles without any waiting.
    pub(super) alone: u64,
    pub(super) accesses: std::ops::Range<usize>,
    pub(super) operations: u64,
    pub(super) passes: u64,
}

#[derive(Debug, Default)]
pub(super) struct TurnVisits {
    pub(super) visits: Vec<Visit>,
    pub(super) accesses: Vec<Access>,
    pub(super) alone: u64,
    /// Cycles with the longest waits, alone on the hardware.
    pub(super) worst: u64,
    pub(super) child_level: u32,
    pub(super) changed_to_screen: bool,
}
