//! Transparent voxels over what is opaque: nodes back to front, within a node
//! in the file's order, tested against depth and not written to it.
//!
//! A voxel whose square covers a share `s` of a pixel with opacity `a` lets
//! `(1 - a)^s` of what is behind through: squares side by side that together
//! cover the pixel once then let `1 - a` through, as the surface does that
//! they are parts of.

use rayon::prelude::*;

use super::cut::Chosen;
use super::opaque::light_of;
use super::splat::{Places, Square};
use super::{Opacity, Pixel, ViewError, ViewOptions};
use crate::far::blend::Blend;
use crate::far::record::{LISTS, OpacityKind, RECORD_BYTES, Voxel};
use crate::far::store::FarFile;
use crate::mesh::raster::RasterCamera;

/// Rows that a thread draws at a time.
const BAND: usize = 16;

/// A transparent voxel in the picture.
struct Splat {
    square: Square,
    color: [f32; 3],
    opacity: f64,
    rows: [usize; 2],
}

/// Draws; returns how many voxels. `nodes` in any order.
pub(super) fn draw(
    file: &FarFile,
    view: &RasterCamera,
    options: &ViewOptions,
    nodes: &[&Chosen],
    pixels: &mut [Pixel],
) -> Result<u64, ViewError> {
    let mut nodes: Vec<&Chosen> = nodes.to_vec();
    nodes.sort_by(|a, b| b.middle.total_cmp(&a.middle).then(a.number.cmp(&b.number)));
    let splats = nodes
        .par_iter()
        .map(|node| splats(file, view, options, node.number))
        .collect::<Result<Vec<Vec<Splat>>, ViewError>>()?;
    let width = view.width as usize;
    pixels
        .par_chunks_mut(width * BAND)
        .enumerate()
        .for_each(|(band, pixels)| {
            let rows = [band * BAND, band * BAND + pixels.len() / width];
            for splat in splats.iter().flatten() {
                if splat.rows[0] < rows[1] && splat.rows[1] > rows[0] {
                    blend(splat, view, rows, pixels);
                }
            }
        });
    Ok(splats.iter().map(|node| node.len() as u64).sum())
}

fn splats(
    file: &FarFile,
    view: &RasterCamera,
    options: &ViewOptions,
    number: usize,
) -> Result<Vec<Splat>, ViewError> {
    let node = &file.nodes()[number];
    let places = Places::of(node, file.centre());
    let mut splats = Vec::new();
    for (list, records) in file.lists(number)?.into_iter().enumerate() {
        if LISTS[list].1 == OpacityKind::Opaque {
            continue;
        }
        for record in records.chunks_exact(RECORD_BYTES[list]) {
            let Some(square) = places.square(view, record) else {
                continue;
            };
            let [[x0, y0], [x1, y1]] = square.touched(view);
            if x0 >= x1 || y0 >= y1 {
                continue;
            }
            let voxel = Voxel::read(list, record);
            splats.push(Splat {
                opacity: opacity(&voxel, &square, file.opacity_blend(), options.opacity),
                color: light_of(&voxel, square.towards_eye, file, options),
                rows: [y0, y1],
                square,
            });
        }
    }
    Ok(splats)
}

fn opacity(voxel: &Voxel, square: &Square, blend: Blend, mode: Opacity) -> f64 {
    match mode {
        Opacity::None => 1.0,
        Opacity::Scalar => voxel.scalar,
        Opacity::Six => {
            let shares = blend.shares(square.towards_eye).into_iter();
            shares.map(|(k, share)| voxel.opacity[k] * share).sum()
        }
    }
}

fn blend(splat: &Splat, view: &RasterCamera, [top, bottom]: [usize; 2], pixels: &mut [Pixel]) {
    let width = view.width as usize;
    let [[x0, y0], [x1, y1]] = splat.square.touched(view);
    let depth = splat.square.depth as f32;
    for y in y0.max(top)..y1.min(bottom) {
        for x in x0..x1 {
            let pixel = &mut pixels[(y - top) * width + x];
            if depth > pixel.depth {
                continue;
            }
            let share = splat.square.share(x, y);
            let through = libm::pow((1.0 - splat.opacity).max(0.0), share);
            pixel.cover(splat.color, (1.0 - through) as f32);
        }
    }
}
