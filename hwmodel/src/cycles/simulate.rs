//! Contexts, blocks, and the choice of the next record.

use std::collections::VecDeque;

use super::hardware::{Hardware, HardwareError, StackOverflow};
use super::memories::Memories;
use super::observe::{Observer, START, VisitSpan};
use super::report::{Cause, CycleReport};
use super::sequential::{Asked, Step};
use super::tasks::Tasks;
use super::totals::Totals;
use super::turn::{Child, STAGES, TurnVisits, Workload};
use super::wheel::Wheel;
use crate::Stage;
use crate::memory::RecordKind;

const NONE: u32 = u32::MAX;
const PROGRESS: u64 = 1 << 14;

/// Why a simulation ended early.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulationError<E> {
    /// Of the workload.
    #[error(transparent)]
    Workload(#[from] E),
    /// An invalid description.
    #[error(transparent)]
    Hardware(HardwareError),
    /// A stack without room, on hardware that does not spill.
    #[error(
        "record {record} leaves more records than the {entries} entries of lane {lane}'s \
         stack hold; give it more, or set overflow = \"spill\""
    )]
    #[expect(missing_docs, reason = "the record is numbered in the order of turns")]
    StackOverflow {
        record: u64,
        lane: u32,
        entries: u32,
    },
}

#[derive(Debug, Clone, Copy)]
struct StageBlock {
    free_at: u64,
    /// Waiting contexts, in order; the first has its event set.
    first: u32,
    last: u32,
}

#[derive(Debug, Default)]
pub(super) struct Context {
    pub(super) lane: u32,
    pub(super) number: u32,
    pub(super) plan: TurnVisits,
    pub(super) children: Vec<Child>,
    pub(super) visit: usize,
    pub(super) step: Step,
    arrived: u64,
    granted: bool,
    pub(super) task: u32,
    record: u64,
    pub(super) from: u32,
    steal: u64,
    spill: u64,
    in_screen_space: bool,
    behind: u32,
}

#[derive(Debug, Default)]
pub(super) struct Lane {
    pub(super) ready: VecDeque<u32>,
    stored: u64,
    pub(super) idle: u64,
}

/// Simulates a workload.
pub fn simulate<W: Workload>(
    hardware: &Hardware,
    workload: &mut W,
    observer: &mut dyn Observer,
) -> Result<CycleReport, SimulationError<W::Error>> {
    hardware.check().map_err(SimulationError::Hardware)?;
    let mut simulation = Simulation::new(hardware, workload, observer);
    let end = simulation.run()?;
    Ok(simulation.report(end))
}

pub(super) struct Simulation<'a, W> {
    pub(super) hardware: &'a Hardware,
    pub(super) workload: &'a mut W,
    observer: &'a mut dyn Observer,
    watched: bool,
    pub(super) wheel: Wheel,
    pub(super) contexts: Vec<Context>,
    pub(super) lanes: Vec<Lane>,
    blocks: Vec<[StageBlock; STAGES]>,
    pub(super) memories: Memories,
    pub(super) tasks: Tasks,
    pub(super) totals: Totals,
    pub(super) asked: Asked,
    newly: Vec<u32>,
    ready: u64,
    pub(super) idle: u64,
    pub(super) live: u64,
    accounted: u64,
}

