//! What an engine draws into: one entry for each sample.

mod colors;
pub mod quadtree;

pub use colors::{Colors, color_word};
pub use quadtree::{FillVectors, QuadNode};

/// Most samples of a picture: about three gigabytes with all buffers.
const MAX_SAMPLES: u64 = 1 << 27;

/// A picture has more samples than memory should be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a picture of {0} samples is too large: the most is {MAX_SAMPLES}")]
pub struct TooManySamples(u64);

/// The samples of a picture of so many pixels. `aa_log2`: samples per pixel and axis, as a power of two.
///
/// # Errors
/// [`TooManySamples`] where they are more than 2^27.
pub fn count_samples(width: u32, height: u32, aa_log2: u32) -> Result<u64, TooManySamples> {
    let pixels = u64::from(width) * u64::from(height);
    match pixels.saturating_mul(1 << (2 * aa_log2)) {
        samples if samples > MAX_SAMPLES => Err(TooManySamples(samples)),
        samples => Ok(samples),
    }
}

/// `node` where nothing is seen.
pub const NO_NODE: u32 = u32::MAX;
/// `voxel` where nothing is seen.
pub const NO_VOXEL: [i32; 4] = [0, 0, 0, -1];

/// The samples of one frame, row by row from the top left.
///
/// An engine stores which voxel is seen and nothing else; colour, normal and
/// depth follow from it and are made afterwards, once for each sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Samples across.
    pub width: u32,
    /// Samples down.
    pub height: u32,
    /// Graph node seen, or [`NO_NODE`].
    pub node: Vec<u32>,
    /// Object coordinates of the seen voxel's lowest corner, in finest
    /// voxels, and its octree level (0 = root); or [`NO_VOXEL`]. Empty where
    /// voxels are not stored ([`Frame::nodes_only`]).
    pub voxel: Vec<[i32; 4]>,
    /// Share of the records worked on for this sample, if requested:
    /// a record counts 1, spread evenly over its quadtree node's samples.
    pub records: Option<Vec<f32>>,
    /// What the samples took of the voxels before them, where those were
    /// blended; `node` and `voxel` are then the first that a sample took.
    pub blend: Option<Vec<Blend>>,
}

/// What a sample has taken of the voxels before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Blend {
    /// How much it still lets through: 256 all, 0 nothing.
    pub left: u16,
    /// Linear light, 0 to 65535 a channel, times the share that it was given of 256.
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
    /// An empty frame; `with_records`: with the records of each sample.
    #[must_use]
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

    /// An empty frame whose `voxel` stays empty, for uses that need nodes alone:
    /// a fifth of the memory to write. Engines then store no voxels.
    #[must_use]
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

    /// Forgets what was drawn, keeps the memory.
    pub fn clear(&mut self) {
        self.node.fill(NO_NODE);
        self.voxel.fill(NO_VOXEL);
        if let Some(records) = &mut self.records {
            records.fill(0.0);
        }
    }

    /// Has room for what is blended, and nothing in it, or has none.
    pub fn set_blending(&mut self, blends: bool) {
        let samples = self.node.len();
        match &mut self.blend {
            Some(blend) if blends => blend.fill(Blend::default()),
            blend => *blend = blends.then(|| vec![Blend::default(); samples]),
        }
    }

    /// Samples that show a voxel.
    #[must_use]
    pub fn drawn(&self) -> usize {
        self.node.iter().filter(|&&node| node != NO_NODE).count()
    }
}
