//! From loose vertices and triangles to a sound mesh.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::SceneError;
use super::geometry::{area, plane_normal, point};
use super::list::{List, ListFolder};
use super::load::{Fault, Place, Problem};
use super::{Material, Mesh, Surface, Texture, Triangle};

const MOST: usize = u32::MAX as usize;

/// Collects positions and triangles and leaves out what cannot be drawn.
///
/// Left out, with a warning: triangles with a coordinate that is not finite, without area, or of a material with opacity
/// 0. If all triangles have opacity 0, they are drawn opaque: some programs write 0 for opaque materials.
#[derive(Debug, Default)]
pub struct MeshBuilder {
    mesh: Mesh,
    not_finite: u64,
    no_place: u64,
    degenerate: u64,
    invisible: u64,
    seen: u64,
    too_many: bool,
    folder: Option<Arc<ListFolder>>,
}

impl MeshBuilder {
    /// An empty builder.
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty builder whose mesh is in files of a folder.
    pub fn within(folder: Option<&Arc<ListFolder>>) -> Self {
        Self {
            mesh: Mesh {
                positions: List::within(folder),
                triangles: List::within(folder),
                material_of: List::within(folder),
                corner_normals: List::within(folder),
                vertex_colors: List::within(folder),
                places: List::within(folder),
                tints: List::within(folder),
                ..Mesh::default()
            },
            folder: folder.cloned(),
            ..Self::default()
        }
    }

    pub(crate) fn folder(&self) -> Option<&Arc<ListFolder>> {
        self.folder.as_ref()
    }

    /// Whether the folder has had room so far.
    pub(crate) fn has_room(&self) -> bool {
        self.folder.as_ref().is_none_or(|folder| folder.has_room())
    }

    /// Fails if the folder had no room.
    pub(crate) fn check_folder(&self) -> Result<(), SceneError> {
        self.folder.as_ref().map_or(Ok(()), |folder| folder.check())
    }

    /// Adds a material and returns its number.
    pub fn material(&mut self, material: Material) -> u32 {
        self.mesh.materials.push(material);
        (self.mesh.materials.len() - 1) as u32
    }

    pub(crate) fn set_texture(&mut self, material: u32, texture: Arc<Texture>) {
        self.mesh.materials[material as usize].texture = Some(texture);
    }

    pub(crate) fn set_opaque(&mut self, material: u32) {
        self.mesh.materials[material as usize].alpha = 1.0;
    }

    /// Adds a position and returns its number.
    pub fn position<T: Into<f64>>(&mut self, position: [T; 3]) -> u32 {
        let number = self.mesh.positions.len();
        if number >= MOST {
            self.too_many = true;
            return 0;
        }
        self.mesh.positions.push(position.map(Into::into));
        number as u32
    }

    /// Adds a position with a colour (sRGB). Positions before it that came
    /// without are white.
    pub fn colored_position<T: Into<f64>>(&mut self, position: [T; 3], color: [u8; 3]) -> u32 {
        let number = self.position(position);
        let colors = &mut self.mesh.vertex_colors;
        colors.pad(number as usize, [255; 3]);
        colors.push(color);
        number
    }

    /// A position that it has.
    pub(crate) fn at(&self, position: u32) -> DVec3 {
        point(self.mesh.positions[position as usize])
    }

    /// Positions so far.
    pub fn positions(&self) -> usize {
        self.mesh.positions.len()
    }

    /// Adds a warning to the mesh.
    pub fn warn(&mut self, warning: impl Into<String>) {
        self.mesh.warnings.push(warning.into());
    }

    /// Adds a triangle, with or without normals of its corners. A material that does not exist is taken for the first.
    ///
    /// # Errors
    /// The number of a position that does not exist; the triangle is not added.
    pub fn triangle(
        &mut self,
        corners: [u32; 3],
        normals: Option<[[f32; 3]; 3]>,
        material: u32,
    ) -> Result<(), u32> {
        self.textured_triangle(corners, normals, material, None)
    }

