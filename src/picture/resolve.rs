//! Samples become pixels.

use rayon::prelude::*;

use super::shade::Shader;
use super::{Background, NO_DEPTH, Picture, Shading};
use crate::frame::{Blend, Frame, NO_NODE, NO_VOXEL};
use crate::graph::Graph;
use crate::project::FrameSetup;

/// Why a frame and its set-up make no picture.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ResolveError {
    /// Frame and set-up differ in size.
    #[error("the frame has {0} x {1} samples, its set-up {2} x {3}")]
    Size(u32, u32, u32, u32),
    /// A voxel's index, counted from the file's origin, leaves the range of `i32`.
    #[error("the file index of a voxel is beyond 32 bits")]
    Index,
}

/// One pixel of a [`Picture`].
struct Pixel {
    rgba: [u8; 4],
    depth: f32,
    normal: [f32; 3],
    voxel: [i32; 4],
    node: i32,
    records: f32,
}

/// Makes the picture of a drawn frame.
///
/// Colours are averaged over all samples of a pixel, in linear light; the other
/// buffers come from the sample right of and below the pixel's middle (the
/// pixel's only one without anti-aliasing), records from all samples together.
///
/// # Errors
/// When the frame is not of the set-up's size, or indices leave `i32`.
pub fn resolve(
    frame: &Frame,
    graph: &Graph,
    setup: &FrameSetup,
    shading: Shading,
    background: Background,
) -> Result<Picture, ResolveError> {
    if (frame.width, frame.height) != (setup.width, setup.height) {
        return Err(ResolveError::Size(
            frame.width,
            frame.height,
            setup.width,
            setup.height,
        ));
    }
    let aa = setup.options.aa_log2;
    let (width, height) = (frame.width >> aa, frame.height >> aa);
    let resolver = Resolver::new(frame, graph, setup, shading, background);
    let pixels: Vec<Pixel> = (0..height)
        .into_par_iter()
        .flat_map_iter(|y| {
            let resolver = &resolver;
            (0..width).map(move |x| resolver.pixel(x, y))
        })
        .collect::<Result<_, _>>()?;
    Ok(Picture {
        width,
        height,
        rgba: pixels.iter().map(|p| p.rgba).collect(),
        depth: pixels.iter().map(|p| p.depth).collect(),
        normal: pixels.iter().map(|p| p.normal).collect(),
        voxel: pixels.iter().map(|p| p.voxel).collect(),
        node: pixels.iter().map(|p| p.node).collect(),
        records: frame
            .records
            .is_some()
            .then(|| pixels.iter().map(|p| p.records).collect()),
    })
}

/// What all pixels of a picture share.
struct Resolver<'f> {
    frame: &'f Frame,
    shader: Shader<'f>,
    origin_index: [i64; 3],
    aa: u32,
}

impl<'f> Resolver<'f> {
    fn new(
        frame: &'f Frame,
        graph: &'f Graph,
        setup: &FrameSetup,
        shading: Shading,
        background: Background,
    ) -> Self {
        Self {
            frame,
            shader: Shader::new(graph, setup, shading, background),
            origin_index: setup.placement.origin_index,
            aa: setup.options.aa_log2,
        }
    }

