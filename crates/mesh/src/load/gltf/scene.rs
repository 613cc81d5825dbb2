//! From a glTF document's nodes to triangles in world coordinates.

use std::collections::{BTreeMap, HashSet};

use glam::{DMat4, DQuat, DVec3};

use super::accessor::Numbers;
use super::document::{
    Attributes, Document, Instances, Material as FileMaterial, Mesh as FileMesh, Node, Primitive,
};
use super::picture::{self, Places};
use super::{Beside, Buffers, Fault, Place, Problem, broken};
use crate::load::texture::Textures;
use crate::material::to_srgb;
use crate::texture::AlphaMode;
use crate::{ColorSpace, Material, MeshBuilder};
use shiftvox::budget;

/// Triangles that a document may always have, besides those that its length justifies.
const FREE_TRIANGLES: usize = 100_000;
/// Triangles that a byte of file and buffers justifies: nodes may show a mesh many times.
const TRIANGLES_A_BYTE: usize = 16;

type Parts<'d> = (Numbers<'d>, Option<Numbers<'d>>, usize);

pub(super) struct Reader<'d> {
    document: &'d Document,
    buffers: &'d Buffers<'d>,
    beside: &'d Beside<'d>,
    most: usize,
    /// Counts of things that are not drawn.
    left_out: BTreeMap<&'static str, usize>,
    textures: Textures,
    /// The material of primitives without one that have colours.
    white: Option<u32>,
}

impl<'d> Reader<'d> {
    pub(super) fn new(
        document: &'d Document,
        buffers: &'d Buffers<'d>,
        beside: &'d Beside<'d>,
        json_bytes: usize,
    ) -> Self {
        let bytes = json_bytes + buffers.bytes;
        Self {
            document,
            buffers,
            beside,
            most: TRIANGLES_A_BYTE
                .saturating_mul(bytes)
                .saturating_add(FREE_TRIANGLES),
            left_out: BTreeMap::new(),
            textures: Textures::default(),
            white: None,
        }
    }

    /// Adds all triangles of the default scene, or of the first, or of all nodes.
    pub(super) fn read(mut self, builder: &mut MeshBuilder) -> Result<(), Problem> {
        builder.material(Material::default_color());
        for material in &self.document.materials {
            builder.material(understood(material));
        }
        for (number, accessor) in self.document.accessors.iter().enumerate() {
            if accessor.sparse.is_some() {
                self.numbers(number)?.check_order(number)?;
            }
        }
        let (scene, scenes) = (self.document.scene.unwrap_or(0), self.document.scenes.len());
        if scene >= scenes && self.document.scene.is_some() {
            builder.warn(format!(
                "the default scene {scene} is none of {scenes}; all nodes are drawn"
            ));
        }
        let shown = self.shown()?;
        self.check_size(&shown, builder)?;
        let meshes: HashSet<usize> = shown.iter().map(|&(mesh, _)| mesh).collect();
        for (number, placed) in shown {
            for primitive in &self.mesh(number)?.primitives {
                self.primitive(number, primitive, placed, builder)?;
            }
        }
        self.textures.tell(builder);
        for material in &self.document.materials {
            let emits = material.emits_light();
            self.left_out(emits, "materials emit light, which is not drawn");
            let transmits =
                "materials transmit light (KHR_materials_*transmission), which is not drawn";
            self.left_out(material.transmits_light(), transmits);
        }
        for number in 0..self.document.meshes.len() {
            let is_hidden = !meshes.contains(&number);
            self.left_out(is_hidden, "meshes are in no node that is shown");
        }
        for (what, count) in &self.left_out {
            builder.warn(format!("{count} {what}"));
        }
        Ok(())
    }

    fn left_out(&mut self, is_so: bool, what: &'static str) {
        if is_so {
            *self.left_out.entry(what).or_default() += 1;
        }
    }

