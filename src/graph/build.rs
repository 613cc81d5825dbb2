//! From loose voxels to a tree stored level by level.
//!
//! Voxels are sorted by Morton key. A node of level `l` begins wherever the first `3 l` bits of the key change: one
//! scan counts the nodes of each level, a second one writes them.

use super::average::Sum;
use super::normals::Estimate;
use super::pushed::{PushedVoxel, PushedVoxels, extent};
use super::{Graph, PackedNormal, Placement, Progress, Voxel, morton, place};
use crate::budget::{self, Shortage};

/// Collects voxels in memory, 20 bytes each, and builds a graph, at most about 29 bytes per voxel of a surface
/// (`spec/graph.md`). A voxel without a normal gets that of the surface around it.
#[derive(Debug)]
pub struct Builder {
    records: PushedVoxels,
    min: [i32; 3],
    max: [i32; 3],
    pushed: u64,
    short: Option<Shortage>,
}

impl Default for Builder {
    fn default() -> Self {
        Self {
            records: PushedVoxels::default(),
            min: [i32::MAX; 3],
            max: [i32::MIN; 3],
            pushed: 0,
            short: None,
        }
    }
}

impl Builder {
    pub fn is_empty(&self) -> bool {
        self.pushed == 0
    }

    pub fn push(&mut self, voxel: Voxel) {
        if self.pushed < u64::from(u32::MAX) && self.short.is_none() {
            for axis in 0..3 {
                let index = voxel.index[axis];
                self.min[axis] = self.min[axis].min(index);
                self.max[axis] = self.max[axis].max(index);
            }
            let normal = voxel.normal.unwrap_or(PackedNormal::NONE);
            let sequence = self.pushed as u32;
            let record = PushedVoxel::new(voxel.index, sequence, voxel.color, normal);
            if let Err(short) = self.records.push(record) {
                self.records = PushedVoxels::default();
                self.short.get_or_insert(short);
            }
        }
        self.pushed += 1;
    }

    /// `placement_world` is the world position of file index (0, 0, 0) and the length of a voxel's side. The result does
    /// not depend on threads, nor on the order of voxels at different indices. Fails when there are no voxels, too many,
    /// or too far apart.
    pub fn finish(
        self,
        placement_world: ([f64; 3], f64),
        progress: &dyn Progress,
    ) -> Result<Graph, BuildError> {
        let placement = Placement {
            origin_index: self.min.map(i64::from),
            world_origin: placement_world.0,
            voxel_size: placement_world.1,
            mesh: None,
        };
        placement.check_world()?;
        if self.is_empty() {
            return Err(BuildError::Empty);
        }
        if let Some(short) = self.short {
            return Err(short.into());
        }
        if self.pushed > self.records.len() as u64 {
            return Err(BuildError::TooMany(self.pushed));
        }
        let extent = extent(self.min, self.max)?;
        let longest = extent.iter().copied().max().unwrap_or(1);
        let depth = longest.next_power_of_two().trailing_zeros();

        progress.begin("sort voxels", 0);
        let records = self.records.sorted(self.min);
        progress.end();

        let mut tree = Tree::build(records, depth, progress)?;
        let finest = tree.level_start[depth as usize] as usize;
        Estimate {
            mask: &tree.mask,
            first: &tree.first,
            level_start: &tree.level_start,
            depth,
            centre: extent.map(|side| side as f64 / 2.0),
        }
        .fill(&mut tree.normal[finest..], progress);
        progress.begin("average colours and normals", 0);
        tree.average(0, 0);
        progress.end();

        let voxels = tree.color.len() as u64 - u64::from(tree.level_start[depth as usize]);
        Ok(Graph {
            depth,
            mask: tree.mask.into(),
            first: tree.first.into(),
            color: tree.color.into(),
            normal: tree.normal.into(),
            level_start: tree.level_start,
            voxels,
            placement,
            ..Graph::default()
        })
    }
}

impl Placement {
    pub(super) fn check_world(&self) -> Result<(), BuildError> {
        match self.can_be_seen(0) {
            true => Ok(()),
            false => Err(BuildError::Placement),
        }
    }

    pub(super) fn can_be_seen(&self, depth: u32) -> bool {
        let side = (1u64 << depth.min(morton::MAX_BITS)) as f64;
        let corner = |inside: f64| {
            let index = |k: usize| self.origin_index[k] as f64 + inside;
            [0, 1, 2].map(|k| self.world_origin[k] + index(k) * self.voxel_size)
        };
        place::can_be_seen(corner(0.0), corner(side), self.voxel_size)
    }
}

