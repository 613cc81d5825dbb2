//! The appearance of a sample: surface, light, and colours in linear light.

use glam::DVec3;

use super::color::Light;
use super::linear::Linear;
use super::sight::{Meeting, Sight};
use super::{Background, Shading};
use crate::graph::{Graph, PackedNormal};
use crate::project::FrameSetup;

/// Shows samples of one frame. The result for a sample depends on its position, but not on its neighbours.
pub struct Shader<'g> {
    pub(super) graph: &'g Graph,
    pub(super) sight: Sight,
    pub(super) light: Light,
    pub(super) linear: &'static Linear,
    background: Option<[u32; 3]>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Surface {
    pub(super) meeting: Meeting,
    pub(super) normal: DVec3,
}

impl<'g> Shader<'g> {
    pub fn new(
        graph: &'g Graph,
        setup: &FrameSetup,
        shading: Shading,
        background: Background,
    ) -> Self {
        let sight = Sight::new(setup);
        let light = Light::new(shading, sight.axes());
        let linear = Linear::tables();
        let background = match background {
            Background::None => None,
            Background::Color(color) => Some(linear.decode(color)),
        };
        Self {
            graph,
            sight,
            light,
            linear,
            background,
        }
    }

    /// Linear light, 0..=65535 per channel, of sample `(x, y)` that shows a node's voxel, given as in a frame.
    pub fn light(&self, x: u32, y: u32, node: u32, voxel: [i32; 4]) -> [u32; 3] {
        let color = self.graph.color.get(node as usize).copied();
        let share = self.light.on(self.surface(x, y, node, voxel).normal);
        let light = self.linear.decode(color.unwrap_or_default());
        light.map(|channel| (channel * share) >> 8)
    }

    pub fn background(&self) -> Option<[u32; 3]> {
        self.background
    }

    pub fn encode(&self, light: [u32; 3]) -> [u8; 3] {
        self.linear.encode(light)
    }

    pub(super) fn surface(&self, x: u32, y: u32, node: u32, voxel: [i32; 4]) -> Surface {
        let meeting = self.sight.meet(x, y, voxel);
        let packed = self.graph.normal.get(node as usize).copied();
        let normal = packed
            .and_then(PackedNormal::decode)
            .map_or(meeting.face, |normal| towards_eye(normal, meeting.ray));
        Surface { meeting, normal }
    }
}

/// Cosine above which a normal is taken to point away from the eye.
pub(super) const AWAY: f64 = 0.25;

/// A normal turned to the visible side. A thin wall has two sides and one normal. Normals that lean away only slightly, as
/// on rounded corners, are kept.
pub(super) fn towards_eye(normal: DVec3, ray: DVec3) -> DVec3 {
    if is_turned(normal, ray) {
        -normal
    } else {
        normal
    }
}

pub(super) fn is_turned(normal: DVec3, ray: DVec3) -> bool {
    normal.dot(ray) > AWAY
}
