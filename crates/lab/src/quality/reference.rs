//! References: pictures of many exact rays per pixel, or of many samples of a mesh's triangles.

use rayon::prelude::*;

use crate::bench::BenchError;
use shiftvox::graph::{Graph, Progress};
use shiftvox::picture::{Background, Shader, Shading};
use shiftvox::project::{Camera, FrameSetup};
use shiftvox::rays::{Caster, MAX_CASTER_LEVELS};
use shiftvox::split_mix::mix;
use shiftvox_mesh::Surface;
use shiftvox_mesh::drawing::mesh_view::{light_of, view_of};
use shiftvox_mesh::raster::{self, Pattern, RasterOptions, Samples};

#[derive(Debug, PartialEq)]
pub(super) struct Reference {
    pub(super) width: u32,
    pub(super) height: u32,
    /// sRGB, opaque, rounded once after the filter.
    pub(super) rgba: Vec<[u8; 4]>,
    pub(super) shares: Vec<f32>,
}

const MOST_JITTER_LEVELS: u32 = 4;

/// Casts a reference of a frame with one sample per pixel, whose image root has at most
/// `MAX_CASTER_LEVELS - 4` levels.
///
/// Samples are points of a grid up to 256 times as fine as the pixels, so that the exact rays start
/// from the same integers as the frame. A pixel has `2^strata_log2` strata along each axis, 16 at most. Of each one
/// random grid point is taken.
pub(super) fn cast(
    graph: &Graph,
    setup: &FrameSetup,
    shading: Shading,
    background: Background,
    (strata_log2, seed): (u32, u64),
    progress: &dyn Progress,
) -> Reference {
    let strata_log2 = strata_log2.min(4);
    let spare = MAX_CASTER_LEVELS.saturating_sub(setup.levels + strata_log2);
    let jitter_log2 = spare.min(MOST_JITTER_LEVELS);
    let mut grid = setup.without_detail();
    grid.levels += strata_log2 + jitter_log2;
    let view = graph.view();
    let pixels = Pixels {
        caster: Caster::new(&view, &grid),
        shader: Shader::new(graph, &grid, shading, background),
        strata_log2,
        jitter_log2,
        seed,
    };
    progress.begin("casting the reference", u64::from(setup.height));
    let row = |y: u32| {
        let row: Vec<([u8; 4], f32)> = (0..setup.width).map(|x| pixels.pixel(x, y)).collect();
        progress.advance(1);
        row
    };
    let rows: Vec<_> = (0..setup.height).into_par_iter().map(row).collect();
    progress.end();
    let all = rows.concat();
    Reference {
        width: setup.width,
        height: setup.height,
        rgba: all.iter().map(|pixel| pixel.0).collect(),
        shares: all.iter().map(|pixel| pixel.1).collect(),
    }
}

pub(super) const TRIANGLE_SAMPLES: u32 = 256;

/// A reference of a mesh: one random sample in each of 256 equal squares of a pixel.
pub(super) fn of_triangles(
    surface: &dyn Surface,
    camera: &Camera,
    seed: u64,
    progress: &dyn Progress,
) -> Result<Reference, BenchError> {
    let failed = |e: &dyn std::fmt::Display| BenchError::Picture(e.to_string());
    let view = view_of(camera, surface.bounds()).map_err(|e| failed(&e))?;
    let options = RasterOptions {
        samples: Samples::new(TRIANGLE_SAMPLES.ilog2() / 2, Pattern::Stratified { seed }),
        light: light_of(&view, Shading::default()),
        background: Background::default().color(),
    };
    let drawn = raster::draw(surface, &view, &options, progress).map_err(|e| failed(&e))?;
    Ok(Reference {
        width: drawn.width,
        height: drawn.height,
        rgba: drawn.rgba,
        shares: drawn.coverage,
    })
}

struct Pixels<'g> {
    caster: Caster<'g>,
    shader: Shader<'g>,
    strata_log2: u32,
    jitter_log2: u32,
    seed: u64,
}

