//! Samples become pixels.

use crate::budget::Shortage;
use std::ops::Range;
use std::sync::OnceLock;

use rayon::prelude::*;

use super::npy::Values;
use super::paint::Painter;
use super::rows::{Buffer, Rows};
use super::shade::{Shader, Surface};
use super::shares::Shares;
use super::{Background, NO_DEPTH, Picture, Shading};
use crate::budget;
use crate::frame::{Frame, NO_NODE, NO_VOXEL};
use crate::graph::Graph;
use crate::project::FrameSetup;

/// Makes the picture of a drawn frame.
///
/// Colours are averaged over all samples of a pixel, in linear light. Other buffers show the sample right of and below
/// the pixel's middle (the pixel's only one without anti-aliasing), records all samples together. Fails when the frame
/// is not of the set-up's size, or does not determine the visible voxels, or indices leave `i32`.
pub fn resolve(
    frame: &Frame,
    graph: &Graph,
    setup: &FrameSetup,
    shading: Shading,
    background: Background,
) -> Result<Picture, ResolveError> {
    let resolver = Resolver::new(frame, graph, setup, shading, background)?;
    let (width, height) = resolver.size();
    let all = || 0..height;
    Ok(Picture {
        width,
        height,
        rgba: resolver.colors(all())?,
        depth: resolver.depth(all())?,
        normal: resolver.normal(all())?,
        voxel: resolver.voxel(all())?,
        node: resolver.node(all())?,
        records: match frame.records {
            Some(_) => Some(resolver.records(all())?),
            None => None,
        },
    })
}

pub struct Resolver<'f> {
    frame: &'f Frame,
    shader: Shader<'f>,
    origin_index: [i64; 3],
    aa: u32,
    shares: OnceLock<Shares>,
}

const PIXELS: &str = "the pixels of a picture";
/// Pixels that one thread makes faster than it can wake another.
const FEW_PIXELS: usize = 1 << 12;

#[derive(Clone, Copy)]
struct At {
    x: u32,
    y: u32,
}

impl<'f> Resolver<'f> {
    pub fn new(
        frame: &'f Frame,
        graph: &'f Graph,
        setup: &FrameSetup,
        shading: Shading,
        background: Background,
    ) -> Result<Self, ResolveError> {
        if (frame.width, frame.height) != (setup.width, setup.height) {
            return Err(ResolveError::Size(
                frame.width,
                frame.height,
                setup.width,
                setup.height,
            ));
        }
        Ok(Self {
            frame,
            shader: Shader::new(graph, setup, shading, background),
            origin_index: setup.placement.origin_index,
            aa: setup.options.aa_log2,
            shares: OnceLock::new(),
        })
    }

    /// The colours of some rows: `N` bytes per pixel, red, green, blue, and alpha if `N` is 4. Fails when a colour
    /// depends on a voxel that the frame does not determine.
    pub fn colors<const N: usize>(&self, rows: Range<u32>) -> Result<Vec<[u8; N]>, ResolveError> {
        let (width, _) = self.size();
        let mut pixels = budget::filled(PIXELS, [0; N], width as usize * rows.len())?;
        self.write_colors(rows, &mut pixels)?;
        Ok(pixels)
    }

    /// [`Resolver::colors`] into the caller's pixels, as many as the rows have. Errors: as [`Resolver::colors`].
    pub fn write_colors<const N: usize>(
        &self,
        rows: Range<u32>,
        pixels: &mut [[u8; N]],
    ) -> Result<(), ResolveError> {
        let Shader { sight, light, .. } = &self.shader;
        let is_lit = light.is_directed() && self.frame.blend.is_none();
        if is_lit && self.shares.get().is_none() {
            // Another thread's are as good.
            let _ = self.shares.set(Shares::new(sight, *light)?);
        }
        let shares = self.shares.get().filter(|_| is_lit);
        let painter = Painter::new(self.frame, &self.shader, shares, self.aa);
        self.each_row(rows, pixels, |y, to| painter.row(y, to))
    }

    pub fn frame(&self) -> &Frame {
        self.frame
    }

    pub fn is_opaque(&self) -> bool {
        self.shader.background().is_some()
    }

    pub fn drawn(&self) -> usize {
        if self.aa == 0 {
            return self.frame.drawn();
        }
        let (width, height) = self.size();
        let row = |y: u32| (0..width).filter(move |&x| self.middle(At { x, y }).is_some());
        (0..height).map(|y| row(y).count()).sum()
    }

    fn fill<T: Copy + Send + Sync>(
        &self,
        rows: Range<u32>,
        nothing: T,
        each: impl Fn(At) -> Result<Option<T>, ResolveError> + Sync,
    ) -> Result<Vec<T>, ResolveError> {
        let (width, _) = self.size();
        let mut pixels = budget::filled(PIXELS, nothing, width as usize * rows.len())?;
        self.each_row(rows, &mut pixels, |y, to| {
            for (x, to) in (0..width).zip(to) {
                if let Some(value) = each(At { x, y })? {
                    *to = value;
                }
            }
            Ok(())
        })?;
        Ok(pixels)
    }

