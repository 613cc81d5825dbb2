//! Merging equal subtrees: a tree becomes a directed acyclic graph.
//!
//! Where nodes are stored level by level, levels are merged from the finest up, and equal nodes of different levels stay
//! apart. In any other graph, nodes start out equal and are distinguished by their children until no class splits.
//! The result is numbered in breadth-first order.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hash, Hasher};

use xxhash_rust::xxh3::xxh3_64_with_seed;

use super::{Graph, Progress, Store};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum MergeBy {
    /// Same shape, colours, normals and opacities: the merged graph looks the same.
    #[default]
    ShapeAndAttributes,
    /// Same shape; the attributes of one node of each class are kept.
    Shape,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MergeReport {
    pub nodes_before: u64,
    pub nodes_after: u64,
}

impl MergeReport {
    pub fn gain(&self) -> f64 {
        self.nodes_before as f64 / self.nodes_after.max(1) as f64
    }
}

/// XXH3 of a key's parts, each hashed at once: keys are short.
#[derive(Default)]
struct Parts(u64);

impl Hasher for Parts {
    fn write(&mut self, bytes: &[u8]) {
        self.0 = xxh3_64_with_seed(bytes, self.0);
    }

    /// All keys of a map have arrays of the same length.
    fn write_usize(&mut self, _: usize) {}

    fn finish(&self) -> u64 {
        self.0
    }
}

type Map<K> = HashMap<K, u32, BuildHasherDefault<Parts>>;
const ABSENT: u32 = u32::MAX;

/// Merges equal nodes. The cells of the result are those of `graph` one for one, with the same colours and normals
/// under [`MergeBy::ShapeAndAttributes`].
pub fn merge(graph: &Graph, by: MergeBy, progress: &dyn Progress) -> (Graph, MergeReport) {
    progress.begin("merge equal subtrees", 0);
    let class = if graph.is_level_ordered() {
        classes_by_level(graph, by)
    } else {
        classes_by_difference(graph, by)
    };
    let merged = rebuild(graph, &class);
    progress.end();
    let report = MergeReport {
        nodes_before: graph.len() as u64,
        nodes_after: merged.len() as u64,
    };
    (merged, report)
}

fn attributes(graph: &Graph, node: u32, by: MergeBy) -> u64 {
    if by == MergeBy::Shape {
        return 0;
    }
    let [red, green, blue] = graph.color_of(node);
    let normal = graph.normal_of(node).0.to_le_bytes();
    let [x, y, z] = graph.view().opacity_of(node).0;
    u64::from_le_bytes([red, green, blue, normal[0], normal[1], x, y, z])
}

fn child_classes(graph: &Graph, node: u32, class: &[u32]) -> [u32; 8] {
    graph
        .children(node)
        .map(|child| child.map_or(ABSENT, |child| class[child as usize]))
}

fn number<K: Hash + Eq>(known: &mut Map<K>, key: K) -> u32 {
    let next = known.len() as u32;
    *known.entry(key).or_insert(next)
}

fn classes_by_level(graph: &Graph, by: MergeBy) -> Vec<u32> {
    let mut class = vec![0; graph.len()];
    for pair in graph.level_start.windows(2).rev() {
        let nodes = pair[0]..pair[1].min(class.len() as u32);
        let mut known = Map::default();
        for node in nodes {
            let key = (
                attributes(graph, node, by),
                child_classes(graph, node, &class),
            );
            class[node as usize] = number(&mut known, key);
        }
    }
    class
}

fn classes_by_difference(graph: &Graph, by: MergeBy) -> Vec<u32> {
    let nodes = 0..graph.len() as u32;
    let mut class = vec![0; graph.len()];
    let mut classes = 0;
    loop {
        let mut known = Map::default();
        class = nodes
            .clone()
            .map(|node| {
                let own = class[node as usize];
                let children = child_classes(graph, node, &class);
                number(&mut known, (own, attributes(graph, node, by), children))
            })
            .collect();
        // Classes are only ever split, so an equal number is an equal partition.
        if known.len() == classes {
            return class;
        }
        classes = known.len();
    }
}

fn rebuild(graph: &Graph, class: &[u32]) -> Graph {
    let ordered = graph.is_level_ordered();
    let classes = class.iter().max().map_or(0, |&most| most as usize + 1);
    // New number per class. Where nodes are stored level by level, the table is for one level.
    let mut renamed = vec![ABSENT; classes];
    let mut chosen = vec![graph.root];
    let mut links = Vec::new();
    let mut masks = Vec::new();
    let mut firsts = Vec::new();
    let mut level_start = vec![0u32];
    let mut level_end = 1;
    if let Some(&root_class) = class.get(graph.root as usize)
        && !ordered
    {
        renamed[root_class as usize] = 0;
    }
    let mut next = 0;
    while next < chosen.len() {
        if ordered && next == level_end {
            level_start.push(level_end as u32);
            for &node in &chosen[level_end..] {
                renamed[class[node as usize] as usize] = ABSENT;
            }
            level_end = chosen.len();
        }
        let mut mask = 0u8;
        let first = links.len() as u32;
        let finest = ordered && level_start.len() > graph.depth as usize;
        let children = if finest {
            [None; 8]
        } else {
            graph.children(chosen[next])
        };
        for (octant, child) in children.into_iter().enumerate() {
            let Some(child) = child else { continue };
            let name = &mut renamed[class[child as usize] as usize];
            if *name == ABSENT {
                *name = chosen.len() as u32;
                chosen.push(child);
            }
            mask |= 1 << octant;
            links.push(*name);
        }
        masks.push(mask);
        firsts.push(if mask == 0 { 0 } else { first });
        next += 1;
    }
    let last_inner = masks.iter().rposition(|&mask| mask != 0);
    let inner = last_inner.map_or(0, |last| last + 1);
    masks.truncate(inner);
    masks.shrink_to_fit();
    firsts.truncate(inner);
    firsts.shrink_to_fit();
    links.shrink_to_fit();
    let view = graph.view();
    let opacity = match graph.opacity.is_empty() {
        true => Store::default(),
        false => chosen.iter().map(|&n| view.opacity_of(n)).collect(),
    };
    let mut merged = Graph {
        depth: graph.depth,
        mask: masks.into(),
        first: firsts.into(),
        links: links.into(),
        color: chosen.iter().map(|&n| graph.color_of(n)).collect(),
        normal: chosen.iter().map(|&n| graph.normal_of(n)).collect(),
        opacity,
        voxels: graph.voxels,
        placement: graph.placement,
        ..Graph::default()
    };
    if ordered {
        level_start.push(merged.len() as u32);
        // A level without reachable nodes is empty, which the level table cannot express.
        if level_start.len() == graph.depth as usize + 2 {
            merged.level_start = level_start;
        }
    }
    merged
}
