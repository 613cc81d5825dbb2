//! What a record's turn does, as the cycle model needs it.

use super::hardware::{Hardware, Independence};
use super::memories::Latencies;
use crate::{Memory, OpClass, Place, Probe, Stage};

pub(super) const STAGES: usize = Stage::ALL.len();
const CLASSES: usize = OpClass::ALL.len();
/// Widths of operations that are told apart; wider ones count as this less one.
const WIDTHS: usize = 128;

/// What is simulated: something that works on records, one turn each, and
/// knows what a turn does only by doing it.
///
/// The simulator calls [`Workload::turn`] in the order of simulated time, so
/// that a record finds things as they are when its turn begins.
pub trait Workload {
    /// Why a turn failed.
    type Error;

    /// Makes the first records. What this does counts as a turn of its own,
    /// of a record that was on no stack.
    ///
    /// # Errors
    /// As the workload has them.
    fn start(&mut self, children: &mut Vec<Child>) -> Result<(), Self::Error>;

    /// A record's turn: what it does goes into the log; the records that it
    /// leaves go into `children` (empty before), nearest first, at most eight.
    ///
    /// # Errors
    /// As the workload has them.
    fn turn(&mut self, item: u32, children: &mut Vec<Child>) -> Result<(), Self::Error>;

    /// The log that the turns write.
    fn log(&mut self) -> &mut TurnLog;
}

/// A record that a turn left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Child {
    /// What the workload knows it by.
    pub item: u32,
    /// Its place in the occlusion order, 0 (nearest) to 7.
    pub place: u8,
    /// Its part of the picture, within its parent's.
    pub region: Region,
}

/// A node of a quadtree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Region {
    /// Level, 0 = root.
    pub level: u32,
    /// Column among `2^level`.
    pub x: u32,
    /// Row among `2^level`.
    pub y: u32,
}

impl Region {
    /// Whether neither region holds the other.
    #[inline]
    #[must_use]
    pub fn is_disjoint(self, other: Self) -> bool {
        let (up, down) = (
            other.level.saturating_sub(self.level),
            self.level.saturating_sub(other.level),
        );
        self.x >> down != other.x >> up || self.y >> down != other.y >> up
    }
}

/// Classes of the occlusion order by place: `{7} {6, 5, 3} {4, 2, 1} {0}` in
/// the paper's octants.
const CLASS_OF_PLACE: [u8; 8] = [0, 1, 1, 1, 2, 2, 2, 3];

impl Independence {
    /// Whether `later` need not wait for `earlier`, its sibling.
    #[inline]
    #[must_use]
    pub fn allows(self, earlier: &Child, later: &Child) -> bool {
        let class = |child: &Child| CLASS_OF_PLACE[usize::from(child.place & 7)];
        let classes = || class(earlier) == class(later);
        let image = || earlier.region.is_disjoint(later.region);
        match self {
            Self::None => false,
            Self::Classes => classes(),
            Self::Image => image(),
            Self::Both => classes() || image(),
        }
    }
}

/// An access to a memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Access {
    pub(super) address: u64,
    pub(super) memory: Memory,
    pub(super) write: bool,
}

#[derive(Debug, Default)]
struct InStage {
    passes: [u32; CLASSES],
    operations: u64,
    accesses: Vec<Access>,
}

/// The probe of a turn: operations as passes through a hardware's units, and
/// accesses, by stage. All that a turn does in one stage is one *visit* of
/// it; visits are in the order in which their stages were met first.
#[derive(Debug)]
pub struct TurnLog {
    stages: [InStage; STAGES],
    /// Bit by stage.
    met: u32,
    order: [Stage; STAGES],
    count: usize,
    /// Passes of one operation: by stage, class, width.
    passes_of: Box<[[[u8; WIDTHS]; CLASSES]; STAGES]>,
    units: [[Issue; CLASSES]; STAGES],
    latencies: Latencies,
}

/// A unit as the log needs it; `count` 0: wires.
#[derive(Debug, Clone, Copy, Default)]
struct Issue {
    count: u32,
    latency: u32,
    interval: u32,
}