    /// [`triangle`](Self::triangle) with the places of its corners in the material's texture: across from the left and
    /// down from the top, in sizes of the picture. If one is not finite they have no effect, with a warning.
    ///
    /// # Errors
    /// As [`triangle`](Self::triangle).
    pub fn textured_triangle(
        &mut self,
        corners: [u32; 3],
        normals: Option<[[f32; 3]; 3]>,
        material: u32,
        places: Option<[[f64; 2]; 3]>,
    ) -> Result<(), u32> {
        let positions = self.mesh.positions.len();
        if let Some(&index) = corners.iter().find(|&&i| i as usize >= positions) {
            return Err(index);
        }
        self.seen += 1;
        let [a, b, c] = corners.map(|i| point(self.mesh.positions[i as usize]));
        if !(a.is_finite() && b.is_finite() && c.is_finite()) {
            self.not_finite += 1;
            return Ok(());
        }
        let across = (b - a).cross(c - a);
        if across == DVec3::ZERO {
            self.degenerate += 1;
            return Ok(());
        }
        if self.mesh.triangles.len() >= MOST {
            self.too_many = true;
            return Ok(());
        }
        let near = places.map(|places| {
            // Of a picture that repeats, the nearest repetition has the most digits.
            let texture = self.mesh.materials.get(material as usize);
            let texture = texture.and_then(|material| material.texture.as_ref());
            let first = texture.map_or([0.0; 2], |texture| texture.repetition(places[0]));
            places.map(|place| [0, 1].map(|k| (place[k] - first[k]) as f32))
        });
        let sound = near.filter(|near| near.as_flattened().iter().all(|c| c.is_finite()));
        self.no_place += u64::from(near.is_some() && sound.is_none());
        if let Some(near) = sound {
            let none = [[f32::NAN; 2]; 3];
            self.mesh.places.pad(self.mesh.triangles.len(), none);
            self.mesh.places.push(near);
        }
        let mesh = &mut self.mesh;
        if normals.is_some() || !mesh.corner_normals.is_empty() {
            // Earlier triangles get the normal of their plane.
            for number in mesh.corner_normals.len()..mesh.triangles.len() {
                let plane = plane_normal(Surface::corners(mesh, number));
                mesh.corner_normals.push([plane.as_vec3().to_array(); 3]);
            }
            // No zero: `across` is not, though its length may round to it.
            let plane = across.normalize_or(DVec3::Z);
            let given = normals.map_or([plane; 3], |normals| normals.map(point));
            let sound = given.map(|n| n.try_normalize().unwrap_or(plane).as_vec3().to_array());
            mesh.corner_normals.push(sound);
        }
        mesh.triangles.push(corners);
        mesh.material_of.push(material);
        Ok(())
    }

    /// Gives triangles of unknown materials the first one. Adds warnings of them and of coordinates without effect.
    fn check_materials(&mut self) {
        let mesh = &mut self.mesh;
        if mesh.materials.is_empty() {
            mesh.materials.push(Material::default_color());
        }
        let count = mesh.materials.len();
        let mut unknown = 0;
        for material in mesh.material_of.iter_mut() {
            if *material as usize >= count {
                *material = 0;
                unknown += 1;
            }
        }
        let first = format!(
            "are of materials that do not exist, and got {:?}",
            mesh.materials[0].name
        );
        let places =
            "had texture coordinates that are infinite or not numbers, which were passed over";
        for (count, what) in [(unknown, &first[..]), (self.no_place, places)] {
            if count > 0 {
                mesh.warnings.push(format!("{count} triangles {what}"));
            }
        }
    }

    /// Leaves out triangles of materials with opacity 0, unless there are no others.
    fn leave_out_invisible(&mut self) {
        let mesh = &mut self.mesh;
        if mesh.materials.iter().all(|material| material.alpha != 0.0) {
            return;
        }
        let alpha = |of: u32| mesh.materials.get(of as usize).map(|m| m.alpha);
        let materials = mesh.material_of.iter();
        let is_shown: Vec<bool> = materials.map(|&of| alpha(of) != Some(0.0)).collect();
        if is_shown.contains(&true) {
            mesh.keep(&is_shown);
            self.invisible = (is_shown.len() - mesh.triangles.len()) as u64;
        } else if !is_shown.is_empty() {
            for material in mesh.materials.iter_mut().filter(|m| m.alpha == 0.0) {
                material.alpha = 1.0;
            }
            self.warn(format!(
                "all {} triangles are of materials with opacity 0, which some programs write for opaque ones: they are \
                 drawn opaque",
                is_shown.len()
            ));
        }
    }

    /// The mesh, of a file of that name.
    ///
    /// # Errors
    /// When no triangle is left, or when there are more than 2^32 of anything.
    pub fn finish(mut self, file: &str) -> Result<Mesh, SceneError> {
        self.check_folder()?;
        self.check_materials();
        self.leave_out_invisible();
        let in_file = |error: Problem| error.in_file(file);
        if self.too_many {
            let expected = "fewer than 2^32 positions and triangles";
            let fault = Fault::new("mesh", Place::Whole, expected, "more", "split the mesh");
            return Err(in_file(Problem::Limit(fault)));
        }
        let mut told = Vec::new();
        for (count, what) in [
            (
                self.not_finite,
                "with a coordinate that is infinite or not a number",
            ),
            (
                self.degenerate,
                "without area (corners equal, or on a line)",
            ),
            (self.invisible, "of a material with opacity 0"),
        ] {
            if count > 0 {
                told.push(format!("{count} of {} triangles {what}", self.seen));
            }
        }
        if self.mesh.triangles.is_empty() {
            let found = match &told[..] {
                [] => "none".to_owned(),
                told => format!("none that can be drawn: {}", told.join(", ")),
            };
            let advice = "export the mesh again, with its faces";
            let fault = Fault::new("mesh", Place::Whole, "at least one triangle", found, advice);
            return Err(in_file(fault.into()));
        }
        for complaint in &mut told {
            complaint.push_str(" were left out");
        }
        let mesh = &mut self.mesh;
        mesh.warnings.append(&mut told);
        if mesh.materials.iter().any(|m| m.texture.is_some()) {
            leave_out_clear(mesh);
            for number in 0..mesh.triangles.len() {
                mesh.tints.push(middle(mesh, number));
            }
        }
        if !mesh.vertex_colors.is_empty() {
            mesh.vertex_colors.pad(mesh.positions.len(), [255; 3]);
        }
        mesh.find_bounds();
        mesh.positions.shrink_to_fit();
        mesh.triangles.shrink_to_fit();
        mesh.material_of.shrink_to_fit();
        mesh.corner_normals.shrink_to_fit();
        self.check_folder()?;
        Ok(self.mesh)
    }
}

