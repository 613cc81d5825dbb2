//! Records of voxels, triangles and nodes (`spec/far.md`). Plain bytes, little-endian.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::blend::{DIRECTIONS, by_cosines, by_squares};
use crate::geometry::point;
use crate::material::to_srgb;
use crate::srgb_to_linear;
use crate::texture::paint::PAINT_BYTES;
pub use crate::texture::paint::Paint;
use shiftvox::graph::PackedNormal;
use shiftvox::graph::file::Stored;

/// Opacities that are stored or used. Of both, the lesser counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Opacity {
    /// Every voxel is opaque.
    None,
    /// For each side of a voxel's surface: rays that hit, over rays that hit or pass.
    Scalar,
    /// A number for each main direction, where they differ.
    #[default]
    Six,
}

/// Bytes of a voxel in each list of a node: place 3, shader 8 or 30, opacities 0, 2 or 5. Three lists have flat shaders,
/// the next three complex ones. Each three have the kinds of opacities in the order of [`Opacity`].
pub const RECORD_BYTES: [usize; 6] = [11, 13, 16, 33, 35, 38];

/// Bytes of the opacities in a voxel of each list.
pub const OPACITY_BYTES: [usize; 6] = [0, 2, 5, 0, 2, 5];

/// Area of a unit cube's outline, mean over all directions.
const MEAN_OUTLINE: f64 = 1.5;

const SCALAR_STEPS: f64 = 63.0;
const SIX_STEPS: f64 = 15.0;

/// Equal ranges of the cosine to a surface's normal.
pub const STEEPNESSES: usize = 4;

/// The range of a cosine from 0 to 1, steepest last.
pub fn steepness(cosine: f64) -> usize {
    ((cosine * STEEPNESSES as f64) as usize).min(STEEPNESSES - 1)
}

/// Unit normals, and colours in linear light.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "lives on the stack for one voxel at a time"
)]
pub enum Shader {
    Flat {
        normal: DVec3,
        /// In front, behind.
        colors: [DVec3; 2],
    },
    Complex {
        normals: [DVec3; DIRECTIONS],
        colors: [DVec3; DIRECTIONS],
    },
}

impl Shader {
    /// The cosine to its normal, negative from behind a flat one.
    pub fn cosine(&self, towards_eye: DVec3) -> f64 {
        match self {
            Self::Flat { normal, .. } => normal.dot(towards_eye),
            Self::Complex { .. } => self.seen_from(towards_eye).0.dot(towards_eye),
        }
    }

    /// The normal on the eye's side, and the colour.
    pub fn seen_from(&self, towards_eye: DVec3) -> (DVec3, DVec3) {
        match self {
            Self::Flat { normal, colors } => {
                if normal.dot(towards_eye) >= 0.0 {
                    (*normal, colors[0])
                } else {
                    (-*normal, colors[1])
                }
            }
            Self::Complex { normals, colors } => {
                let (mut normal, mut color) = (DVec3::ZERO, DVec3::ZERO);
                for (k, share) in by_squares(towards_eye) {
                    normal += normals[k] * share;
                    color += colors[k] * share;
                }
                (normal.normalize_or(towards_eye), color)
            }
        }
    }
}

/// Opacity seen from one side of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SideOpacity {
    /// Over all directions, 0 to 1.
    pub scalar: f64,
    /// The steepness from which on it is opaque, or [`STEEPNESSES`] for none.
    pub solid_from: u8,
}

impl SideOpacity {
    pub const OPAQUE: Self = Self {
        scalar: 1.0,
        solid_from: 0,
    };

    /// A byte: opacity, and in the two high bits from which steepness on it is 1.
    fn byte(self) -> u8 {
        let solid = match self.solid_from {
            0 => return u8::MAX,
            solid => solid.min(STEEPNESSES as u8),
        };
        // 0 to 63, but at most 62 if it is solid from 1 on, because 255 means opaque.
        let steps = (self.scalar.clamp(0.0, 1.0) * SCALAR_STEPS + 0.5) as u8;
        ((STEEPNESSES as u8 - solid) << 6 | steps).min(u8::MAX - 1)
    }

