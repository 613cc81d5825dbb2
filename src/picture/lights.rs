//! Light of each node of a graph, for a rule that blends while it draws.

use rayon::prelude::*;

use super::Shading;
use super::color::Light;
use super::linear::Linear;
use super::shade::towards_eye;
use super::sight::Sight;
use crate::graph::{Graph, PackedNormal};
use crate::project::FrameSetup;

/// Linear light by node, 0 to 65535 per channel; empty where the frame's rule does not blend.
///
/// A picture that is shaded afterwards knows the face and the ray of each sample. Here a node has one light for all
/// samples: its normal is turned towards the camera's plane, and a node without one is lit as if it faced the camera.
pub fn lights(graph: &Graph, setup: &FrameSetup, shading: Shading) -> Vec<[u16; 3]> {
    if !setup.options.coverage.blends() {
        return Vec::new();
    }
    let sight = Sight::new(setup);
    let [_, _, back] = sight.axes();
    let light = Light::new(shading, sight.axes());
    let linear = Linear::tables();
    (0..graph.len() as u32)
        .into_par_iter()
        .map(|node| {
            let normal = PackedNormal::decode(graph.normal_of(node));
            let normal = normal.map_or(back, |normal| towards_eye(normal, -back));
            let share = light.on(normal);
            let full = linear.decode(graph.color_of(node));
            full.map(|channel| ((channel * share) >> 8) as u16)
        })
        .collect()
}
