//! Opaque voxels and triangles, with a depth buffer.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::cut::Chosen;
use super::splat::Places;
use super::{FarCounts, Opacity, Pixel, ViewOptions};
use crate::far::record::{LeafTriangle, OPACITY_BYTES, RECORD_BYTES, Voxel};
use crate::far::store::{FarFile, NodeData};
use crate::geometry::point;
use crate::raster::{self, NOTHING, Pattern, RasterCamera, RasterOptions, Samples};
use crate::view_error::ViewError;
use crate::{Surface, Texture, Triangle, srgb_to_linear};
use shiftvox::graph::{PackedNormal, Silent};

const EMPTY: u64 = (f32::INFINITY.to_bits() as u64) << 32 | u32::MAX as u64;

/// Neighbouring pixels mostly show one node.
const RESOLVED: usize = 1 << 12;

/// For each pixel depth (bits of a positive `f32`) and number of the nearest voxel or triangle.
pub(super) struct Opaque<'f> {
    file: &'f FarFile,
    view: RasterCamera,
    options: ViewOptions,
    words: Vec<AtomicU64>,
    /// Of the triangles.
    colors: Vec<[u8; 4]>,
}

impl<'f> Opaque<'f> {
    /// Draws what is opaque of some nodes, in any order.
    pub(super) fn draw(
        file: &'f FarFile,
        view: &RasterCamera,
        options: &ViewOptions,
        nodes: &[Chosen],
        counts: &mut FarCounts,
    ) -> Result<Self, ViewError> {
        view.check()?;
        let pixels = view.width as usize * view.height as usize;
        let mut picture = Self {
            file,
            view: *view,
            options: *options,
            words: (0..pixels).map(|_| AtomicU64::new(EMPTY)).collect(),
            colors: Vec::new(),
        };
        let drawn = nodes.par_iter().map(|node| picture.voxels(node.number));
        let drawn = drawn.collect::<Result<Vec<u64>, ViewError>>()?;
        counts.opaque_voxels = drawn.iter().sum();
        let with_surface = nodes.iter().map(|node| node.number);
        let has_surface = |&number: &usize| file.nodes()[number].surface > 0;
        let mut with_surface: Vec<usize> = with_surface.filter(has_surface).collect();
        with_surface.sort_unstable();
        if !with_surface.is_empty() {
            counts.triangles = picture.surfaces(&with_surface)?;
        }
        Ok(picture)
    }

    fn voxels(&self, number: usize) -> Result<u64, ViewError> {
        let places = Places::of(&self.file.nodes()[number], self.file.settings.centre);
        let mut id = self.file.first_voxel[number];
        let mut drawn = 0;
        let width = self.view.width as usize;
        let data = self.file.data(number)?;
        for (list, records) in data.lists().into_iter().enumerate() {
            let is_opaque = OPACITY_BYTES[list] == 0 || self.options.opacity == Opacity::None;
            for record in records.chunks_exact(RECORD_BYTES[list]) {
                let number = id;
                id += 1;
                if !is_opaque && !Voxel::is_partly_solid(list, record) {
                    continue;
                }
                let Some(square) = places.square(&self.view, record) else {
                    continue;
                };
                let seen_opacity = || {
                    let voxel = Voxel::read(list, record);
                    voxel.opacity_from(square.towards_eye, self.options.opacity)
                };
                if !is_opaque && seen_opacity() < 1.0 {
                    continue;
                }
                drawn += 1;
                let depth = (square.depth as f32).to_bits();
                let word = u64::from(depth) << 32 | u64::from(number);
                let hexagon = places.hexagon(&self.view, &square);
                let [columns, rows] = hexagon.pixels(&self.view);
                for y in rows {
                    for x in columns.clone() {
                        if hexagon.holds(x, y) {
                            self.put(y * width + x, word);
                        }
                    }
                }
            }
        }
        Ok(drawn)
    }

    fn put(&self, pixel: usize, word: u64) {
        // Mostly hidden: reading alone does not take the line from other threads.
        if self.words[pixel].load(Ordering::Relaxed) > word {
            self.words[pixel].fetch_min(word, Ordering::Relaxed);
        }
    }

    fn surfaces(&mut self, nodes: &[usize]) -> Result<u64, ViewError> {
        let surface = Surfaces::of(self.file, nodes)?;
        let options = RasterOptions {
            samples: Samples::new(0, Pattern::Regular),
            light: self.options.light,
            background: None,
        };
        let depths = self.depths();
        let drawn = raster::draw_before(&surface, &self.view, &options, Some(&depths), &Silent)?;
        for (pixel, &at) in drawn.seen.iter().enumerate() {
            if at != NOTHING {
                let id = self.file.voxels() + surface.places[at as usize].2;
                let depth = drawn.depth[pixel].to_bits();
                // The rasteriser has compared depths.
                *self.words[pixel].get_mut() = u64::from(depth) << 32 | u64::from(id);
            }
        }
        self.colors = drawn.rgba;
        Ok(surface.places.len() as u64)
    }

    pub(super) fn depths(&self) -> Vec<f32> {
        let depth = |word: &AtomicU64| f32::from_bits((word.load(Ordering::Relaxed) >> 32) as u32);
        self.words.iter().map(depth).collect()
    }

    pub(super) fn nodes(&self) -> Vec<u32> {
        let voxels = self.file.voxels();
        let node = |word: &AtomicU64| {
            let word = word.load(Ordering::Relaxed);
            let node = match word as u32 {
                _ if word == EMPTY => return NOTHING,
                id if id < voxels => last_from(&self.file.first_voxel, id),
                id => last_from(&self.file.first_triangle, id - voxels),
            };
            node as u32
        };
        self.words.iter().map(node).collect()
    }