    fn of(byte: u8) -> Self {
        if byte == u8::MAX {
            return Self::OPAQUE;
        }
        Self {
            scalar: f64::from(byte & 63) / SCALAR_STEPS,
            solid_from: STEEPNESSES as u8 - (byte >> 6),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Voxel {
    /// Place in the node's grid.
    pub place: [u8; 3],
    pub shader: Shader,
    /// Opacity seen from each main direction, 0 to 1; 1 where it is not stored.
    pub opacity: [f64; DIRECTIONS],
    /// Opacity over all directions from before its surface, and behind it.
    pub sides: [SideOpacity; 2],
    pub stored: Opacity,
}

fn color_of(bytes: &[u8]) -> DVec3 {
    point([0, 1, 2].map(|c| srgb_to_linear(bytes[c])))
}

fn normal_bytes(normal: DVec3) -> [u8; 2] {
    PackedNormal::encode(normal).0.to_le_bytes()
}

fn normal_of(bytes: &[u8]) -> DVec3 {
    let packed = PackedNormal(u16::from_le_bytes([bytes[0], bytes[1]]));
    packed.decode().unwrap_or(DVec3::Z)
}

/// Opacities are rounded up or down at random, so that the mean over many voxels is kept: thin things do not vanish.
fn six_bytes(opacity: &[f64; DIRECTIONS], place: [u8; 3]) -> [u8; 3] {
    let [x, y, z] = place.map(u64::from);
    let mut bits = 0u32;
    for (k, a) in opacity.iter().enumerate() {
        let seed = (x << 24 | y << 16 | z << 8 | k as u64) + 1;
        let lot = (seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / (1u64 << 24) as f64;
        let steps = (a.clamp(0.0, 1.0) * SIX_STEPS + lot).min(SIX_STEPS) as u32;
        bits |= steps << (4 * k);
    }
    let [a, b, c, _] = bits.to_le_bytes();
    [a, b, c]
}

impl Voxel {
    /// The list that it belongs to.
    pub fn list(&self) -> usize {
        3 * usize::from(matches!(self.shader, Shader::Complex { .. })) + self.stored as usize
    }

    pub fn write(&self, out: &mut Vec<u8>) {
        out.extend(self.place);
        let (normals, colors) = match &self.shader {
            Shader::Flat { normal, colors } => (std::slice::from_ref(normal), &colors[..]),
            Shader::Complex { normals, colors } => (&normals[..], &colors[..]),
        };
        out.extend(normals.iter().flat_map(|&n| normal_bytes(n)));
        out.extend(colors.iter().flat_map(|&c| to_srgb(c)));
        if self.stored != Opacity::None {
            out.extend(self.sides.map(SideOpacity::byte));
        }
        if self.stored == Opacity::Six {
            out.extend(six_bytes(&self.opacity, self.place));
        }
    }

    /// Reads a record of a list; its bytes may be any.
    pub fn read(list: usize, bytes: &[u8]) -> Self {
        let stored = [Opacity::None, Opacity::Scalar, Opacity::Six][list % 3];
        let shader = match list < 3 {
            true => Shader::Flat {
                normal: normal_of(&bytes[3..5]),
                colors: [color_of(&bytes[5..8]), color_of(&bytes[8..11])],
            },
            false => Shader::Complex {
                normals: std::array::from_fn(|k| normal_of(&bytes[3 + 2 * k..])),
                colors: std::array::from_fn(|k| color_of(&bytes[15 + 3 * k..])),
            },
        };
        let bytes_of_opacity = &bytes[RECORD_BYTES[list] - OPACITY_BYTES[list]..];
        let (mut sides, mut opacity) = ([SideOpacity::OPAQUE; 2], [1.0; DIRECTIONS]);
        if stored != Opacity::None {
            sides = [0, 1].map(|side| SideOpacity::of(bytes_of_opacity[side]));
        }
        if stored == Opacity::Six {
            let steps = |k: usize| bytes_of_opacity[2 + k / 2] >> (4 * (k % 2)) & 15;
            opacity = std::array::from_fn(|k| f64::from(steps(k)) / SIX_STEPS);
        }
        Self {
            place: [bytes[0], bytes[1], bytes[2]],
            shader,
            opacity,
            sides,
            stored,
        }
    }

    pub fn opacity_from(&self, towards_eye: DVec3, mode: Opacity) -> f64 {
        let used = mode.min(self.stored);
        if used == Opacity::None {
            return 1.0;
        }
        let cosine = self.shader.cosine(towards_eye);
        let side = self.sides[usize::from(cosine < 0.0)];
        if steepness(cosine.abs()) >= usize::from(side.solid_from) {
            return 1.0;
        }
        if used == Opacity::Scalar {
            // As of a mist in its cube: through its greater outlines one sees through less of it.
            let outline = towards_eye.abs().element_sum();
            return 1.0 - libm::pow(1.0 - side.scalar, MEAN_OUTLINE / outline);
        }
        let shares = by_cosines(towards_eye).into_iter();
        shares.map(|(k, share)| self.opacity[k] * share).sum()
    }

    /// Whether the voxel is opaque from some directions only.
    pub fn is_partly_solid(list: usize, bytes: &[u8]) -> bool {
        let end = RECORD_BYTES[list] - OPACITY_BYTES[list];
        let is_solid = |&byte: &u8| usize::from(SideOpacity::of(byte).solid_from) < STEEPNESSES;
        OPACITY_BYTES[list] > 0 && bytes[end..end + 2].iter().any(is_solid)
    }
}

/// A triangle of a node, in memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeafTriangle {
    /// Relative to the file's centre.
    pub corners: [[f32; 3]; 3],
    /// Packed.
    pub normals: [u16; 3],
    /// sRGB.
    pub colors: [[u8; 3]; 3],
    pub paint: Paint,
}

/// A node of the hierarchy. Its box holds its triangles. Coordinates are relative to the file's centre.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    pub low: [f32; 3],
    pub high: [f32; 3],
    /// Lowest corner of its grid; zero without one, as `voxel` and `cells`.
    pub origin: [f32; 3],
    /// Side of a voxel, world units.
    pub voxel: f32,
    /// Voxels of the grid along each axis.
    pub cells: [u8; 3],
    /// 1 or 0.
    pub is_leaf: u8,
    /// Levels below the root.
    pub level: u16,
    /// Its voxels across a pixel from which on it is drawn, doubled: 2 to 4, 0 without a grid.
    pub across: u16,
    /// Numbers of the children, or zeros.
    pub children: [u32; 2],
    pub first_triangle: u32,
    /// Those of all leaves below.
    pub triangles: u32,
    /// Where its data begins in its section, bytes.
    pub data_at: u64,
    /// Voxels of each of the six lists.
    pub counts: [u32; 6],
    /// Voxels that triangles touch.
    pub touched: u32,
    /// Kept voxels with too few rays to decide whether they are hidden.
    pub untested: u32,
    pub rays: u32,
    /// Rays that hit one of its triangles.
    pub hits: u32,
    /// Rays through the voxels that are kept, summed over these.
    pub crossings: u32,
    /// Root mean square error of the fitted shaders: 0 to about 1.
    pub error: f32,
    /// xxh3-64 of its data as it is stored.
    pub checksum: u64,
    /// Corners of its surface that no other node has, and those that others share.
    pub vertices: [u32; 2],
    /// Triangles of its surface: all of a leaf, decimated ones of an inner node.
    pub surface: u32,
    /// Colours in the table of its surface, or 0 where each vertex has its own.
    pub colors: u16,
    /// Whether normals are those of the triangles' planes, 1 or 0.
    pub is_flat: u8,
    /// Whether its surface has textures or opacities, 1 or 0.
    pub is_painted: u8,
}

impl Stored for Node {
    const NUMBERS: &'static [(usize, usize)] = &[
        (10, 4),
        (4, 1),
        (2, 2),
        (4, 4),
        (1, 8),
        (12, 4),
        (1, 8),
        (3, 4),
        (1, 2),
        (2, 1),
    ];
}

/// Bytes of the position of a vertex of one node, and of one that nodes share.
pub const OWN_BYTES: usize = 6;
pub const SHARED_BYTES: usize = 12;
/// Most colours in the table of a surface.
pub const MOST_COLORS: usize = 256;

/// Bytes per vertex, index or triangle.
pub(in crate::far) struct SurfaceColumns {
    pub(in crate::far) normal: usize,
    pub(in crate::far) color: usize,
    pub(in crate::far) index: usize,
    pub(in crate::far) paint: usize,
}

impl SurfaceColumns {
    pub(in crate::far) fn of(node: &Node) -> Self {
        let [own, shared] = node.vertices.map(u64::from);
        Self {
            normal: if node.is_flat == 0 { 2 } else { 0 },
            color: match node.colors {
                0 => 3,
                1 => 0,
                _ => 1,
            },
            // Twice the number, and which list it is of.
            index: if own.max(shared) < 1 << 15 { 2 } else { 4 },
            paint: usize::from(node.is_painted) * PAINT_BYTES,
        }
    }
}

pub const NODE_BYTES: usize = size_of::<Node>();

impl Node {
    pub fn is_leaf(&self) -> bool {
        self.is_leaf != 0
    }

