//! Levels of detail: what each shows, by erosion depths alone.
//!
//! Level 0 has all voxels. Each erosion replaces the voxels of the next depth by their primitives. The last level has
//! no voxels and all primitives. Voxels are sorted by depth, so a level's voxels are a tail of the list. Its primitives
//! are a beginning of a list, sorted by the level at which they first appear. Going from level to level, either way, is
//! choosing another number.

use std::collections::HashMap;

use super::cell_grid::{ACROSS, is_positive_half};
use super::record::{CLEAR, VoxelRecord};

/// A face of a voxel that some levels show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Surfel {
    /// Number of its voxel.
    pub voxel: u32,
    /// The axis it stands on, 0 to 2.
    pub axis: u8,
    /// Whether it looks along the positive axis.
    pub is_positive: bool,
    /// First level that shows it.
    pub from: u16,
    /// Last level that shows it.
    pub to: u16,
}

/// The faces that levels show: of each column of cells and each half of it the
/// first voxel from outside that is left at a level.
pub fn surfels(voxels: &[VoxelRecord], cells: u32) -> Vec<Surfel> {
    let mut surfels = Vec::new();
    for (axis, [across, down]) in ACROSS.into_iter().enumerate() {
        let mut keyed: Vec<([u16; 4], u32)> = voxels
            .iter()
            .enumerate()
            .map(|(number, voxel)| {
                let slice = u32::from(voxel.cell[axis]);
                let is_positive = is_positive_half(slice, cells);
                let from_outside = if is_positive {
                    cells.saturating_sub(1 + slice)
                } else {
                    slice
                };
                let key = [
                    voxel.cell[down],
                    voxel.cell[across],
                    u16::from(is_positive),
                    // Below the number of cells.
                    from_outside as u16,
                ];
                (key, number as u32)
            })
            .collect();
        keyed.sort_unstable();
        let mut column = None;
        // The level from which on voxels farther out are gone.
        let mut free = 0;
        for ([down, across, half, _], voxel) in keyed {
            if column != Some([down, across, half]) {
                column = Some([down, across, half]);
                free = 0;
            }
            let to = voxels[voxel as usize].depth;
            if to >= free {
                surfels.push(Surfel {
                    voxel,
                    axis: axis as u8,
                    is_positive: half == 1,
                    from: free,
                    to,
                });
                free = to.saturating_add(1);
            }
        }
    }
    surfels
}

/// The counts of a level: a row of Tellier and Baroud 2003, Fig. 12.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LevelRow {
    /// Erosions.
    pub level: u32,
    /// Faces that are drawn: primitives and surfels.
    pub faces: u64,
    /// Primitives among them.
    pub primitives: u64,
    /// Voxels that are left.
    pub voxels: u64,
    /// Textured surfels that are drawn: those with anything on them.
    pub surfels: u64,
}

/// The contents of all levels of a grid, computed once.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Levels {
    /// Of each level, the number of voxels that are eroded.
    eroded: Vec<u32>,
    /// Of each level, how many of `order` it shows.
    shown: Vec<u32>,
    /// Primitives, by the level that first shows them.
    order: Vec<u32>,
    /// Surfels with anything on them.
    surfels: Vec<Surfel>,
    /// Of each level, the cells of the box around the voxels that are left.
    boxes: Vec<[[u32; 3]; 2]>,
    /// Of each level, along each axis, how many cells before its voxels what they show may lie behind their faces.
    reaches: Vec<[u32; 3]>,
    rows: Vec<LevelRow>,
}

