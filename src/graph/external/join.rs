//! The levels joined to the sections of a file.

use std::io;
use std::sync::Arc;

use super::scratch::{Scratch, Spool};
use super::tree::LevelArrays;
use crate::graph::{BuildError, Graph, Placement};

pub(super) struct Built {
    pub(super) depth: u32,
    pub(super) runs: u64,
    pub(super) levels: Vec<LevelArrays>,
    pub(super) counts: Vec<u64>,
    pub(super) color: Spool,
    pub(super) normal: Spool,
    pub(super) scratch: Arc<Scratch>,
}

impl Built {
    pub(super) fn outline(&self, placement: Placement) -> Result<Graph, BuildError> {
        let mut level_start = vec![0u32];
        let mut total = 0u64;
        let all: u64 = self.counts.iter().sum();
        if all >= u64::from(u32::MAX) {
            return Err(BuildError::TooMany(all));
        }
        for count in &self.counts {
            total += count;
            level_start.push(total as u32);
        }
        Ok(Graph {
            depth: self.depth,
            level_start,
            voxels: self.counts[self.depth as usize],
            placement,
            ..Graph::default()
        })
    }

    pub(super) fn sections(self) -> Sections {
        let mut sections = Sections::default();
        for level in self.levels {
            sections.mask.push(level.mask);
            sections.first.push(level.first);
            sections.color.push(level.color);
            sections.normal.push(level.normal);
        }
        sections.color.push(self.color);
        sections.normal.push(self.normal);
        sections
    }
}

/// The levels' parts of each section, freed once written.
#[derive(Default)]
pub(super) struct Sections {
    mask: Vec<Spool>,
    first: Vec<Spool>,
    color: Vec<Spool>,
    normal: Vec<Spool>,
}

impl Sections {
    /// Writes a section's bytes: `MASK`, `FRST`, `LINK`, `COLR`, `NRML`.
    pub(super) fn hand_on(
        &mut self,
        section: usize,
        level_start: &[u32],
        put: &mut dyn FnMut(&[u8]) -> io::Result<()>,
    ) -> io::Result<()> {
        let levels = match section {
            0 => &mut self.mask,
            1 => {
                for (level, spool) in std::mem::take(&mut self.first).into_iter().enumerate() {
                    // Children are of the level below.
                    let base = level_start[level + 1];
                    spool.drain(|piece| {
                        for number in piece.as_chunks_mut::<4>().0 {
                            let first = base.wrapping_add(u32::from_ne_bytes(*number));
                            *number = first.to_le_bytes();
                        }
                        put(piece)
                    })?;
                }
                return Ok(());
            }
            3 => &mut self.color,
            4 => &mut self.normal,
            _ => return Ok(()),
        };
        for spool in std::mem::take(levels) {
            spool.drain(|piece| put(piece))?;
        }
        Ok(())
    }
}
