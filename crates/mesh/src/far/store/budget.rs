//! Keeps unpacked data of nodes to a budget by the clock algorithm, which spares nodes once that were used.

use std::collections::VecDeque;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::list::lock;

#[derive(Debug)]
pub(super) struct Budget {
    most: u64,
    is_here: Vec<AtomicBool>,
    was_used: Vec<AtomicBool>,
    clock: Mutex<Clock>,
}

#[derive(Debug, Default)]
struct Clock {
    here: VecDeque<(usize, u64)>,
    resident: Resident,
}

/// The use of a budget: bytes now, the most that there were, and nodes released.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Resident {
    pub bytes: u64,
    pub most_bytes: u64,
    pub released: u64,
}

impl Budget {
    pub(super) fn new(most: u64, nodes: usize) -> Self {
        let marks = || (0..nodes).map(|_| AtomicBool::new(false)).collect();
        Self {
            most,
            is_here: marks(),
            was_used: marks(),
            clock: Mutex::new(Clock::default()),
        }
    }

    /// A node of so many bytes is used; releases others until it fits or is alone.
    pub(super) fn touch(&self, node: usize, bytes: u64, release: impl Fn(usize)) {
        self.was_used[node].store(true, Ordering::Relaxed);
        if self.is_here[node].load(Ordering::Relaxed) {
            return;
        }
        let mut clock = lock(&self.clock);
        if self.is_here[node].swap(true, Ordering::Relaxed) {
            return;
        }
        while clock.resident.bytes.saturating_add(bytes) > self.most
            && let Some((other, its)) = clock.here.pop_front()
        {
            if self.was_used[other].swap(false, Ordering::Relaxed) {
                clock.here.push_back((other, its));
                continue;
            }
            release(other);
            self.is_here[other].store(false, Ordering::Relaxed);
            clock.resident.bytes -= its;
            clock.resident.released += 1;
        }
        let resident = &mut clock.resident;
        resident.bytes += bytes;
        resident.most_bytes = resident.most_bytes.max(resident.bytes);
        clock.here.push_back((node, bytes));
    }

    pub(super) fn resident(&self) -> Resident {
        lock(&self.clock).resident
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    #[test]
    fn what_was_not_used_goes_first_and_the_budget_is_kept() {
        let budget = Budget::new(100, 20);
        // All were used at 3 and 5: the hand spares each once, then takes the first.
        for (node, expected) in [
            (0, None),
            (1, None),
            (2, None),
            (3, Some(0)),
            (2, None),
            (4, Some(1)),
            (5, Some(2)),
            (3, None),
            (6, Some(4)),
        ] {
            let gone = Cell::new(None);
            budget.touch(node, 30, |other| gone.set(Some(other)));
            assert_eq!(gone.get(), expected, "{node}");
        }
        let resident = budget.resident();
        assert_eq!(
            (resident.bytes, resident.most_bytes, resident.released),
            (90, 90, 4)
        );
        // Larger than the budget: alone.
        budget.touch(9, 500, |_| {});
        assert_eq!(budget.resident().bytes, 500);
    }
}
