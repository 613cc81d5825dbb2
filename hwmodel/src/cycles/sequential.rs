//! Sequential hardware (rules 12 to 14). Requests of a cycle are served after all its other events.

use std::collections::VecDeque;

use super::hardware::Hardware;
use super::report::Cause;
use super::simulate::{Simulation, SimulationError};
use super::turn::Workload;
use crate::Memory;

const HAND_OUT: u64 = 1;

/// Kinds of request, in the order in which they are served within a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Of {
    Node,
    Attribute,
    Other,
    Tile,
}

#[derive(Debug, Default)]
pub(super) struct Asked {
    now: Vec<(Of, u32)>,
    /// For the node cache and the attribute cache; the first has its event set.
    waiting: [VecDeque<u32>; 2],
    /// The next tile, and the first cycle in which one is handed out.
    tile: u32,
    tile_from: u64,
    pub(super) sharing: Vec<Sharing>,
    /// Contexts of lanes whose holder may change at the end of this cycle.
    pub(super) lanes: Vec<u32>,
}

impl Asked {
    pub(super) fn new(hardware: &Hardware) -> Self {
        let firsts = (0..hardware.lanes).map(|lane| lane * hardware.contexts);
        Self {
            sharing: firsts.map(Sharing::new).collect(),
            ..Self::default()
        }
    }
}

#[derive(Debug, Default)]
pub(super) struct Step {
    pub(super) tile: Option<u32>,
    waits: bool,
    /// First cycle in which another has the lane, cycles in which others had it, and in which it was requested.
    pub(super) away_from: u64,
    pub(super) away: u64,
    pub(super) wanted: u64,
    is_begun: bool,
    access: usize,
    begun: u64,
    has_asked: bool,
    cause: Option<Cause>,
}

impl<W: Workload> Simulation<'_, W> {
    pub(super) fn ask_for_tiles(&mut self) {
        let contexts = 0..self.contexts.len() as u32;
        self.asked.now.extend(contexts.map(|of| (Of::Tile, of)));
    }

    pub(super) fn must_serve(&self, now: u64) -> bool {
        let is_asked = !self.asked.now.is_empty() || !self.asked.lanes.is_empty();
        is_asked && self.wheel.next_at().is_none_or(|next| next > now)
    }

    pub(super) fn serve_asked(&mut self, now: u64) {
        let mut asked = std::mem::take(&mut self.asked.now);
        asked.sort_unstable();
        for (of, context) in asked.drain(..) {
            match of {
                Of::Tile => self.hand_out(now, context),
                Of::Node => self.serve_cached(now, context, Memory::Node),
                Of::Attribute => self.serve_cached(now, context, Memory::Attribute),
                Of::Other => {
                    let of = &self.contexts[context as usize];
                    let access = of.plan.accesses[of.step.access];
                    let served = self.memories.serve(access, now, of.from as usize);
                    self.is_served(context, served.cause);
                    self.wheel
                        .set(served.done + u64::from(!access.write), context);
                }
            }
        }
        self.asked.now = asked;
        self.give_lanes(now);
    }

    fn hand_out(&mut self, now: u64, context: u32) {
        if self.asked.tile == self.workload.tiles() {
            return;
        }
        let at = now.max(self.asked.tile_from);
        self.contexts[context as usize].step.tile = Some(self.asked.tile);
        self.asked.tile += 1;
        self.asked.tile_from = at + 1;
        self.totals.serial += HAND_OUT;
        self.waits_until(now, at, context);
    }

    fn waits_until(&mut self, now: u64, at: u64, context: u32) {
        if at == now {
            self.waits_no_more(now, context);
        } else {
            self.contexts[context as usize].step.waits = true;
            self.wheel.set(at, context);
        }
    }

    /// Serves a cache access, if it is the first in line and the cache is free.
    fn serve_cached(&mut self, now: u64, context: u32, memory: Memory) {
        let (cache, line) = match memory {
            Memory::Node => (&mut self.memories.nodes, 0),
            _ => (&mut self.memories.attributes, 1),
        };
        let waiting = &mut self.asked.waiting[line];
        let of = &mut self.contexts[context as usize];
        if !std::mem::replace(&mut of.step.has_asked, true) {
            waiting.push_back(context);
            if waiting.len() > 1 {
                return;
            }
        }
        let free = cache.free_from(now);
        if free > now {
            self.wheel.set(free, context);
            return;
        }
        waiting.pop_front();
        let access = of.plan.accesses[of.step.access];
        let served = cache.access_alone(access.address, now, &mut self.memories.outer);
        if let Some(&next) = waiting.front() {
            let free = cache.free_from(now + 1);
            self.wheel.set(free, next);
        }
        self.is_served(context, served.cause);
        self.waits_until(now, served.done, context);
    }

    fn is_served(&mut self, context: u32, cause: Cause) {
        let step = &mut self.contexts[context as usize].step;
        step.access += 1;
        step.has_asked = false;
        step.cause = Some(cause);
    }

    /// Handles an event, except an arrival at a block or the end of a turn.
    pub(super) fn step_on(
        &mut self,
        now: u64,
        context: u32,
    ) -> Result<bool, SimulationError<W::Error>> {
        let step = &mut self.contexts[context as usize].step;
        if std::mem::take(&mut step.waits) {
            self.waits_no_more(now, context);
            return Ok(true);
        }
        if let Some(tile) = step.tile.take() {
            self.begin_tile(now, context, tile)?;
            return Ok(true);
        }
        let is_begun = self.contexts[context as usize].step.is_begun;
        if is_begun {
            self.next_access(now, context);
        }
        Ok(is_begun)
    }

    fn begin_tile(
        &mut self,
        now: u64,
        context: u32,
        tile: u32,
    ) -> Result<(), SimulationError<W::Error>> {
        self.account(now);
        let task = self.tasks.root();
        self.live += 1;
        self.totals.stack.most_live = self.totals.stack.most_live.max(self.live);
        let of = &mut self.contexts[context as usize];
        self.lanes[of.lane as usize].idle &= !(1 << of.number);
        self.idle -= 1;
        of.task = task;
        of.from = of.lane;
        of.children.clear();
        self.workload.begin_tile(tile, &mut of.children)?;
        self.begin_turn_of_start(now, context);
        Ok(())
    }

    pub(super) fn begin_steps(&mut self, now: u64, context: u32) {
        let of = &mut self.contexts[context as usize];
        of.step.is_begun = true;
        of.step.begun = now;
        of.step.access = of.plan.visits[of.visit].accesses.start;
        of.step.cause = None;
        (of.step.away, of.step.wanted) = (0, 0);
        self.next_access(now, context);
    }

    fn next_access(&mut self, now: u64, context: u32) {
        let of = &mut self.contexts[context as usize];
        let visit = &of.plan.visits[of.visit];
        if of.step.access < visit.accesses.end {
            let what = match of.plan.accesses[of.step.access].memory {
                Memory::Node => Of::Node,
                Memory::Attribute => Of::Attribute,
                _ => Of::Other,
            };
            self.asked.now.push((what, context));
            if what != Of::Other {
                self.begins_to_wait(context);
            }
            return;
        }
        of.step.is_begun = false;
        let begun = of.step.begun;
        // Finally the operations that the inspecting cycles left.
        let ends = (now + visit.latency).max(begun + 1);
        let cause = of.step.cause.unwrap_or(Cause::MemoryPort);
        let stalled = ends - (begun + visit.alone);
        self.end_visit(context, begun, (ends, ends), (cause, stalled));
    }

    pub(super) fn go_on(
        &mut self,
        now: u64,
        context: u32,
    ) -> Result<(), SimulationError<W::Error>> {
        let lane = self.contexts[context as usize].lane as usize;
        if self.lanes[lane].ready.is_empty() {
            self.asked.now.push((Of::Tile, context));
            self.begins_to_wait(context);
            return Ok(());
        }
        self.give(now, context)
    }
}

