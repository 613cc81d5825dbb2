//! The levels joined to the sections of a file.

use std::io;
use std::sync::Arc;

use super::scratch::{Scratch, Spool};
use super::tree::LevelArrays;
use crate::graph::PackedNormal;
use crate::graph::file::turn;
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
        let mut sections: [Vec<Spool>; 4] = Default::default();
        for level in self.levels {
            let both = sections.iter_mut().zip(level);
            both.for_each(|(section, spool)| section.push(spool));
        }
        sections[2].push(self.color);
        sections[3].push(self.normal);
        Sections(sections)
    }
}

/// The levels' masks, first children, colours and normals, freed once written.
pub(super) struct Sections([Vec<Spool>; 4]);

impl Sections {
    /// Writes a section's bytes: `MASK`, `FRST`, `LINK` (which is empty), `COLR`, `NRML`.
    pub(super) fn hand_on(
        &mut self,
        section: usize,
        level_start: &[u32],
        put: &mut dyn FnMut(&[u8]) -> io::Result<()>,
    ) -> io::Result<()> {
        let Some(of) = [Some(0), Some(1), None, Some(2), Some(3)][section] else {
            return Ok(());
        };
        for (level, spool) in std::mem::take(&mut self.0[of]).into_iter().enumerate() {
            spool.drain(|piece| {
                if section == 1 {
                    // Children are of the level below.
                    let base = level_start[level + 1];
                    for number in piece.as_chunks_mut::<4>().0 {
                        let first = base.wrapping_add(u32::from_ne_bytes(*number));
                        *number = first.to_le_bytes();
                    }
                }
                if section == 4 {
                    turn::<PackedNormal>(piece);
                }
                put(piece)
            })?;
        }
        Ok(())
    }
}
