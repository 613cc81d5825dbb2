//! The frame: one entry per sample.

mod colors;
pub mod quadtree;

use crate::budget::{self, Shortage};

pub use colors::{Colors, color_word};
pub use quadtree::{FillVectors, QuadNode};

/// Most samples of a picture: about three gigabytes with all buffers.
const MAX_SAMPLES: u64 = 1 << 27;

#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a picture of {0} samples is too large: the most is {MAX_SAMPLES}")]
pub struct TooManySamples(u64);

/// The number of samples of a picture. `aa_log2`: logarithm of the samples per pixel and axis.
pub fn count_samples(width: u32, height: u32, aa_log2: u32) -> Result<u64, TooManySamples> {
    let pixels = u64::from(width) * u64::from(height);
    match pixels.saturating_mul(1 << (2 * aa_log2)) {
        samples if samples > MAX_SAMPLES => Err(TooManySamples(samples)),
        samples => Ok(samples),
    }
}

pub const NO_NODE: u32 = u32::MAX;
pub const NO_VOXEL: [i32; 4] = [0, 0, 0, -1];

/// The samples of one frame, row by row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    pub width: u32,
    pub height: u32,
    pub node: Vec<u32>,
    /// Object coordinates of the visible voxel's lowest corner, in finest voxels, and its octree level (0 = root); or
    /// [`NO_VOXEL`]. May be empty.
    pub voxel: Vec<[i32; 4]>,
    /// Share of the processed records, if requested: a record counts 1, spread evenly over its quadtree node's samples.
    pub records: Option<Vec<f32>>,
    /// Blended voxels, under the rule that blends; `node` and `voxel` are then the first of a sample.
    pub blend: Option<Vec<Blend>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Blend {
    /// Transmittance: 256 all, 0 nothing.
    pub left: u16,
    /// Linear light, 0 to 65535 per channel, times its share of 256.
    pub light: [u32; 3],
}

impl Default for Blend {
    fn default() -> Self {
        Self {
            left: 256,
            light: [0; 3],
        }
    }
}

impl Frame {
    pub fn new(width: u32, height: u32, with_records: bool) -> Self {
        let samples = width as usize * height as usize;
        Self {
            width,
            height,
            node: vec![NO_NODE; samples],
            voxel: vec![NO_VOXEL; samples],
            records: with_records.then(|| vec![0.0; samples]),
            blend: None,
        }
    }

    /// Engines then store no voxels, which saves four fifths of the memory.
    pub fn nodes_only(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            node: vec![NO_NODE; width as usize * height as usize],
            voxel: Vec::new(),
            records: None,
            blend: None,
        }
    }

    pub fn clear(&mut self) {
        self.node.fill(NO_NODE);
        self.voxel.fill(NO_VOXEL);
        if let Some(records) = &mut self.records {
            records.fill(0.0);
        }
    }

    /// Makes this a frame of `width` x `height` samples, with empty blends if `blends`. Other entries may be old. A frame
    /// without voxels or records stays without. Errors: [`Shortage`] if the system refuses the memory.
    pub fn fit(&mut self, width: u32, height: u32, blends: bool) -> Result<(), Shortage> {
        let samples = width as usize * height as usize;
        (self.width, self.height) = (width, height);
        fit(&mut self.node, NO_NODE, samples)?;
        if !self.voxel.is_empty() {
            fit(&mut self.voxel, NO_VOXEL, samples)?;
        }
        if let Some(records) = &mut self.records {
            fit(records, 0.0, samples)?;
        }
        if !blends {
            self.blend = None;
            return Ok(());
        }
        let blend = self.blend.get_or_insert_default();
        blend.fill(Blend::default());
        fit(blend, Blend::default(), samples)
    }

    pub fn drawn(&self) -> usize {
        self.node.iter().filter(|&&node| node != NO_NODE).count()
    }
}

/// Replaces a list of another length by one of equal entries.
fn fit<T: Clone>(list: &mut Vec<T>, entry: T, samples: usize) -> Result<(), Shortage> {
    if list.len() != samples {
        // Not empty, even if memory is refused: empty lists are absent.
        *list = vec![entry.clone()];
        *list = budget::filled("the frame of a picture", entry, samples)?;
    }
    Ok(())
}