    fn shown(&mut self) -> Result<Vec<(usize, DMat4)>, Problem> {
        let nodes = &self.document.nodes;
        let scene = self.document.scene.unwrap_or(0);
        let roots = match self.document.scenes.get(scene) {
            Some(scene) => scene.nodes.clone(),
            None => {
                let children = nodes.iter().flat_map(|node| node.children.iter().copied());
                let children: HashSet<usize> = children.collect();
                (0..nodes.len()).filter(|n| !children.contains(n)).collect()
            }
        };
        let roots = roots.into_iter().rev().map(|n| (n, DMat4::IDENTITY));
        let mut open: Vec<(usize, DMat4)> = roots.collect();
        let (mut seen, mut shown) = (HashSet::new(), Vec::new());
        while let Some((number, parent)) = open.pop() {
            let Some(node) = nodes.get(number) else {
                return Err(broken("node", number, "a node of this number", "none"));
            };
            if !seen.insert(number) {
                let expected = "one parent, in a tree";
                return Err(broken("node", number, expected, "a second way to it"));
            }
            let visibility = node.extensions.visibility.as_ref();
            if visibility.and_then(|of| of.visible) == Some(false) {
                continue;
            }
            let placed = parent * transform(node);
            if let Some(mesh) = node.mesh {
                let has_skin = node.skin.is_some();
                self.left_out(has_skin, "meshes have skins, which are not applied");
                match &node.extensions.instances {
                    None => shown.push((mesh, placed)),
                    Some(instances) => {
                        let mut names = instances.attributes.keys();
                        let told =
                            "nodes have colours of instances (_COLOR_0), which are not drawn";
                        self.left_out(names.any(|name| name.starts_with("_COLOR")), told);
                        let room = self.most.saturating_sub(shown.len());
                        let instances = self.instances(instances, room)?;
                        shown.extend(instances.map(|instance| (mesh, placed * instance)));
                    }
                }
            }
            open.extend(node.children.iter().rev().map(|&child| (child, placed)));
        }
        Ok(shown)
    }