impl<'a, W: Workload> Simulation<'a, W> {
    fn new(hardware: &'a Hardware, workload: &'a mut W, observer: &'a mut dyn Observer) -> Self {
        // With tiles, contexts have their own stacks: for records, each is a lane.
        let (lanes, contexts) = match hardware.hands_out_tiles() {
            true => (hardware.stacks(), 1),
            false => (hardware.lanes, hardware.contexts),
        };
        let contexts_of = |lane| (0..contexts).map(move |number| (lane, number));
        let all: Vec<_> = (0..lanes)
            .flat_map(contexts_of)
            .map(|(lane, number)| Context {
                lane,
                number,
                behind: NONE,
                ..Context::default()
            })
            .collect();
        let lane = || Lane {
            idle: u64::MAX >> (64 - contexts),
            ..Lane::default()
        };
        let block = StageBlock {
            free_at: 0,
            first: NONE,
            last: NONE,
        };
        let mut memories = Memories::new(hardware);
        memories.outer.log = observer.watches_requests().then(Vec::new);
        Self {
            wheel: Wheel::new(all.len()),
            idle: all.len() as u64,
            contexts: all,
            lanes: (0..lanes).map(|_| lane()).collect(),
            blocks: vec![[block; STAGES]; lanes as usize],
            memories,
            tasks: Tasks::new(hardware.independence),
            totals: Totals::new(),
            asked: Asked::new(hardware),
            newly: Vec::new(),
            ready: 0,
            live: 0,
            accounted: 0,
            hardware,
            workload,
            watched: observer.watches_visits(),
            observer,
        }
    }

    fn run(&mut self) -> Result<u64, SimulationError<W::Error>> {
        if self.hardware.hands_out_tiles() {
            self.ask_for_tiles();
        } else {
            self.start()?;
        }
        let mut now = 0;
        loop {
            if self.must_serve(now) {
                self.serve_asked(now);
                continue;
            }
            let Some((at, context)) = self.wheel.take() else {
                break;
            };
            now = at;
            if self.hardware.sequential && self.step_on(now, context)? {
                continue;
            }
            let at_end = {
                let of = &self.contexts[context as usize];
                of.visit == of.plan.visits.len()
            };
            if at_end {
                self.end_turn(now, context)?;
            } else {
                self.arrive(now, context);
            }
        }
        Ok(now)
    }

    fn start(&mut self) -> Result<(), SimulationError<W::Error>> {
        let task = self.tasks.root();
        self.lanes[0].idle &= !1;
        self.idle -= 1;
        self.live = 1;
        self.totals.stack.most_live = 1;
        let of = &mut self.contexts[0];
        self.workload.start(&mut of.children)?;
        of.task = task;
        self.begin_turn_of_start(0, 0);
        Ok(())
    }

    pub(super) fn begin_turn_of_start(&mut self, now: u64, context: u32) {
        let of = &mut self.contexts[context as usize];
        of.record = START;
        (of.steal, of.spill) = (0, 0);
        of.in_screen_space = false;
        self.plan(now, context);
    }

    fn plan(&mut self, now: u64, context: u32) {
        let of = &mut self.contexts[context as usize];
        self.workload.log().take(&mut of.plan);
        of.visit = 0;
        of.arrived = now;
        of.granted = false;
        of.in_screen_space |= of.plan.changed_to_screen;
        self.totals.work += of.plan.alone;
        self.totals.serial += of.plan.worst + of.steal + of.spill;
        for visit in &of.plan.visits {
            let stage = &mut self.totals.stages[visit.stage.number()];
            stage.stage = visit.stage;
            stage.visits += 1;
            stage.operations += visit.operations;
            stage.passes += visit.passes;
            stage.busy += visit.occupied;
            stage.alone += visit.alone;
        }
        self.wheel.set(now, context);
    }

    /// Adds idle cycles, before the numbers of idle contexts or waiting records change.
    #[inline]
    pub(super) fn account(&mut self, now: u64) {
        let idle = (now - self.accounted) * self.idle;
        self.accounted = now;
        if self.tasks.waiting > 0 {
            self.totals.idle_cycles.order_wait += idle;
        } else {
            self.totals.idle_cycles.no_record += idle;
        }
    }

    /// A record arrives at a block, or at the head of its line.
    #[inline]
    fn arrive(&mut self, now: u64, context: u32) {
        let of = &mut self.contexts[context as usize];
        let stage = of.plan.visits[of.visit].stage.number();
        let block = &mut self.blocks[of.lane as usize][stage];
        if of.granted {
            of.granted = false;
            let next = of.behind;
            of.behind = NONE;
            block.first = next;
            self.begin(now, context);
            if next != NONE {
                self.grant(next);
            }
        } else if block.first == NONE && block.free_at <= now {
            self.begin(now, context);
        } else if block.first == NONE {
            block.first = context;
            block.last = context;
            self.grant(context);
        } else {
            let last = block.last;
            block.last = context;
            self.contexts[last as usize].behind = context;
        }
    }

