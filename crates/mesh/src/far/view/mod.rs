//! Far voxels to a picture: `cut` chooses nodes, `opaque` draws into a depth buffer, `transparent` over it. `samples`
//! averages several samples per pixel.

mod cut;
mod opaque;
mod samples;
mod splat;
mod transparent;

pub use super::record::Opacity;
use super::store::{FarError, FarFile};
use crate::raster::{Light, RasterCamera, RasterError};
use crate::{linear_to_srgb, srgb_to_linear};
use cut::Cut;
use opaque::Opaque;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewOptions {
    /// Largest projected side of a voxel, pixels, above 0.
    pub voxel_px: f64,
    /// Samples of a pixel along each axis, 1 to 16.
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

#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    #[error(transparent)]
    File(#[from] FarError),
    #[error(transparent)]
    Raster(#[from] RasterError),
    #[error("voxels are drawn at a size above 0 pixels, not {0}")]
    VoxelSize(f64),
    #[error("a pixel has 1 to {MOST_SAMPLES_ACROSS} samples along each axis, not {0}")]
    Samples(u32),
}

/// A finished picture, row by row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct FarPicture {
    pub width: u32,
    pub height: u32,
    /// Colour, sRGB, and coverage, not premultiplied.
    pub rgba: Vec<[u8; 4]>,
    pub coverage: Vec<f32>,
    /// View-axis depth, world units, of the opaque surface at the sample right of and below the pixel's middle, or infinite.
    pub depth: Vec<f32>,
    /// The node that is opaque at that sample, or -1.
    pub node: Vec<i32>,
}

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
) -> Result<(FarPicture, FarCounts), ViewError> {
    if !(options.voxel_px > 0.0 && options.voxel_px.is_finite()) {
        return Err(ViewError::VoxelSize(options.voxel_px));
    }
    let across = options.samples_across;
    if !(1..=MOST_SAMPLES_ACROSS).contains(&across) {
        return Err(ViewError::Samples(across));
    }
    let (pixels, view) = (view, &samples::finer(view, across));
    let mut counts = FarCounts::default();
    let cut = Cut {
        file,
        view: *view,
        // From here on a pixel is a sample.
        voxel_px: options.voxel_px * f64::from(across),
        is_fine: across >= FINE,
    };
    let nodes = cut.nodes(&mut counts);
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
    let picture = FarPicture {
        width: pixels.width,
        height: pixels.height,
        rgba: drawn.iter().map(|p| p.encode(options.background)).collect(),
        coverage: drawn.iter().map(|p| p.coverage).collect(),
        node: samples::middles(&opaque.nodes(), size, across as usize),
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
    fn encode(&self, background: Option<[u8; 3]>) -> [u8; 4] {
        if self.coverage <= 0.0 {
            return background.map_or([0; 4], |[r, g, b]| [r, g, b, 255]);
        }
        let light = self.light.map(f64::from);
        let coverage = f64::from(self.coverage);
        let (light, alpha) = match background {
            Some(color) => {
                let mixed =
                    |k: usize| light[k] + (1.0 - coverage) * f64::from(srgb_to_linear(color[k]));
                ([0, 1, 2].map(mixed), 255)
            }
            None => (light.map(|l| l / coverage), (coverage * 255.0 + 0.5) as u8),
        };
        let [r, g, b] = light.map(linear_to_srgb);
        [r, g, b, alpha]
    }
}