    /// Without a grid only its children are drawn.
    pub fn has_grid(&self) -> bool {
        self.voxel > 0.0
    }

    /// Numbers of its children, at most two.
    pub fn below(&self) -> impl Iterator<Item = usize> + use<> {
        let children = self.children.into_iter();
        // The first node is never a child.
        children
            .filter(|&child| child > 0)
            .map(|child| child as usize)
    }

    /// Unpacked.
    pub fn surface_bytes(&self) -> u64 {
        let columns = SurfaceColumns::of(self);
        let [own, shared] = self.vertices.map(u64::from);
        let vertex = (columns.normal + columns.color) as u64;
        u64::from(self.colors) * 3
            + own * OWN_BYTES as u64
            + shared * SHARED_BYTES as u64
            + (own + shared) * vertex
            + u64::from(self.surface) * (3 * columns.index + columns.paint) as u64
    }

    pub fn drawn_bytes(&self) -> u64 {
        self.voxel_bytes() + self.surface_bytes()
    }

    pub fn voxels(&self) -> u64 {
        self.counts.iter().map(|&n| u64::from(n)).sum()
    }

    /// Unpacked.
    pub fn voxel_bytes(&self) -> u64 {
        let lists = self.counts.iter().zip(RECORD_BYTES);
        lists.map(|(&n, bytes)| u64::from(n) * bytes as u64).sum()
    }

    /// Corners of its grid, or of its triangles.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        if !self.has_grid() {
            return (point(self.low), point(self.high));
        }
        let origin = point(self.origin);
        (origin, origin + point(self.cells) * f64::from(self.voxel))
    }
}