    /// The places of a mesh that a node shows several times, at most `most`.
    fn instances(
        &self,
        instances: &Instances,
        most: usize,
    ) -> Result<impl Iterator<Item = DMat4> + use<'d>, Problem> {
        let find = |name: &str| self.attribute(&instances.attributes, name);
        let [moves, turns, scales] = [find("TRANSLATION")?, find("ROTATION")?, find("SCALE")?];
        let all = [&moves, &turns, &scales].into_iter().flatten();
        let count = all.map(|numbers| numbers.count).max().unwrap_or(0);
        if count > most {
            return Err(too_many());
        }
        Ok((0..count).map(move |at| {
            let turn = turns.as_ref().map_or(DQuat::IDENTITY, |turns| {
                DQuat::from_array([0, 1, 2, 3].map(|k| f64::from(turns.real(at, k))))
            });
            let scale = scales.as_ref().map_or(DVec3::ONE, |of| of.point(at));
            let moved = moves.as_ref().map_or(DVec3::ZERO, |of| of.point(at));
            placed(scale, turn, moved)
        }))
    }

    fn mesh(&self, number: usize) -> Result<&'d FileMesh, Problem> {
        let mesh = self.document.meshes.get(number);
        mesh.ok_or_else(|| broken("mesh", number, "a mesh of this number", "none"))
    }

    /// Fails if there is too much, before any of it is made.
    fn check_size(&self, shown: &[(usize, DMat4)], builder: &MeshBuilder) -> Result<(), Problem> {
        let (mut used, mut bytes) = (0usize, 0u64);
        for &(mesh, _) in shown {
            for primitive in &self.mesh(mesh)?.primitives {
                let parts = self.parts(primitive)?;
                let [positions, triangles] = parts.map_or([0; 2], |of| [of.0.count, of.2]);
                // Positions take memory, too. Also a primitive without any takes time.
                used = used.saturating_add(positions.saturating_add(triangles).saturating_add(1));
                if used > self.most {
                    return Err(too_many());
                }
                bytes += 24 * positions as u64 + 16 * triangles as u64;
            }
        }
        match builder.folder() {
            Some(_) => Ok(()),
            None => budget::check("a mesh", bytes).map_err(|short| {
                too_large("memory for all triangles".to_owned(), short.to_string())
            }),
        }
    }

    /// A primitive's positions, indices and number of triangles; `None` without triangles.
    fn parts(&self, primitive: &Primitive) -> Result<Option<Parts<'d>>, Problem> {
        let mode = primitive.mode.unwrap_or(4);
        if !(4..=6).contains(&mode) {
            return Ok(None);
        }
        let Some(positions) = self.attribute(&primitive.attributes, "POSITION")? else {
            return Ok(None);
        };
        if !positions.has(2) {
            let number = primitive.attributes["POSITION"].unwrap_or_default();
            let expected = "positions as VEC3";
            return Err(broken("accessor", number, expected, "fewer numbers"));
        }
        let indices = primitive.indices.map(|a| self.numbers(a)).transpose()?;
        let corners = indices.as_ref().map_or(positions.count, |i| i.count);
        let triangles = match mode {
            4 => corners / 3,
            _ => corners.saturating_sub(2),
        };
        Ok(Some((positions, indices, triangles)))
    }

    /// The places of a primitive's vertices, if its material has a texture, which the builder gets.
    fn places(
        &mut self,
        primitive: &Primitive,
        number: u32,
        builder: &mut MeshBuilder,
    ) -> Result<Option<Places<'d>>, Problem> {
        let document = self.document;
        let Some(material) = primitive.material.and_then(|m| document.materials.get(m)) else {
            return Ok(None);
        };
        let Some(info) = &material.base().base_color_texture else {
            return Ok(None);
        };
        let transform = info.extensions.transform.as_ref();
        let moved = transform.and_then(|t| t.tex_coord);
        let set = moved.unwrap_or(info.tex_coord);
        let Some(uvs) = self.attribute(&primitive.attributes, &format!("TEXCOORD_{set}"))? else {
            let told = "primitives have a texture, but no texture coordinates";
            self.left_out(true, told);
            return Ok(None);
        };
        let (buffers, beside) = (self.buffers, self.beside);
        let wanted = (info.index, alpha_mode(material));
        let texture = picture::find(document, buffers, beside, wanted, &mut self.textures);
        Ok(texture.map(|texture| {
            builder.set_texture(number, texture);
            if let AlphaMode::Mask(_) = wanted.1 {
                // The texels have the mask.
                builder.set_opaque(number);
            }
            Places { uvs, transform }
        }))
    }

    fn numbers(&self, accessor: usize) -> Result<Numbers<'d>, Problem> {
        Numbers::find(self.document, self.buffers, accessor)
    }

    fn attribute(
        &self,
        attributes: &Attributes,
        name: &str,
    ) -> Result<Option<Numbers<'d>>, Problem> {
        let accessor = attributes.get(name).copied().flatten();
        accessor.map(|a| self.numbers(a)).transpose()
    }

    fn primitive(
        &mut self,
        mesh: usize,
        primitive: &Primitive,
        placed: DMat4,
        builder: &mut MeshBuilder,
    ) -> Result<(), Problem> {
        let Some((positions, indices, triangles)) = self.parts(primitive)? else {
            self.left_out(true, "primitives of points or lines were passed over");
            return Ok(());
        };
        let told = "primitives have morph targets, which are not applied";
        self.left_out(!primitive.targets.is_empty(), told);
        let corners = indices.as_ref().map_or(positions.count, |i| i.count);
        let is_whole = primitive.mode.unwrap_or(4) != 4 || corners.is_multiple_of(3);
        let told = "primitives end within a triangle, which was passed over";
        self.left_out(!is_whole, told);
        let normals = self.attribute(&primitive.attributes, "NORMAL")?;
        let colors = self.attribute(&primitive.attributes, "COLOR_0")?;
        let blended = primitive
            .material
            .and_then(|m| self.document.materials.get(m));
        let blended = blended.filter(|&material| alpha_mode(material) != AlphaMode::Opaque);
        if let (Some(_), Some(colors)) = (blended, &colors) {
            let mut vertices = 0..colors.count.min(positions.count);
            let has_opacities = colors.has(3) && vertices.any(|at| colors.real(at, 3) < 1.0);
            self.left_out(
                has_opacities,
                "primitives have opacities of vertices, which are not drawn",
            );
        }
        let base = builder.positions() as u32;
        for at in 0..positions.count {
            let world = placed.transform_point3(positions.point(at)).to_array();
            match &colors {
                Some(colors) => {
                    let color = to_srgb(colors.point(at));
                    builder.colored_position(world, color)
                }
                None => builder.position(world),
            };
        }
        let turn = placed.inverse().transpose();
        let mirrored = placed.determinant() < 0.0;
        // The first material is the one of triangles without.
        let material = match (primitive.material, &colors) {
            (Some(material), _) if material < self.document.materials.len() => material as u32 + 1,
            // The builder warns of it.
            (Some(_), _) => u32::MAX,
            (None, None) => 0,
            (None, Some(_)) => {
                let new = || builder.material(Material::vertex_colors());
                *self.white.get_or_insert_with(new)
            }
        };
        let places = self.places(primitive, material, builder)?;
        let uvs = places.as_ref().map(|places| &places.uvs);
        let mut given = [normals.as_ref(), colors.as_ref(), uvs]
            .into_iter()
            .flatten();
        let told = "primitives have fewer normals, colours or texture coordinates than positions";
        self.left_out(given.any(|of| of.count < positions.count), told);
        for number in 0..triangles {
            let mut at = match primitive.mode.unwrap_or(4) {
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
                let index = indices.as_ref().map_or(Some(at as u32), |i| i.index(at));
                let sound = index.filter(|&index| (index as usize) < positions.count);
                *corner = sound.ok_or_else(|| {
                    let expected = format!("indices from 0 to {}", positions.count as i64 - 1);
                    let found = index.map(|index| index.to_string());
                    let found = found.as_deref().unwrap_or("a number of another kind");
                    broken("mesh", mesh, &expected, found)
                })?;
            }
            let given = normals.as_ref().map(|normals| {
                triangle.map(|at| {
                    let normal = turn.transform_vector3(normals.point(at as usize));
                    normal.normalize_or_zero().as_vec3().to_array()
                })
            });
            let places = places.as_ref().map(|places| places.of(triangle));
            let corners = triangle.map(|i| base + i);
            let _ = builder.textured_triangle(corners, given, material, places);
        }
        Ok(())
    }
}

