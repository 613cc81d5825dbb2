//! Which parts a node has, and in which order: its children, or theirs.

use super::lanes::Isa;
use crate::graph::GraphView;
use crate::project::OCCLUSION_ORDER;

/// By octant: the bits of a child mask in occlusion order.
const IN_ORDER: [[u8; 256]; 8] = all_in_order();
static IN_ORDER_TABLE: [[u8; 256]; 8] = IN_ORDER;

/// The children of a mask in occlusion order, nearest in bit 0.
#[inline(always)]
pub(super) fn in_order(octant: u8, mask: u8) -> u8 {
    IN_ORDER_TABLE[usize::from(octant & 7)][usize::from(mask)]
}

const fn all_in_order() -> [[u8; 256]; 8] {
    let mut table = [[0u8; 256]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut mask = 0;
        while mask < 256 {
            let mut i = 0;
            while i < 8 {
                let child = octant as u8 ^ OCCLUSION_ORDER[i];
                table[octant][mask] |= ((mask >> child) as u8 & 1) << i;
                i += 1;
            }
            mask += 1;
        }
        octant += 1;
    }
    table
}

/// The parts of a node that exist.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parts {
    /// By lane.
    pub(super) lanes: u64,
    /// The masks of the node's children, a byte each, by octant. Of a node one
    /// level above its parts: nothing.
    masks: u64,
    /// Where the node's children begin.
    first: u32,
    /// Which children the node has.
    mask: u8,
    /// Whether a child has no children, so that a part is larger than the others.
    pub(super) is_uneven: bool,
}

/// By mask: a byte of ones for each bit.
static BYTES: [u64; 256] = {
    let mut table = [0u64; 256];
    let mut mask = 0;
    while mask < 256 {
        let mut bit = 0;
        while bit < 8 {
            if mask >> bit & 1 != 0 {
                table[mask] |= 0xff << (8 * bit);
            }
            bit += 1;
        }
        mask += 1;
    }
    table
};

impl Parts {
    /// The parts of a node `levels` levels above the finest: of one level, its
    /// children; of more, theirs.
    #[inline(always)]
    pub(super) fn of<I: Isa>(
        isa: I,
        graph: &GraphView<'_>,
        node: u32,
        levels: u32,
        octant: u8,
    ) -> Self {
        let mask = graph.mask(node);
        let first = graph.first.get(node as usize).copied().unwrap_or(0);
        if levels == 1 {
            return Self {
                lanes: u64::from(in_order(octant, mask)),
                masks: 0,
                first,
                mask,
                is_uneven: mask == 0,
            };
        }
        let exist = BYTES[usize::from(mask)];
        let eight = graph
            .mask
            .get(first as usize..)
            .and_then(|m| m.first_chunk());
        let masks = match eight {
            Some(&eight) if graph.links.is_empty() => {
                isa.spread(u64::from_le_bytes(eight), mask, exist)
            }
            _ => Self::masks_one_by_one(graph, first, mask),
        };
        const ONES: u64 = 0x0101_0101_0101_0101;
        let filled = masks | !exist;
        let has_zero = filled.wrapping_sub(ONES) & !filled & (ONES << 7) != 0;
        Self {
            lanes: isa.masks_in_order(masks, octant),
            masks,
            first,
            mask,
            is_uneven: has_zero || mask == 0,
        }
    }

    /// The masks of a node's children, wherever they are.
    fn masks_one_by_one(graph: &GraphView<'_>, first: u32, mask: u8) -> u64 {
        let mut masks = 0;
        let mut slot = first;
        for octant in 0..8 {
            if mask >> octant & 1 != 0 {
                let child = linked(graph.links, slot);
                masks |= u64::from(graph.mask(child)) << (8 * octant);
                slot = slot.wrapping_add(1);
            }
        }
        masks
    }

    /// The node of a lane, `levels` levels below.
    #[inline(always)]
    pub(super) fn node(&self, graph: &GraphView<'_>, levels: u32, octant: u8, lane: u32) -> u32 {
        let octants = (u32::from(octant & 7) * 9) ^ u32::from(BY_LANE[lane as usize & 63]);
        let (outer, inner) = (octants >> 3 & 7, octants & 7);
        let before = |mask: u64, child: u32| (mask & ((1u64 << child) - 1)).count_ones();
        let mask = u64::from(self.mask);
        if levels == 1 {
            return linked(graph.links, self.first.wrapping_add(before(mask, inner)));
        }
        let child = linked(graph.links, self.first.wrapping_add(before(mask, outer)));
        let first = graph.first.get(child as usize).copied().unwrap_or(0);
        let before = before(self.masks >> (8 * outer) & 0xff, inner);
        linked(graph.links, first.wrapping_add(before))
    }
}

/// By lane, for octant 0: a child, and in the upper bits the child that it is in.
static BY_LANE: [u8; 64] = {
    let mut octants = [0; 64];
    let mut lane = 0;
    while lane < 64 {
        octants[lane] = OCCLUSION_ORDER[lane >> 3] << 3 | OCCLUSION_ORDER[lane & 7];
        lane += 1;
    }
    octants
};

/// By octant, for lanes of sixteen bytes: the children of a mask's lower and
/// upper half in occlusion order, and the order itself.
pub(super) static ORDER_BYTES: [[[u8; 16]; 3]; 8] = {
    let mut table = [[[0u8; 16]; 3]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut i = 0;
        while i < 16 {
            table[octant][0][i] = IN_ORDER[octant][i];
            table[octant][1][i] = IN_ORDER[octant][i << 4];
            table[octant][2][i] = octant as u8 ^ OCCLUSION_ORDER[i & 7];
            i += 1;
        }
        octant += 1;
    }
    table
};

/// [`Isa::masks_in_order`], byte by byte.
#[inline(always)]
pub(super) fn masks_in_order(masks: u64, octant: u8) -> u64 {
    let mut lanes = 0;
    for (i, nearest) in OCCLUSION_ORDER.into_iter().enumerate() {
        let mask = (masks >> (8 * ((octant ^ nearest) & 7))) as u8;
        lanes |= u64::from(in_order(octant, mask)) << (8 * i);
    }
    lanes
}

/// The node at a place of a child list.
#[inline(always)]
pub(super) fn linked(links: &[u32], slot: u32) -> u32 {
    if links.is_empty() {
        slot
    } else {
        links.get(slot as usize).copied().unwrap_or(slot)
    }
}

/// The lowest corner of a lane's part with this side, of a node `levels` above.
#[inline(always)]
pub(super) fn corner(min: [i32; 3], levels: u32, side: i32, octant: u8, lane: u32) -> [i32; 3] {
    let inner = octant ^ OCCLUSION_ORDER[lane as usize & 7];
    let outer = octant ^ OCCLUSION_ORDER[(lane >> 3) as usize & 7];
    let mut corner = min;
    for k in 0..3 {
        corner[k] += i32::from(inner >> (2 - k) & 1) * side;
        if levels == 2 {
            corner[k] += 2 * i32::from(outer >> (2 - k) & 1) * side;
        }
    }
    corner
}
