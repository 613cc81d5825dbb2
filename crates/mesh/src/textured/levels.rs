//! Levels of detail: each erosion replaces the voxels of the next depth by their primitives, down to primitives alone.
//! Voxels are sorted by depth and primitives by their first level: a level has a tail of these and a beginning of those.

use super::record::{CLEAR, VoxelRecord, list_of};
use crate::voxelize::OTHERS;

/// A face of a voxel that some levels show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Surfel {
    pub voxel: u32,
    pub axis: u8,
    pub is_positive: bool,
    pub from: u16,
    /// Last level that shows it.
    pub to: u16,
    /// Cells from the face to the end of the voxels behind it in its half.
    pub reach: u16,
}

/// The faces that levels show: of each half of a column of cells the first voxel from outside that is left.
pub fn surfels(voxels: &[VoxelRecord], cells: u32) -> Vec<Surfel> {
    let mut surfels = Vec::new();
    let cells = cells as u16;
    for (axis, [across, down]) in OTHERS.into_iter().enumerate() {
        let mut keyed: Vec<((u16, u16, bool), u16, u32)> = (0..)
            .zip(voxels)
            .map(|(number, voxel)| {
                let slice = voxel.cell[axis];
                let is_positive = slice >= cells / 2;
                let from_outside = slice.min(cells - 1 - slice);
                let column = (voxel.cell[down], voxel.cell[across], is_positive);
                (column, from_outside, number)
            })
            .collect();
        keyed.sort_unstable();
        for column in keyed.chunk_by(|a, b| a.0 == b.0) {
            let end = column.last().map_or(0, |voxel| voxel.1 + 1);
            // The level from which on voxels farther out are gone.
            let mut free = 0;
            for &((_, _, is_positive), from_outside, voxel) in column {
                let to = voxels[voxel as usize].depth;
                if to >= free {
                    surfels.push(Surfel {
                        voxel,
                        axis: axis as u8,
                        is_positive,
                        from: free,
                        to,
                        reach: end - from_outside,
                    });
                    free = to.saturating_add(1);
                }
            }
        }
    }
    surfels
}

/// The counts of a level: a row of Tellier and Baroud 2003, Fig. 12.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LevelRow {
    pub level: u32,
    /// Faces that are drawn: primitives and surfels.
    pub faces: u64,
    pub primitives: u64,
    pub voxels: u64,
    /// Textured surfels that are drawn: those with anything on them.
    pub surfels: u64,
    /// The lowest cell of the box around the voxels that are left, and the cell after its highest.
    pub cells: [[u32; 3]; 2],
    /// Along each axis, how many cells behind a face lies what is on it, at the most.
    pub reach: [u32; 3],
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Levels {
    /// Primitives, by the level that first shows them.
    order: Vec<u32>,
    /// Surfels with anything on them.
    surfels: Vec<Surfel>,
    rows: Vec<LevelRow>,
}

impl Levels {
    /// Of voxels sorted by depth and their lists. Entries of lists must be below `primitives`.
    pub fn of(voxels: &[VoxelRecord], lists: &[u32], primitives: usize, cells: u32) -> Self {
        let mut levels = Self {
            order: Vec::with_capacity(primitives),
            surfels: surfels(voxels, cells),
            rows: Vec::new(),
        };
        levels.surfels.retain(|surfel| {
            let face = usize::from(surfel.axis);
            voxels[surfel.voxel as usize].textures[face] < CLEAR
        });
        let deepest = voxels.last().map_or(0, |voxel| u32::from(voxel.depth));
        let mut is_shown = vec![false; primitives];
        let mut eroded = 0;
        for level in 0..=deepest + 1 {
            let before = eroded;
            eroded = voxels.partition_point(|v| u32::from(v.depth) < level);
            for &primitive in (before..eroded).flat_map(|voxel| list_of(voxels, lists, voxel)) {
                if !std::mem::replace(&mut is_shown[primitive as usize], true) {
                    levels.order.push(primitive);
                }
            }
            let mut row = LevelRow {
                level,
                faces: 0,
                primitives: levels.order.len() as u64,
                voxels: (voxels.len() - eroded) as u64,
                surfels: 0,
                cells: [[u32::MAX; 3], [0; 3]],
                reach: [0; 3],
            };
            for surfel in levels.surfels(level) {
                row.surfels += 1;
                let reach = &mut row.reach[usize::from(surfel.axis)];
                *reach = u32::from(surfel.reach).max(*reach);
            }
            row.faces = row.primitives + row.surfels;
            let [low, high] = &mut row.cells;
            for cell in voxels[eroded..].iter().map(|v| v.cell.map(u32::from)) {
                for k in 0..3 {
                    low[k] = low[k].min(cell[k]);
                    high[k] = high[k].max(cell[k] + 1);
                }
            }
            levels.rows.push(row);
        }
        levels
    }

    pub fn last(&self) -> u32 {
        self.rows.len() as u32 - 1
    }

    /// A level; one above the last is taken for the last.
    pub fn row(&self, level: u32) -> &LevelRow {
        &self.rows[level.min(self.last()) as usize]
    }

    pub fn rows(&self) -> &[LevelRow] {
        &self.rows
    }

    pub fn primitives(&self, level: u32) -> &[u32] {
        &self.order[..self.row(level).primitives as usize]
    }

    pub fn surfels(&self, level: u32) -> impl Iterator<Item = &Surfel> {
        let shows = move |s: &&Surfel| (u32::from(s.from)..=u32::from(s.to)).contains(&level);
        self.surfels.iter().filter(shows)
    }
}
