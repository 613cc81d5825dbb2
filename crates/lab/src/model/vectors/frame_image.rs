//! Images for `$readmemh`: the constants, nodes and attributes from which `rtl/` draws whole frames (`docs/rtl.md`).

use std::fmt::Write;

use shiftvox::graph::{GraphView, NodeLayout, PackedNormal};
use shiftvox::machine::frame_registers;
use shiftvox::project::FrameSetup;

/// The file of constants from number 0 on, one register per line.
pub(super) const CONSTANTS: &str = "frame.constants.hex";
/// The file of nodes from number 0 on, one word of 64 bits per line. A brick has two words.
pub(super) const NODES: &str = "frame.nodes.hex";
/// The file of attributes from number 0 on, one word of 64 bits per line.
pub(super) const ATTRIBUTES: &str = "frame.attributes.hex";

/// The constants, each as wide as a word.
pub(super) fn constants(setup: &FrameSetup, graph: &GraphView<'_>, layout: &NodeLayout) -> String {
    let format = setup.format;
    let mask = u64::MAX >> (64 - format.bits());
    let digits = format.bits().div_ceil(4) as usize;
    let mut text =
        String::from("// Registers of the frame's constants, from number 0 on: docs/rtl.md.\n");
    for value in frame_registers(setup, graph, layout) {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{:0digits$x}", value as u64 & mask);
    }
    text
}

/// The nodes: masks of children and of leaves, and the place of the first child. Bricks have two words, and no nodes below.
/// `None` if children are not side by side, or if numbers are too large for the words.
pub(super) fn nodes(graph: &GraphView<'_>, layout: &NodeLayout) -> Option<String> {
    if !graph.links.is_empty() {
        return None;
    }
    let bricks = layout.bricks();
    let mut text = String::from(
        "// Nodes from number 0 on: leaves << 40 | mask of children << 32 | where they begin.\n",
    );
    let whole = match bricks.is_empty() {
        true => graph.mask.len(),
        false => bricks.start as usize,
    };
    for (&mask, &first) in graph.mask.iter().zip(graph.first).take(whole) {
        // Children lie side by side, in octant order.
        let octants = (0..8).filter(|octant| mask >> octant & 1 != 0);
        let leaves = octants
            .zip(first as usize..)
            .fold(0, |bits, (octant, child)| {
                bits | u64::from(graph.mask.get(child) == Some(&0)) << octant
            });
        let word = leaves << 40 | u64::from(mask) << 32 | u64::from(first);
        let _ = writeln!(text, "{word:016x}");
    }
    if !bricks.is_empty() {
        text.push_str(
            "// Bricks: voxels; leaves << 56 | where children begin << 28 | where voxels begin.\n",
        );
    }
    for brick in bricks {
        for word in NodeLayout::brick_words(graph, brick)? {
            let _ = writeln!(text, "{word:016x}");
        }
    }
    Some(text)
}

/// The nodes' colours and normals. A file without normals has none.
pub(super) fn attributes(color: &[[u8; 3]], normal: &[PackedNormal]) -> String {
    let mut text = String::from(
        "// Attributes from number 0 on: normal << 24 | red << 16 | green << 8 | blue.\n",
    );
    let normals = normal.iter().chain(std::iter::repeat(&PackedNormal(0)));
    for (&[red, green, blue], normal) in color.iter().zip(normals) {
        let color = u32::from_be_bytes([0, red, green, blue]);
        let word = u64::from(normal.0) << 24 | u64::from(color);
        let _ = writeln!(text, "{word:016x}");
    }
    text
}
