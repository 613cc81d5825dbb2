//! One bin: its samples' depths and triangles, then its pixels.
//!
//! A triangle that lets light through at a sample is a layer, and not in the depth buffer. Layers are sorted, and blended
//! from the front to the back, when all triangles are known.

use std::cmp::Ordering;
use std::collections::HashMap;

use glam::DVec3;

use super::bins::{BIN, Bins};
use super::clip::Outline;
use super::edges::{Cover, Edges};
use super::samples::{Places, SUBPIXELS};
use super::shade::{Nearness, Paint, Seen, Side, light_of, point_seen};
use super::{NOTHING, RasterCamera, RasterOptions, RasterPicture};
use crate::Surface;
use crate::material::{to_light, to_srgb};

#[derive(Debug, Clone, Copy)]
struct Pixel {
    rgba: [u8; 4],
    coverage: f32,
    depth: f32,
    triangle: u32,
}

pub(super) struct Bin {
    corner: [u32; 2],
    columns: u32,
    pixels: Vec<Pixel>,
}

struct Buffer<'b> {
    view: &'b RasterCamera,
    options: &'b RasterOptions,
    corner: [u32; 2],
    columns: u32,
    rows: u32,
    places: Places,
    /// One over the depth of the nearest triangle so far; 0 where there is none.
    nearness: Vec<f64>,
    /// Whether that triangle faces the eye.
    faces_eye: Vec<bool>,
    triangle: Vec<u32>,
    layers: Vec<Layer>,
    /// Of a sample, in pixels.
    width: f64,
    /// See [`rounding`].
    rounding: f64,
}

/// A triangle that lets light through at a sample.
#[derive(Debug, Clone, Copy)]
struct Layer {
    sample: u32,
    triangle: u32,
    nearness: f64,
    side: Side,
    opacity: f64,
}

/// A distance within which points are the same. Files round coordinates to single precision, `.far` from the middle of
/// the box and `.tvx` from the origin. That moves a point by at most 2^-24 of its distance, and two points apart by 2^-23.
/// Twice this is to spare. Coordinates far from the origin get less, because true layers would be hidden.
fn rounding((low, high): (DVec3, DVec3)) -> f64 {
    let farthest = low.abs().max(high.abs()).length();
    (farthest / f64::from(1 << 22)).min((high - low).length() / f64::from(1 << 19))
}

impl Bin {
    pub(super) fn draw(
        surface: &dyn Surface,
        view: &RasterCamera,
        options: &RasterOptions,
        bins: &Bins,
        number: usize,
        depths: Option<&[f32]>,
    ) -> Self {
        let corner = bins.corner(number);
        let columns = BIN.min(view.width - corner[0]);
        let rows = BIN.min(view.height - corner[1]);
        let samples = (columns * rows) as usize * options.samples.per_pixel();
        let mut buffer = Buffer {
            view,
            options,
            corner,
            columns,
            rows,
            places: Places::new(&options.samples, corner, columns, rows),
            nearness: vec![0.0; samples],
            faces_eye: vec![true; samples],
            triangle: vec![NOTHING; samples],
            layers: Vec::new(),
            width: 1.0 / (options.samples.per_pixel() as f64).sqrt(),
            rounding: rounding(surface.bounds()),
        };
        if let Some(depths) = depths {
            let per_pixel = options.samples.per_pixel();
            for (i, samples) in buffer.nearness.chunks_exact_mut(per_pixel).enumerate() {
                let [x, y] = [i as u32 % columns, i as u32 / columns];
                let at = (corner[1] + y) as usize * view.width as usize + (corner[0] + x) as usize;
                samples.fill(1.0 / f64::from(depths[at]));
            }
        }
        for triangle in bins.triangles(number) {
            buffer.triangle(surface, triangle);
        }
        Self {
            corner,
            columns,
            pixels: buffer.resolve(surface),
        }
    }

    pub(super) fn store(&self, picture: &mut RasterPicture) {
        for (i, pixel) in self.pixels.iter().enumerate() {
            let (column, row) = (i as u32 % self.columns, i as u32 / self.columns);
            let x = (self.corner[0] + column) as usize;
            let y = (self.corner[1] + row) as usize;
            let at = y * picture.width as usize + x;
            picture.rgba[at] = pixel.rgba;
            picture.coverage[at] = pixel.coverage;
            picture.depth[at] = pixel.depth;
            picture.seen[at] = pixel.triangle;
        }
    }
}

