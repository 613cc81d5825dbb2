//! The textures of one column of cells, slice by slice from the inside out.
//!
//! Along an axis, a column is projected twice: its positive half as seen from
//! the positive end, its negative half as seen from the negative end. A texel
//! of a triangle belongs to the slice in which it lies, so each triangle is
//! projected once along an axis, for both halves and for all slices. A texture
//! is then the one before with one more slice laid over it.

use glam::DVec3;

use crate::geometry::{barycentric, blend, plane_normal};
use crate::raster::Edges;
use crate::textured::CellGrid;
use crate::textured::cell_grid::{ACROSS, is_positive_half};
use crate::textured::record::Texel;
use crate::{Surface, Triangle, linear_to_srgb};
use shiftvox::graph::PackedNormal;

/// A column of cells along an axis.
#[derive(Debug)]
pub(super) struct Column {
    pub(super) axis: usize,
    /// Where it is along the other two axes.
    pub(super) at: [u32; 2],
    /// Primitives of its cells, rising, each once.
    pub(super) primitives: Vec<u32>,
    /// Slices whose outer face is a surfel at some level, and the voxel there.
    pub(super) wanted: Vec<(u32, u32)>,
}

/// The result of one column.
#[derive(Debug, Default)]
pub(super) struct Projected {
    /// Voxels and their sub-textures; `None` where nothing projects on any texel.
    pub(super) textures: Vec<(u32, Option<Vec<Texel>>)>,
    /// Texels that primitives were projected on.
    pub(super) texels: u64,
    /// The same, had each volume been projected afresh.
    pub(super) texels_afresh: u64,
}

/// The sample of a texel: distance along the axis, in lattice steps, and the primitive.
#[derive(Debug, Clone, Copy)]
struct Hit {
    along: i64,
    primitive: u32,
}

/// Projects a column.
pub(super) fn project<S: Surface + ?Sized>(
    column: &Column,
    surface: &S,
    corners: &[[[i64; 3]; 3]],
    lattice: &CellGrid,
) -> Projected {
    let texels = lattice.texels() as usize;
    let cells = lattice.cells();
    let mut projected = Projected::default();
    let mut slices: Vec<Vec<Option<Hit>>> = vec![Vec::new(); cells as usize];
    for &primitive in &column.primitives {
        let Some(shadow) = Shadow::of(&corners[primitive as usize], column.axis) else {
            continue;
        };
        shadow.each_texel(column, lattice, |texel, along| {
            // The last cell is closed on its outer side too.
            let slice = ((along / lattice.cell_steps()) as u32).min(cells - 1);
            let is_positive = is_positive_half(slice, cells);
            projected.texels += 1;
            let volumes = if is_positive {
                cells - slice
            } else {
                slice + 1
            };
            projected.texels_afresh += u64::from(volumes);
            let hits = &mut slices[slice as usize];
            hits.resize(texels * texels, None);
            // Primitives come in rising order: of those equally far out the first counts.
            let is_farther_out = hits[texel].is_none_or(|hit| {
                if is_positive {
                    along > hit.along
                } else {
                    along < hit.along
                }
            });
            if is_farther_out {
                hits[texel] = Some(Hit { along, primitive });
            }
        });
    }
    let mut painter = Painter {
        surface,
        lattice,
        column,
        last: None,
    };
    let middle = cells / 2;
    for is_positive in [false, true] {
        let mut texture = vec![Texel::default(); texels * texels];
        for step in 0..middle {
            let slice = if is_positive {
                middle + step
            } else {
                middle - 1 - step
            };
            for (texel, hit) in slices[slice as usize].iter().enumerate() {
                if let Some(hit) = hit {
                    texture[texel] = painter.texel(texel, *hit, is_positive);
                }
            }
            let wanted = column.wanted.iter().filter(|(at, _)| *at == slice);
            for &(_, voxel) in wanted {
                let is_clear = texture.iter().all(Texel::is_clear);
                let texture = (!is_clear).then(|| texture.clone());
                projected.textures.push((voxel, texture));
            }
        }
    }
    projected
}

/// A triangle as an axis sees it.
struct Shadow {
    edges: Edges,
    low: [i64; 2],
    high: [i64; 2],
    /// The plane's normal: across, down, along.
    normal: [i128; 3],
    /// The normal dotted with any corner.
    offset: i128,
}