    fn pixel(&self, x: u32, y: u32) -> Result<Pixel, ResolveError> {
        let side = 1u32 << self.aa;
        let mut sum = [0u32; 3];
        let mut seen = 0u32;
        let mut blended = Blended::default();
        let mut records = 0.0;
        let mut pixel = Pixel {
            rgba: [0; 4],
            depth: NO_DEPTH,
            normal: [0.0; 3],
            voxel: NO_VOXEL,
            node: -1,
            records: 0.0,
        };
        for j in 0..side {
            for i in 0..side {
                let (sx, sy) = (x * side + i, y * side + j);
                let at = sy as usize * self.frame.width as usize + sx as usize;
                if let Some(all) = &self.frame.records {
                    records += all[at];
                }
                if let Some(blend) = &self.frame.blend {
                    blended.add(&blend[at], self.shader.background());
                }
                let light = if self.frame.node[at] == NO_NODE {
                    self.shader.background().unwrap_or([0; 3])
                } else {
                    seen += 1;
                    let middle = (i, j) == (side >> 1, side >> 1);
                    self.sample(sx, sy, at, middle.then_some(&mut pixel))?
                };
                for (sum, light) in sum.iter_mut().zip(light) {
                    *sum += light;
                }
            }
        }
        pixel.rgba = match self.frame.blend {
            Some(_) => blended.mix(&self.shader, 2 * self.aa),
            None => self.mix(sum, seen),
        };
        pixel.records = records;
        Ok(pixel)
    }

    /// Linear light of a drawn sample; fills in the pixel that it stands for.
    fn sample(
        &self,
        x: u32,
        y: u32,
        at: usize,
        pixel: Option<&mut Pixel>,
    ) -> Result<[u32; 3], ResolveError> {
        let (node, voxel) = (self.frame.node[at], self.frame.voxel[at]);
        let surface = self.shader.surface(x, y, node, voxel);
        if let Some(pixel) = pixel {
            pixel.depth = surface.meeting.depth as f32;
            pixel.normal = surface.normal.as_vec3().to_array();
            for k in 0..3 {
                let index = i64::from(voxel[k]) + self.origin_index[k];
                pixel.voxel[k] = i32::try_from(index).map_err(|_| ResolveError::Index)?;
            }
            pixel.voxel[3] = voxel[3];
            pixel.node = node as i32;
        }
        Ok(self.shader.light_of(node, &surface))
    }

    /// The mean of a pixel's samples, of which `seen` show a voxel.
    fn mix(&self, sum: [u32; 3], seen: u32) -> [u8; 4] {
        let samples_log2 = 2 * self.aa;
        let half = (1u32 << samples_log2) >> 1;
        if self.shader.background().is_some() {
            // All samples count, so their number is a power of two.
            let mean = sum.map(|channel| (channel + half) >> samples_log2);
            let [r, g, b] = self.shader.encode(mean);
            return [r, g, b, 255];
        }
        if seen == 0 {
            return [0; 4];
        }
        let alpha = ((seen << 8) - seen + half) >> samples_log2;
        // PNG stores colours that are not premultiplied: the host divides.
        let mean = sum.map(|channel| (channel + seen / 2) / seen);
        let [r, g, b] = self.shader.encode(mean);
        [r, g, b, alpha as u8]
    }
}

/// What the samples of a pixel took, of 256 each.
#[derive(Default)]
struct Blended {
    light: [u64; 3],
    covered: u32,
}

impl Blended {
    fn add(&mut self, sample: &Blend, background: Option<[u32; 3]>) {
        self.covered += 256 - u32::from(sample.left);
        let behind = background.unwrap_or([0; 3]);
        for c in 0..3 {
            let through = u32::from(sample.left) * behind[c];
            self.light[c] += u64::from(sample.light[c] + through);
        }
    }

    /// The mean of `2^samples_log2` samples.
    fn mix(&self, shader: &Shader<'_>, samples_log2: u32) -> [u8; 4] {
        let places = 8 + samples_log2;
        let half = 1u32 << (places - 1);
        if shader.background().is_some() {
            let mean = self.light.map(|c| ((c + u64::from(half)) >> places) as u32);
            let [r, g, b] = shader.encode(mean);
            return [r, g, b, 255];
        }
        if self.covered == 0 {
            return [0; 4];
        }
        let covered = u64::from(self.covered);
        let mean = self.light.map(|c| ((c + covered / 2) / covered) as u32);
        let [r, g, b] = shader.encode(mean);
        let alpha = ((self.covered << 8) - self.covered + half) >> places;
        [r, g, b, alpha as u8]
    }
}
