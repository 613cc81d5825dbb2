//! Traverses the hierarchy front to back and culls hidden nodes (`spec/far.md`, Culling). Culled nodes are behind drawn
//! ones in every pixel, so memory cannot change the picture.

use std::collections::BTreeMap;

use super::cut::{Chosen, Cut};
use super::fill::Fill;
use super::opaque::Opaque;
use super::{FarCounts, ViewError};

const FIRST_BATCH: usize = 16;

#[derive(Debug, Clone)]
pub(super) struct VisibilityHistory {
    seen_in: Vec<u32>,
    frame: u32,
}

impl VisibilityHistory {
    pub(super) fn new(nodes: usize) -> Self {
        Self {
            seen_in: vec![0; nodes],
            frame: 1,
        }
    }

    fn was_visible(&self, number: usize) -> bool {
        self.seen_in[number] == self.frame
    }

    /// `visible` nodes were drawn, `branches` walked, parents before children.
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

pub(super) struct VisibleNodes {
    pub(super) drawn: Vec<Chosen>,
    pub(super) branches: Vec<usize>,
}

/// Without a memory, nothing is culled.
pub(super) fn walk(
    cut: &Cut<'_>,
    memory: Option<&VisibilityHistory>,
    opaque: &mut Opaque<'_>,
    counts: &mut FarCounts,
) -> Result<VisibleNodes, ViewError> {
    let mut walked = VisibleNodes {
        drawn: Vec::new(),
        branches: Vec::new(),
    };
    // The nearest first: the bits of positive numbers order as these do.
    let mut waiting = BTreeMap::new();
    let place = |node: &Chosen| (node.distance.to_bits(), node.number);
    let mut known = vec![0];
    while let Some(number) = known.pop() {
        let Some(found) = cut.classify(number, counts) else {
            continue;
        };
        if memory.is_some_and(|memory| !memory.was_visible(number)) {
            waiting.insert(place(&found), found);
        } else if found.is_drawn {
            walked.drawn.push(found);
        } else {
            walked.branches.push(number);
            known.extend(cut.children(number));
        }
    }
    opaque.draw(&walked.drawn, counts)?;
    let mut fill = Fill::of(&opaque.depths(), &cut.view);
    let mut next_fill = None;
    let mut batch = FIRST_BATCH;
    while !waiting.is_empty() {
        let mut visible = Vec::new();
        while visible.len() < batch
            && let Some((_, found)) = waiting.pop_first()
        {
            counts.queries += 1;
            if fill.hides(&cut.view, &found.outline) {
                counts.hidden += 1;
                continue;
            }
            if found.is_drawn {
                visible.push(found);
            } else {
                walked.branches.push(found.number);
                let children = cut.children(found.number);
                let children = children.filter_map(|child| cut.classify(child, counts));
                waiting.extend(children.map(|child| (place(&child), child)));
            }
        }
        opaque.draw(&visible, counts)?;
        walked.drawn.extend(visible);
        let drawn = next_fill.replace(Fill::of(&opaque.depths(), &cut.view));
        fill = drawn.unwrap_or(fill);
        batch *= 2;
    }
    Ok(walked)
}
