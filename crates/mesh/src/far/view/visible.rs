//! The visible nodes: traverses the hierarchy front to back and culls hidden nodes.
//!
//! A branch that was visible in the last frame is walked without a test, and its nodes are drawn first. Any other
//! branch's box is tested against what is drawn by then; if it is hidden, nothing below it is visited. Results come
//! late, as on a GPU: a batch is tested against the picture of some batches before. Culled nodes are behind drawn ones
//! in every pixel, so neither memory nor lateness can change the picture.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::cut::{Chosen, Cut, CutNode};
use super::fill::Fill;
use super::opaque::Opaque;
use super::{FarCounts, ViewError};

/// Nodes of the first batch of those that were not visible; each next has twice as many.
const FIRST_BATCH: usize = 16;

/// The visible nodes, frame by frame.
#[derive(Debug, Clone)]
pub(super) struct VisibilityHistory {
    /// The last frame in which each node was visible, or 0.
    seen_in: Vec<u32>,
    /// The last frame that was drawn.
    frame: u32,
}

impl VisibilityHistory {
    pub(super) fn new(nodes: usize) -> Self {
        Self {
            seen_in: vec![0; nodes],
            frame: 1,
        }
    }

    /// Makes these the nodes that were visible in the last frame.
    pub(super) fn set(&mut self, is_visible: impl Fn(usize) -> bool) {
        for (number, seen_in) in self.seen_in.iter_mut().enumerate() {
            *seen_in = if is_visible(number) { self.frame } else { 0 };
        }
    }

    fn was_visible(&self, number: usize) -> bool {
        self.seen_in[number] == self.frame
    }

    /// Ends a frame: `visible` nodes were drawn, `branches` walked, parents before children.
    pub(super) fn end_frame(
        &mut self,
        visible: impl Iterator<Item = usize>,
        branches: &[usize],
        cut: &Cut<'_>,
    ) {
        self.frame = self.frame.wrapping_add(1).max(1);
        for number in visible {
            self.seen_in[number] = self.frame;
        }
        for &branch in branches.iter().rev() {
            let is_seen = |child: usize| self.seen_in[child] == self.frame;
            if cut.children(branch).any(is_seen) {
                self.seen_in[branch] = self.frame;
            }
        }
    }
}

/// The nodes found visible.
pub(super) struct VisibleNodes {
    /// Nodes that were drawn.
    pub(super) drawn: Vec<Chosen>,
    /// Branches whose children were examined, parents before children.
    pub(super) branches: Vec<usize>,
}

/// A branch or node that waits; the nearest comes first.
struct QueueEntry(CutNode);

impl PartialEq for QueueEntry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for QueueEntry {}

impl PartialOrd for QueueEntry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for QueueEntry {
    fn cmp(&self, other: &Self) -> Ordering {
        let (a, b) = (self.0.chosen(), other.0.chosen());
        b.distance
            .total_cmp(&a.distance)
            .then(b.number.cmp(&a.number))
    }
}

/// Walks and draws.
pub(super) fn walk(
    cut: &Cut<'_>,
    memory: &VisibilityHistory,
    late: usize,
    opaque: &mut Opaque<'_>,
    counts: &mut FarCounts,
) -> Result<VisibleNodes, ViewError> {
    let mut walked = VisibleNodes {
        drawn: Vec::new(),
        branches: Vec::new(),
    };
    let mut waiting = BinaryHeap::new();
    let mut known = vec![0];
    while let Some(number) = known.pop() {
        let Some(found) = cut.classify(number, counts) else {
            continue;
        };
        match found {
            _ if !memory.was_visible(number) => waiting.push(QueueEntry(found)),
            CutNode::Drawn(chosen) => walked.drawn.push(chosen),
            CutNode::Branch(_) => {
                walked.branches.push(number);
                known.extend(cut.children(number));
            }
        }
    }
    opaque.draw(&walked.drawn, counts)?;
    let mut fills = vec![Fill::of(&opaque.depths(), &cut.view)];
    let mut batch = FIRST_BATCH;
    while !waiting.is_empty() {
        let fill = &fills[(fills.len() - 1).saturating_sub(late)];
        let mut visible = Vec::new();
        while visible.len() < batch
            && let Some(QueueEntry(found)) = waiting.pop()
        {
            counts.queries += 1;
            if fill.hides(&cut.view, &found.chosen().outline) {
                counts.hidden += 1;
                continue;
            }
            match found {
                CutNode::Drawn(chosen) => visible.push(chosen),
                CutNode::Branch(chosen) => {
                    walked.branches.push(chosen.number);
                    let children = cut.children(chosen.number);
                    let found = children.filter_map(|child| cut.classify(child, counts));
                    waiting.extend(found.map(QueueEntry));
                }
            }
        }
        opaque.draw(&visible, counts)?;
        walked.drawn.extend(visible);
        fills.push(Fill::of(&opaque.depths(), &cut.view));
        batch *= 2;
    }
    Ok(walked)
}
