//! A timing wheel. A context has at most one event, so its lists are links between contexts.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Cycles on the wheel; later events wait in a heap.
const SLOTS: usize = 1024;
const WORDS: usize = SLOTS / 64;
const NONE: u32 = u32::MAX;

#[derive(Debug)]
pub(super) struct Wheel {
    now: u64,
    first: Vec<u32>,
    last: Vec<u32>,
    next: Vec<u32>,
    used: [u64; WORDS],
    late: BinaryHeap<Reverse<(u64, u64, u32)>>,
    set: u64,
}

impl Wheel {
    pub(super) fn new(contexts: usize) -> Self {
        Self {
            now: 0,
            first: vec![NONE; SLOTS],
            last: vec![NONE; SLOTS],
            next: vec![NONE; contexts],
            used: [0; WORDS],
            late: BinaryHeap::new(),
            set: 0,
        }
    }

    /// Sets a context's event; `at` is not before the last event taken.
    #[inline]
    pub(super) fn set(&mut self, at: u64, context: u32) {
        debug_assert!(at >= self.now, "an event in the past");
        if at - self.now < SLOTS as u64 {
            self.append(at, context);
        } else {
            self.set += 1;
            self.late.push(Reverse((at, self.set, context)));
        }
    }

    #[inline]
    fn append(&mut self, at: u64, context: u32) {
        let slot = at as usize % SLOTS;
        self.next[context as usize] = NONE;
        let bit = 1u64 << (slot % 64);
        if self.used[slot / 64] & bit == 0 {
            self.used[slot / 64] |= bit;
            self.first[slot] = context;
        } else {
            self.next[self.last[slot] as usize] = context;
        }
        self.last[slot] = context;
    }

    pub(super) fn next_at(&self) -> Option<u64> {
        match self.next_slot() {
            Some(slot) => {
                let ahead = (slot + SLOTS - self.now as usize % SLOTS) % SLOTS;
                Some(self.now + ahead as u64)
            }
            None => self.late.peek().map(|Reverse((at, ..))| *at),
        }
    }

    #[inline]
    pub(super) fn take(&mut self) -> Option<(u64, u32)> {
        let slot = match self.next_slot() {
            Some(slot) => slot,
            None => {
                let &Reverse((at, ..)) = self.late.peek()?;
                self.advance(at);
                at as usize % SLOTS
            }
        };
        let ahead = (slot + SLOTS - self.now as usize % SLOTS) % SLOTS;
        if ahead > 0 {
            self.advance(self.now + ahead as u64);
        }
        let context = self.first[slot];
        let next = self.next[context as usize];
        self.first[slot] = next;
        if next == NONE {
            self.used[slot / 64] &= !(1 << (slot % 64));
        }
        Some((self.now, context))
    }

    /// The first used slot from now on.
    #[inline]
    fn next_slot(&self) -> Option<usize> {
        let from = self.now as usize % SLOTS;
        let mut word = from / 64;
        let mut bits = self.used[word] & (u64::MAX << (from % 64));
        for _ in 0..=WORDS {
            if bits != 0 {
                return Some(word * 64 + bits.trailing_zeros() as usize);
            }
            word = (word + 1) % WORDS;
            bits = self.used[word];
        }
        None
    }

    /// Moves to a cycle; near events leave the heap.
    #[inline]
    fn advance(&mut self, to: u64) {
        self.now = to;
        while let Some(&Reverse((at, _, context))) = self.late.peek() {
            if at - to >= SLOTS as u64 {
                break;
            }
            self.late.pop();
            self.append(at, context);
        }
    }
}
