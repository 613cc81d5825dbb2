//! Surfaces to draw and to voxelise: one mesh, or several placed copies of it.

use std::collections::HashSet;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::geometry::{area, barycentric, blend, bounds, plane_normal, point};
use super::material::srgb_to_linear;
use super::{Mesh, Sampler, Texture};
use shiftvox::graph::MeshBox;
use shiftvox::split_mix::mix;

/// One triangle, ready to be drawn: attributes of its corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle<'t> {
    /// Positions.
    pub corners: [DVec3; 3],
    /// Unit normals.
    pub normals: [DVec3; 3],
    /// Colours, linear light.
    pub colors: [DVec3; 3],
    /// Opacity, above 0.
    pub alpha: f64,
    /// Its texture, whose colours and opacities are factors.
    pub sampler: Option<Sampler<'t>>,
}

impl Triangle<'_> {
    /// Colour and opacity at shares of the corners: the mean of a square of that side.
    pub fn at(&self, shares: [f64; 3], side: f64) -> (DVec3, f64) {
        let color = blend(&self.colors, shares);
        let Some(sampler) = &self.sampler else {
            return (color, self.alpha);
        };
        let (factor, opacity) = sampler.at(&self.corners, shares, side);
        (color * factor, self.alpha * opacity)
    }

    /// The texels that a side of a square spans, for [`Triangle::opacity`].
    pub(crate) fn texels(&self, side: f64) -> f64 {
        let sampler = self.sampler.as_ref();
        sampler.map_or(0.0, |sampler| side * sampler.texels_per_unit(&self.corners))
    }

    /// Opacity at shares of the corners: the mean of a square of so many texels a side.
    pub(crate) fn opacity(&self, shares: [f64; 3], texels: f64) -> f64 {
        let sampler = self.sampler.as_ref();
        self.alpha * sampler.map_or(1.0, |sampler| sampler.opacity(shares, texels))
    }

    /// Colours of the corners with the texture's mean there, or around the middle where it is clear there, for files
    /// without textures.
    pub(crate) fn corner_colors(&self) -> [DVec3; 3] {
        let side = area(self.corners).sqrt() / 2.0;
        let shares = [[4.0, 1.0, 1.0], [1.0, 4.0, 1.0], [1.0, 1.0, 4.0]];
        match self.sampler {
            None => self.colors,
            Some(_) => shares.map(|shares| match self.at(shares.map(|s| s / 6.0), side) {
                (_, 0.0) => self.at([1.0 / 3.0; 3], 4.0 * side).0,
                (color, _) => color,
            }),
        }
    }

    /// The unit normal on the eye's side, and colour and opacity at a point: the mean of a square of that side.
    pub(crate) fn seen_from(
        &self,
        point: DVec3,
        towards_eye: DVec3,
        side: f64,
    ) -> (DVec3, (DVec3, f64)) {
        let shares = barycentric(&self.corners, point);
        let facing = |n: DVec3, side: DVec3| if n.dot(side) < 0.0 { -n } else { n };
        let face = facing(plane_normal(self.corners), towards_eye);
        let normal = blend(&self.normals, shares).normalize_or(face);
        (facing(normal, face), self.at(shares, side))
    }
}

/// Whether something of an opacity stops light at a point, by lot, which the bits of the point draw.
pub(crate) fn stops(opacity: f64, point: DVec3) -> bool {
    let bits = point.to_array().map(f64::to_bits);
    let lot = bits.iter().fold(0, |lot, &bits| mix(lot ^ bits));
    (lot >> 11) as f64 / (1u64 << 53) as f64 <= opacity && opacity > 0.0
}

/// Triangles, accessed by a number below [`Surface::len`].
pub trait Surface: Sync {
    /// Number of triangles.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Positions of a triangle's corners.
    fn corners(&self, number: usize) -> [DVec3; 3];

    /// All attributes of a triangle.
    fn triangle(&self, number: usize) -> Triangle<'_>;

    /// Lowest and highest corner.
    fn bounds(&self) -> (DVec3, DVec3);

    /// The material of a triangle whose colour is the mean of its texture.
    fn tinted_material(&self, _number: usize) -> Option<u32> {
        None
    }

    /// The textures of its triangles, each once.
    fn textures(&self) -> Vec<Arc<Texture>> {
        Vec::new()
    }

    /// Whether nothing shows through a triangle.
    fn is_opaque(&self, _number: usize) -> bool {
        true
    }

    /// Whether the rasteriser calls [`Surface::texture`] at each point of a triangle. It does for no triangle of a mesh.
    fn is_textured(&self, _number: usize) -> bool {
        false
    }

    /// Colour (linear light) and unit normal of a textured triangle at a point; `None` where it is transparent.
    fn texture(&self, _number: usize, _point: DVec3) -> Option<(DVec3, DVec3)> {
        None
    }
}

