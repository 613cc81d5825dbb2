//! Sierpinski's tetrahedron: the smallest graph with a cycle.

use super::list::Settings;
use crate::graph::{Graph, PackedNormal, Placement};

/// The octants that are filled: no two share a face.
const OCTANTS: [u8; 4] = [0b000, 0b011, 0b101, 0b110];
const COLOR: [u8; 3] = [226, 174, 88];

pub(super) fn graph(settings: &Settings) -> Graph {
    Graph {
        depth: settings.depth,
        root: 0,
        mask: vec![OCTANTS.iter().fold(0, |mask, octant| mask | 1 << octant)].into(),
        first: vec![0].into(),
        links: vec![0; OCTANTS.len()].into(),
        color: vec![COLOR].into(),
        normal: vec![PackedNormal::default()].into(),
        opacity: Vec::new().into(),
        level_start: Vec::new(),
        voxels: 4u64.saturating_pow(settings.depth),
        placement: Placement::default(),
    }
}
