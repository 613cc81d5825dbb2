//! Every invariant of a graph, checked.

use super::{Graph, MAX_DEPTH, place};

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{array} entry {index}: expected {expected}")]
pub struct Invalid {
    pub array: &'static str,
    /// Entry of the array; 0 for a field that is not an array.
    pub index: usize,
    pub expected: String,
}

pub(super) const MAX_ORIGIN: i64 = 1 << 52;

fn check(
    holds: bool,
    array: &'static str,
    index: usize,
    expected: impl FnOnce() -> String,
) -> Result<(), Invalid> {
    if holds {
        return Ok(());
    }
    Err(Invalid {
        array,
        index,
        expected: expected(),
    })
}

impl Graph {
    /// Checks every invariant, reading every entry:
    /// - `depth` at most [`MAX_DEPTH`]; placement finite, voxel size above 0;
    /// - 1 to `u32::MAX - 1` colours, as many normals, as many opacities or none, at most as many masks, as many `first`
    ///   as masks, the root among the nodes;
    /// - child lists within `links`, or within the nodes where there are no links; links within the nodes;
    /// - where stored level by level, no level is empty, the root is alone on its level, the finest level has no masks;
    /// - children there are of the level below, and in a tree each node is the child of exactly one, in order;
    /// - `voxels` is the counted number.
    pub fn validate(&self) -> Result<(), Invalid> {
        self.validate_shape()?;
        self.validate_levels()?;
        self.validate_children()?;
        let counted = self.count_voxels();
        check(self.voxels == counted, "voxels", 0, || {
            format!(
                "{counted}, the number of voxels counted, not {}",
                self.voxels
            )
        })
    }

    /// Checks lengths and single fields. Reads no array of nodes.
    pub(super) fn validate_shape(&self) -> Result<(), Invalid> {
        let nodes = self.color.len();
        check(self.depth <= MAX_DEPTH, "depth", 0, || {
            format!("at most {MAX_DEPTH}, not {}", self.depth)
        })?;
        check(nodes > 0 && nodes < u32::MAX as usize, "color", 0, || {
            format!("1 to {} nodes, not {nodes}", u32::MAX - 1)
        })?;
        check(self.normal.len() == nodes, "normal", 0, || {
            format!("{nodes} normals, one a node, not {}", self.normal.len())
        })?;
        let opacities = self.opacity.len();
        check(opacities == nodes || opacities == 0, "opacity", 0, || {
            format!("{nodes} opacities, one a node, or none, not {opacities}")
        })?;
        let masks = self.mask.len();
        check(masks <= nodes, "mask", 0, || {
            format!("at most {nodes} masks, not {masks}")
        })?;
        check(self.first.len() == masks, "first", 0, || {
            format!("{masks} entries, one a mask, not {}", self.first.len())
        })?;
        check(self.links.len() <= u32::MAX as usize, "links", 0, || {
            format!("at most {} links, not {}", u32::MAX, self.links.len())
        })?;
        check((self.root as usize) < nodes, "root", 0, || {
            format!("a node below {nodes}, not {}", self.root)
        })?;
        let place = &self.placement;
        let near = |&origin: &i64| (-MAX_ORIGIN..=MAX_ORIGIN).contains(&origin);
        check(place.origin_index.iter().all(near), "placement", 0, || {
            format!("an origin within 2^52, not {:?}", place.origin_index)
        })?;
        if place.can_be_seen(self.depth) {
            let is_seen = { place.mesh }.is_none_or(|mesh| mesh.can_be_seen(place.voxel_size));
            return check(is_seen, "mesh", 0, || {
                "a mesh's box that can be drawn, as long as a voxel or longer".to_owned()
            });
        }
        let size = place.voxel_size;
        let is_size = place::can_be_seen([0.0; 3], [0.0; 3], size);
        check(is_size, "voxel_size", 0, || {
            format!("a voxel size above 0 that can be drawn, not {size}")
        })?;
        check(false, "world_origin", 0, || {
            format!(
                "a world origin at which voxels of size {size} can be told apart, not {:?}",
                place.world_origin
            )
        })
    }

    pub(super) fn validate_levels(&self) -> Result<(), Invalid> {
        let starts = &self.level_start;
        if starts.is_empty() {
            return Ok(());
        }
        let entries = self.depth as usize + 2;
        check(starts.len() == entries, "level_start", 0, || {
            format!("no entries or {entries}, not {}", starts.len())
        })?;
        let ends = starts[0] == 0 && starts[1] == 1 && self.root == 0;
        check(ends, "level_start", 0, || {
            "node 0 as the root and only node of level 0".to_owned()
        })?;
        for (level, pair) in starts.windows(2).enumerate() {
            check(pair[0] < pair[1], "level_start", level + 1, || {
                format!("more than {}, not {}", pair[0], pair[1])
            })?;
        }
        let last = starts[entries - 1] as usize;
        check(last == self.len(), "level_start", entries - 1, || {
            format!("{}, the number of nodes, not {last}", self.len())
        })?;
        let finest = starts[entries - 2] as usize;
        check(self.mask.len() <= finest, "mask", finest, || {
            "no masks of the finest level".to_owned()
        })
    }

    pub(super) fn validate_children(&self) -> Result<(), Invalid> {
        let nodes = self.len() as u64;
        let linked = !self.links.is_empty();
        for (index, &link) in self.links.iter().enumerate() {
            check(u64::from(link) < nodes, "links", index, || {
                format!("a node below {nodes}, not {link}")
            })?;
        }
        let slots = if linked { self.links.len() } else { self.len() } as u64;
        let mut level = 0;
        // In a tree stored level by level: the next node without a parent.
        let mut orphan = 1u64;
        let lists = self.mask.iter().zip(self.first.iter()).enumerate();
        for (index, (&mask, &first)) in lists {
            if mask == 0 {
                continue;
            }
            let expect = |holds, what: &dyn Fn() -> String| check(holds, "first", index, what);
            let first = u64::from(first);
            let end = first + u64::from(mask.count_ones());
            expect(end <= slots, &|| {
                format!("children before {slots}, not {first}..{end}")
            })?;
            if self.level_start.is_empty() {
                continue;
            }
            while self.level_start[level + 1] as usize <= index {
                level += 1;
            }
            let below =
                u64::from(self.level_start[level + 1])..u64::from(self.level_start[level + 2]);
            if linked {
                for &link in &self.links[first as usize..end as usize] {
                    expect(below.contains(&u64::from(link)), &|| {
                        format!("children in {below:?}, the level below, not {link}")
                    })?;
                }
            } else {
                expect(first == orphan && end <= below.end, &|| {
                    format!(
                        "children from {orphan} and before {}, not {first}..{end}",
                        below.end
                    )
                })?;
                orphan = end;
            }
        }
        if !self.level_start.is_empty() && !linked {
            let last = self.first.len();
            check(orphan == nodes, "first", last, || {
                format!("each of {nodes} nodes to have a parent, not only {orphan}")
            })?;
        }
        Ok(())
    }
}
