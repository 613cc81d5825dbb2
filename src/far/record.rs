//! What is stored of a voxel, a triangle and a node. Plain bytes, little-endian.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::blend::{Blend, DIRECTIONS};
use crate::graph::PackedNormal;
use crate::mesh::{linear_to_srgb, srgb_to_linear};

/// Which shader a voxel has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ShaderKind {
    /// One normal, two materials: one for each side.
    Flat,
    /// Six normals and six materials.
    Complex,
}

/// How a voxel's opacity is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum OpacityKind {
    /// It hides what is behind it, from everywhere.
    Opaque,
    /// One number.
    Scalar,
    /// One number for each main direction.
    Six,
}

/// What opacities are used for: when a file is built, or when it is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Opacity {
    /// Every voxel is opaque: without anti-aliasing.
    None,
    /// One number a voxel: hits over rays, of all directions.
    ///
    /// Rays that hit, over rays that hit or pass.
    Scalar,
    /// A number for each main direction.
    ///
    /// Only where they differ.
    #[default]
    Six,
}

/// The six lists of a node, in the order in which they are stored.
pub const LISTS: [(ShaderKind, OpacityKind); 6] = [
    (ShaderKind::Flat, OpacityKind::Opaque),
    (ShaderKind::Flat, OpacityKind::Scalar),
    (ShaderKind::Flat, OpacityKind::Six),
    (ShaderKind::Complex, OpacityKind::Opaque),
    (ShaderKind::Complex, OpacityKind::Scalar),
    (ShaderKind::Complex, OpacityKind::Six),
];

/// Bytes of a voxel in each list: place 3; a flat one 8, a complex one 30; opacity 0, 1 or 4.
pub const RECORD_BYTES: [usize; 6] = [11, 12, 15, 33, 34, 37];

/// Bytes of the opacities in a voxel of each list: the scalar, and six of four bits.
pub const OPACITY_BYTES: [usize; 6] = [0, 1, 4, 0, 1, 4];

/// Steps of an opacity of a main direction: four bits, finer than tens of rays can measure.
const SIX_STEPS: f64 = 15.0;

/// A voxel's colours and normals.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "lives on the stack for one voxel at a time"
)]
pub enum Shader {
    /// One normal; colours (linear light) seen from its side and from the other.
    Flat {
        /// Unit normal.
        normal: DVec3,
        /// In front, behind.
        colors: [DVec3; 2],
    },
    /// A normal and a colour (linear light) for each main direction.
    Complex {
        /// Unit normals.
        normals: [DVec3; DIRECTIONS],
        /// Colours.
        colors: [DVec3; DIRECTIONS],
    },
}

impl Shader {
    /// Unit normal on the eye's side, and colour in linear light, as seen from a direction.
    #[must_use]
    pub fn seen_from(&self, towards_eye: DVec3, blend: Blend) -> (DVec3, DVec3) {
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
                for (k, share) in blend.shares(towards_eye) {
                    normal += normals[k] * share;
                    color += colors[k] * share;
                }
                (normal.normalize_or(towards_eye), color)
            }
        }
    }
}

/// A voxel, decoded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Voxel {
    /// Place in the node's grid.
    pub place: [u8; 3],
    /// Its colours and normals.
    pub shader: Shader,
    /// Opacity seen from each main direction, 0 to 1.
    pub opacity: [f64; DIRECTIONS],
    /// Opacity over all directions, 0 to 1.
    pub scalar: f64,
    /// How they are stored.
    pub opacity_kind: OpacityKind,
}

fn color_bytes(color: DVec3) -> [u8; 3] {
    color.to_array().map(linear_to_srgb)
}

fn color_of(bytes: &[u8]) -> DVec3 {
    DVec3::new(
        f64::from(srgb_to_linear(bytes[0])),
        f64::from(srgb_to_linear(bytes[1])),
        f64::from(srgb_to_linear(bytes[2])),
    )
}

fn normal_bytes(normal: DVec3) -> [u8; 2] {
    PackedNormal::encode(normal).0.to_le_bytes()
}

fn normal_of(bytes: &[u8]) -> DVec3 {
    let packed = PackedNormal(u16::from_le_bytes([bytes[0], bytes[1]]));
    packed.decode().unwrap_or(DVec3::Z)
}