impl Levels {
    /// Of voxels sorted by depth and their lists. Entries of lists must be below `primitives`.
    pub fn of(voxels: &[VoxelRecord], lists: &[u32], primitives: usize, cells: u32) -> Self {
        let deepest = voxels.last().map_or(0, |voxel| u32::from(voxel.depth));
        let mut levels = Self {
            eroded: Vec::new(),
            shown: Vec::new(),
            order: Vec::with_capacity(primitives),
            surfels: surfels(voxels, cells),
            boxes: Vec::new(),
            reaches: Vec::new(),
            rows: Vec::new(),
        };
        levels.surfels.retain(|surfel| {
            let face = usize::from(surfel.axis);
            voxels[surfel.voxel as usize].textures[face] < CLEAR
        });
        let mut is_shown = vec![false; primitives];
        let mut listed = 0;
        for level in 0..=deepest + 1 {
            let eroded = voxels.partition_point(|voxel| u32::from(voxel.depth) < level);
            let end = voxels.get(eroded).map_or(lists.len(), |v| v.first as usize);
            for &primitive in &lists[listed..end] {
                if !std::mem::replace(&mut is_shown[primitive as usize], true) {
                    levels.order.push(primitive);
                }
            }
            listed = end;
            levels.eroded.push(eroded as u32);
            levels.shown.push(levels.order.len() as u32);
            levels.boxes.push(box_around(&voxels[eroded..]));
        }
        levels.reaches = reaches(voxels, &levels.surfels, levels.last(), cells);
        levels.rows = (0..=levels.last())
            .map(|level| {
                let primitives = levels.primitives(level).len() as u64;
                let surfels = levels.surfels(level).count() as u64;
                LevelRow {
                    level,
                    faces: primitives + surfels,
                    primitives,
                    voxels: (voxels.len() - levels.eroded(level)) as u64,
                    surfels,
                }
            })
            .collect();
        levels
    }

    /// The last level, which shows primitives alone.
    pub fn last(&self) -> u32 {
        // At most 2^16 levels.
        self.eroded.len() as u32 - 1
    }

    /// Number of voxels that a level has eroded: those from there on are left.
    /// A level above the last is taken for the last.
    pub fn eroded(&self, level: u32) -> usize {
        self.eroded[level.min(self.last()) as usize] as usize
    }

    /// The primitives that a level shows.
    pub fn primitives(&self, level: u32) -> &[u32] {
        &self.order[..self.shown[level.min(self.last()) as usize] as usize]
    }

    /// The surfels that a level shows: those with anything on them.
    pub fn surfels(&self, level: u32) -> impl Iterator<Item = &Surfel> {
        let shows = move |s: &&Surfel| (u32::from(s.from)..=u32::from(s.to)).contains(&level);
        self.surfels.iter().filter(shows)
    }

    /// Along each axis, how many cells behind a face that a level shows lies what is on it, at the most.
    pub fn reach(&self, level: u32) -> [u32; 3] {
        self.reaches[level.min(self.last()) as usize]
    }

    /// The table of all levels.
    pub fn rows(&self) -> &[LevelRow] {
        &self.rows
    }

    /// Lowest cell of the box around the voxels that a level leaves, and the
    /// cell after its highest; `None` where it leaves none.
    pub fn box_of(&self, level: u32) -> Option<[[u32; 3]; 2]> {
        let level = level.min(self.last());
        (level < self.last()).then(|| self.boxes[level as usize])
    }
}

/// Of each level, the longest way from a face that it shows to the end of the voxels behind it in its half.
fn reaches(voxels: &[VoxelRecord], surfels: &[Surfel], last: u32, cells: u32) -> Vec<[u32; 3]> {
    let half_column = |voxel: &VoxelRecord, axis: usize| {
        let [across, down] = ACROSS[axis];
        let is_positive = is_positive_half(u32::from(voxel.cell[axis]), cells);
        (axis, voxel.cell[across], voxel.cell[down], is_positive)
    };
    // The slice of each half column that is nearest to the middle.
    let mut innermost = HashMap::new();
    for voxel in voxels {
        for axis in 0..3 {
            let slice = u32::from(voxel.cell[axis]);
            let key = half_column(voxel, axis);
            let inner = innermost.entry(key).or_insert(slice);
            *inner = if key.3 {
                slice.min(*inner)
            } else {
                slice.max(*inner)
            };
        }
    }
    let mut reaches = vec![[0; 3]; last as usize + 1];
    for surfel in surfels {
        let (axis, voxel) = (usize::from(surfel.axis), &voxels[surfel.voxel as usize]);
        let slice = u32::from(voxel.cell[axis]);
        let reach = 1 + slice.abs_diff(innermost[&half_column(voxel, axis)]);
        for level in surfel.from..=surfel.to {
            let longest = &mut reaches[usize::from(level)][axis];
            *longest = reach.max(*longest);
        }
    }
    reaches
}

fn box_around(voxels: &[VoxelRecord]) -> [[u32; 3]; 2] {
    let cells = voxels.iter().map(|voxel| voxel.cell.map(u32::from));
    cells.fold([[u32::MAX; 3], [0; 3]], |[low, high], cell| {
        let axes = [0, 1, 2];
        [
            axes.map(|k| low[k].min(cell[k])),
            axes.map(|k| high[k].max(cell[k] + 1)),
        ]
    })
}