impl TurnLog {
    /// A log for turns on a hardware.
    #[must_use]
    pub fn new(hardware: &Hardware) -> Self {
        let mut passes_of = Box::new([[[0; WIDTHS]; CLASSES]; STAGES]);
        let mut units = [[Issue::default(); CLASSES]; STAGES];
        for stage in Stage::ALL {
            for class in OpClass::ALL {
                let Some(unit) = hardware.unit(stage, class) else {
                    continue;
                };
                units[stage as usize][class as usize] = Issue {
                    count: unit.count,
                    latency: unit.latency,
                    interval: unit.interval,
                };
                let by_width = &mut passes_of[stage as usize][class as usize];
                for (bits, passes) in by_width.iter_mut().enumerate() {
                    // At most 127: it fits.
                    *passes = (bits as u32).div_ceil(unit.width).max(1) as u8;
                }
            }
        }
        Self {
            stages: Default::default(),
            met: 0,
            order: [Stage::Pop; STAGES],
            count: 0,
            passes_of,
            units,
            latencies: Latencies::new(hardware),
        }
    }

    #[inline(always)]
    fn meet(&mut self, stage: Stage) -> &mut InStage {
        let bit = 1 << stage as u32;
        if self.met & bit == 0 {
            self.met |= bit;
            self.order[self.count] = stage;
            self.count += 1;
        }
        &mut self.stages[stage as usize]
    }

    #[inline]
    fn access(&mut self, memory: Memory, address: u64, stage: Stage, write: bool) {
        self.meet(stage).accesses.push(Access {
            address,
            memory,
            write,
        });
    }

    /// Takes the turn's visits and accesses, and forgets them.
    #[inline]
    pub(super) fn take(&mut self, plan: &mut Plan) {
        plan.visits.clear();
        plan.accesses.clear();
        plan.alone = 0;
        plan.worst = 0;
        for &stage in &self.order[..self.count] {
            let did = &mut self.stages[stage as usize];
            let (mut occupied, mut latency, mut passes) = (1, 0, 0);
            for (done, unit) in did.passes.iter_mut().zip(&self.units[stage as usize]) {
                if *done == 0 {
                    continue;
                }
                let issues = if *done <= unit.count {
                    1
                } else {
                    done.div_ceil(unit.count)
                };
                occupied = occupied.max(u64::from(issues) * u64::from(unit.interval));
                latency = latency.max(unit.latency);
                passes += u64::from(*done);
                *done = 0;
            }
            let mut alone = occupied + u64::from(latency);
            let first = plan.accesses.len();
            plan.worst += alone;
            for &access in &did.accesses {
                alone = alone.max(u64::from(self.latencies.alone(access)));
                plan.worst += self.latencies.worst(access);
            }
            plan.accesses.extend_from_slice(&did.accesses);
            did.accesses.clear();
            plan.alone += alone;
            plan.visits.push(Visit {
                stage,
                occupied,
                latency,
                alone,
                accesses: first..plan.accesses.len(),
                operations: did.operations,
                passes,
            });
            did.operations = 0;
        }
        self.count = 0;
        self.met = 0;
    }
}

impl Probe for TurnLog {
    #[inline(always)]
    fn op(&mut self, class: OpClass, bits: u32, place: Place, times: u32) {
        let stage = place.stage;
        let width = (bits as usize).min(WIDTHS - 1);
        let each = self.passes_of[stage as usize][class as usize][width];
        let here = self.meet(stage);
        here.passes[class as usize] += u32::from(each) * times;
        here.operations += u64::from(times);
    }

    #[inline]
    fn read(&mut self, memory: Memory, address: u64, place: Place) {
        self.access(memory, address, place.stage, false);
    }

    #[inline]
    fn write(&mut self, memory: Memory, address: u64, place: Place) {
        self.access(memory, address, place.stage, true);
    }
}

/// What a turn does in one stage.
#[derive(Debug, Clone)]
pub(super) struct Visit {
    pub(super) stage: Stage,
    /// Cycles during which its operations are issued, at least 1.
    pub(super) occupied: u64,
    /// Further cycles until their results are there.
    pub(super) latency: u32,
    /// Cycles if it waits for nothing.
    pub(super) alone: u64,
    pub(super) accesses: std::ops::Range<usize>,
    pub(super) operations: u64,
    pub(super) passes: u64,
}

/// A turn's visits, in order.
#[derive(Debug, Default)]
pub(super) struct Plan {
    pub(super) visits: Vec<Visit>,
    pub(super) accesses: Vec<Access>,
    /// Cycles if it waits for nothing.
    pub(super) alone: u64,
    /// Cycles if it waits for all it ever must with nothing else under way.
    pub(super) worst: u64,
}