impl Pixels<'_> {
    fn pixel(&self, x: u32, y: u32) -> ([u8; 4], f32) {
        let strata = 1u32 << self.strata_log2;
        let (mut light, mut seen) = ([0u32; 3], 0u32);
        for j in 0..strata {
            for i in 0..strata {
                let stratum = (x << self.strata_log2 | i, y << self.strata_log2 | j);
                let (u, v) = self.place_in(stratum);
                let of_sample = match self.caster.nearest(u, v) {
                    Some((node, voxel)) => {
                        seen += 1;
                        self.shader.light(u, v, node, voxel)
                    }
                    None => self.shader.background().unwrap_or_default(),
                };
                // At most 2^8 samples of 16 bits.
                for (sum, light) in light.iter_mut().zip(of_sample) {
                    *sum += light;
                }
            }
        }
        let samples_log2 = 2 * self.strata_log2;
        let half = (1u32 << samples_log2) >> 1;
        let [r, g, b] = self
            .shader
            .encode(light.map(|sum| (sum + half) >> samples_log2));
        let share = seen as f32 / (1u32 << samples_log2) as f32;
        ([r, g, b, 255], share)
    }

    fn place_in(&self, (x, y): (u32, u32)) -> (u32, u32) {
        let lot = mix(self.seed ^ mix(u64::from(x) << 32 | u64::from(y)));
        let mask = (1u32 << self.jitter_log2) - 1;
        let (dx, dy) = (lot as u32 & mask, (lot >> 32) as u32 & mask);
        (x << self.jitter_log2 | dx, y << self.jitter_log2 | dy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    use crate::model::frame::exact;
    use shiftvox::graph::{LinkedGraph, Silent};
    use shiftvox::picture::resolve;
    use shiftvox::project::SetupOptions;

    /// The cube `[0, 1]^3`, seen along y: its near face is `side` pixels a side and begins at pixel
    /// `(left, left)` of 8 x 8.
    fn facing(left: f64, side: f64) -> (Graph, FrameSetup) {
        let mut graph = LinkedGraph::new(0);
        graph.add_node([200, 40, 90], [None; 8]);
        let graph = graph.build().unwrap();
        let (x, z) = ((4.0 - left) / side, 1.0 - (4.0 - left) / side);
        let [eye, target] = [-8.0, 0.0].map(|y| DVec3::new(x, y, z));
        let fov_degrees = 2.0 * libm::atan(4.0 / (8.0 * side)).to_degrees();
        let camera = Camera::looking(eye, target, fov_degrees, (8, 8));
        let setup = FrameSetup::new(&camera, &graph.placement, 0, &SetupOptions::default());
        (graph, setup.unwrap())
    }

    #[test]
    fn shares_are_areas() {
        // From (2.25, 2.25) to (4.75, 4.75): a rim of 3/4 on both sides.
        let cast = |(graph, setup): (Graph, FrameSetup), seed| {
            let black = Background::Color([0; 3]);
            cast(&graph, &setup, Shading::Flat, black, (4, seed), &Silent)
        };
        let reference = cast(facing(2.25, 2.5), 1);
        for (at, &share) in reference.shares.iter().enumerate() {
            let along = |at: usize| [0.0, 0.0, 0.75, 1.0, 0.75, 0.0, 0.0, 0.0][at];
            let area = along(at % 8) * along(at / 8);
            assert!((share - area).abs() < 0.02, "{at}: {share}");
        }
        assert_eq!(reference.rgba[3 * 8 + 3], [200, 40, 90, 255]);
        assert_eq!(reference.rgba[0], [0, 0, 0, 255]);
        // Light is averaged, not bytes: half of black and white is 188.
        let half = reference.rgba[3 * 8 + 2][0];
        assert!((174..=179).contains(&half), "{half}");
        let [a, again, b] = [7, 7, 8].map(|seed| cast(facing(2.3, 3.1), seed));
        assert!(a == again && a != b);
    }

    #[test]
    fn one_stratum_without_jitter_is_the_oracles_picture() {
        let (graph, setup) = facing(2.3, 3.1);
        let frame = exact(&graph.view(), &setup).unwrap();
        let background = Background::default();
        let picture = resolve(&frame, &graph, &setup, Shading::Lambert, background).unwrap();
        let view = graph.view();
        let pixels = Pixels {
            caster: Caster::new(&view, &setup),
            shader: Shader::new(&graph, &setup, Shading::Lambert, background),
            strata_log2: 0,
            jitter_log2: 0,
            seed: 1,
        };
        let found: Vec<[u8; 4]> = (0..64).map(|i| pixels.pixel(i % 8, i / 8).0).collect();
        assert_eq!(found, picture.rgba);
    }
}