const THE_GRAPH: &str = "a graph of all voxels";

struct Tree {
    depth: u32,
    mask: Vec<u8>,
    first: Vec<u32>,
    color: Vec<[u8; 3]>,
    normal: Vec<PackedNormal>,
    level_start: Vec<u32>,
}

impl Tree {
    fn build(
        records: Vec<PushedVoxel>,
        depth: u32,
        progress: &dyn Progress,
    ) -> Result<Self, BuildError> {
        progress.begin("build the tree", 0);
        let level_start = level_starts(&records, depth)?;
        let inner = level_start[depth as usize] as usize;
        let nodes = level_start[depth as usize + 1] as usize;

        budget::check(THE_GRAPH, 5 * (inner + nodes) as u64)?;
        let mut color = budget::filled(THE_GRAPH, [0; 3], nodes)?;
        let mut normal = budget::filled(THE_GRAPH, PackedNormal::NONE, nodes)?;
        for (i, record) in records.iter().enumerate() {
            color[inner + i] = record.color;
            normal[inner + i] = record.normal;
        }

        let mut mask = budget::filled(THE_GRAPH, 0u8, inner)?;
        let mut first = budget::filled(THE_GRAPH, 0u32, inner)?;
        let mut next: Vec<u32> = level_start[..=depth as usize].to_vec();
        let mut before = None;
        for record in &records {
            let key = record.key();
            for level in first_new_level(before, key, depth)..=depth {
                if level > 0 {
                    let parent = next[level as usize - 1] as usize - 1;
                    let octant = key >> (3 * (depth - level)) & 7;
                    mask[parent] |= 1 << octant;
                }
                if level < depth {
                    first[next[level as usize] as usize] = next[level as usize + 1];
                }
                next[level as usize] += 1;
            }
            before = Some(key);
        }
        progress.end();
        Ok(Self {
            depth,
            mask,
            first,
            color,
            normal,
            level_start,
        })
    }

    /// Writes the averages of a node and its descendants, and returns its sum, in which each finest voxel counts once.
    fn average(&mut self, node: u32, level: u32) -> Sum {
        let mut sum = Sum::default();
        let at = node as usize;
        if level == self.depth {
            sum.add_voxel(self.color[at], self.normal[at]);
            return sum;
        }
        let first = self.first[at];
        for child in first..first + self.mask[at].count_ones() {
            if level + 1 == self.depth {
                sum.add_voxel(self.color[child as usize], self.normal[child as usize]);
            } else {
                sum.add(&self.average(child, level + 1));
            }
        }
        self.color[at] = sum.color();
        self.normal[at] = sum.normal();
        sum
    }
}

/// The coarsest level at which a voxel begins a node of its own.
pub(super) fn first_new_level(before: Option<u64>, key: u64, depth: u32) -> u32 {
    match before {
        None => 0,
        // Keys differ, and below bit 3 * depth.
        Some(before) => depth - (before ^ key).ilog2() / 3,
    }
}

fn level_starts(records: &[PushedVoxel], depth: u32) -> Result<Vec<u32>, BuildError> {
    let mut begun = [0u64; morton::MAX_BITS as usize + 1];
    for pair in records.windows(2) {
        let level = first_new_level(Some(pair[0].key()), pair[1].key(), depth);
        begun[level as usize] += 1;
    }
    // The first voxel begins a node at every level.
    let mut nodes_at_level = 1u64;
    let mut total = 0u64;
    let mut starts = vec![0u64];
    for count in &begun[..=depth as usize] {
        nodes_at_level += count;
        total += nodes_at_level;
        starts.push(total);
    }
    if total >= u64::from(u32::MAX) {
        return Err(BuildError::TooMany(total));
    }
    Ok(starts.into_iter().map(|start| start as u32).collect())
}

#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum BuildError {
    #[error("there are no voxels, so there is nothing to build")]
    Empty,
    #[error(
        "the voxels span {extent} along axis {axis}, more than {}; \
         are there stray voxels far from the object?",
        morton::MAX_SIDE
    )]
    TooLarge { axis: char, extent: u64 },
    #[error("{0} voxels or nodes are more than 32 bits can number; split the object")]
    TooMany(u64),
    #[error("{0} voxels are too many to be listed one by one")]
    TooManyToList(u64),
    #[error(transparent)]
    Memory(#[from] Shortage),
    #[error(
        "the world origin and the voxel size must be finite, the size above 0, and voxels there far enough apart to be told apart"
    )]
    Placement,
}
