//! The voxel graph and its file.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

mod external;
mod normals;
mod properties;
mod scale;
#[path = "../../crates/mesh/tests/sealed/seal.rs"]
#[allow(dead_code, reason = "other formats, too")]
mod seal;
mod vxg;

use proptest::prelude::*;
use shiftvox::graph::{Builder, Graph, PackedNormal, Silent, Voxel, vxg as file};
use shiftvox::scene::generate::Spec;

/// World origin and size of a voxel.
const PLACE: ([f64; 3], f64) = ([0.5, -2.0, 1e3], 0.25);

fn build(voxels: &[Voxel]) -> Graph {
    let mut builder = Builder::default();
    voxels.iter().for_each(|&voxel| builder.push(voxel));
    let graph = builder.finish(PLACE, &Silent).unwrap();
    graph.validate().unwrap();
    graph
}

fn at(index: [i32; 3]) -> Voxel {
    Voxel {
        index,
        color: index.map(|c| c.wrapping_mul(37) as u8),
        normal: None,
    }
}

fn generated(spec: &str) -> Vec<Voxel> {
    let mut voxels = Vec::new();
    let spec = Spec::parse(spec).unwrap();
    spec.voxels(&mut |voxel| voxels.push(voxel), &Silent);
    voxels
}

fn bytes_of(graph: &Graph) -> Vec<u8> {
    let mut bytes = Vec::new();
    file::write_to(graph, &mut bytes).unwrap();
    bytes
}

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
    let numbers = (graph.depth, graph.root, graph.voxels, graph.placement);
    let shape = [&graph.first, &graph.links].map(|numbers| numbers.to_vec());
    let attributes = (
        graph.color.to_vec(),
        graph.normal.to_vec(),
        graph.opacity.to_vec(),
    );
    (
        numbers,
        graph.mask.to_vec(),
        shape,
        attributes,
        graph.level_start.clone(),
    )
}
