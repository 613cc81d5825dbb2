//! Transparent voxels over opaque ones, front to back, by the 4 x 4 parts of a pixel (`spec/far.md`).

use std::ops::Range;

use rayon::prelude::*;

use super::cut::Chosen;
use super::opaque::light_of;
use super::splat::{PARTS, Places, Square};
use super::{Pixel, ViewOptions};
use crate::far::record::{OPACITY_BYTES, RECORD_BYTES, Voxel};
use crate::far::store::FarFile;
use crate::raster::RasterCamera;
use crate::view_error::ViewError;

const BAND: usize = 16;

struct Splat {
    square: Square,
    color: [f32; 3],
    through: f32,
    columns: Range<usize>,
    rows: Range<usize>,
}

#[derive(Clone, Copy)]
struct Veil {
    through: [[f32; PARTS]; PARTS],
    light: [f32; 3],
}

/// Draws; returns how many voxels. `nodes` in any order.
pub(super) fn draw(
    file: &FarFile,
    view: &RasterCamera,
    options: &ViewOptions,
    mut nodes: Vec<Chosen>,
    pixels: &mut [Pixel],
) -> Result<u64, ViewError> {
    nodes.sort_by(|a, b| a.middle.total_cmp(&b.middle).then(b.number.cmp(&a.number)));
    let splats = nodes
        .par_iter()
        .map(|node| splats(file, view, options, node.number))
        .collect::<Result<Vec<Vec<Splat>>, ViewError>>()?;
    let width = view.width as usize;
    pixels
        .par_chunks_mut(width * BAND)
        .enumerate()
        .for_each(|(band, pixels)| {
            let rows = band * BAND..band * BAND + pixels.len() / width;
            let mut veils: Vec<Option<Box<Veil>>> = vec![None; pixels.len()];
            for splat in splats.iter().flat_map(|node| node.iter().rev()) {
                blend(splat, width, &rows, pixels, &mut veils);
            }
            for (pixel, veil) in pixels.iter_mut().zip(&veils) {
                if let Some(veil) = veil {
                    pixel.lay(veil);
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
    let places = Places::of(node, file.settings.centre);
    let mut splats = Vec::new();
    let data = file.data(number)?;
    for (list, records) in data.lists().into_iter().enumerate() {
        if OPACITY_BYTES[list] == 0 {
            continue;
        }
        for record in records.chunks_exact(RECORD_BYTES[list]) {
            let Some(square) = places.square(view, record) else {
                continue;
            };
            let [columns, rows] = square.touched(view);
            if columns.is_empty() || rows.is_empty() {
                continue;
            }
            let voxel = Voxel::read(list, record);
            let opacity = voxel.opacity_from(square.towards_eye, options.opacity);
            if opacity < 1.0 {
                splats.push(Splat {
                    through: (1.0 - opacity) as f32,
                    color: light_of(&voxel, square.towards_eye, options),
                    columns,
                    rows,
                    square,
                });
            }
        }
    }
    Ok(splats)
}

fn blend(
    splat: &Splat,
    width: usize,
    rows: &Range<usize>,
    pixels: &[Pixel],
    veils: &mut [Option<Box<Veil>>],
) {
    let depth = splat.square.nearest as f32;
    for y in splat.rows.start.max(rows.start)..splat.rows.end.min(rows.end) {
        let down = splat.square.parts(1, y);
        for x in splat.columns.clone() {
            let across = splat.square.parts(0, x);
            let at = (y - rows.start) * width + x;
            if down == 0 || across == 0 || depth > pixels[at].depth {
                continue;
            }
            let clear = || {
                Box::new(Veil {
                    through: [[1.0; PARTS]; PARTS],
                    light: [0.0; 3],
                })
            };
            let veil = veils[at].get_or_insert_with(clear);
            let factors: [f32; PARTS] =
                std::array::from_fn(|part| [1.0, splat.through][(across >> part & 1) as usize]);
            let mut taken = 0.0;
            for (part, row) in veil.through.iter_mut().enumerate() {
                if down >> part & 1 == 0 {
                    continue;
                }
                for (through, factor) in row.iter_mut().zip(factors) {
                    let less = *through * factor;
                    taken += *through - less;
                    *through = less;
                }
            }
            taken /= (PARTS * PARTS) as f32;
            for (light, color) in veil.light.iter_mut().zip(splat.color) {
                *light += color * taken;
            }
        }
    }
}

impl Pixel {
    fn lay(&mut self, veil: &Veil) {
        let sum: f32 = veil.through.iter().flatten().sum();
        let through = sum / (PARTS * PARTS) as f32;
        for (light, before) in self.light.iter_mut().zip(veil.light) {
            *light = before + *light * through;
        }
        self.coverage = 1.0 - (1.0 - self.coverage) * through;
    }
}