    fn grant(&mut self, context: u32) {
        let of = &mut self.contexts[context as usize];
        of.granted = true;
        let stage = of.plan.visits[of.visit].stage.number();
        let free_at = self.blocks[of.lane as usize][stage].free_at;
        self.wheel.set(free_at, context);
    }

    #[inline]
    fn begin(&mut self, now: u64, context: u32) {
        if self.hardware.sequential {
            return self.begin_steps(now, context);
        }
        let of = &mut self.contexts[context as usize];
        let visit = &of.plan.visits[of.visit];
        let from = of.from as usize;
        let issued = now + visit.occupied;
        let mut frees = issued;
        let mut ends = issued + visit.latency;
        let mut cause = Cause::MemoryPort;
        let mut at = now;
        for &access in &of.plan.accesses[visit.accesses.clone()] {
            let served = self.memories.serve(access, at, from);
            at = served.issued;
            frees = frees.max(at + 1);
            if served.done > ends {
                ends = served.done;
                cause = served.cause;
            }
        }
        let stalled = ends - (now + visit.alone);
        self.end_visit(context, now, (frees, ends), (cause, stalled));
    }

    #[inline]
    pub(super) fn end_visit(
        &mut self,
        context: u32,
        begun: u64,
        (frees, mut ends): (u64, u64),
        (cause, stalled): (Cause, u64),
    ) {
        let of = &mut self.contexts[context as usize];
        let visit = &of.plan.visits[of.visit];
        let report = &mut self.totals.stages[visit.stage.number()];
        let Step { away, wanted, .. } = of.step;
        report.held += frees - (begun + visit.occupied) - away;
        let busy = begun - of.arrived + wanted;
        report.stalls.add(Cause::BlockBusy, busy);
        report.stalls.add(cause, stalled - wanted);
        if visit.stage == Stage::default() {
            report.stalls.add(Cause::Steal, of.steal);
            report.stalls.add(Cause::StackSpill, of.spill);
            ends += of.steal + of.spill;
            // The rest belongs to its own lane's stack.
            of.from = of.lane;
        }
        self.blocks[of.lane as usize][visit.stage.number()].free_at = frees;
        if self.watched {
            self.observer.visit(&VisitSpan {
                record: of.record,
                lane: context / self.hardware.contexts,
                context: context % self.hardware.contexts,
                stage: visit.stage,
                arrives: of.arrived,
                begins: begun,
                frees,
                ends,
                stall: (stalled > 0).then_some((cause, stalled)),
            });
        }
        of.visit += 1;
        of.arrived = ends;
        self.wheel.set(ends, context);
    }

