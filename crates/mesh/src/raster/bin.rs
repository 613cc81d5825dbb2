//! One bin: its samples' depths and triangles, then its pixels.

use glam::DVec3;

use super::bins::{BIN, Bins};
use super::clip::Outline;
use super::edges::{Cover, Edges};
use super::samples::{Places, SUBPIXELS};
use super::shade::{Nearness, Paint, light_of, point_seen};
use super::{NO_TRIANGLE, RasterCamera, RasterOptions, RasterPicture};
use crate::Surface;
use crate::material::{linear_to_srgb, srgb_to_linear};

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
    triangle: Vec<u32>,
}

impl Bin {
    pub(super) fn draw<S: Surface + ?Sized>(
        surface: &S,
        view: &RasterCamera,
        options: &RasterOptions,
        bins: &Bins,
        number: usize,
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
            triangle: vec![NO_TRIANGLE; samples],
        };
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
            picture.triangle[at] = pixel.triangle;
        }
    }
}

impl Buffer<'_> {
    fn triangle<S: Surface + ?Sized>(&mut self, surface: &S, number: u32) {
        let corners = surface.corners(number as usize);
        let Some(outline) = Outline::of(self.view, &corners) else {
            return;
        };
        let nearness = Nearness::of(self.view, &corners);
        let [low, high] = outline.pixels();
        let points = outline.points();
        for pair in points[1..].windows(2) {
            let Some(edges) = Edges::new([points[0], pair[0], pair[1]]) else {
                continue;
            };
            self.part(surface, number, &edges, &nearness, [low, high]);
        }
    }

    fn part<S: Surface + ?Sized>(
        &mut self,
        surface: &S,
        number: u32,
        edges: &Edges,
        nearness: &Nearness,
        [low, high]: [[i64; 2]; 2],
    ) {
        let is_textured = surface.is_textured(number as usize);
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
                    if near > self.nearness[at + sample] {
                        if is_textured {
                            let point = point_seen(self.view, sample_x, sample_y, 1.0 / near);
                            if surface.texture(number as usize, point).is_none() {
                                continue;
                            }
                        }
                        self.nearness[at + sample] = near;
                        self.triangle[at + sample] = number;
                    }
                }
            }
        }
    }

    fn resolve<S: Surface + ?Sized>(&self, surface: &S) -> Vec<Pixel> {
        let light = self.options.light.as_ref();
        let mut paints: std::collections::HashMap<u32, Paint> = std::collections::HashMap::new();
        let background = self
            .options
            .background
            .map(|color| DVec3::from_array(color.map(|c| f64::from(srgb_to_linear(c)))));
        let per_pixel = self.options.samples.per_pixel();
        let mut last: Option<(u32, Paint)> = None;
        let middle = self.options.samples.middle();
        (0..(self.columns * self.rows) as usize)
            .map(|i| {
                let (column, row) = (i as u32 % self.columns, i as u32 / self.columns);
                let pixel = [self.corner[0] + column, self.corner[1] + row];
                let mut sum = DVec3::ZERO;
                let mut seen = 0;
                for sample in 0..per_pixel {
                    let at = i * per_pixel + sample;
                    let number = self.triangle[at];
                    if number == NO_TRIANGLE {
                        continue;
                    }
                    seen += 1;
                    if last.as_ref().is_none_or(|(of, _)| *of != number) {
                        let paint = paints.entry(number).or_insert_with(|| {
                            Paint::of(self.view, surface.triangle(number as usize), light)
                        });
                        last = Some((number, *paint));
                    }
                    let Some((_, paint)) = &last else { continue };
                    let place = self.places.of(i)[sample];
                    let [x, y] = [0, 1]
                        .map(|k| f64::from(pixel[k]) * SUBPIXELS as f64 + f64::from(place[k]));
                    let depth = 1.0 / self.nearness[at];
                    sum += if surface.is_textured(number as usize) {
                        let point = point_seen(self.view, x, y, depth);
                        let look = surface.texture(number as usize, point);
                        look.map_or(DVec3::ZERO, |look| light_of(self.view, light, point, look))
                    } else {
                        paint.light(self.view, light, x, y, depth)
                    };
                }
                let at = i * per_pixel + middle;
                let nearness = self.nearness[at];
                Pixel {
                    rgba: mixed(sum, seen, per_pixel, background),
                    coverage: seen as f32 / per_pixel as f32,
                    depth: (1.0 / nearness) as f32,
                    triangle: self.triangle[at],
                }
            })
            .collect()
    }
}

fn mixed(sum: DVec3, seen: usize, samples: usize, background: Option<DVec3>) -> [u8; 4] {
    let (mean, alpha) = match background {
        Some(background) => {
            let behind = background * (samples - seen) as f64;
            ((sum + behind) / samples as f64, 255)
        }
        None if seen == 0 => return [0; 4],
        None => {
            let alpha = (255 * seen + samples / 2) / samples;
            (sum / seen as f64, alpha as u8)
        }
    };
    let [r, g, b] = mean.to_array().map(linear_to_srgb);
    [r, g, b, alpha]
}