    pub(super) fn resolve(&self) -> Vec<Pixel> {
        let pixels = (0..self.words.len()).into_par_iter();
        let pixels = pixels.with_min_len(RESOLVED);
        pixels
            .map_init(|| None, |last, pixel| self.pixel(pixel, last))
            .collect()
    }

    /// Lays triangles that let light through over pixels of voxels. Over triangles, they are in the colours already.
    pub(super) fn lay_glass(&self, pixels: &mut [Pixel]) {
        let voxels = self.file.voxels();
        for ((pixel, color), word) in pixels.iter_mut().zip(&self.colors).zip(&self.words) {
            let word = word.load(Ordering::Relaxed);
            let [r, g, b, alpha] = *color;
            if alpha > 0 && (word == EMPTY || (word as u32) < voxels) {
                let cover = f32::from(alpha) / 255.0;
                let glass = [r, g, b].map(srgb_to_linear);
                for (light, glass) in pixel.light.iter_mut().zip(glass) {
                    *light = glass * cover + *light * (1.0 - cover);
                }
                pixel.coverage = cover + pixel.coverage * (1.0 - cover);
            }
        }
    }

    /// `last`: the node whose data was needed last.
    fn pixel(&self, pixel: usize, last: &mut Option<(usize, Arc<NodeData>)>) -> Pixel {
        let word = self.words[pixel].load(Ordering::Relaxed);
        if word == EMPTY {
            return Pixel {
                depth: f32::INFINITY,
                ..Pixel::default()
            };
        }
        let (id, voxels) = (word as u32, self.file.voxels());
        Pixel {
            light: match id < voxels {
                true => self.voxel_light(id, last),
                false => {
                    let [r, g, b, _] = self.colors[pixel];
                    [r, g, b].map(srgb_to_linear)
                }
            },
            coverage: 1.0,
            depth: f32::from_bits((word >> 32) as u32),
        }
    }

    fn voxel_light(&self, id: u32, last: &mut Option<(usize, Arc<NodeData>)>) -> [f32; 3] {
        let number = last_from(&self.file.first_voxel, id);
        if last.as_ref().is_none_or(|(node, _)| *node != number) {
            // The node was drawn, so its data is sound.
            *last = self.file.data(number).ok().map(|data| (number, data));
        }
        let Some((_, data)) = last else {
            return [0.0; 3];
        };
        let mut rest = (id - self.file.first_voxel[number]) as usize;
        for (list, records) in data.lists().into_iter().enumerate() {
            let count = records.len() / RECORD_BYTES[list];
            if rest < count {
                let voxel = Voxel::read(list, &records[rest * RECORD_BYTES[list]..]);
                let places = Places::of(&self.file.nodes()[number], self.file.settings.centre);
                let towards_eye = places.towards_eye(&self.view, &voxel.place);
                return light_of(&voxel, towards_eye, &self.options);
            }
            rest -= count;
        }
        [0.0; 3]
    }
}

/// The node that an item belongs to.
fn last_from(first: &[u32], item: u32) -> usize {
    let after = first.partition_point(|&first| first <= item);
    after.saturating_sub(1)
}

pub(super) fn light_of(voxel: &Voxel, towards_eye: DVec3, options: &ViewOptions) -> [f32; 3] {
    let (normal, color) = voxel.shader.seen_from(towards_eye);
    let share = options.light.as_ref().map_or(1.0, |light| light.on(normal));
    (color * share).as_vec3().to_array()
}

struct Surfaces<'f> {
    file: &'f FarFile,
    /// Nothing if no node has textures.
    textures: &'f [Arc<Texture>],
    data: Vec<Arc<NodeData>>,
    /// Node among these, place in it, number in the file.
    places: Vec<(u32, u32, u32)>,
}

impl<'f> Surfaces<'f> {
    fn of(file: &'f FarFile, nodes: &[usize]) -> Result<Self, ViewError> {
        let is_painted = |&node: &usize| file.nodes()[node].is_painted == 1;
        let mut surface = Self {
            file,
            textures: match nodes.iter().any(is_painted) {
                true => file.textures()?,
                false => &[],
            },
            data: Vec::with_capacity(nodes.len()),
            places: Vec::new(),
        };
        for &node in nodes {
            let first = file.first_triangle[node];
            let number = surface.data.len() as u32;
            let places = (0..file.nodes()[node].surface).map(|at| (number, at, first + at));
            surface.places.extend(places);
            surface.data.push(file.data(node)?);
        }
        Ok(surface)
    }

    fn triangle_at(&self, at: usize) -> &LeafTriangle {
        let (node, place, _) = self.places[at];
        &self.data[node as usize].triangles()[place as usize]
    }
}

impl Surface for Surfaces<'_> {
    fn len(&self) -> usize {
        self.places.len()
    }

    fn corners(&self, number: usize) -> [DVec3; 3] {
        let centre = self.file.settings.centre;
        let corners = self.triangle_at(number).corners;
        corners.map(|p| point(p) + centre)
    }

    fn triangle(&self, number: usize) -> Triangle<'_> {
        let stored = self.triangle_at(number);
        let normal = |n: u16| PackedNormal(n).decode().unwrap_or(DVec3::Z);
        Triangle {
            corners: Surface::corners(self, number),
            normals: stored.normals.map(normal),
            colors: stored.colors.map(crate::material::to_light),
            alpha: stored.paint.opacity(),
            sampler: stored.paint.sampler(self.textures),
        }
    }

    fn is_opaque(&self, number: usize) -> bool {
        self.triangle_at(number).paint.is_opaque(self.textures)
    }

    fn bounds(&self) -> (DVec3, DVec3) {
        self.file.bounds()
    }
}
