//! Bits of the fill vectors on the chip, and of an access to them.

use hwmodel::cycles::{Hardware, Organisation};

use shiftvox::frame::quadtree::nodes_to;
use shiftvox::project::FrameSetup;

const FILL_VECTOR_BITS: u32 = 4;
/// Bits of a word that takes the place of the vectors of a node two levels above the samples and of all below it.
const JOINED_FILL_BITS: u32 = 16;

/// Levels above the tiles of a picture, and whether there are joined vectors below them.
fn fill_levels(setup: &FrameSetup, organisation: Organisation) -> (u32, bool) {
    let above = organisation.tile_levels.min(setup.levels);
    let joined = organisation.joined_fill && setup.levels >= above + 2;
    (above, joined)
}

pub fn fill_access_bits(setup: &FrameSetup, organisation: Organisation) -> u32 {
    match fill_levels(setup, organisation).1 {
        true => JOINED_FILL_BITS,
        false => FILL_VECTOR_BITS,
    }
}

/// Bits of the fill vectors on the chip: of the picture or, if it is drawn by tiles, of one tile per context. A context
/// begins a tile only if no record of its lane is ready. Lanes that steal work may have a few more tiles in progress.
pub fn fill_store_bits(setup: &FrameSetup, hardware: &Hardware) -> u64 {
    let (above, joined) = fill_levels(setup, hardware.organisation);
    let levels = setup.levels - above;
    let bits = match (joined, levels.checked_sub(3)) {
        (false, _) => u64::from(FILL_VECTOR_BITS) * nodes_to(levels) as u64,
        (true, rest) => {
            let words = 1u64 << (2 * (levels - 2));
            let vectors = rest.map_or(0, |levels| nodes_to(levels) as u64);
            u64::from(JOINED_FILL_BITS) * words + u64::from(FILL_VECTOR_BITS) * vectors
        }
    };
    let tiles = hardware.all_contexts().min(1u64 << (2 * above));
    tiles * (bits + u64::from(FILL_VECTOR_BITS * above))
}
