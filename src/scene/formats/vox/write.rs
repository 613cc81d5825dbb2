//! Writes a `.vox` file: models of at most 256 voxels per side under a scene graph.

use std::collections::BTreeMap;
use std::io::{self, Write};

use super::quantize;
use crate::graph::Voxel;

const MODEL_SIDE: i32 = 256;

type Stored = ([u8; 3], [u8; 3]);

/// Collects voxels and writes them as `.vox`, 6 bytes per voxel and the size of the file.
///
/// Each block of 256 voxels per side becomes a model as small as its voxels allow, which the scene graph puts in its
/// place. Of several voxels at one index the last is kept. Up to 255 colours are kept exactly; more are reduced by
/// median cut.
#[derive(Debug, Default)]
pub struct VoxWriter {
    blocks: BTreeMap<[i32; 3], Vec<Stored>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VoxWritten {
    pub voxels: u64,
    pub colors_given: usize,
    pub colors_kept: usize,
}

impl VoxWriter {
    pub fn new() -> Self {
        Self::default()
    }

    pub fn add(&mut self, voxel: Voxel) {
        let block = voxel.index.map(|i| i.div_euclid(MODEL_SIDE));
        let local = voxel.index.map(|i| i.rem_euclid(MODEL_SIDE) as u8);
        self.blocks
            .entry(block)
            .or_default()
            .push((local, voxel.color));
    }

    /// Fails also if the file would exceed the 4 GiB that the format can count.
    pub fn write(mut self, out: &mut dyn Write) -> io::Result<VoxWritten> {
        if self.blocks.is_empty() {
            self.blocks.insert([0; 3], Vec::new());
        }
        let mut histogram = BTreeMap::new();
        for stored in self.blocks.values_mut() {
            keep_last(stored);
            for (_, color) in stored.iter() {
                *histogram.entry(*color).or_insert(0u64) += 1;
            }
        }
        let (palette, index_of) = quantize::palette(&histogram);
        let written = VoxWritten {
            voxels: histogram.values().sum(),
            colors_given: histogram.len(),
            colors_kept: palette.len(),
        };
        let mut children = Vec::new();
        let mut translations = Vec::new();
        for (block, stored) in self.blocks {
            let (low, size) = bounds(&stored);
            chunk(&mut children, b"SIZE", &size.map(u32::to_le_bytes).concat())?;
            let mut content = Vec::with_capacity(4 + 4 * stored.len());
            content.extend(count(stored.len())?.to_le_bytes());
            for (position, color) in &stored {
                content.extend((0..3).map(|axis| position[axis] - low[axis]));
                content.push(index_of[color]);
            }
            chunk(&mut children, b"XYZI", &content)?;
            // Undoes the reader's pivot, floor(size / 2).
            translations.push([0, 1, 2].map(|axis| {
                i64::from(block[axis]) * i64::from(MODEL_SIDE)
                    + i64::from(low[axis])
                    + i64::from(size[axis] / 2)
            }));
        }
        scene_graph(&mut children, &translations)?;
        let mut rgba = [[0u8; 4]; 256];
        for (slot, [r, g, b]) in rgba.iter_mut().zip(palette) {
            *slot = [r, g, b, 255];
        }
        chunk(&mut children, b"RGBA", rgba.as_flattened())?;
        out.write_all(b"VOX ")?;
        out.write_all(&150u32.to_le_bytes())?;
        out.write_all(b"MAIN")?;
        out.write_all(&0u32.to_le_bytes())?;
        out.write_all(&count(children.len())?.to_le_bytes())?;
        out.write_all(&children)?;
        Ok(written)
    }
}

fn keep_last(stored: &mut Vec<Stored>) {
    stored.reverse();
    stored.sort_by_key(|([x, y, z], _)| [*z, *y, *x]);
    stored.dedup_by_key(|(position, _)| *position);
}

fn bounds(stored: &[Stored]) -> ([u8; 3], [u32; 3]) {
    let mut low = [u8::MAX; 3];
    let mut high = [0u8; 3];
    for (position, _) in stored {
        for axis in 0..3 {
            low[axis] = low[axis].min(position[axis]);
            high[axis] = high[axis].max(position[axis]);
        }
    }
    if stored.is_empty() {
        return ([0; 3], [1; 3]);
    }
    (
        low,
        [0, 1, 2].map(|axis| u32::from(high[axis] - low[axis]) + 1),
    )
}

/// A root on no layer, a group under it, and a transform and a shape for every model.
fn scene_graph(out: &mut Vec<u8>, translations: &[[i64; 3]]) -> io::Result<()> {
    let models = count(translations.len())?;
    chunk(out, b"nTRN", &numbers(&[0, 0, 1, u32::MAX, u32::MAX, 1, 0]))?;
    let mut group = vec![1, 0, models];
    group.extend((0..models).map(|model| 2 + 2 * model));
    chunk(out, b"nGRP", &numbers(&group))?;
    for (model, [x, y, z]) in (0..models).zip(translations) {
        let [transform, shape] = [2 + 2 * model, 3 + 2 * model];
        let mut moved = numbers(&[transform, 0, shape, u32::MAX, 0, 1, 1]);
        for text in ["_t", &format!("{x} {y} {z}")] {
            moved.extend(numbers(&[text.len() as u32]));
            moved.extend(text.bytes());
        }
        chunk(out, b"nTRN", &moved)?;
        chunk(out, b"nSHP", &numbers(&[shape, 0, 1, model, 0]))?;
    }
    Ok(())
}

fn numbers(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

fn chunk(out: &mut Vec<u8>, id: &[u8; 4], content: &[u8]) -> io::Result<()> {
    out.extend(id);
    out.extend(count(content.len())?.to_le_bytes());
    out.extend(0u32.to_le_bytes());
    out.extend(content);
    Ok(())
}

fn count(number: usize) -> io::Result<u32> {
    u32::try_from(number).map_err(|_| {
        io::Error::new(
            io::ErrorKind::InvalidInput,
            "the scene is too large for .vox, which counts bytes in 32 bits; write .ply instead",
        )
    })
}
