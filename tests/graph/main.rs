//! The voxel graph and its file.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod external;
mod properties;
mod scale;
mod vxg;

use proptest::prelude::*;
use shiftvox::graph::{Graph, PackedNormal, Voxel};

/// Clusters and strays, with repeated indices, a few colours, some normals.
fn voxels(most: usize) -> impl Strategy<Value = Vec<Voxel>> {
    let near = prop::array::uniform3(-6..6i32);
    let wide = prop::array::uniform3(-40..300i32);
    let far = prop::array::uniform3(-900_000..900_000i32);
    let index = prop_oneof![25 => near, 6 => wide, 1 => far];
    let color = prop_oneof![Just([1, 2, 3]), Just([250, 0, 9]), any::<[u8; 3]>()];
    let normal =
        prop_oneof![3 => Just(None), 1 => (1..=u16::MAX).prop_map(|n| Some(PackedNormal(n)))];
    let voxel = (index, color, normal).prop_map(|(index, color, normal)| Voxel {
        index,
        color,
        normal,
    });
    prop::collection::vec(voxel, 1..most)
}

/// All that makes a graph, to be compared.
fn parts(graph: &Graph) -> impl PartialEq + std::fmt::Debug + use<> {
    (
        (graph.depth, graph.root, graph.voxels, graph.placement),
        (
            graph.mask.to_vec(),
            graph.first.to_vec(),
            graph.links.to_vec(),
        ),
        (
            graph.color.to_vec(),
            graph.normal.to_vec(),
            graph.opacity.to_vec(),
        ),
        graph.level_start.clone(),
    )
}