impl Buffer<'_> {
    fn triangle(&mut self, surface: &dyn Surface, number: u32) {
        let corners = surface.corners(number as usize);
        let Some(outline) = Outline::of(self.view, &corners) else {
            return;
        };
        let nearness = Nearness::of(self.view, &corners, self.rounding);
        let [low, high] = outline.pixels();
        let points = outline.points();
        for pair in points[1..].windows(2) {
            let Some(edges) = Edges::new([points[0], pair[0], pair[1]]) else {
                continue;
            };
            self.part(surface, number, &edges, &nearness, [low, high]);
        }
    }

    fn part(
        &mut self,
        surface: &dyn Surface,
        number: u32,
        edges: &Edges,
        nearness: &Nearness,
        [low, high]: [[i64; 2]; 2],
    ) {
        let is_textured = surface.is_textured(number as usize);
        let is_opaque = surface.is_opaque(number as usize);
        let clear = (!is_opaque).then(|| Seen::of(self.view, surface.triangle(number as usize)));
        let corner = self.corner.map(i64::from);
        let size = [self.columns, self.rows].map(i64::from);
        let begin = [0, 1].map(|k| low[k].max(corner[k]));
        let end = [0, 1].map(|k| high[k].min(corner[k] + size[k] - 1));
        let per_pixel = self.options.samples.per_pixel();
        for y in begin[1]..=end[1] {
            for x in begin[0]..=end[0] {
                let here = edges.seen_from([x, y]);
                let cover = here.cover();
                if cover == Cover::Nothing {
                    continue;
                }
                let pixel = ((y - corner[1]) * size[0] + (x - corner[0])) as usize;
                let at = pixel * per_pixel;
                for (sample, place) in self.places.of(pixel).iter().enumerate() {
                    let place = place.map(i64::from);
                    if cover == Cover::Part && !here.covers(place) {
                        continue;
                    }
                    let [sample_x, sample_y] =
                        [x * SUBPIXELS + place[0], y * SUBPIXELS + place[1]].map(|c| c as f64);
                    let near = nearness.at(sample_x, sample_y);
                    let order = self.order(at + sample, near, nearness.side);
                    // Glass at the depth of an opaque triangle lies on it.
                    let is_seen = match is_opaque {
                        true => order == Ordering::Greater,
                        false => order != Ordering::Less,
                    };
                    if is_seen {
                        if is_textured {
                            let point = point_seen(self.view, sample_x, sample_y, 1.0 / near);
                            if surface.texture(number as usize, point).is_none() {
                                continue;
                            }
                        }
                        if let Some(triangle) = &clear {
                            let point = point_seen(self.view, sample_x, sample_y, 1.0 / near);
                            let shares = triangle.shares(point);
                            let side = self.width / (near * self.view.focal_px);
                            let opacity = triangle.opacity(shares, side);
                            if opacity < 1.0 {
                                self.layers.extend((opacity > 0.0).then_some(Layer {
                                    sample: (at + sample) as u32,
                                    triangle: number,
                                    nearness: near,
                                    side: nearness.side,
                                    opacity,
                                }));
                                continue;
                            }
                        }
                        // The opaque part of a clear triangle lies on an opaque one, too.
                        let known = self.triangle[at + sample] as usize;
                        if order == Ordering::Equal && !surface.is_opaque(known) {
                            continue;
                        }
                        self.nearness[at + sample] = near;
                        self.faces_eye[at + sample] = nearness.side.faces_eye;
                        self.triangle[at + sample] = number;
                    }
                }
            }
        }
    }

    /// Compares something with the opaque triangle of a sample so far: greater counts before it. At one depth a triangle
    /// that faces the eye counts before one that turns its back. Triangles come in the order of their numbers, and so what
    /// counts is never farther behind the nearest than by three times the slack.
    #[inline]
    fn order(&self, at: usize, nearness: f64, side: Side) -> Ordering {
        let known = self.nearness[at];
        if nearness > known * (1.0 + side.slack) {
            Ordering::Greater
        } else if nearness < known * (1.0 - side.slack) {
            Ordering::Less
        } else {
            side.faces_eye.cmp(&self.faces_eye[at])
        }
    }

    fn resolve(mut self, surface: &dyn Surface) -> Vec<Pixel> {
        let mut layers = std::mem::take(&mut self.layers);
        layers.retain(|l| self.order(l.sample as usize, l.nearness, l.side) != Ordering::Less);
        layers.sort_unstable_by(|a, b| {
            let nearest_first = b.nearness.total_cmp(&a.nearness);
            let order = a.sample.cmp(&b.sample).then(nearest_first);
            order.then(a.triangle.cmp(&b.triangle))
        });
        let mut layers = layers.chunk_by(|a, b| a.sample == b.sample).peekable();
        let mut paints = Paints {
            buffer: &self,
            surface,
            known: HashMap::new(),
            last: None,
        };
        let background = self.options.background.map(to_light);
        let per_pixel = self.options.samples.per_pixel();
        let middle = self.options.samples.middle();
        let pixels = (0..(self.columns * self.rows) as usize).map(|i| {
            let mut sum = DVec3::ZERO;
            let mut seen = 0.0;
            for at in i * per_pixel..(i + 1) * per_pixel {
                let mut passing = 1.0;
                let mut behind = layers
                    .next_if(|l| l[0].sample as usize == at)
                    .unwrap_or(&[]);
                while let Some(nearest) = behind.first() {
                    let is_same = |l: &Layer| l.nearness >= nearest.nearness * (1.0 - l.side.slack);
                    let count = behind.iter().take_while(|l| is_same(l)).count();
                    let (same, rest) = behind.split_at(count);
                    let layer = same.iter().min_by_key(|l| (!l.side.faces_eye, l.triangle));
                    let layer = layer.unwrap_or(nearest);
                    let light = paints.light(layer.triangle, at, layer.nearness);
                    sum += light * (passing * layer.opacity);
                    passing *= 1.0 - layer.opacity;
                    behind = rest;
                }
                let number = self.triangle[at];
                if number != NOTHING {
                    sum += paints.light(number, at, self.nearness[at]) * passing;
                    passing = 0.0;
                }
                seen += 1.0 - passing;
            }
            let at = i * per_pixel + middle;
            let nearness = self.nearness[at];
            Pixel {
                rgba: mixed(sum, seen, per_pixel as f64, background),
                coverage: (seen / per_pixel as f64) as f32,
                depth: (1.0 / nearness) as f32,
                triangle: self.triangle[at],
            }
        });
        pixels.collect()
    }
}

