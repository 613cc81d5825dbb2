//! A quick picture: each sample's own unlit colour. Experiments time it.

use rayon::prelude::*;

use super::{Frame, NO_NODE};
use crate::budget::Shortage;

const TOGETHER: usize = 16;
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

    /// Looks up the colours of the nodes that [`Colors::nodes`] shows. `of_node`: colours by graph node.
    pub fn take_nodes(&mut self, of_node: &[[u8; 3]]) {
        if let Some(frame) = self.nodes.take() {
            self.take(of_node, &frame);
            self.nodes = Some(frame);
        }
    }

    /// Looks up the colours of a frame of this size, on the threads of the current pool.
    fn take(&mut self, of_node: &[[u8; 3]], frame: &Frame) {
        let nodes = frame.node.par_chunks(SHARE);
        let words = self.words.par_chunks_mut(SHARE);
        nodes
            .zip(words)
            .for_each(|(nodes, words)| look_up(of_node, nodes, words));
    }
}

fn look_up(of_node: &[[u8; 3]], nodes: &[u32], words: &mut [u32]) {
    let chunks = nodes.chunks(TOGETHER).zip(words.chunks_mut(TOGETHER));
    for (nodes, words) in chunks {
        if nodes
            .iter()
            .fold(true, |all, &node| all & (node == NO_NODE))
        {
            words.fill(0);
            continue;
        }
        for (&node, word) in nodes.iter().zip(words) {
            *word = of_node
                .get(node as usize)
                .map_or(0, |&color| color_word(color));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_become_colors_and_nothing_zero() {
        let mut colors = Colors::new(2, 2);
        colors.nodes().node = vec![NO_NODE, 2, NO_NODE, 1];
        colors.words.fill(7);
        colors.take_nodes(&[[9, 9, 9], [1, 2, 3], [4, 5, 6]]);
        assert_eq!(colors.words, [0, 0xff04_0506, 0, 0xff01_0203]);
    }
}
