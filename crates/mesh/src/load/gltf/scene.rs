//! From a glTF document's nodes to triangles in world coordinates.

use glam::{DMat4, DQuat, DVec3};

use super::accessor::Numbers;
use super::document::{Document, Material as FileMaterial, Mesh as FileMesh, Node, Primitive};
use super::picture::{self, Painted};
use super::{Beside, Buffers, Fault, Place, Problem, broken};
use crate::load::texture::Textures;
use crate::material::linear_to_srgb;
use crate::{ColorSpace, Material, MeshBuilder};

/// Triangles that a document may always have, besides those that its length justifies.
const FREE_TRIANGLES: u64 = 100_000;
/// Triangles that a byte of file and buffers justifies: nodes may show a mesh many times.
const TRIANGLES_A_BYTE: u64 = 16;

/// A primitive's corners: their order and their number.
struct Sizes<'d> {
    mode: u32,
    positions: Numbers<'d>,
    indices: Option<Numbers<'d>>,
    triangles: usize,
}

pub(super) struct Reader<'d> {
    document: &'d Document,
    buffers: &'d Buffers,
    /// Positions and triangles that may be made.
    most: u64,
    skipped_modes: u64,
    morphed: u64,
    skinned: u64,
    beside: &'d dyn Beside,
    textures: Textures,
}

impl<'d> Reader<'d> {
    pub(super) fn new(
        document: &'d Document,
        buffers: &'d Buffers,
        beside: &'d dyn Beside,
        json_bytes: usize,
    ) -> Self {
        let bytes = json_bytes + buffers.len();
        Self {
            document,
            buffers,
            most: FREE_TRIANGLES + TRIANGLES_A_BYTE * bytes as u64,
            skipped_modes: 0,
            morphed: 0,
            skinned: 0,
            beside,
            textures: Textures::default(),
        }
    }

    /// Adds all triangles of the default scene, or of the first, or of all nodes.
    pub(super) fn read(mut self, builder: &mut MeshBuilder) -> Result<(), Problem> {
        let document = self.document;
        builder.material(Material::default_color());
        for material in &document.materials {
            builder.material(understood(material));
        }
        let nodes = &document.nodes;
        let mut open: Vec<(usize, DMat4)> = match document.scenes.get(document.scene.unwrap_or(0)) {
            Some(scene) => scene.nodes.iter().map(|&n| (n, DMat4::IDENTITY)).collect(),
            None => {
                let mut is_child = vec![false; nodes.len()];
                for &child in nodes.iter().flat_map(|node| &node.children) {
                    if let Some(entry) = is_child.get_mut(child) {
                        *entry = true;
                    }
                }
                let roots = (0..nodes.len()).filter(|&n| !is_child[n]);
                roots.map(|n| (n, DMat4::IDENTITY)).collect()
            }
        };
        open.reverse();
        let mut seen = vec![false; nodes.len()];
        let mut shown = Vec::new();
        while let Some((number, parent)) = open.pop() {
            let Some(node) = nodes.get(number) else {
                return Err(broken("node", number, "a node of this number", "none"));
            };
            if std::mem::replace(&mut seen[number], true) {
                let expected = "one parent, in a tree";
                return Err(broken("node", number, expected, "a second way to it"));
            }
            let placed = parent * transform(node);
            if let Some(mesh) = node.mesh {
                self.skinned += u64::from(node.skin.is_some());
                shown.push((mesh, placed));
            }
            open.extend(node.children.iter().rev().map(|&child| (child, placed)));
        }
        self.make_room(&shown, builder)?;
        for (number, placed) in shown {
            let mesh = document.meshes.get(number);
            let mesh =
                mesh.ok_or_else(|| broken("mesh", number, "a mesh of this number", "none"))?;
            for primitive in &mesh.primitives {
                self.primitive(number, primitive, placed, builder)?;
            }
        }
        self.tell(builder);
        Ok(())
    }