impl Mesh {
    /// Keeps the triangles for which there is `true`.
    fn keep(&mut self, is_kept: &[bool]) {
        self.triangles.keep(is_kept);
        self.material_of.keep(is_kept);
        self.corner_normals.keep(is_kept);
        self.places.keep(is_kept);
    }
}

/// Leaves out triangles whose texture is clear everywhere, unless there are no others.
fn leave_out_clear(mesh: &mut Mesh) {
    let numbers = (0..mesh.triangles.len()).into_par_iter();
    let is_shown: Vec<bool> = numbers.map(|n| !is_clear(&mesh.triangle(n))).collect();
    if !is_shown.contains(&true) {
        let told = "no triangle is seen: the textures are clear wherever a triangle shows them";
        mesh.warnings.push(told.to_owned());
    } else if is_shown.contains(&false) {
        mesh.keep(&is_shown);
    }
}

/// Parts along a side, over which a texture is averaged.
const PARTS: usize = 8;

fn is_clear(triangle: &Triangle<'_>) -> bool {
    let [a, b, c] = triangle.corners;
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    // Wide enough for parts of any direction.
    let part = 2.0 * longest / PARTS as f64;
    let mut places = (0..PARTS * PARTS).map(|at| [at / PARTS, at % PARTS].map(|k| k as f64 + 0.5));
    triangle.sampler.is_some()
        && places.all(|[i, j]| {
            let [u, v] = [i, j].map(|k| k / PARTS as f64);
            u + v > 1.0 || triangle.at([1.0 - u - v, u, v], part).1 == 0.0
        })
}

/// The factor of a triangle's texture, about its mean.
fn middle(mesh: &Mesh, number: usize) -> [f32; 3] {
    let triangle = mesh.triangle(number);
    let color = triangle.sampler.map_or(DVec3::ONE, |sampler| {
        let side = area(triangle.corners).sqrt();
        sampler.at(&triangle.corners, [1.0 / 3.0; 3], side).0
    });
    color.as_vec3().to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_triangles_are_left_out_and_normals_and_colours_may_come_late() {
        let mut builder = MeshBuilder::new();
        for position in [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f32::NAN; 3]] {
            builder.position(position);
        }
        builder.colored_position([2.0, 0.0, 0.0], [1, 2, 3]);
        for triangle in [[0, 1, 2], [0, 1, 1], [0, 1, 4], [0, 1, 3]] {
            builder.triangle(triangle, None, 9).unwrap();
        }
        let bad = [[0.0; 3], [f32::NAN; 3], [0.0, 3.0, 0.0]];
        let places = [[0.0; 2], [f64::NAN; 2], [0.0; 2]];
        builder
            .textured_triangle([0, 1, 2], Some(bad), 0, Some(places))
            .unwrap();
        assert_eq!(builder.triangle([0, 1, 5], None, 0), Err(5));
        let mesh = builder.finish("a.obj").unwrap();
        assert_eq!(mesh.triangles(), [[0, 1, 2]; 2]);
        let told = [
            "1 triangles are of materials that do not exist, and got \"no material\"",
            "1 triangles had texture coordinates that are infinite",
            "1 of 5 triangles with a coordinate",
            "2 of 5 triangles without area",
        ];
        assert_eq!(mesh.warnings().len(), told.len());
        for (warning, told) in mesh.warnings().iter().zip(told) {
            assert!(warning.starts_with(told), "{warning}");
        }
        assert_eq!(mesh.bounds().1, DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(
            (mesh.materials().len(), mesh.material_of()),
            (1, &[0, 0][..])
        );
        assert_eq!(mesh.vertex_colors()[3..], [[255; 3], [1, 2, 3]]);
        let plane = [0.0, 0.0, 1.0];
        let normals = [[plane; 3], [plane, plane, [0.0, 1.0, 0.0]]];
        assert_eq!(mesh.corner_normals(), normals);
    }
}
