//! Hits whose colours are on their way from the memory, because nodes lie all over it. Their samples are marked as drawn
//! already, so only these hits are shown there.

use super::canvas::Pixels;
use super::directions::SAMPLES;
use crate::frame::color_word;

/// Hits that wait at most: those of four squares.
pub(super) const MOST: usize = 4 * SAMPLES.len();

#[derive(Debug)]
pub(super) struct Waiting {
    /// Places in the picture, and nodes.
    pub(super) hits: [(usize, u32); MOST],
    pub(super) count: usize,
}

impl Waiting {
    pub(super) fn none() -> Self {
        Self {
            hits: [(0, 0); MOST],
            count: 0,
        }
    }

    /// Makes room for the hits of a square.
    #[inline(always)]
    pub(super) fn make_room(&mut self, pixels: &mut Pixels<'_>) {
        if self.count > MOST - SAMPLES.len() {
            self.show(pixels);
        }
    }

    #[inline(always)]
    pub(super) fn show(&mut self, pixels: &mut Pixels<'_>) {
        let hits = &self.hits[..self.count.min(MOST)];
        self.count = 0;
        if pixels.color.is_empty() {
            hits.iter().for_each(|&(at, node)| pixels.set(at, node));
            return;
        }
        let (shown, colors) = (&mut *pixels.shown, pixels.color.as_flattened());
        for &(at, node) in hits {
            if let Some(shown) = shown.get_mut(at) {
                *shown = word_of(colors, node as usize);
            }
        }
    }
}

/// The word of a node's colour: four bytes are read at once if another colour follows.
#[inline(always)]
fn word_of(colors: &[u8], node: usize) -> u32 {
    let first = node.wrapping_mul(3);
    match colors.get(first..first.wrapping_add(4)) {
        Some(&[r, g, b, next]) => u32::from_be_bytes([r, g, b, next]) >> 8 | 0xff << 24,
        _ => last_word(colors, node),
    }
}

#[inline(never)]
fn last_word(colors: &[u8], node: usize) -> u32 {
    match colors.get(node.wrapping_mul(3)..) {
        Some(&[r, g, b]) => color_word([r, g, b]),
        _ => 0,
    }
}
