//! Far voxels to a picture: `cut` chooses nodes, `opaque` draws into a depth buffer, `transparent` over it. `samples`
//! averages several samples per pixel.

mod cut;
mod opaque;
mod samples;
mod splat;
mod transparent;

use glam::DVec3;

pub use super::record::Opacity;
use super::store::FarFile;
use crate::material::to_light;
use crate::raster::{Light, RasterCamera, RasterPicture, mixed};
use crate::view_error::ViewError;
use opaque::Opaque;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewOptions {
    /// Largest projected side of a voxel, pixels, above 0.
    pub voxel_px: f64,
    /// Samples of a pixel along each axis, 1 to 16: fewer or more count as these.
    pub samples_across: u32,
    pub opacity: Opacity,
    /// `None` for unlit colours.
    pub light: Option<Light>,
    /// sRGB, or `None` for transparent.
    pub background: Option<[u8; 3]>,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self {
            voxel_px: 1.0,
            samples_across: 1,
            opacity: Opacity::Six,
            light: None,
            background: None,
        }
    }
}

const MOST_SAMPLES_ACROSS: u32 = 16;
/// From so many on a hybrid's nodes are drawn as their `across` says. With fewer, triangles flicker and voxels look better.
const FINE: u32 = 4;

/// Work of one frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FarCounts {
    /// Nodes.
    pub visited: u64,
    /// Visited nodes beside or behind the picture.
    pub outside: u64,
    /// Inner nodes drawn.
    pub voxel_nodes: u64,
    /// Leaves drawn.
    pub leaves: u64,
    pub opaque_voxels: u64,
    pub transparent_voxels: u64,
    /// Given to the rasteriser.
    pub triangles: u64,
    /// Bytes of the drawn nodes' data, unpacked.
    pub bytes: u64,
}

/// Draws a file. Errors: options or a view out of range, or data that cannot be read or is damaged.
pub fn draw(
    file: &FarFile,
    view: &RasterCamera,
    options: &ViewOptions,
) -> Result<(RasterPicture, FarCounts), ViewError> {
    if !(options.voxel_px > 0.0 && options.voxel_px.is_finite()) {
        return Err(ViewError::VoxelSize(options.voxel_px));
    }
    let across = options.samples_across.clamp(1, MOST_SAMPLES_ACROSS);
    let (pixels, view) = (view, &samples::finer(view, across));
    let mut counts = FarCounts::default();
    // From here on a pixel is a sample.
    let voxel_px = options.voxel_px * f64::from(across);
    let nodes = cut::nodes(file, view, voxel_px, across >= FINE, &mut counts);
    let opaque = Opaque::draw(file, view, options, &nodes, &mut counts)?;
    for node in &nodes {
        let node = &file.nodes()[node.number];
        counts.leaves += u64::from(node.is_leaf());
        counts.bytes += node.drawn_bytes();
    }
    counts.voxel_nodes = nodes.len() as u64 - counts.leaves;
    let mut drawn = opaque.resolve();
    if options.opacity != Opacity::None {
        counts.transparent_voxels = transparent::draw(file, view, options, nodes, &mut drawn)?;
    }
    opaque.lay_glass(&mut drawn);
    let size = [pixels.width, pixels.height].map(|side| side as usize);
    let drawn = samples::averaged(drawn, size, across as usize);
    let background = options.background.map(to_light);
    let picture = RasterPicture {
        width: pixels.width,
        height: pixels.height,
        rgba: drawn.iter().map(|p| p.encode(background)).collect(),
        coverage: drawn.iter().map(|p| p.coverage).collect(),
        seen: samples::middles(&opaque.nodes(), size, across as usize),
        depth: samples::middles(&opaque.depths(), size, across as usize),
    };
    Ok((picture, counts))
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Pixel {
    light: [f32; 3],
    coverage: f32,
    depth: f32,
}

impl Pixel {
    fn encode(&self, background: Option<DVec3>) -> [u8; 4] {
        let light = DVec3::from(self.light.map(f64::from));
        mixed(light, f64::from(self.coverage), 1.0, background)
    }
}
