//! Parts: the 64 grandchildren of a node, each a quarter of its side.

use super::lanes::Isa;
use crate::graph::{GraphView, prefetch};

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Parts {
    pub(super) exist: u64,
    /// The first child; the node itself unless plain.
    first: u32,
    solid: u8,
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Kind {
    /// All children have children, whose lists follow each other.
    #[default]
    Plain,
    Other,
    Solid,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) node: u32,
    pub(super) levels: u32,
}

const ONES: u64 = 0x0101_0101_0101_0101;

impl Parts {
    pub(super) fn of_solid(node: u32) -> Self {
        Self {
            exist: u64::MAX,
            first: node,
            kind: Kind::Solid,
            ..Self::default()
        }
    }

    /// `is_last`: the children are finest voxels. `detail`: those that level of detail makes solids.
    #[inline(always)]
    pub(super) fn of<I: Isa>(
        isa: I,
        graph: &GraphView<'_>,
        node: u32,
        is_last: bool,
        detail: u8,
    ) -> Self {
        let mut parts = Self::default();
        parts.read(isa, graph, node, is_last, detail);
        parts
    }

    #[inline(always)]
    pub(super) fn read<I: Isa>(
        &mut self,
        isa: I,
        graph: &GraphView<'_>,
        node: u32,
        is_last: bool,
        detail: u8,
    ) {
        let at = node as usize;
        if let (Some(&mask), Some(&first)) = (graph.mask.get(at), graph.first.get(at))
            && mask != 0
            && detail == 0
            && !is_last
            && graph.is_in_order
            && let Some(eight) = graph
                .mask
                .get(first as usize..(first as usize).saturating_add(8))
            && let Some(eight) = eight.first_chunk()
        {
            let [exist, bytes] = isa.expand(u64::from_le_bytes(*eight), mask);
            let filled = exist | !bytes;
            if filled.wrapping_sub(ONES) & !filled & (ONES << 7) == 0 {
                self.exist = exist;
                self.first = first;
                self.solid = 0;
                self.kind = Kind::Plain;
                return;
            }
        }
        self.look_up_all(graph, node, is_last, detail);
    }

    #[inline(never)]
    fn look_up_all(&mut self, graph: &GraphView<'_>, node: u32, is_last: bool, detail: u8) {
        let mask = graph.mask(node);
        if mask == 0 {
            *self = Self::of_solid(node);
            return;
        }
        *self = Self {
            first: node,
            kind: Kind::Other,
            ..Self::default()
        };
        for octant in (0..8u8).filter(|octant| mask >> octant & 1 != 0) {
            let Some(child) = graph.child(node, octant) else {
                continue;
            };
            let mut below = graph.mask(child);
            if is_last || detail >> octant & 1 != 0 || below == 0 {
                self.solid |= 1 << octant;
                below = u8::MAX;
            }
            self.exist |= u64::from(below) << (8 * octant);
        }
    }

    #[inline(always)]
    pub(super) fn are_even(&self) -> bool {
        self.solid == 0 && self.kind != Kind::Solid
    }

    #[inline(always)]
    pub(super) fn prefetch(&self, graph: &GraphView<'_>) {
        prefetch(graph.first, self.first as usize);
    }

    #[inline(always)]
    pub(super) fn prefetch_masks(&self, graph: &GraphView<'_>) {
        let part = graph.first.get(self.first as usize).copied().unwrap_or(0);
        let first = graph.first.get(part as usize).copied().unwrap_or(0) as usize;
        for line in 0..4 {
            prefetch(graph.mask, first + 64 * line);
        }
    }

    #[inline(always)]
    pub(super) fn is_single(&self) -> bool {
        self.kind == Kind::Solid
    }

    #[inline(always)]
    pub(super) fn part(&self, graph: &GraphView<'_>, part: u32) -> Part {
        if self.kind != Kind::Plain {
            return self.look_up(graph, part);
        }
        Part {
            node: self.after(graph.first(self.first), part),
            levels: 2,
        }
    }

    /// The first part's node, if those of others follow from it.
    #[inline(always)]
    pub(super) fn first_node(&self, graph: &GraphView<'_>) -> Option<u32> {
        (self.kind == Kind::Plain).then(|| graph.first(self.first))
    }

    /// A part's node. `first`: [`Parts::first_node`].
    #[inline(always)]
    pub(super) fn node(&self, graph: &GraphView<'_>, first: Option<u32>, part: u32) -> u32 {
        match first {
            Some(first) => self.after(first, part),
            None => self.look_up(graph, part).node,
        }
    }

    #[inline(always)]
    fn after(&self, first: u32, part: u32) -> u32 {
        let before = self.exist & ((1 << (part & 63)) - 1);
        first.wrapping_add(before.count_ones())
    }

    #[inline(never)]
    fn look_up(&self, graph: &GraphView<'_>, part: u32) -> Part {
        let outer = (part >> 3 & 7) as u8;
        let of = |node, levels| Part { node, levels };
        if self.kind == Kind::Solid {
            return of(self.first, 0);
        }
        let child = graph.child(self.first, outer).unwrap_or(self.first);
        if self.solid >> outer & 1 != 0 {
            return of(child, 1);
        }
        of(graph.child(child, part as u8 & 7).unwrap_or(child), 2)
    }
}
