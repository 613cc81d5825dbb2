//! The cells of a grid, and the lattice of integers on which they are distinguished.

use glam::DVec3;

pub const MOST_CELLS: u32 = 128;
pub const MOST_TEXELS: u32 = 64;
/// Most texels along the side of a whole texture.
pub const MOST_ACROSS: u32 = 4096;
/// Bits of a coordinate on the lattice: one fewer than edge functions and `voxelize::Prepared` have room for.
const BITS: u32 = 29;

/// Equal cells around a box, as many along each axis, as in the paper, so cells are cubes only on the lattice. On it lie
/// cells and the middles of texels exactly.
///
/// A mesh thinner than a cell's longest side along an axis gets that extent, with the mesh in its middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellGrid {
    pub cells: u32,
    pub texels: u32,
    origin: DVec3,
    span: DVec3,
    /// Lattice steps of a texel: even.
    pub texel_steps: i64,
}

impl CellGrid {
    /// A grid around a box, of numbers that [`CellGrid::is_possible`].
    pub fn around(low: DVec3, high: DVec3, cells: u32, texels: u32) -> Self {
        let extent = high - low;
        let least = extent.max_element() / f64::from(cells);
        let span = extent.max(DVec3::splat(least));
        let origin = (low + high) * 0.5 - span * 0.5;
        let across = 2 * i64::from(cells) * i64::from(texels);
        Self {
            cells,
            texels,
            origin,
            span,
            texel_steps: 2 * ((1 << BITS) / across),
        }
    }

    pub fn is_possible(cells: u32, texels: u32) -> bool {
        (2..=MOST_CELLS).contains(&cells)
            && cells.is_multiple_of(2)
            && (1..=MOST_TEXELS).contains(&texels)
            && cells * texels <= MOST_ACROSS
    }

    pub fn cell_size(&self) -> DVec3 {
        self.span / f64::from(self.cells)
    }

    /// The longest side of a texel, world units.
    pub fn texel_size(&self) -> f64 {
        self.cell_size().max_element() / f64::from(self.texels)
    }

    pub fn corner(&self, cell: [u32; 3]) -> DVec3 {
        self.world(cell.map(|c| i64::from(c) * self.cell_steps()))
    }

    pub fn cell_steps(&self) -> i64 {
        self.texel_steps * i64::from(self.texels)
    }

    /// Lattice steps along the side of the box, at most 2^29.
    pub fn steps(&self) -> i64 {
        self.cell_steps() * i64::from(self.cells)
    }

    pub fn point(&self, world: DVec3) -> [i64; 3] {
        let most = self.steps() as f64;
        let at = ((world - self.origin) / self.span * most).to_array();
        at.map(|c| libm::round(c.clamp(0.0, most)) as i64)
    }

    pub fn world(&self, point: [i64; 3]) -> DVec3 {
        let share = DVec3::from_array(point.map(|c| c as f64)) / self.steps() as f64;
        self.origin + self.span * share
    }
}
