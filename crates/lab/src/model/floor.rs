//! A lower bound on the energy of every design that draws a frame from a graph in a given node format. Every design must
//! move:
//!
//! - the lines that hold the attributes of the visible voxels;
//! - the lines that hold the nodes above them;
//! - the pixels.
//!
//! Each line is fetched once, as by a cache of unlimited size. Arithmetic and memories on the chip cost nothing here.

use std::collections::BTreeSet;

use hwmodel::cost::{CostError, CostTable};
use hwmodel::cycles::Hardware;
use hwmodel::memory::PIXEL_BITS;
use serde::Serialize;

use super::cost::{OuterTraffic, outer_energy};
use shiftvox::frame::{Frame, NO_NODE};
use shiftvox::graph::{Graph, NodeLayout};

#[derive(Debug, Clone, Serialize)]
pub struct Floor {
    pub node_lines: u64,
    pub attribute_lines: u64,
    /// Samples that show something.
    pub pixels: u64,
    pub nodes_pj: f64,
    pub attributes_pj: f64,
    pub pixels_pj: f64,
    pub energy_pj: f64,
}

/// The bound for a frame, the node format and the cache lines of a hardware.
pub fn floor(
    graph: &Graph,
    frame: &Frame,
    hardware: &Hardware,
    table: &CostTable,
) -> Result<Floor, CostError> {
    let view = graph.view();
    let organisation = hardware.organisation;
    let layout = NodeLayout::new(&view, organisation.leaf_masks, organisation.bricks);
    let line_of = |cache: &hwmodel::cycles::Cache, entry: u64| {
        entry * u64::from(cache.entry_bytes) / u64::from(cache.line_bytes)
    };
    let (mut nodes, mut attributes) = (BTreeSet::new(), BTreeSet::new());
    let mut seen = BTreeSet::new();
    let mut pixels = 0;
    for (&node, &voxel) in frame.node.iter().zip(&frame.voxel) {
        if node == NO_NODE {
            continue;
        }
        pixels += 1;
        if !seen.insert(voxel) {
            continue;
        }
        attributes.insert(line_of(&hardware.attribute_cache, u64::from(node)));
        let [x, y, z, level] = voxel;
        let mut above = view.root;
        for at in 0..=level.max(0) as u32 {
            // A leaf is marked in its parent or in its own node.
            if at == level as u32 && layout.leaf_masks {
                break;
            }
            for word in layout.words(above, at) {
                nodes.insert(line_of(&hardware.node_cache, word));
            }
            if at == level as u32 {
                break;
            }
            let place = graph.depth - at - 1;
            let octant = [x, y, z]
                .iter()
                .fold(0u8, |bits, c| bits << 1 | (c >> place & 1) as u8);
            match view.child(above, octant) {
                Some(child) => above = child,
                None => break,
            }
        }
    }
    let lines = |lines: usize, cache: &hwmodel::cycles::Cache| {
        8 * u64::from(cache.line_bytes) * lines as u64
    };
    let price = |traffic: OuterTraffic| outer_energy(&traffic, table).map(|sum| sum.total);
    let none = OuterTraffic::default();
    let nodes_pj = price(OuterTraffic {
        node_bits: lines(nodes.len(), &hardware.node_cache),
        ..none
    })?;
    let attributes_pj = price(OuterTraffic {
        attribute_bits: lines(attributes.len(), &hardware.attribute_cache),
        ..none
    })?;
    let pixels_pj = price(OuterTraffic {
        pixel_bits: pixels * u64::from(PIXEL_BITS),
        ..none
    })?;
    Ok(Floor {
        node_lines: nodes.len() as u64,
        attribute_lines: attributes.len() as u64,
        pixels,
        nodes_pj,
        attributes_pj,
        pixels_pj,
        energy_pj: nodes_pj + attributes_pj + pixels_pj,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use hwmodel::cycles::Organisation;
    use shiftvox::graph::{BuildOptions, Builder, Silent, Voxel};

    /// Two voxels of opposite corners, depth 2: the root, two nodes below it, two voxels.
    #[test]
    fn two_voxels_by_hand() {
        let mut builder = Builder::new(BuildOptions::default());
        builder.push(Voxel::default());
        builder.push(Voxel {
            index: [3; 3],
            ..Voxel::default()
        });
        let graph = builder.finish(([0.0; 3], 1.0), &Silent).unwrap();
        let mut frame = Frame::new(2, 1, false);
        frame.node = vec![3, 4];
        frame.voxel = vec![[0, 0, 0, 2], [3, 3, 3, 2]];
        let mut hardware = Hardware::preset("paper").unwrap();
        (
            hardware.node_cache.line_bytes,
            hardware.attribute_cache.line_bytes,
        ) = (16, 8);
        for (leaf_masks, bricks, node_lines) in [
            // Nodes 0 to 4 in lines of two.
            (false, false, 3),
            // Without the leaves: nodes 0, 1, 2.
            (true, false, 2),
            // The root is a brick of two words.
            (true, true, 1),
        ] {
            hardware.organisation = Organisation {
                leaf_masks,
                bricks,
                ..Organisation::default()
            };
            let table = CostTable::load_shipped().unwrap();
            let found = floor(&graph, &frame, &hardware, &table).unwrap();
            // Attributes 3 and 4 in lines of one; 48 bits of pixels are a word.
            assert_eq!((found.node_lines, found.attribute_lines), (node_lines, 2));
            let price = (node_lines as f64 * 2.0 + 2.0 + 1.0) * 1950.0;
            assert!((found.energy_pj - price).abs() < 1e-6);
        }
    }
}
