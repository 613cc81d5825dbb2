//! The colours of a frame, one row of pixels at a time. Consecutive samples of one node look it up once.

use glam::DVec3;

use super::ResolveError;
use super::resolve::Resolver;
use crate::frame::NO_NODE;

/// The last sample's node, since the next often shows the same.
struct Look {
    node: u32,
    light: [u32; 3],
    facing: Facing,
}

/// A node's lit share, of 256, or the data that decide it.
enum Facing {
    FullyLit,
    /// The side of its surface that is seen.
    Sides {
        normal: DVec3,
        front: u32,
        back: u32,
    },
    /// The face of its voxel, which is here if the frame has no voxels.
    Face(Option<[i32; 4]>),
}

/// Sums of a pixel's samples: shares of 256, and linear light times its share. 16 samples fit.
#[derive(Default)]
struct Sums {
    light: [u32; 3],
    covered: u32,
}

impl Resolver<'_> {
    pub(super) fn row<const N: usize>(
        &self,
        y: u32,
        to: &mut [[u8; N]],
    ) -> Result<(), ResolveError> {
        let width = self.frame.width as usize;
        let behind = match self.shader.background() {
            Some(light) => pixel(self.shader.encode(light), 255),
            None => [0; N],
        };
        let mut last = Look {
            node: NO_NODE,
            light: [0; 3],
            facing: Facing::FullyLit,
        };
        for (x, to) in (0..).zip(to) {
            let mut sums = Sums::default();
            for y in y << self.aa..(y + 1) << self.aa {
                for x in x << self.aa..(x + 1) << self.aa {
                    let at = y as usize * width + x as usize;
                    if let Some(blend) = &self.frame.blend {
                        sums.add(blend[at].light, 256 - u32::from(blend[at].left));
                        continue;
                    }
                    let node = self.frame.node[at];
                    if node != NO_NODE {
                        if node != last.node {
                            last = self.look_at(node);
                        }
                        let share = self.lit_share(&last, x, y, at)?;
                        // Times 256 of 256.
                        let lit = |channel| ((channel * share) >> 8) << 8;
                        sums.add(last.light.map(lit), 256);
                    }
                }
            }
            *to = match sums.covered {
                0 => behind,
                _ => self.mix(&sums),
            };
        }
        Ok(())
    }

    fn look_at(&self, node: u32) -> Look {
        let graph = self.shader.graph;
        let light = &self.shader.light;
        let facing = if !light.is_directed() {
            Facing::FullyLit
        } else if let Some(normal) = graph.normal_of(node).decode() {
            Facing::Sides {
                normal,
                front: light.on(normal),
                back: light.on(-normal),
            }
        } else if self.frame.voxel.is_empty() {
            Facing::Face(graph.place_of(node))
        } else {
            Facing::Face(None)
        };
        Look {
            node,
            light: self.shader.linear.decode(graph.color_of(node)),
            facing,
        }
    }

    fn lit_share(&self, look: &Look, x: u32, y: u32, at: usize) -> Result<u32, ResolveError> {
        let sight = &self.shader.sight;
        Ok(match look.facing {
            Facing::FullyLit => 256,
            Facing::Sides {
                normal,
                front,
                back,
            } => match sight.is_turned(normal, x, y) {
                true => back,
                false => front,
            },
            Facing::Face(place) => {
                let voxel = self.frame.voxel.get(at).copied().or(place);
                let voxel = voxel.ok_or(ResolveError::Voxel)?;
                self.shader.light.on(sight.meet(x, y, voxel).face)
            }
        })
    }

    fn mix<const N: usize>(&self, sums: &Sums) -> [u8; N] {
        let &Sums { light, covered } = sums;
        let places = 8 + 2 * self.aa;
        let half = 1 << (places - 1);
        if let Some(behind) = self.shader.background() {
            let left = (1 << places) - covered;
            let mean = |c: usize| (light[c] + left * behind[c] + half) >> places;
            return pixel(self.shader.encode([0, 1, 2].map(mean)), 255);
        }
        // PNG stores colours that are not premultiplied, so the host divides.
        let mean = light.map(|channel| (channel + covered / 2) / covered);
        let alpha = ((covered << 8) - covered + half) >> places;
        pixel(self.shader.encode(mean), alpha as u8)
    }
}

impl Sums {
    #[inline]
    fn add(&mut self, light: [u32; 3], share: u32) {
        self.covered += share;
        self.light = std::array::from_fn(|c| self.light[c] + light[c]);
    }
}

/// A pixel of `N` bytes, 3 or 4.
fn pixel<const N: usize>([r, g, b]: [u8; 3], alpha: u8) -> [u8; N] {
    let all = [r, g, b, alpha];
    std::array::from_fn(|i| all[i])
}