/// The light of triangles at samples. Each triangle is prepared once.
struct Paints<'b, 's> {
    buffer: &'b Buffer<'b>,
    surface: &'s dyn Surface,
    known: HashMap<u32, Paint<'s>>,
    last: Option<(u32, Paint<'s>)>,
}

impl Paints<'_, '_> {
    fn light(&mut self, number: u32, at: usize, nearness: f64) -> DVec3 {
        let (buffer, surface) = (self.buffer, self.surface);
        let (view, light) = (buffer.view, buffer.options.light.as_ref());
        let per_pixel = buffer.options.samples.per_pixel();
        let (i, sample) = (at / per_pixel, at % per_pixel);
        let pixel = [i as u32 % buffer.columns, i as u32 / buffer.columns];
        let place = buffer.places.of(i)[sample];
        let [x, y] = [0, 1].map(|k| {
            let pixel = buffer.corner[k] + pixel[k];
            f64::from(pixel) * SUBPIXELS as f64 + f64::from(place[k])
        });
        let depth = 1.0 / nearness;
        let is_last = self.last.as_ref().is_some_and(|(of, _)| *of == number);
        if !is_last && surface.is_textured(number as usize) {
            let point = point_seen(view, x, y, depth);
            let look = surface.texture(number as usize, point);
            return look.map_or(DVec3::ZERO, |look| light_of(view, light, point, look));
        }
        if !is_last {
            let paint = || Paint::of(view, surface.triangle(number as usize), light);
            self.last = Some((number, *self.known.entry(number).or_insert_with(paint)));
        }
        let paint = self.last.as_ref().map(|(_, paint)| paint);
        let light_of = |paint: &Paint<'_>| paint.light(view, light, [x, y], depth, buffer.width);
        paint.map_or(DVec3::ZERO, light_of)
    }
}

/// The colour of a pixel. `sum` is the premultiplied linear light of all its `samples`, of which `seen` see something, a
/// fraction where that lets light through. `background` is linear light, too.
pub(crate) fn mixed(sum: DVec3, seen: f64, samples: f64, background: Option<DVec3>) -> [u8; 4] {
    let (mean, alpha) = match background {
        Some(background) => {
            let behind = background * (samples - seen);
            ((sum + behind) / samples, 255)
        }
        None if seen <= 0.0 => return [0; 4],
        None => (sum / seen, (255.0 * seen / samples + 0.5) as u8),
    };
    let [r, g, b] = to_srgb(mean);
    [r, g, b, alpha]
}