    fn tell(&self, builder: &mut MeshBuilder) {
        self.textures.tell(builder);
        let mut warn = |count: u64, what: &str| {
            if count > 0 {
                builder.warn(format!("{count} {what}"));
            }
        };
        let (modes, morphed) = (self.skipped_modes, self.morphed);
        warn(modes, "primitives of points or lines were passed over");
        warn(
            morphed,
            "primitives have morph targets, which are not applied",
        );
        warn(self.skinned, "meshes have skins, which are not applied");
    }

    fn make_room(
        &self,
        shown: &[(usize, DMat4)],
        builder: &mut MeshBuilder,
    ) -> Result<(), Problem> {
        let fault = |expected: String, found: String| {
            let advice = "export a part of the scene";
            Problem::Limit(Fault::new("nodes", Place::Whole, expected, found, advice))
        };
        let mut of_mesh = vec![None; self.document.meshes.len()];
        let (mut positions, mut triangles) = (0u64, 0u64);
        for &(mesh, _) in shown {
            // A missing mesh is reported where it is drawn.
            let Some(known) = of_mesh.get_mut(mesh) else {
                continue;
            };
            let (more_positions, more_triangles) = match *known {
                Some(known) => known,
                None => *known.insert(self.size_of(&self.document.meshes[mesh])?),
            };
            positions += more_positions;
            triangles += more_triangles;
            // Positions count as triangles: they take memory too.
            if positions + triangles > self.most {
                return Err(fault(
                    format!("at most {TRIANGLES_A_BYTE} triangles for a byte of the file"),
                    "more: they show meshes very often".to_owned(),
                ));
            }
        }
        let room = builder.reserve(positions as usize, triangles as usize);
        room.map_err(|short| fault("memory for all triangles".to_owned(), short.to_string()))
    }

    fn size_of(&self, mesh: &FileMesh) -> Result<(u64, u64), Problem> {
        let (mut positions, mut triangles) = (0, 0);
        for primitive in &mesh.primitives {
            if let Some(of) = self.sizes(primitive)? {
                positions += of.positions.count as u64;
                triangles += of.triangles as u64;
            }
        }
        Ok((positions, triangles))
    }