fn transform(node: &Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix);
    }
    placed(
        DVec3::from_array(node.scale.unwrap_or([1.0; 3])),
        DQuat::from_array(node.rotation.unwrap_or_default()),
        DVec3::from_array(node.translation.unwrap_or_default()),
    )
}

/// Scaled, turned and moved, in this order. A quaternion without length turns nothing.
fn placed(scale: DVec3, turn: DQuat, moved: DVec3) -> DMat4 {
    let is_sound = turn.length_squared() > 0.0 && turn.is_finite();
    let turn = if is_sound {
        turn.normalize()
    } else {
        DQuat::IDENTITY
    };
    DMat4::from_scale_rotation_translation(scale, turn, moved)
}

fn too_many() -> Problem {
    let expected = format!("at most {TRIANGLES_A_BYTE} triangles for a byte of the file");
    too_large(expected, "more: they show meshes very often".to_owned())
}

fn too_large(expected: String, found: String) -> Problem {
    let advice = "export a part of the scene";
    Problem::Limit(Fault::new("nodes", Place::Whole, expected, found, advice))
}

/// Of the texture's texels, whose opacity the material's multiplies.
fn alpha_mode(material: &FileMaterial) -> AlphaMode {
    let factor = material.base().base_color_factor;
    match material.alpha_mode.as_deref() {
        Some("BLEND") => AlphaMode::Blend,
        Some("MASK") => {
            let [.., alpha] = factor.unwrap_or([1.0; 4]);
            AlphaMode::Mask(material.alpha_cutoff.unwrap_or(0.5) / alpha)
        }
        _ => AlphaMode::Opaque,
    }
}

fn understood(material: &FileMaterial) -> Material {
    let factor = material.base().base_color_factor;
    let [r, g, b, a] = factor.unwrap_or([1.0; 4]);
    let alpha = match material.alpha_mode.as_deref() {
        Some("BLEND") => a,
        // Written so that an alpha that is no number is opaque.
        Some("MASK") if a < material.alpha_cutoff.unwrap_or(0.5) => 0.0,
        _ => 1.0,
    };
    Material::of_numbers(material.name.clone(), [r, g, b], ColorSpace::Linear, alpha)
}