impl Shadow {
    /// `None` where the triangle is seen edge on.
    fn of(corners: &[[i64; 3]; 3], axis: usize) -> Option<Self> {
        let [across, down] = ACROSS[axis];
        let points = corners.map(|p| [p[across], p[down]]);
        let edges = Edges::new(points)?;
        let fold = |pick: fn(i64, i64) -> i64| {
            [0, 1].map(|k| pick(pick(points[0][k], points[1][k]), points[2][k]))
        };
        let [a, b, c] = corners.map(|p| [p[across], p[down], p[axis]]);
        // Coordinates reach 2^29: components stay below 2^60, the offset below 2^91.
        let (e, f) = (
            [0, 1, 2].map(|k| b[k] - a[k]),
            [0, 1, 2].map(|k| c[k] - a[k]),
        );
        let normal = [[1, 2], [2, 0], [0, 1]].map(|[i, j]| i128::from(e[i] * f[j] - e[j] * f[i]));
        Some(Self {
            edges,
            low: fold(i64::min),
            high: fold(i64::max),
            normal,
            offset: (0..3).map(|k| normal[k] * i128::from(a[k])).sum(),
        })
    }

    /// Calls for each texel of the column whose middle the triangle covers:
    /// its number, and how far along the axis the triangle is there, rounded down.
    fn each_texel(&self, column: &Column, lattice: &CellGrid, mut call: impl FnMut(usize, i64)) {
        let step = lattice.texel_steps();
        let texels = i64::from(lattice.texels());
        let first = column.at.map(|c| i64::from(c) * texels);
        // Texels whose middles are not outside the triangle's box.
        let begin = [0, 1].map(|k| (self.low[k] + step / 2 - 1).div_euclid(step).max(first[k]));
        let end = [0, 1].map(|k| {
            let last = (self.high[k] - step / 2).div_euclid(step);
            last.min(first[k] + texels - 1)
        });
        for y in begin[1]..=end[1] {
            for x in begin[0]..=end[0] {
                let middle = [x, y].map(|c| c * step + step / 2);
                if !self.edges.covers(middle) {
                    continue;
                }
                let [across, down, along] = self.normal;
                let rest =
                    self.offset - across * i128::from(middle[0]) - down * i128::from(middle[1]);
                let texel = (y - first[1]) * texels + (x - first[0]);
                // The triangle is within the lattice.
                call(texel as usize, rest.div_euclid(along) as i64);
            }
        }
    }
}

/// Colours and normals of texels.
struct Painter<'p, S: ?Sized> {
    surface: &'p S,
    lattice: &'p CellGrid,
    column: &'p Column,
    /// Neighbouring texels mostly see the same triangle.
    last: Option<(u32, Triangle)>,
}

impl<S: Surface + ?Sized> Painter<'_, S> {
    fn texel(&mut self, texel: usize, hit: Hit, is_positive: bool) -> Texel {
        let triangle = match &self.last {
            Some((primitive, triangle)) if *primitive == hit.primitive => *triangle,
            _ => {
                let triangle = self.surface.triangle(hit.primitive as usize);
                self.last = Some((hit.primitive, triangle));
                triangle
            }
        };
        let share = barycentric(&triangle.corners, self.world(texel, hit.along));
        let sign = if is_positive { 1.0 } else { -1.0 };
        let outwards = DVec3::AXES[self.column.axis] * sign;
        let facing = |n: DVec3, side: DVec3| if n.dot(side) < 0.0 { -n } else { n };
        let plane = facing(plane_normal(triangle.corners), outwards);
        let normal = facing(blend(&triangle.normals, share).normalize_or(plane), plane);
        Texel {
            color: blend(&triangle.colors, share)
                .to_array()
                .map(linear_to_srgb),
            opacity: 255,
            normal: PackedNormal::encode(normal).0,
        }
    }

    /// Where the middle of a texel meets what it sees.
    fn world(&self, texel: usize, along: i64) -> DVec3 {
        let texels = self.lattice.texels() as usize;
        let step = self.lattice.texel_steps();
        let [across, down] = ACROSS[self.column.axis];
        let place = [texel % texels, texel / texels];
        let mut point = [0; 3];
        for (k, axis) in [across, down].into_iter().enumerate() {
            let number = u64::from(self.column.at[k]) * texels as u64 + place[k] as u64;
            point[axis] = number as i64 * step + step / 2;
        }
        point[self.column.axis] = along;
        self.lattice.world(point)
    }
}
