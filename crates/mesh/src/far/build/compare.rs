//! The choice among several representations of a node's triangles, by error and bytes (`spec/far.md`, Hybrid).

use std::sync::Arc;

use glam::{DVec3, DVec4};
use xxhash_rust::xxh3::xxh3_64;

use super::{BuildError, BuildOptions};
use crate::Texture;
use crate::far::record::{LeafTriangle, Node};
use crate::far::store::pack::pack;
use crate::far::store::{encode, surface};
use crate::far::view::{self, ViewOptions};
use crate::far::{FarData, FarFile};
use crate::geometry::point;
use crate::material::to_light;
use crate::raster::{Light, RasterCamera};

/// The exponent of the bytes: a candidate with 32 times the bytes must have half of the error.
const BYTES_WEIGH: f64 = 0.2;
const AMBIENT: u32 = 64;
const DISTANCE: f64 = 4.0;
/// Halves of a node's voxels across a pixel of the pictures in which candidates are compared.
pub(super) const ACROSS: u16 = 4;
const DIRECTIONS: [DVec3; 4] = [
    DVec3::new(1.0, 0.4, 0.3),
    DVec3::new(-0.5, 0.6, 1.0),
    DVec3::new(-0.8, 0.2, -0.6),
    DVec3::new(0.3, 1.0, -0.7),
];
/// Samples along each axis of a pixel: of the triangles and of a candidate.
const SAMPLES_ACROSS: [u32; 2] = [8, 4];

pub(super) struct Candidate {
    pub(super) node: Node,
    pub(super) lists: [Vec<u8>; 6],
    pub(super) triangles: Vec<LeafTriangle>,
}

pub(super) struct Judged {
    pub(super) candidate: Candidate,
    /// The root of the mean square error and of the lost share of an empty picture's.
    pub(super) error: f64,
    /// The share of coverage that is lost, mean of all views.
    pub(super) lost: f64,
    /// By error and bytes, and some bytes more: an empty candidate is not free, and few bytes more are.
    pub(super) cost: f64,
}

pub(super) struct Comparison<'o> {
    options: &'o BuildOptions,
    /// Bytes that cost nothing.
    free: f64,
    textures: &'o [Arc<Texture>],
    /// Coordinates are relative to it, so that single precision resolves the node's parts.
    middle: DVec3,
    leaf: (Node, Vec<u8>),
    views: Vec<(RasterCamera, Light, Vec<DVec4>)>,
}

impl<'o> Comparison<'o> {
    /// In pictures with `across` halves of a voxel across a pixel. With fewer than [`ACROSS`] they show a part.
    pub(super) fn of(
        node: &Node,
        triangles: &[LeafTriangle],
        options: &'o BuildOptions,
        textures: &'o [Arc<Texture>],
        free: f64,
        across: u16,
    ) -> Result<Self, BuildError> {
        let [lowest, highest] = [node.low, node.high].map(point);
        let middle = (lowest + highest) / 2.0;
        let extent = (highest - lowest).max_element();
        let Node { low, high, .. } = around(node, middle);
        let mut leaf = Node {
            low,
            high,
            is_leaf: 1,
            level: 1,
            triangles: triangles.len() as u32,
            ..bytemuck::Zeroable::zeroed()
        };
        let moved = moved(triangles, middle);
        let bytes = surface::lay_out(&mut leaf, &moved, |_| true);
        let mut of = Self {
            options,
            free,
            textures,
            middle,
            leaf: (leaf, pack(&Default::default(), &bytes)),
            views: Vec::new(),
        };
        let empty = Candidate {
            node: *node,
            lists: Default::default(),
            triangles: Vec::new(),
        };
        let (truth, _) = of.file(&empty)?;
        let half_voxel = 0.5 * f64::from(node.voxel);
        let pixel = f64::from(across) * half_voxel;
        let size = (highest - lowest).length() * 1.2;
        let side = libm::ceil(size / (f64::from(ACROSS) * half_voxel));
        // Larger pictures would take much memory: a window towards most triangles.
        let beyond = (size - side * pixel).max(0.0);
        for direction in DIRECTIONS {
            let towards = direction.normalize_or(DVec3::X);
            let forward = -towards;
            let right = forward.cross(DVec3::Y).normalize_or(DVec3::X);
            let up = right.cross(forward);
            let distance = DISTANCE * extent;
            let [aside, above] = most_of(&moved, right, up).map(|sign| 0.5 * sign * beyond);
            let view = RasterCamera {
                eye: towards * distance + right * aside + up * above,
                right,
                up,
                forward,
                focal_px: distance / pixel,
                width: side as u32,
                height: side as u32,
                near: extent * 1e-3,
            };
            let light = Light {
                towards: (towards + up * 0.7 + right * 0.4).normalize_or(up),
                ambient: AMBIENT,
            };
            let expected = draw(&truth, &view, light, SAMPLES_ACROSS[0], NO_VOXEL)?;
            of.views.push((view, light, expected));
        }
        Ok(of)
    }

    pub(super) fn judge(&self, candidate: Candidate) -> Result<Judged, BuildError> {
        let [error, lost, bytes] = self.measure(&candidate)?;
        Ok(Judged {
            candidate,
            error,
            lost,
            cost: error * libm::pow(bytes, BYTES_WEIGH),
        })
    }

