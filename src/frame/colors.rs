//! A quick picture: each sample's own unlit colour. Experiments time it.

use rayon::prelude::*;

use super::Frame;
use crate::budget::Shortage;

/// Samples that a thread takes at least.
const SHARE: usize = 1 << 15;

#[derive(Debug, Clone)]
pub struct Colors {
    pub width: u32,
    pub height: u32,
    /// [`color_word`] of each sample, row by row; 0 without a voxel.
    pub words: Vec<u32>,
    nodes: Option<Frame>,
}

#[inline(always)]
pub const fn color_word([r, g, b]: [u8; 3]) -> u32 {
    u32::from_be_bytes([0xff, r, g, b])
}

impl Colors {
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            words: vec![0; width as usize * height as usize],
            nodes: None,
        }
    }

    /// Makes this a picture of `width` x `height` samples. Errors: [`Shortage`] if the system refuses the memory.
    pub fn fit(&mut self, width: u32, height: u32) -> Result<(), Shortage> {
        (self.width, self.height) = (width, height);
        super::fit(&mut self.words, 0, width as usize * height as usize)
    }

    /// A frame to be drawn, of any size.
    pub fn nodes(&mut self) -> &mut Frame {
        self.nodes.get_or_insert_with(|| Frame::nodes_only(0, 0))
    }

    /// Looks up the colours of the nodes that [`Colors::nodes`] shows, on the threads of the current pool. `of_node`:
    /// colours by graph node.
    pub fn take_nodes(&mut self, of_node: &[[u8; 3]]) {
        let Some(frame) = &self.nodes else {
            return;
        };
        let words = self.words.par_iter_mut().zip(&frame.node);
        words.with_min_len(SHARE).for_each(|(word, &node)| {
            let color = of_node.get(node as usize);
            *word = color.map_or(0, |&color| color_word(color));
        });
    }
}