#[derive(Debug)]
pub(super) struct Sharing {
    holder: u32,
    waits: bool,
    wanted_by: Vec<(u64, u32)>,
}

impl Sharing {
    pub(super) fn new(first: u32) -> Self {
        Self {
            holder: first,
            waits: true,
            wanted_by: Vec::new(),
        }
    }
}

impl<W: Workload> Simulation<'_, W> {
    fn sharing(&mut self, context: u32) -> &mut Sharing {
        &mut self.asked.sharing[(context / self.hardware.contexts) as usize]
    }

    pub(super) fn begins_to_wait(&mut self, context: u32) {
        let sharing = self.sharing(context);
        if sharing.holder == context {
            sharing.waits = true;
            self.asked.lanes.push(context);
        }
    }

    /// The answer for a context is ready in the cycle `now`: a holder continues in the next one.
    pub(super) fn waits_no_more(&mut self, now: u64, context: u32) {
        let sharing = self.sharing(context);
        if sharing.holder == context {
            sharing.waits = false;
            self.wheel.set(now + 1, context);
            return;
        }
        let place = sharing.wanted_by.partition_point(|&of| of < (now, context));
        sharing.wanted_by.insert(place, (now, context));
        self.asked.lanes.push(context);
    }

    /// At the end of the cycle `now`.
    pub(super) fn give_lanes(&mut self, now: u64) {
        while let Some(context) = self.asked.lanes.pop() {
            let sharing = self.sharing(context);
            if !sharing.waits || sharing.wanted_by.is_empty() {
                continue;
            }
            let (since, next) = sharing.wanted_by.remove(0);
            let before = std::mem::replace(&mut sharing.holder, next);
            sharing.waits = false;
            self.contexts[before as usize].step.away_from = now + 1;
            let step = &mut self.contexts[next as usize].step;
            step.away += now + 1 - step.away_from;
            step.wanted += now + 1 - since;
            // It inspects its result, or begins its tile.
            let looks = u64::from(step.tile.is_none());
            self.wheel.set(now + 1 + looks, next);
        }
    }
}