    pub(super) fn error(&self, candidate: &Candidate) -> Result<f64, BuildError> {
        Ok(self.measure(candidate)?[0])
    }

    /// Error, lost share and bytes, as in [`Judged`].
    fn measure(&self, candidate: &Candidate) -> Result<[f64; 3], BuildError> {
        let (file, bytes) = self.file(candidate)?;
        let (mut squares, mut lost) = (0.0, 0.0);
        let mut of_blank = 0.0;
        for (view, light, expected) in &self.views {
            let seen = draw(&file, view, *light, SAMPLES_ACROSS[1], ANY_VOXEL)?;
            let both = seen.iter().zip(expected);
            squares += mean(both.map(|(&a, &b)| (a - b).length_squared()));
            of_blank += mean(expected.iter().map(|p| p.length_squared()));
            let [covered, all] = [&seen, expected].map(|pixels| mean(pixels.iter().map(|p| p.w)));
            if covered < all {
                lost += 1.0 - covered / all;
            }
        }
        let views = self.views.len() as f64;
        let lost = lost / views;
        // A mean of squares alone takes a blank for little worse than thin lines that are a pixel off.
        let error = libm::sqrt((squares + lost * lost * of_blank) / views);
        let bytes = bytes as f64 + size_of::<Node>() as f64 + self.free;
        Ok([error, lost, bytes])
    }

    fn file(&self, candidate: &Candidate) -> Result<(FarFile, u64), BuildError> {
        let (mut leaf, of_leaf) = (self.leaf.0, &self.leaf.1);
        let mut root = Node {
            level: 0,
            children: [1, 0],
            first_triangle: 0,
            triangles: leaf.triangles,
            ..around(&candidate.node, self.middle)
        };
        let triangles = moved(&candidate.triangles, self.middle);
        let bytes = surface::lay_out(&mut root, &triangles, |_| false);
        let mut packed = pack(&candidate.lists, &bytes);
        root.checksum = xxh3_64(&packed);
        leaf.data_at = packed.len() as u64;
        leaf.checksum = xxh3_64(of_leaf);
        packed.extend(of_leaf);
        let drawn = root.drawn_bytes();
        let data = FarData {
            settings: self.options.settings(DVec3::ZERO),
            nodes: vec![root, leaf],
            textures: Vec::new(),
            packed,
            undecimated: 0,
        };
        let encoded = encode(&data).map_err(failed)?;
        let file = FarFile::from_bytes(&encoded).map_err(failed)?;
        Ok((file.with_textures(self.textures), drawn))
    }
}

/// The signs of coordinates, along two axes, of the quarter with most triangles.
fn most_of(triangles: &[LeafTriangle], right: DVec3, up: DVec3) -> [f64; 2] {
    let mut counts = [0; 4];
    for triangle in triangles {
        let sum: DVec3 = triangle.corners.map(point).into_iter().sum();
        let bits = [right, up].map(|axis| usize::from(sum.dot(axis) > 0.0));
        counts[2 * bits[0] + bits[1]] += 1;
    }
    let most = (0..4).max_by_key(|&quarter| counts[quarter]).unwrap_or(0);
    [most / 2, most % 2].map(|bit| 2.0 * bit as f64 - 1.0)
}

fn mean(numbers: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = numbers.len().max(1) as f64;
    numbers.sum::<f64>() / count
}

fn failed(error: impl std::fmt::Display) -> BuildError {
    BuildError::Surface(error.to_string())
}

fn near(position: [f32; 3], middle: DVec3) -> [f32; 3] {
    (point(position) - middle).as_vec3().to_array()
}

fn around(node: &Node, middle: DVec3) -> Node {
    Node {
        low: near(node.low, middle),
        high: near(node.high, middle),
        origin: near(node.origin, middle),
        data_at: 0,
        ..*node
    }
}

fn moved(triangles: &[LeafTriangle], middle: DVec3) -> Vec<LeafTriangle> {
    let triangle = |triangle: &LeafTriangle| LeafTriangle {
        corners: triangle.corners.map(|p| near(p, middle)),
        ..*triangle
    };
    triangles.iter().map(triangle).collect()
}

/// The largest drawn voxel in pixels. One value selects only the leaf, the other only the candidate.
const NO_VOXEL: f64 = f64::MIN_POSITIVE;
const ANY_VOXEL: f64 = 1e150;

/// Light and coverage.
fn draw(
    file: &FarFile,
    view: &RasterCamera,
    light: Light,
    samples_across: u32,
    voxel_px: f64,
) -> Result<Vec<DVec4>, BuildError> {
    let options = ViewOptions {
        voxel_px,
        samples_across,
        light: Some(light),
        background: Some([0; 3]),
        ..ViewOptions::default()
    };
    let (picture, _) = view::draw(file, view, &options).map_err(failed)?;
    let pixels = picture.rgba.iter().zip(&picture.coverage);
    let pixel =
        |(&[r, g, b, _], &cover): (&[u8; 4], &f32)| to_light([r, g, b]).extend(f64::from(cover));
    Ok(pixels.map(pixel).collect())
}