fn opacity_byte(opacity: f64) -> u8 {
    // 0 to 255.
    (opacity.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Six opacities in four bits each, lowest first, rounded up or down by lot, so
/// that the mean over many voxels is kept: thin things do not vanish. The lot
/// is drawn from the voxel's place.
fn six_bytes(opacity: &[f64; DIRECTIONS], place: [u8; 3]) -> [u8; 3] {
    let [x, y, z] = place.map(u64::from);
    let mut bits = 0u32;
    for (k, a) in opacity.iter().enumerate() {
        let seed = (x << 24 | y << 16 | z << 8 | k as u64) + 1;
        let lot = (seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / (1u64 << 24) as f64;
        // 0 to 15.
        let steps = (a.clamp(0.0, 1.0) * SIX_STEPS + lot).min(SIX_STEPS) as u32;
        bits |= steps << (4 * k);
    }
    let [a, b, c, _] = bits.to_le_bytes();
    [a, b, c]
}

impl Voxel {
    /// The list that it belongs to.
    #[must_use]
    pub fn list(&self) -> usize {
        let shader = match self.shader {
            Shader::Flat { .. } => 0,
            Shader::Complex { .. } => 3,
        };
        shader
            + match self.opacity_kind {
                OpacityKind::Opaque => 0,
                OpacityKind::Scalar => 1,
                OpacityKind::Six => 2,
            }
    }

    /// Appends its record, [`RECORD_BYTES`] of its list.
    pub fn write(&self, out: &mut Vec<u8>) {
        out.extend(self.place);
        match &self.shader {
            Shader::Flat { normal, colors } => {
                out.extend(normal_bytes(*normal));
                out.extend(colors.iter().flat_map(|&c| color_bytes(c)));
            }
            Shader::Complex { normals, colors } => {
                out.extend(normals.iter().flat_map(|&n| normal_bytes(n)));
                out.extend(colors.iter().flat_map(|&c| color_bytes(c)));
            }
        }
        match self.opacity_kind {
            OpacityKind::Opaque => {}
            OpacityKind::Scalar => out.push(opacity_byte(self.scalar)),
            OpacityKind::Six => {
                out.push(opacity_byte(self.scalar));
                out.extend(six_bytes(&self.opacity, self.place));
            }
        }
    }

    /// Decodes a record of [`RECORD_BYTES`] of a list. Any bytes are accepted.
    #[must_use]
    pub fn read(list: usize, bytes: &[u8]) -> Self {
        let (kind, opacity_kind) = LISTS[list];
        let (shader, end) = match kind {
            ShaderKind::Flat => {
                let shader = Shader::Flat {
                    normal: normal_of(&bytes[3..5]),
                    colors: [color_of(&bytes[5..8]), color_of(&bytes[8..11])],
                };
                (shader, 11)
            }
            ShaderKind::Complex => {
                let shader = Shader::Complex {
                    normals: std::array::from_fn(|k| normal_of(&bytes[3 + 2 * k..])),
                    colors: std::array::from_fn(|k| color_of(&bytes[15 + 3 * k..])),
                };
                (shader, 33)
            }
        };
        let (scalar, opacity) = opacity_of(opacity_kind, &bytes[end..]);
        Self {
            place: [bytes[0], bytes[1], bytes[2]],
            shader,
            opacity,
            scalar,
            opacity_kind,
        }
    }
}

/// The opacities at the end of a record: over all directions, and of each.
fn opacity_of(kind: OpacityKind, bytes: &[u8]) -> (f64, [f64; DIRECTIONS]) {
    let scalar = |byte: u8| f64::from(byte) / 255.0;
    match kind {
        OpacityKind::Opaque => (1.0, [1.0; DIRECTIONS]),
        OpacityKind::Scalar => (scalar(bytes[0]), [scalar(bytes[0]); DIRECTIONS]),
        OpacityKind::Six => {
            let steps = |k: usize| bytes[1 + k / 2] >> (4 * (k % 2)) & 15;
            let six = std::array::from_fn(|k| f64::from(steps(k)) / SIX_STEPS);
            (scalar(bytes[0]), six)
        }
    }
}

/// A triangle of a leaf.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct LeafTriangle {
    /// Corners, relative to the file's centre.
    pub corners: [[f32; 3]; 3],
    /// Normals of the corners, packed.
    pub normals: [u16; 3],
    /// Colours of the corners, sRGB.
    pub colors: [[u8; 3]; 3],
    /// Zero.
    pub spare: u8,
}

/// Bytes of a [`LeafTriangle`].
pub const TRIANGLE_BYTES: usize = size_of::<LeafTriangle>();

/// The bytes of triangles as they are stored (on machines that store the lowest byte first).
#[must_use]
pub fn triangle_bytes(triangles: &[LeafTriangle]) -> &[u8] {
    bytemuck::cast_slice(triangles)
}

/// A node of the hierarchy.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Node {
    /// Lowest corner of its triangles, relative to the file's centre.
    pub low: [f32; 3],
    /// Highest corner of its triangles.
    pub high: [f32; 3],
    /// Lowest corner of its grid; zero in a leaf.
    pub origin: [f32; 3],
    /// Side of a voxel, world units; zero in a leaf.
    pub voxel: f32,
    /// Voxels of the grid along each axis; zero in a leaf.
    pub cells: [u8; 3],
    /// 1 for a leaf, 0 for an inner node.
    pub is_leaf: u8,
    /// Levels below the root.
    pub level: u32,
    /// Numbers of the two children; zero in a leaf.
    pub children: [u32; 2],
    /// The first of its triangles.
    pub first_triangle: u32,
    /// How many it has: those of all leaves below.
    pub triangles: u32,
    /// Where its voxels begin in their section, bytes.
    pub voxels_at: u64,
    /// Voxels of each of the six lists; zero in a leaf.
    pub counts: [u32; 6],
    /// Voxels that triangles touch (a little too many): those kept and those dropped.
    pub touched: u32,
    /// Rays that were shot for it.
    pub rays: u32,
    /// Those that hit one of its triangles.
    pub hits: u32,
    /// Rays through the voxels that are kept, summed over these.
    pub crossings: u32,
    /// Root mean square error of the fitted shaders: 0 to about 1.
    pub error: f32,
    /// Zero.
    pub spare: u32,
    /// xxh3-64 of its voxels' bytes, or, of a leaf, of its triangles'.
    pub checksum: u64,
}

/// Bytes of a [`Node`].
pub const NODE_BYTES: usize = size_of::<Node>();

impl Node {
    /// Whether it has triangles and no voxels.
    #[must_use]
    pub fn is_leaf(&self) -> bool {
        self.is_leaf != 0
    }

    /// Voxels that it keeps.
    #[must_use]
    pub fn voxels(&self) -> u64 {
        self.counts.iter().map(|&n| u64::from(n)).sum()
    }

    /// Bytes of its voxels.
    #[must_use]
    pub fn voxel_bytes(&self) -> u64 {
        let lists = self.counts.iter().zip(RECORD_BYTES);
        lists.map(|(&n, bytes)| u64::from(n) * bytes as u64).sum()
    }

    /// Lowest and highest corner of its grid, or of a leaf's triangles, relative to the file's
    /// centre.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let point = |p: [f32; 3]| DVec3::from_array(p.map(f64::from));
        if self.is_leaf() {
            return (point(self.low), point(self.high));
        }
        let cells = DVec3::from_array(self.cells.map(f64::from));
        let origin = point(self.origin);
        (origin, origin + cells * f64::from(self.voxel))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_have_their_sizes_and_come_back() {
        assert_eq!((NODE_BYTES, TRIANGLE_BYTES), (128, 52));
        let white = DVec3::ONE;
        let axes = [
            DVec3::X,
            DVec3::NEG_X,
            DVec3::Y,
            DVec3::NEG_Y,
            DVec3::Z,
            DVec3::NEG_Z,
        ];
        let shaders = [
            Shader::Flat {
                normal: DVec3::Y,
                colors: [white, DVec3::ZERO],
            },
            Shader::Complex {
                normals: axes,
                colors: [white, white, DVec3::ZERO, white, DVec3::ZERO, white],
            },
        ];
        let opacities = [
            (OpacityKind::Opaque, 1.0, [1.0; 6]),
            (OpacityKind::Scalar, 0.2, [0.2; 6]),
            (OpacityKind::Six, 0.6, [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]),
        ];
        for shader in shaders {
            for (opacity_kind, scalar, opacity) in opacities {
                let voxel = Voxel {
                    place: [1, 2, 255],
                    shader,
                    opacity,
                    scalar,
                    opacity_kind,
                };
                let mut bytes = Vec::new();
                voxel.write(&mut bytes);
                assert_eq!(bytes.len(), RECORD_BYTES[voxel.list()]);
                assert_eq!(Voxel::read(voxel.list(), &bytes), voxel);
            }
        }
    }

    #[test]
    fn rounded_opacities_keep_their_mean() {
        for opacity in [0.01, 0.3, 0.5, 0.97] {
            let mut sum = 0.0;
            for place in 0..4096u32 {
                let place = [place % 16, place / 16 % 16, place / 256].map(|c| c as u8);
                let [a, b, c] = six_bytes(&[opacity; DIRECTIONS], place);
                let (_, six) = opacity_of(OpacityKind::Six, &[0, a, b, c]);
                assert!(six.iter().all(|a| (a - opacity).abs() < 1.0 / SIX_STEPS));
                sum += six.iter().sum::<f64>() / DIRECTIONS as f64;
            }
            assert!((sum / 4096.0 - opacity).abs() < 2e-3, "{opacity}: {sum}");
        }
    }
}
