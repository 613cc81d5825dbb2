//! The textures of one column of cells, slice by slice from the inside out.
//!
//! Each half of a column is seen from its own end. A texel of a triangle belongs to the slice in which it lies, so each
//! triangle is projected once along an axis. A texture is then the one before with one more slice laid over it.

use glam::DVec3;

use crate::geometry::barycentric;
use crate::material::to_srgb;
use crate::raster::Edges;
use crate::surface::stops;
use crate::textured::CellGrid;
use crate::textured::record::Texel;
use crate::voxelize::{OTHERS, Prepared};
use crate::{Surface, Triangle};
use shiftvox::graph::PackedNormal;

pub(super) struct Column {
    pub(super) axis: usize,
    /// Where it is along the other two axes.
    pub(super) at: [u32; 2],
    /// Rising, each once.
    pub(super) primitives: Vec<u32>,
    /// Slices whose outer face is a surfel at some level, and the voxel there.
    pub(super) wanted: Vec<(u32, u32)>,
}

#[derive(Default)]
pub(super) struct Projected {
    /// Voxels and their sub-textures; `None` where nothing projects on any texel.
    pub(super) textures: Vec<(u32, Option<Vec<Texel>>)>,
    pub(super) texels: u64,
    pub(super) texels_afresh: u64,
}

/// The nearest point behind a texel: how far along the axis, in lattice steps, and its primitive.
#[derive(Debug, Clone, Copy)]
struct Hit {
    along: i64,
    primitive: u32,
}

pub(super) fn project(
    column: &Column,
    surface: &dyn Surface,
    corners: &[[[i64; 3]; 3]],
    lattice: &CellGrid,
) -> Projected {
    let texels = lattice.texels as usize;
    let cells = lattice.cells;
    let middle = cells / 2;
    let mut projected = Projected::default();
    let mut slices: Vec<Vec<Option<Hit>>> = vec![Vec::new(); cells as usize];
    for &primitive in &column.primitives {
        let triangle = Prepared::new(corners[primitive as usize]);
        let is_opaque = surface.is_opaque(primitive as usize);
        let clear = (!is_opaque).then(|| surface.triangle(primitive as usize));
        each_texel(&triangle, column, lattice, |texel, along| {
            let is_hole = |clear: &Triangle<'_>| {
                let point = world(column, lattice, texel, along);
                let shares = barycentric(&clear.corners, point);
                // By lot, so that coarse texels keep small leaves.
                !stops(clear.at(shares, lattice.texel_size()).1, point)
            };
            if clear.as_ref().is_some_and(is_hole) {
                return;
            }
            // The last cell is closed on its outer side too.
            let slice = ((along / lattice.cell_steps()) as u32).min(cells - 1);
            let is_positive = slice >= middle;
            projected.texels += 1;
            let volumes = [slice + 1, cells - slice][usize::from(is_positive)];
            projected.texels_afresh += u64::from(volumes);
            let hits = &mut slices[slice as usize];
            hits.resize(texels * texels, None);
            // Primitives come in rising order: of those equally far out the first counts.
            let is_farther_out = hits[texel].is_none_or(|hit| match is_positive {
                true => along > hit.along,
                false => along < hit.along,
            });
            if is_farther_out {
                hits[texel] = Some(Hit { along, primitive });
            }
        });
    }
    // Neighbouring texels mostly see the same triangle.
    let mut last: Option<(u32, Triangle<'_>)> = None;
    for (half, outwards) in [(0..middle, -1.0), (middle..cells, 1.0)] {
        let mut texture = vec![Texel::default(); texels * texels];
        for step in 0..middle {
            let slice = match outwards < 0.0 {
                true => half.end - 1 - step,
                false => half.start + step,
            };
            for (texel, hit) in slices[slice as usize].iter().enumerate() {
                let Some(Hit { along, primitive }) = *hit else {
                    continue;
                };
                if last.as_ref().is_none_or(|(number, _)| *number != primitive) {
                    last = Some((primitive, surface.triangle(primitive as usize)));
                }
                if let Some((_, triangle)) = &last {
                    let point = world(column, lattice, texel, along);
                    let outwards = DVec3::AXES[column.axis] * outwards;
                    let (normal, (color, _)) =
                        triangle.seen_from(point, outwards, lattice.texel_size());
                    texture[texel] = Texel {
                        color: to_srgb(color),
                        opacity: 255,
                        normal: PackedNormal::encode(normal).0,
                    };
                }
            }
            for &(_, voxel) in column.wanted.iter().filter(|(at, _)| *at == slice) {
                let is_clear = texture.iter().all(Texel::is_clear);
                let texture = (!is_clear).then(|| texture.clone());
                projected.textures.push((voxel, texture));
            }
        }
    }
    projected
}

/// Calls for each texel whose middle the triangle covers: its number, and the place along the axis, rounded down.
fn each_texel(
    triangle: &Prepared,
    column: &Column,
    lattice: &CellGrid,
    mut call: impl FnMut(usize, i64),
) {
    let axes = OTHERS[column.axis];
    let Some(edges) = Edges::new(triangle.corners.map(|p| axes.map(|k| p[k]))) else {
        return;
    };
    let step = lattice.texel_steps;
    let texels = i64::from(lattice.texels);
    let first = column.at.map(|c| i64::from(c) * texels);
    let [columns, rows] = [0, 1].map(|k| {
        let begin = (triangle.low[axes[k]] + step / 2 - 1).div_euclid(step);
        let last = (triangle.high[axes[k]] - step / 2).div_euclid(step);
        begin.max(first[k])..=last.min(first[k] + texels - 1)
    });
    let [across, down] = axes.map(|k| i128::from(triangle.normal[k]));
    let along = i128::from(triangle.normal[column.axis]);
    for y in rows {
        for x in columns.clone() {
            let middle = [x, y].map(|c| c * step + step / 2);
            if edges.covers(middle) {
                let [right, below] = middle.map(i128::from);
                let rest = triangle.offset - across * right - down * below;
                let texel = (y - first[1]) * texels + (x - first[0]);
                // The triangle is within the lattice.
                call(texel as usize, rest.div_euclid(along) as i64);
            }
        }
    }
}

/// The point, `along` the axis, behind the middle of a texel.
fn world(column: &Column, lattice: &CellGrid, texel: usize, along: i64) -> DVec3 {
    let texels = lattice.texels as usize;
    let step = lattice.texel_steps;
    let place = [texel % texels, texel / texels];
    let mut point = [along; 3];
    for (k, axis) in OTHERS[column.axis].into_iter().enumerate() {
        let number = column.at[k] as usize * texels + place[k];
        point[axis] = number as i64 * step + step / 2;
    }
    lattice.world(point)
}
