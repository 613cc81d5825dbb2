//! The pictures of base colours.

use std::io::{self, ErrorKind};
use std::sync::Arc;

use super::accessor::{Numbers, view_bytes};
use super::document::{Document, TextureTransform};
use super::{Beside, Buffers, decoded, unescaped};
use crate::Texture;
use crate::load::texture::{Parts, Textures};
use crate::texture::{AlphaMode, Wrap};

/// Places of vertices in the picture of their material.
pub(super) struct Places<'d> {
    pub(super) uvs: Numbers<'d>,
    pub(super) transform: Option<&'d TextureTransform>,
}

impl Places<'_> {
    pub(super) fn of(&self, corners: [u32; 3]) -> [[f64; 2]; 3] {
        corners.map(|corner| {
            let uv = [0, 1].map(|k| f64::from(self.uvs.real(corner as usize, k)));
            self.transform.map_or(uv, |transform| moved(uv, transform))
        })
    }
}

/// Scaled, turned and moved, in this order: `KHR_texture_transform`.
fn moved([u, v]: [f64; 2], transform: &TextureTransform) -> [f64; 2] {
    let scale = transform.scale.unwrap_or([1.0; 2]);
    let offset = transform.offset.unwrap_or_default();
    let (u, v) = (u * scale[0], v * scale[1]);
    let (sin, cos) = (libm::sin(transform.rotation), libm::cos(transform.rotation));
    [cos * u + sin * v + offset[0], cos * v - sin * u + offset[1]]
}

fn wrap(number: u32) -> Wrap {
    match number {
        33071 => Wrap::Clamp,
        33648 => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

pub(super) fn find(
    document: &Document,
    buffers: &Buffers<'_>,
    beside: &Beside<'_>,
    (texture, mode): (usize, AlphaMode),
    textures: &mut Textures,
) -> Option<Arc<Texture>> {
    let found = document.textures.get(texture);
    let sampler = found.and_then(|texture| document.samplers.get(texture.sampler?));
    let pictures = found.into_iter().flat_map(|texture| texture.pictures());
    let images = pictures.filter_map(|number| Some((number, document.images.get(number)?)));
    let mut images: Vec<_> = images.map(Some).collect();
    if images.is_empty() {
        images.push(None);
    }
    images.into_iter().find_map(|image| {
        let (number, image) = image.unzip();
        let uri = image.and_then(|image| image.uri.as_deref());
        let file = uri.filter(|uri| !uri.starts_with("data:")).map(unescaped);
        let name = file.clone().unwrap_or_else(|| match number {
            Some(image) => format!("image {image}"),
            None => format!("number {texture}"),
        });
        let parts = Parts {
            color: Some(&name),
            opacity: None,
            mode,
            wrap: sampler.map_or([Wrap::Repeat; 2], |s| [s.wrap_s, s.wrap_t].map(wrap)),
        };
        textures.get(parts, |_| {
            let missing = |what: &str| io::Error::new(ErrorKind::NotFound, what.to_owned());
            let image = image.ok_or_else(|| {
                let others = found.and_then(|texture| texture.extensions.as_object());
                let mut others = others.into_iter().flat_map(|others| others.keys());
                let other = others.find(|name| *name != "EXT_texture_webp");
                let other = other.map_or(String::new(), |name| {
                    let command = match &name[..] {
                        "KHR_texture_basisu" => "ktxdecompress",
                        _ => "png --formats \"*\"",
                    };
                    format!(", but that of {name}; convert it with gltf-transform {command}")
                });
                missing(&format!("it has no picture of PNG, JPEG or WebP{other}"))
            })?;
            match (&file, uri) {
                (Some(file), _) => beside(file),
                (None, Some(uri)) => {
                    decoded(uri).ok_or_else(|| missing("its data is not in base64"))
                }
                (None, None) => {
                    let view = image.buffer_view.and_then(|v| document.buffer_views.get(v));
                    let bytes = view.and_then(|view| view_bytes(view, buffers));
                    let bytes = bytes.ok_or_else(|| missing("it is not in its buffer"))?;
                    Ok(bytes.to_vec())
                }
            }
        })
    })
}