/// The box for fitted cameras, the same for all files made of a surface.
pub fn mesh_box(surface: &dyn Surface, y_up: bool) -> MeshBox {
    let (low, high) = surface.bounds();
    let span = (low.to_array(), high.to_array());
    let corners = (0..surface.len()).flat_map(|number| surface.corners(number));
    MeshBox::around(span, corners.map(|corner| corner.to_array()), y_up)
}

impl Surface for Mesh {
    fn len(&self) -> usize {
        self.triangles.len()
    }

    fn corners(&self, number: usize) -> [DVec3; 3] {
        let positions = &self.positions[..];
        self.triangles[number].map(|i| point(positions[i as usize]))
    }

    fn triangle(&self, number: usize) -> Triangle<'_> {
        let corners = Surface::corners(self, number);
        let normals = match self.corner_normals.get(number) {
            Some(normals) => normals.map(point),
            None => [plane_normal(corners); 3],
        };
        // Meshes of far nodes have no materials.
        let material = self.materials.get(self.material_of[number] as usize);
        let (diffuse, alpha) = material.map_or(([1.0; 3], 1.0), |m| (m.diffuse, m.alpha));
        let texture = material.and_then(|material| material.texture.as_deref());
        let places = self.places.get(number).filter(|p| p[0][0].is_finite());
        let sampler = texture
            .zip(places)
            .map(|(texture, &places)| Sampler { texture, places });
        let diffuse = point(diffuse);
        let color = |i: u32| match self.vertex_colors.get(i as usize) {
            Some(color) => diffuse * point(color.map(srgb_to_linear)),
            None => diffuse,
        };
        Triangle {
            corners,
            normals,
            colors: self.triangles[number].map(color),
            alpha: f64::from(alpha),
            sampler,
        }
    }

    fn bounds(&self) -> (DVec3, DVec3) {
        Self::bounds(self)
    }

    fn is_opaque(&self, number: usize) -> bool {
        let material = self.materials.get(self.material_of[number] as usize);
        material.is_none_or(|material| {
            let texture = material.texture.as_ref();
            material.alpha >= 1.0 && texture.is_none_or(|texture| texture.is_opaque())
        })
    }

    fn textures(&self) -> Vec<Arc<Texture>> {
        let textures = self.materials.iter();
        let textures = textures.filter_map(|material| material.texture.as_ref());
        let mut known = HashSet::new();
        let textures = textures.filter(|texture| known.insert(Arc::as_ptr(texture)));
        textures.cloned().collect()
    }

    fn tinted_material(&self, number: usize) -> Option<u32> {
        self.tints.get(number).map(|_| self.material_of[number])
    }
}

/// One mesh at many places, 96 bytes each.
#[derive(Debug, Clone)]
pub struct Instances {
    mesh: Mesh,
    places: Vec<DAffine3>,
    low: DVec3,
    high: DVec3,
}

impl Instances {
    /// Places that are not finite, or have no inverse, are left out.
    pub fn new(mesh: Mesh, places: Vec<DAffine3>) -> Self {
        let places: Vec<DAffine3> = places
            .into_iter()
            .filter(|place| place.is_finite() && place.matrix3.determinant() != 0.0)
            .collect();
        let mut is_used = vec![false; mesh.positions.len()];
        for &corner in mesh.triangles.as_flattened() {
            is_used[corner as usize] = true;
        }
        let used = || mesh.positions.iter().zip(&is_used).filter(|used| *used.1);
        // Of the points and not of their box, whose corners may end up farther out.
        let points = places
            .iter()
            .flat_map(|place| used().map(|(&p, _)| place.transform_point3(point(p))));
        let (low, high) = bounds(points);
        Self {
            mesh,
            places,
            low,
            high,
        }
    }
}

impl Surface for Instances {
    fn len(&self) -> usize {
        self.mesh.triangles.len().saturating_mul(self.places.len())
    }

    fn corners(&self, number: usize) -> [DVec3; 3] {
        let each = self.mesh.triangles.len();
        let place = &self.places[number / each];
        Surface::corners(&self.mesh, number % each).map(|p| place.transform_point3(p))
    }

    fn triangle(&self, number: usize) -> Triangle<'_> {
        let each = self.mesh.triangles.len();
        let place = &self.places[number / each];
        let mut triangle = self.mesh.triangle(number % each);
        triangle.corners = triangle.corners.map(|p| place.transform_point3(p));
        // Normals turn with the inverse transposed; a mirror image keeps outside outside.
        let turn = place.matrix3.inverse().transpose();
        triangle.normals = triangle.normals.map(|n| (turn * n).normalize_or(n));
        triangle
    }

    fn bounds(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }

    fn is_opaque(&self, number: usize) -> bool {
        Surface::is_opaque(&self.mesh, number % self.mesh.triangles.len())
    }

    fn textures(&self) -> Vec<Arc<Texture>> {
        self.mesh.textures()
    }

    fn tinted_material(&self, number: usize) -> Option<u32> {
        Surface::tinted_material(&self.mesh, number % self.mesh.triangles.len())
    }
}