    /// The corners of a primitive, or none if it has no triangles.
    fn sizes(&self, primitive: &Primitive) -> Result<Option<Sizes<'d>>, Problem> {
        let mode = primitive.mode.unwrap_or(4);
        let (Some(position), 4..=6) = (primitive.attributes.position, mode) else {
            return Ok(None);
        };
        let positions = self.numbers(position)?;
        let indices = primitive.indices.map(|a| self.numbers(a)).transpose()?;
        let corners = indices
            .as_ref()
            .map_or(positions.count, |indices| indices.count);
        let triangles = match mode {
            4 => corners / 3,
            _ => corners.saturating_sub(2),
        };
        Ok(Some(Sizes {
            mode,
            positions,
            indices,
            triangles,
        }))
    }

    fn painted(&mut self, primitive: &Primitive) -> Result<Option<Painted<'d>>, Problem> {
        let document = self.document;
        let material = primitive.material.and_then(|m| document.materials.get(m));
        let Some(info) =
            material.and_then(|m| m.pbr_metallic_roughness.base_color_texture.as_ref())
        else {
            return Ok(None);
        };
        let transform = info.extensions.transform.as_ref();
        let set = transform
            .and_then(|t| t.tex_coord)
            .unwrap_or(info.tex_coord);
        let uvs = match set {
            0 => primitive.attributes.first_uv,
            1 => primitive.attributes.second_uv,
            _ => None,
        };
        let Some(uvs) = uvs else { return Ok(None) };
        let uvs = self.numbers(uvs)?;
        let texture = picture::find(
            document,
            self.buffers,
            self.beside,
            info.index,
            &mut self.textures,
        );
        Ok(texture.map(|texture| Painted {
            texture,
            uvs,
            transform,
        }))
    }

    fn numbers(&self, accessor: usize) -> Result<Numbers<'d>, Problem> {
        Numbers::find(self.document, self.buffers, accessor)
    }

    fn primitive(
        &mut self,
        mesh: usize,
        primitive: &Primitive,
        placed: DMat4,
        builder: &mut MeshBuilder,
    ) -> Result<(), Problem> {
        let Some(Sizes {
            mode,
            positions,
            indices,
            triangles,
        }) = self.sizes(primitive)?
        else {
            self.skipped_modes += 1;
            return Ok(());
        };
        self.morphed += u64::from(!primitive.targets.is_empty());
        let optional = |accessor: Option<usize>| accessor.map(|a| self.numbers(a)).transpose();
        let normals = optional(primitive.attributes.normal)?;
        let colors = optional(primitive.attributes.color)?;
        let base = builder.positions() as u32;
        for at in 0..positions.count {
            let point = DVec3::from_array(positions.triple(at).map(f64::from));
            let world = placed.transform_point3(point).to_array();
            match &colors {
                Some(colors) => {
                    let light = colors.triple(at);
                    let color = light.map(|light| linear_to_srgb(f64::from(light)));
                    builder.colored_position(world, color)
                }
                None => builder.position(world),
            };
        }
        let turn = placed.inverse().transpose();
        let mirrored = placed.determinant() < 0.0;
        let normal_of = |at: u32| {
            normals.as_ref().map(|normals| {
                let normal = DVec3::from_array(normals.triple(at as usize).map(f64::from));
                turn.transform_vector3(normal)
                    .normalize_or_zero()
                    .as_vec3()
                    .to_array()
            })
        };
        // The first material is the one of triangles without.
        let material = primitive
            .material
            .map_or(0, |m| (m as u32).saturating_add(1));
        let painted = self.painted(primitive)?;
        for number in 0..triangles {
            let mut at = match mode {
                4 => [3 * number, 3 * number + 1, 3 * number + 2],
                5 if number % 2 == 1 => [number + 1, number, number + 2],
                5 => [number, number + 1, number + 2],
                _ => [0, number + 1, number + 2],
            };
            if mirrored {
                at.swap(1, 2);
            }
            let mut triangle = [0u32; 3];
            for (corner, &at) in triangle.iter_mut().zip(&at) {
                let index = match &indices {
                    None => Some(at as u32),
                    Some(indices) => indices.index(at),
                };
                let sound = index.filter(|&index| (index as usize) < positions.count);
                *corner = sound.ok_or_else(|| {
                    broken(
                        "mesh",
                        mesh,
                        &format!("indices from 0 to {}", positions.count as i64 - 1),
                        &index.map_or("a number of another kind".into(), |i| i.to_string()),
                    )
                })?;
            }
            let given = triangle.map(normal_of);
            let given = match given {
                [Some(a), Some(b), Some(c)] => Some([a, b, c]),
                _ => None,
            };
            // In range: checked just now.
            let tint = painted.as_ref().and_then(|painted| painted.mean(triangle));
            let corners = triangle.map(|i| base + i);
            let _ = builder.textured_triangle(corners, given, material, tint);
        }
        Ok(())
    }
}

/// A node's place in its parent.
fn transform(node: &Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix);
    }
    let rotation = node.rotation.map(DQuat::from_array);
    let rotation = rotation.filter(|q| q.length_squared() > 0.0 && q.is_finite());
    DMat4::from_scale_rotation_translation(
        DVec3::from_array(node.scale.unwrap_or([1.0; 3])),
        rotation.map_or(DQuat::IDENTITY, DQuat::normalize),
        DVec3::from_array(node.translation.unwrap_or_default()),
    )
}

fn understood(material: &FileMaterial) -> Material {
    let [r, g, b, a] = material
        .pbr_metallic_roughness
        .base_color_factor
        .unwrap_or([1.0; 4]);
    let alpha = match material.alpha_mode.as_deref() {
        Some("BLEND") => a,
        // Written so that an alpha that is no number is opaque.
        Some("MASK") if a < material.alpha_cutoff.unwrap_or(0.5) => 0.0,
        _ => 1.0,
    };
    Material::of_numbers(material.name.clone(), [r, g, b], ColorSpace::Linear, alpha)
}
