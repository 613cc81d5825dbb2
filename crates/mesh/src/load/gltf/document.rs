//! The parts of a glTF document that are read.

use std::collections::HashMap;

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;

use super::{EXPORT, broken, fault_of};
use crate::load::{Fault, Place, Problem};

/// Extensions that a file may require and that change nothing that is read here.
const HARMLESS: [&str; 9] = [
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_lights_punctual",
    // Pictures that are not read cause a warning each.
    "KHR_texture_basisu",
    "EXT_texture_webp",
    "EXT_texture_avif",
    "MSFT_texture_dds",
    "EXT_mesh_gpu_instancing",
    "KHR_node_visibility",
];

const UNPACK: &str = "unpack it: gltf-transform cp IN OUT";

const COMPRESSED: [&str; 3] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
];

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Document {
    asset: Asset,
    pub(super) scene: Option<usize>,
    pub(super) scenes: Vec<Scene>,
    pub(super) nodes: Vec<Node>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) materials: Vec<Material>,
    pub(super) textures: Vec<Texture>,
    pub(super) samplers: Vec<Sampler>,
    pub(super) images: Vec<Image>,
    pub(super) accessors: Vec<Accessor>,
    pub(super) buffer_views: Vec<BufferView>,
    pub(super) buffers: Vec<Buffer>,
    extensions_required: Vec<String>,
    extensions_used: Vec<String>,
}

#[derive(Debug, Default, Deserialize)]
struct Asset {
    version: String,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Scene {
    pub(super) nodes: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub(super) children: Vec<usize>,
    pub(super) mesh: Option<usize>,
    pub(super) skin: Option<usize>,
    pub(super) matrix: Option<[f64; 16]>,
    pub(super) translation: Option<[f64; 3]>,
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
    pub(super) extensions: NodeExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(super) instances: Option<Instances>,
    #[serde(rename = "KHR_node_visibility")]
    pub(super) visibility: Option<Visibility>,
}

/// Of a node with all below it. Visible if not said.
#[derive(Debug, Deserialize)]
pub(super) struct Visibility {
    pub(super) visible: Option<bool>,
}

/// Accessors by their names, of two the last. Some exporters write `null` for an attribute that is not there.
pub(super) type Attributes = HashMap<String, Option<usize>>;

/// Accessors of `TRANSLATION`, `ROTATION` and `SCALE` of each instance.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Instances {
    pub(super) attributes: Attributes,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Mesh {
    pub(super) primitives: Vec<Primitive>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Primitive {
    pub(super) attributes: Attributes,
    pub(super) indices: Option<usize>,
    pub(super) material: Option<usize>,
    pub(super) mode: Option<u32>,
    pub(super) targets: Vec<IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Material {
    pub(super) name: String,
    pbr_metallic_roughness: Pbr,
    extensions: MaterialExtensions,
    pub(super) alpha_mode: Option<String>,
    pub(super) alpha_cutoff: Option<f32>,
    emissive_factor: Value,
}

impl Material {
    /// The base colour, or the diffuse one of the older extension.
    pub(super) fn base(&self) -> &Pbr {
        let older = self.extensions.specular_glossiness.as_ref();
        older.unwrap_or(&self.pbr_metallic_roughness)
    }

    pub(super) fn emits_light(&self) -> bool {
        let mut factor = self.emissive_factor.as_array().into_iter().flatten();
        factor.any(|factor| factor.as_f64() > Some(0.0))
    }

    pub(super) fn transmits_light(&self) -> bool {
        let of = &self.extensions;
        let factors = [
            &of.transmission["transmissionFactor"],
            &of.diffuse_transmission["diffuseTransmissionFactor"],
        ];
        factors.iter().any(|factor| factor.as_f64() > Some(0.0))
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct MaterialExtensions {
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    specular_glossiness: Option<Pbr>,
    #[serde(rename = "KHR_materials_transmission")]
    transmission: Value,
    #[serde(rename = "KHR_materials_diffuse_transmission")]
    diffuse_transmission: Value,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Pbr {
    #[serde(alias = "diffuseFactor")]
    pub(super) base_color_factor: Option<[f32; 4]>,
    #[serde(alias = "diffuseTexture")]
    pub(super) base_color_texture: Option<TextureInfo>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureInfo {
    pub(super) index: usize,
    #[serde(default)]
    pub(super) tex_coord: usize,
    #[serde(default)]
    pub(super) extensions: TextureExtensions,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct TextureExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub(super) transform: Option<TextureTransform>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct TextureTransform {
    pub(super) offset: Option<[f64; 2]>,
    pub(super) rotation: f64,
    pub(super) scale: Option<[f64; 2]>,
    pub(super) tex_coord: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Texture {
    source: Option<usize>,
    pub(super) sampler: Option<usize>,
    pub(super) extensions: Value,
}

impl Texture {
    /// Numbers of its pictures, the better first: WebP, and PNG or JPEG.
    pub(super) fn pictures(&self) -> impl Iterator<Item = usize> {
        let webp = self.extensions["EXT_texture_webp"]["source"].as_u64();
        let webp = webp.and_then(|number| number.try_into().ok());
        webp.into_iter().chain(self.source)
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Sampler {
    pub(super) wrap_s: u32,
    pub(super) wrap_t: u32,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Image {
    pub(super) uri: Option<String>,
    pub(super) buffer_view: Option<usize>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: u64,
    #[serde(rename = "type")]
    pub(super) shape: String,
    pub(super) sparse: Option<Sparse>,
}

/// Elements that differ from the accessor's buffer view, or from 0.
#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) indices: SparsePart,
    pub(super) values: SparsePart,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: Option<u32>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: Option<u64>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
    pub(super) byte_length: u64,
}

impl Document {
    pub(super) fn check(&self) -> Result<(), Problem> {
        let (version, extensions) = (&self.asset.version, &self.extensions_required);
        let is_known = |name: &str| HARMLESS.contains(&name) || name.starts_with("KHR_materials_");
        let (part, expected, found, advice) = if !version.starts_with("2.") {
            ("asset", "version 2", version, EXPORT)
        } else if let Some(unknown) = extensions.iter().find(|name| !is_known(name)) {
            let expected = "no extension that has to be understood";
            let advice = match COMPRESSED.contains(&unknown.as_str()) {
                true => UNPACK,
                false => "export without it",
            };
            ("extensionsRequired", expected, unknown, advice)
        } else {
            return Ok(());
        };
        Err(Fault::new(part, Place::Whole, expected, found.clone(), advice).into())
    }

    /// The error where a part has no data. That of compressed meshes is elsewhere.
    pub(super) fn no_data(&self, part: &str, number: usize, expected: &str) -> Problem {
        let mut used = self.extensions_used.iter();
        match used.find(|name| COMPRESSED.contains(&name.as_str())) {
            Some(name) => fault_of(part, number, expected, &format!("that of {name}"), UNPACK),
            None => broken(part, number, expected, "none"),
        }
    }
}