    fn end_turn(&mut self, now: u64, context: u32) -> Result<(), SimulationError<W::Error>> {
        self.account(now);
        let of = &mut self.contexts[context as usize];
        let lane = of.lane;
        let stack = &mut self.lanes[lane as usize];
        let count = of.children.len() as u64;
        stack.stored += count;
        self.live += count;
        self.live -= 1;
        self.totals.stack.most_live = self.totals.stack.most_live.max(self.live);
        self.totals.stack.deepest = self.totals.stack.deepest.max(stack.stored);
        let over = stack
            .stored
            .saturating_sub(u64::from(self.hardware.stack.entries));
        let spills = over.min(count);
        let record = &self.hardware.stack.record;
        let kind = record.kind(of.plan.child_level, of.in_screen_space);
        if spills > 0 {
            if self.hardware.stack.overflow == StackOverflow::Error {
                return Err(SimulationError::StackOverflow {
                    record: of.record,
                    lane: context / self.hardware.contexts,
                    entries: self.hardware.stack.entries,
                });
            }
            self.totals.stack.spilled += spills;
            let bits = u64::from(record.of(kind));
            self.totals.stack.spilled_bits += spills * bits;
            for _ in 0..spills {
                // In the background: only the port waits for it.
                let request = self.memories.outer.book_spilled(now, bits, true);
                self.totals.serial += request.moving + request.late;
            }
        }
        let mut newly = std::mem::take(&mut self.newly);
        self.tasks.end(
            of.task,
            of.plan.alone,
            (lane, spills as usize, kind),
            &of.children,
            &mut newly,
        );
        self.ready += newly.len() as u64;
        for task in newly.drain(..) {
            let at = self.tasks.lane(task) as usize;
            // On top, but below its own earlier siblings: depth first.
            let ready = &mut self.lanes[at].ready;
            let mut place = ready.len();
            while place > 0 && self.tasks.is_earlier_sibling(ready[place - 1], task) {
                place -= 1;
            }
            ready.insert(place, task);
        }
        self.newly = newly;
        self.lanes[lane as usize].idle |= 1 << self.contexts[context as usize].number;
        self.idle += 1;
        if self.hardware.hands_out_tiles() {
            return self.go_on(now, context);
        }
        if self.ready > 0 {
            self.give(now, context)?;
            self.wake(now)?;
        }
        Ok(())
    }

    fn wake(&mut self, now: u64) -> Result<(), SimulationError<W::Error>> {
        for own in [true, false] {
            if self.ready == 0 || self.idle == 0 {
                return Ok(());
            }
            for lane in 0..self.lanes.len() {
                while self.lanes[lane].idle != 0
                    && self.ready > 0
                    && (!own || !self.lanes[lane].ready.is_empty())
                {
                    let number = self.lanes[lane].idle.trailing_zeros();
                    self.give(now, lane as u32 * self.hardware.contexts + number)?;
                }
            }
        }
        Ok(())
    }

    /// Gives an idle context its next record (rule 10).
    pub(super) fn give(&mut self, now: u64, context: u32) -> Result<(), SimulationError<W::Error>> {
        let lanes = self.lanes.len();
        let lane = self.contexts[context as usize].lane as usize;
        let mut taken = self.lanes[lane].ready.pop_back();
        for ahead in 1..lanes {
            if taken.is_some() {
                break;
            }
            taken = self.lanes[(lane + ahead) % lanes].ready.pop_front();
        }
        let Some(task) = taken else { return Ok(()) };
        let record = self.tasks.get(task);
        let from = record.lane as usize;
        let stolen = from != lane;
        self.ready -= 1;
        self.idle -= 1;
        self.lanes[from].stored -= 1;
        self.totals.stack.stolen += u64::from(stolen);
        let of = &mut self.contexts[context as usize];
        self.lanes[lane].idle &= !(1 << of.number);
        of.task = task;
        of.record = self.totals.records;
        of.from = record.lane;
        of.steal = u64::from(self.hardware.steal_cycles) * u64::from(stolen);
        of.in_screen_space = record.kind == RecordKind::Screen;
        of.spill = if record.spilled {
            let bits = u64::from(self.hardware.stack.record.of(record.kind));
            let request = self.memories.outer.book_spilled(now, bits, false);
            let moved = request.begun + request.moving + request.late;
            moved - now + u64::from(self.hardware.stack.spill_cycles)
        } else {
            0
        };
        self.totals.records += 1;
        if self.totals.records.is_multiple_of(PROGRESS) {
            self.observer.progress(now, self.totals.records);
        }
        of.children.clear();
        self.workload.turn(record.item, &mut of.children)?;
        self.plan(now, context);
        Ok(())
    }

    fn report(mut self, end: u64) -> CycleReport {
        let cycles = end.max(self.memories.pixels.last());
        self.account(cycles);
        if let Some(requests) = self.memories.outer.log.take() {
            self.observer.requests(requests);
        }
        let most_passes = *self.workload.log().most_passes();
        self.totals.report(
            self.hardware,
            cycles,
            &self.memories,
            &self.tasks,
            &most_passes,
        )
    }
}
