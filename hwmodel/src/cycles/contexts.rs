//! Contexts of a sequential lane (rule 14): one of them has the lane at a time.

use super::simulate::Simulation;
use super::turn::Workload;

/// The holder of a lane, and the contexts that want it.
#[derive(Debug)]
pub(super) struct Sharing {
    holder: u32,
    /// Whether the holder waits for a cache or a tile, so that another may have the lane.
    waits: bool,
    /// First cycle and number of contexts that want it, in order.
    wanted_by: Vec<(u64, u32)>,
}

impl Sharing {
    /// Of a lane whose first context `first` has the lane, and waits for a tile.
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

    /// The holder of a lane begins to wait in this cycle.
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

    /// Changes holders that wait while others want the lane, at the end of the cycle `now`.
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
