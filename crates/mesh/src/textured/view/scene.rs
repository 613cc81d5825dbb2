//! A level as a surface: primitives as they are, surfels as two textured triangles each.

use glam::DVec3;

use crate::material::to_light;
use crate::texture::paint::Paint;
use crate::textured::levels::Surfel;
use crate::textured::record::{Primitive, Texel};
use crate::textured::store::{Grid, Painted, TexturedError, TexturedFile};
use crate::voxelize::OTHERS;
use crate::{Surface, Triangle};
use shiftvox::graph::PackedNormal;

/// A surfel and its geometry.
struct Face<'f> {
    axis: usize,
    outwards: DVec3,
    /// The corner from which texels are counted.
    corner: DVec3,
    size: DVec3,
    texels: &'f [Texel],
}

pub(super) struct Shown<'f> {
    file: &'f TexturedFile,
    stored: &'f [Primitive],
    painted: &'f Painted,
    primitives: &'f [u32],
    faces: Vec<Face<'f>>,
    /// Texels along the side of a face.
    side: usize,
}

impl<'f> Shown<'f> {
    pub(super) fn new(
        file: &'f TexturedFile,
        grid: Grid<'f>,
        level: u32,
    ) -> Result<Self, TexturedError> {
        let lattice = grid.cell_grid();
        let size = lattice.cell_size();
        let voxels = grid.voxels();
        let face = |surfel: &Surfel| {
            let axis = usize::from(surfel.axis);
            let voxel = &voxels[surfel.voxel as usize];
            let cell = voxel.cell.map(u32::from);
            let mut corner = cell;
            corner[axis] += u32::from(surfel.is_positive);
            Face {
                axis,
                outwards: DVec3::AXES[axis] * if surfel.is_positive { 1.0 } else { -1.0 },
                corner: lattice.corner(corner),
                size,
                texels: grid.texture(voxel.textures[axis]),
            }
        };
        let levels = grid.levels();
        Ok(Self {
            file,
            stored: file.primitives(),
            painted: file.painted()?,
            primitives: levels.primitives(level),
            faces: levels.surfels(level).map(face).collect(),
            side: lattice.texels as usize,
        })
    }

    /// Of a primitive.
    fn paint(&self, number: usize) -> Option<&Paint> {
        let primitive = *self.primitives.get(number)?;
        self.painted.paints.get(primitive as usize)
    }

    fn face(&self, number: usize) -> &Face<'f> {
        &self.faces[(number - self.primitives.len()) / 2]
    }
}

impl Surface for Shown<'_> {
    fn len(&self) -> usize {
        self.primitives.len() + 2 * self.faces.len()
    }

    fn corners(&self, number: usize) -> [DVec3; 3] {
        if let Some(&primitive) = self.primitives.get(number) {
            return self.stored[primitive as usize].positions();
        }
        let face = self.face(number);
        let [across, down] = OTHERS[face.axis];
        let right = DVec3::AXES[across] * face.size[across];
        let below = DVec3::AXES[down] * face.size[down];
        let is_second = (number - self.primitives.len()) % 2 == 1;
        let middle = face.corner + if is_second { below } else { right };
        [face.corner, middle, face.corner + right + below]
    }

    fn triangle(&self, number: usize) -> Triangle<'_> {
        if let Some(&primitive) = self.primitives.get(number) {
            let triangle = self.stored[primitive as usize].triangle();
            return match self.paint(number) {
                None => triangle,
                Some(paint) => Triangle {
                    alpha: paint.opacity(),
                    sampler: paint.sampler(&self.painted.textures),
                    ..triangle
                },
            };
        }
        let face = self.face(number);
        Triangle {
            corners: self.corners(number),
            normals: [face.outwards; 3],
            colors: [DVec3::ONE; 3],
            alpha: 1.0,
            sampler: None,
        }
    }

    fn bounds(&self) -> (DVec3, DVec3) {
        self.file.bounds()
    }

    fn is_opaque(&self, number: usize) -> bool {
        let paint = self.paint(number);
        paint.is_none_or(|paint| paint.is_opaque(&self.painted.textures))
    }

    fn is_textured(&self, number: usize) -> bool {
        number >= self.primitives.len()
    }

    fn texture(&self, number: usize, point: DVec3) -> Option<(DVec3, DVec3)> {
        let face = self.face(number);
        let place = (point - face.corner) / face.size * self.side as f64;
        // A negative number becomes 0: points on an edge may lie beyond it by rounding.
        let [across, down] = OTHERS[face.axis].map(|k| (place[k] as usize).min(self.side - 1));
        let texel = &face.texels[down * self.side + across];
        if texel.is_clear() {
            return None;
        }
        let normal = PackedNormal(texel.normal).decode();
        Some((to_light(texel.color), normal.unwrap_or(face.outwards)))
    }
}
