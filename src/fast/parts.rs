//! Which of the 64 parts of a node exist, and the nodes that they are.

use super::lanes::Isa;
use crate::graph::GraphView;

/// The children's children of a node: 64 parts of a quarter of its side.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Parts {
    /// Which exist: bit `outer << 3 | inner`, octants in Morton order.
    pub(super) exist: u64,
    /// Where the node's children begin.
    first: u32,
    /// The node itself.
    node: u32,
    /// Which children the node has.
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
    Looked,
    /// The node is solid: all parts are it.
    Solid,
}

/// What a part of a node is.
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

    /// [`Parts::of`], in its place: to move parts there takes longer than to make them.
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
            let (exist, bytes) = isa.spread(u64::from_le_bytes(*eight), mask);
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
            kind: Kind::Looked,
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

    /// Whether all parts are one solid node.
    #[inline(always)]
    pub(super) fn is_single(&self) -> bool {
        self.kind == Kind::Solid
    }

    /// What a part is that exists.
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

/// By octant: the bits of a child mask turned, so that bit `c` is child `c ^ octant`.
static TURNED: [[u8; 256]; 8] = {
    let mut table = [[0u8; 256]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut mask = 0;
        while mask < 256 {
            let mut child = 0;
            while child < 8 {
                table[octant][mask] |= ((mask >> (child ^ octant)) as u8 & 1) << child;
                child += 1;
            }
            mask += 1;
        }
        octant += 1;
    }
    table
};

/// A child mask turned, so that bit `c` is child `c ^ octant`: with the
/// nearest octant that is an order of occlusion.
#[inline(always)]
pub(super) fn turned(mask: u8, octant: u8) -> u8 {
    TURNED[usize::from(octant & 7)][usize::from(mask)]
}

/// The same of 64 parts, both octants of a part turned.
#[inline(always)]
pub(super) fn turned_parts(parts: u64, octant: u8) -> u64 {
    let mut all = 0;
    for outer in 0..8u8 {
        let mask = (parts >> (8 * (outer ^ octant & 7))) as u8;
        all |= u64::from(turned(mask, octant)) << (8 * outer);
    }
    all
}

/// By octant, for lanes of sixteen bytes: the outer octants' order, and a
/// mask's lower and upper half turned.
pub(super) static TURNED_BYTES: [[[u8; 16]; 3]; 8] = {
    let mut table = [[[0u8; 16]; 3]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut i = 0;
        while i < 16 {
            table[octant][0][i] = (i as u8 & 7) ^ octant as u8;
            table[octant][1][i] = TURNED[octant][i];
            table[octant][2][i] = TURNED[octant][i << 4];
            i += 1;
        }
        octant += 1;
    }
    table
};

/// By axis, the parts of the four slabs of a node.
pub(super) static SLABS: [[u64; 4]; 3] = {
    let mut table = [[0; 4]; 3];
    let mut part = 0;
    while part < 64 {
        let mut axis = 0;
        while axis < 3 {
            table[axis][super::strips::along(part, axis)] |= 1 << part;
            axis += 1;
        }
        part += 1;
    }
    table
};

/// By axis and by which of its four slabs are filled: the middle of those from the first to the last,
/// from the node's centre, and half their extent, in sides of a slab; in the axis' lane.
pub(super) static EXTENTS: [[[[f32; 4]; 2]; 16]; 3] = {
    let mut table = [[[[0.0; 4]; 2]; 16]; 3];
    let mut slabs = 1u32;
    while slabs < 16 {
        let first = slabs.trailing_zeros() as f32;
        let end = 32.0 - slabs.leading_zeros() as f32;
        let mut axis = 0;
        while axis < 3 {
            table[axis][slabs as usize][0][axis] = (first + end) / 2.0 - 2.0;
            table[axis][slabs as usize][1][axis] = (end - first) / 2.0;
            axis += 1;
        }
        slabs += 1;
    }
    table
};
