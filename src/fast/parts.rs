//! Parts: the 64 grandchildren of a node.

use super::lanes::Isa;
use crate::graph::GraphView;

/// The children's children of a node: 64 parts of a quarter of its side.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Parts {
    /// Mask of those that exist: bit `outer << 3 | inner`, octants in Morton order.
    pub(super) exist: u64,
    /// Where the node's children begin.
    first: u32,
    /// The node itself.
    node: u32,
    /// Mask of the node's children.
    mask: u8,
    /// Children that are solid themselves: all their parts are they.
    solid: u8,
    kind: Kind,
}

/// How parts become nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Kind {
    /// Each part is a node; children lie one after the other.
    #[default]
    Plain,
    /// Each part is a node, which the graph's links name; or a child is solid.
    Linked,
    /// The node is solid: all parts are it.
    Solid,
}

/// A part of a node: the node that fills it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) node: u32,
    /// Levels below the node whose part it is: 2, or less where a part is of something larger.
    pub(super) levels: u32,
}

const ONES: u64 = 0x0101_0101_0101_0101;

/// Set bits below a place in a byte.
#[inline(always)]
fn rank(mask: u32, place: u32) -> u32 {
    (mask & ((1 << place) - 1)).count_ones()
}

impl Parts {
    /// The parts of a solid node.
    pub(super) fn of_solid(node: u32) -> Self {
        Self {
            exist: u64::MAX,
            node,
            kind: Kind::Solid,
            ..Self::default()
        }
    }

    /// The parts of a node with children. `is_last`: its children are voxels of the finest
    /// level. `detail`: its children that level of detail takes for solids.
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

    /// [`Parts::of`], in place: to move parts there takes longer than to make them.
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
            && graph.links.is_empty()
            && let Some(eight) = graph
                .mask
                .get(first as usize..)
                .and_then(|m| m.first_chunk())
        {
            let [exist, bytes] = isa.expand(u64::from_le_bytes(*eight), mask);
            // A byte of zeros among those of children: a child without children.
            let filled = exist | !bytes;
            if filled.wrapping_sub(ONES) & !filled & (ONES << 7) == 0 {
                self.exist = exist;
                self.first = first;
                self.node = node;
                self.mask = mask;
                self.solid = 0;
                self.kind = Kind::Plain;
                return;
            }
        }
        self.look_up_all(graph, node, is_last, detail);
    }

    /// [`Parts::read`], child by child.
    #[inline(never)]
    fn look_up_all(&mut self, graph: &GraphView<'_>, node: u32, is_last: bool, detail: u8) {
        let mask = graph.mask(node);
        if mask == 0 {
            *self = Self::of_solid(node);
            return;
        }
        *self = Self {
            first: graph.first.get(node as usize).copied().unwrap_or(0),
            node,
            mask,
            kind: Kind::Linked,
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

    /// Whether each part is a node of its own.
    #[inline(always)]
    pub(super) fn are_even(&self) -> bool {
        self.solid == 0 && self.kind != Kind::Solid
    }

    /// Asks the memory for what [`Parts::part`] reads.
    #[inline(always)]
    pub(super) fn prefetch<I: Isa>(&self, isa: I, graph: &GraphView<'_>) {
        isa.prefetch(graph.first, self.first as usize);
    }

    /// Asks the memory for what parts of these are made of, where nodes lie level by level.
    #[inline(always)]
    pub(super) fn prefetch_below<I: Isa>(&self, isa: I, graph: &GraphView<'_>) {
        let first = graph.first.get(self.first as usize).copied().unwrap_or(0) as usize;
        isa.prefetch(graph.mask, first);
        isa.prefetch(graph.mask, first + 63);
        for sixteen in 0..5 {
            isa.prefetch(graph.first, first + 16 * sixteen);
        }
    }

    /// Asks the memory for the masks below the parts, once what [`Parts::prefetch_below`] asked for
    /// has come.
    #[inline(always)]
    pub(super) fn prefetch_masks<I: Isa>(&self, isa: I, graph: &GraphView<'_>) {
        let part = graph.first.get(self.first as usize).copied().unwrap_or(0);
        let first = graph.first.get(part as usize).copied().unwrap_or(0) as usize;
        for line in 0..4 {
            isa.prefetch(graph.mask, first + 64 * line);
        }
    }

    /// Whether all parts are one solid node.
    #[inline(always)]
    pub(super) fn is_single(&self) -> bool {
        self.kind == Kind::Solid
    }

    /// A part that exists.
    #[inline(always)]
    pub(super) fn part(&self, graph: &GraphView<'_>, part: u32) -> Part {
        if self.kind != Kind::Plain {
            return self.look_up(graph, part);
        }
        let outer = part >> 3 & 7;
        let child = self.first.wrapping_add(rank(u32::from(self.mask), outer));
        let first = graph.first.get(child as usize).copied().unwrap_or(0);
        let below = (self.exist >> (8 * outer)) as u32 & 0xff;
        Part {
            node: first.wrapping_add(rank(below, part & 7)),
            levels: 2,
        }
    }

    #[inline(never)]
    fn look_up(&self, graph: &GraphView<'_>, part: u32) -> Part {
        let outer = (part >> 3 & 7) as u8;
        let of = |node, levels| Part { node, levels };
        if self.kind == Kind::Solid {
            return of(self.node, 0);
        }
        let child = graph.child(self.node, outer).unwrap_or(self.node);
        if self.solid >> outer & 1 != 0 {
            return of(child, 1);
        }
        of(graph.child(child, part as u8 & 7).unwrap_or(child), 2)
    }
}