    fn each_row<T: Send>(
        &self,
        rows: Range<u32>,
        pixels: &mut [T],
        each: impl Fn(u32, &mut [T]) -> Result<(), ResolveError> + Sync,
    ) -> Result<(), ResolveError> {
        let width = (self.size().0 as usize).max(1);
        if pixels.len() <= FEW_PIXELS {
            let mut rows = pixels.chunks_mut(width).zip(rows);
            return rows.try_for_each(|(to, y)| each(y, to));
        }
        let rows = pixels.par_chunks_mut(width).zip(rows);
        rows.try_for_each(|(to, y)| each(y, to))
    }

    /// The sample right of and below a pixel's middle, and its place in the frame; none if it shows nothing.
    fn middle(&self, At { x, y }: At) -> Option<(u32, u32, usize)> {
        let half = (1 << self.aa) >> 1;
        let (x, y) = ((x << self.aa) + half, (y << self.aa) + half);
        let at = y as usize * self.frame.width as usize + x as usize;
        (self.frame.node[at] != NO_NODE).then_some((x, y, at))
    }

    fn voxel_at(&self, at: usize) -> Result<[i32; 4], ResolveError> {
        let voxel = match self.frame.voxel.get(at) {
            Some(&voxel) => Some(voxel),
            None => self.shader.graph.place_of(self.frame.node[at]),
        };
        voxel.ok_or(ResolveError::Voxel)
    }

    fn surface(&self, at: At) -> Result<Option<Surface>, ResolveError> {
        let Some((x, y, sample)) = self.middle(at) else {
            return Ok(None);
        };
        let voxel = self.voxel_at(sample)?;
        Ok(Some(self.shader.surface(
            x,
            y,
            self.frame.node[sample],
            voxel,
        )))
    }

    fn depth(&self, rows: Range<u32>) -> Result<Vec<f32>, ResolveError> {
        let depth = |surface: Surface| surface.meeting.depth as f32;
        self.fill(rows, NO_DEPTH, |at| Ok(self.surface(at)?.map(depth)))
    }

    fn normal(&self, rows: Range<u32>) -> Result<Vec<[f32; 3]>, ResolveError> {
        let normal = |surface: Surface| surface.normal.as_vec3().to_array();
        self.fill(rows, [0.0; 3], |at| Ok(self.surface(at)?.map(normal)))
    }

    fn voxel(&self, rows: Range<u32>) -> Result<Vec<[i32; 4]>, ResolveError> {
        self.fill(rows, NO_VOXEL, |at| {
            let Some((_, _, sample)) = self.middle(at) else {
                return Ok(None);
            };
            let mut voxel = self.voxel_at(sample)?;
            for (index, origin) in voxel.iter_mut().zip(self.origin_index) {
                let of_file = i32::try_from(i64::from(*index) + origin);
                *index = of_file.map_err(|_| ResolveError::Index)?;
            }
            Ok(Some(voxel))
        })
    }

    fn node(&self, rows: Range<u32>) -> Result<Vec<i32>, ResolveError> {
        self.fill(rows, -1, |at| {
            let middle = self.middle(at);
            Ok(middle.map(|(_, _, sample)| self.frame.node[sample] as i32))
        })
    }

    fn records(&self, rows: Range<u32>) -> Result<Vec<f32>, ResolveError> {
        let side = 1usize << self.aa;
        let width = self.frame.width as usize;
        self.fill(rows, 0.0, |at| {
            let Some(records) = &self.frame.records else {
                return Ok(None);
            };
            let row = |j| &records[(at.y as usize * side + j) * width + at.x as usize * side..];
            Ok(Some((0..side).flat_map(|j| &row(j)[..side]).sum()))
        })
    }
}

impl Rows for Resolver<'_> {
    type Error = ResolveError;

    fn size(&self) -> (u32, u32) {
        (self.frame.width >> self.aa, self.frame.height >> self.aa)
    }

    fn rows(&self, buffer: Buffer, rows: Range<u32>) -> Result<Values, ResolveError> {
        Ok(match buffer {
            Buffer::Color => Values::U8(self.colors::<4>(rows)?.into_flattened()),
            Buffer::Depth => Values::F32(self.depth(rows)?),
            Buffer::Normal => Values::F32(self.normal(rows)?.into_flattened()),
            Buffer::Voxel => Values::I32(self.voxel(rows)?.into_flattened()),
            Buffer::Node => Values::I32(self.node(rows)?),
            Buffer::Records => Values::F32(self.records(rows)?),
        })
    }
}

/// Why a frame and its set-up make no picture.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ResolveError {
    #[error("the frame has {0} x {1} samples, its set-up {2} x {3}")]
    Size(u32, u32, u32, u32),
    /// A voxel's index, counted from the file's origin, leaves the range of `i32`.
    #[error("the file index of a voxel is beyond 32 bits")]
    Index,
    /// Neither a frame of nodes nor the graph determines the visible voxel of a node.
    #[error("the frame does not tell which voxels are seen")]
    Voxel,
    #[error(transparent)]
    Memory(#[from] Shortage),
}
