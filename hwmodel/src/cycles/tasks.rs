//! Unfinished records, their dependences, and the span.

use super::hardware::Independence;
use super::turn::Child;
use crate::memory::RecordKind;

const NO_TASK: u32 = u32::MAX;

#[derive(Debug, Clone)]
struct Task {
    parent: u32,
    item: u32,
    slot: u8,
    /// Earlier siblings that must be finished first, one bit each.
    waits: u8,
    alive: u8,
    spilled: bool,
    kind: RecordKind,
    lane: u32,
    children: [u32; 8],
    /// Without contention.
    begins: u64,
    over: u64,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct StartedTask {
    pub(super) item: u32,
    pub(super) lane: u32,
    pub(super) spilled: bool,
    pub(super) kind: RecordKind,
}

#[derive(Debug)]
pub(super) struct Tasks {
    independence: Independence,
    tasks: Vec<Task>,
    free: Vec<u32>,
    pub(super) waiting: u64,
    pub(super) open: u64,
    pub(super) most_open: u64,
    pub(super) span: u64,
}

impl Tasks {
    pub(super) fn new(independence: Independence) -> Self {
        Self {
            independence,
            tasks: Vec::new(),
            free: Vec::new(),
            waiting: 0,
            open: 0,
            most_open: 0,
            span: 0,
        }
    }

    fn insert(&mut self, task: Task) -> u32 {
        if let Some(at) = self.free.pop() {
            self.tasks[at as usize] = task;
            at
        } else {
            self.tasks.push(task);
            (self.tasks.len() - 1) as u32
        }
    }

    pub(super) fn root(&mut self) -> u32 {
        self.insert(Task {
            parent: NO_TASK,
            item: 0,
            slot: 0,
            waits: 0,
            alive: 0,
            spilled: false,
            kind: RecordKind::Clip,
            lane: 0,
            children: [NO_TASK; 8],
            begins: 0,
            over: 0,
        })
    }

    #[inline]
    pub(super) fn get(&self, task: u32) -> StartedTask {
        let task = &self.tasks[task as usize];
        StartedTask {
            item: task.item,
            lane: task.lane,
            spilled: task.spilled,
            kind: task.kind,
        }
    }

    #[inline]
    pub(super) fn lane(&self, task: u32) -> u32 {
        self.tasks[task as usize].lane
    }

    #[inline]
    pub(super) fn is_earlier_sibling(&self, a: u32, b: u32) -> bool {
        let (a, b) = (&self.tasks[a as usize], &self.tasks[b as usize]);
        a.parent == b.parent && a.slot < b.slot
    }

    /// Ends a turn of `alone` cycles without contention. Its children are on the stack of `lane`; the `spills` nearest
    /// (last pushed) ones found no entry. Appends tasks that became ready, the one to run last first.
    #[inline]
    pub(super) fn end(
        &mut self,
        task: u32,
        alone: u64,
        (lane, spills, kind): (u32, usize, RecordKind),
        children: &[Child],
        ready: &mut Vec<u32>,
    ) {
        let over = {
            let of = &mut self.tasks[task as usize];
            of.over = of.begins + alone;
            of.over
        };
        if children.is_empty() {
            self.finish(task, ready);
            return;
        }
        self.open += u64::from(self.tasks[task as usize].parent != NO_TASK);
        self.most_open = self.most_open.max(self.open);
        for (slot, child) in children.iter().enumerate().rev() {
            let waits = children[..slot]
                .iter()
                .enumerate()
                .filter(|(_, earlier)| !self.independence.allows(earlier, child))
                .fold(0u8, |bits, (earlier, _)| bits | 1 << earlier);
            let at = self.insert(Task {
                parent: task,
                item: child.item,
                slot: slot as u8,
                waits,
                alive: 0,
                spilled: slot < spills,
                kind,
                lane,
                children: [NO_TASK; 8],
                begins: over,
                over: 0,
            });
            let parent = &mut self.tasks[task as usize];
            parent.children[slot] = at;
            parent.alive |= 1 << slot;
            if waits == 0 {
                ready.push(at);
            } else {
                self.waiting += 1;
            }
        }
    }

    /// Finishes a task, and ancestors without other unfinished descendants.
    fn finish(&mut self, mut task: u32, ready: &mut Vec<u32>) {
        loop {
            let Task {
                parent, slot, over, ..
            } = self.tasks[task as usize];
            self.free.push(task);
            if parent == NO_TASK {
                self.span = self.span.max(over);
                return;
            }
            let of = &mut self.tasks[parent as usize];
            of.alive &= !(1 << slot);
            of.over = of.over.max(over);
            let (alive, siblings) = (of.alive, of.children);
            if alive == 0 {
                self.open -= u64::from(of.parent != NO_TASK);
                task = parent;
                continue;
            }
            // Farthest first, so that the nearest is on top.
            let mut later = alive & !((2u16 << slot) - 1) as u8;
            while later != 0 {
                let sibling = 7 - later.leading_zeros();
                later &= !(1 << sibling);
                let at = siblings[sibling as usize];
                let of = &mut self.tasks[at as usize];
                if of.waits >> slot & 1 != 0 {
                    of.waits &= !(1 << slot);
                    of.begins = of.begins.max(over);
                    if of.waits == 0 {
                        self.waiting -= 1;
                        ready.push(at);
                    }
                }
            }
            return;
        }
    }
}
