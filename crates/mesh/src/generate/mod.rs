//! Small meshes of many kinds, made from a seed, on which the methods of meshes are compared.
//!
//! +Y is up. The same seed gives the same mesh on every computer: sines are those of `libm`.

mod kinds;
mod maker;
mod thin;

use super::material::to_srgb;
use super::{Mesh, Surface};
use maker::Maker;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Scan,
    Machine,
    Wheel,
    Tree,
    Stadium,
    Village,
    Garden,
    Tower,
    Fence,
    Grass,
    Chains,
}

impl Kind {
    pub const ALL: [(&'static str, Self); 11] = [
        ("scan", Self::Scan),
        ("machine", Self::Machine),
        ("wheel", Self::Wheel),
        ("tree", Self::Tree),
        ("stadium", Self::Stadium),
        ("village", Self::Village),
        ("garden", Self::Garden),
        ("tower", Self::Tower),
        ("fence", Self::Fence),
        ("grass", Self::Grass),
        ("chains", Self::Chains),
    ];
}

pub const PREFIX: &str = "mesh:";

/// Reads `mesh:KIND` or `mesh:KIND,seed=N`.
pub fn parse(spec: &str) -> Result<(Kind, u64), String> {
    let body = spec.strip_prefix(PREFIX).unwrap_or(spec);
    let (name, seed) = match body.split_once(',') {
        None => (body, Some(1)),
        Some((name, setting)) => {
            let seed = setting.trim().strip_prefix("seed=");
            (name, seed.and_then(|seed| seed.parse().ok()))
        }
    };
    let names = Kind::ALL.map(|(name, _)| name).join(", ");
    let kind = Kind::ALL.iter().find(|(of, _)| *of == name.trim());
    match (kind, seed) {
        (Some(&(_, kind)), Some(seed)) => Ok((kind, seed)),
        (None, _) => Err(format!(
            "there is no kind of mesh `{name}`; there are {names}"
        )),
        (_, None) => Err(format!("`{spec}` is not of the form mesh:KIND,seed=N")),
    }
}

pub fn generate(kind: Kind, seed: u64) -> Mesh {
    let mut maker = Maker::new(seed);
    match kind {
        Kind::Scan => kinds::scan(&mut maker),
        Kind::Machine => kinds::machine(&mut maker),
        Kind::Wheel => kinds::wheel(&mut maker),
        Kind::Tree => kinds::tree(&mut maker, [0.0; 2], 6.0, 4),
        Kind::Stadium => kinds::stadium(&mut maker),
        Kind::Village => kinds::village(&mut maker),
        Kind::Garden => kinds::garden(&mut maker),
        Kind::Tower => thin::tower(&mut maker),
        Kind::Fence => thin::fence(&mut maker),
        Kind::Grass => thin::grass(&mut maker),
        Kind::Chains => thin::chains(&mut maker),
    }
    maker.finish()
}

/// A mesh as a PLY file: binary, little endian, three vertices a triangle with normals and colours.
pub fn ply(mesh: &Mesh) -> Vec<u8> {
    let count = mesh.len();
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float \
         y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty \
         uchar red\nproperty uchar green\nproperty uchar blue\nelement face {count}\nproperty list \
         uchar uint vertex_indices\nend_header\n",
        3 * count
    )
    .into_bytes();
    for number in 0..count {
        let triangle = mesh.triangle(number);
        for k in 0..3 {
            for vector in [triangle.corners[k], triangle.normals[k]] {
                let numbers = vector.as_vec3().to_array();
                bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
            }
            bytes.extend(to_srgb(triangle.colors[k]));
        }
    }
    // Fewer than 2^32 corners: these meshes are small.
    for first in (0..3 * count as u32).step_by(3) {
        bytes.push(3);
        let corners = [first, first + 1, first + 2].map(u32::to_le_bytes);
        bytes.extend(corners.as_flattened());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ColorSpace, MeshFormat, no_files, read};
    use shiftvox::graph::Silent;

    #[test]
    fn every_kind_is_small_follows_its_seed_and_survives_its_file() {
        for (name, kind) in Kind::ALL {
            assert_eq!(parse(&format!("mesh:{name},seed=7")), Ok((kind, 7)));
            let mesh = generate(kind, 1);
            assert!((1_000..60_000).contains(&mesh.len()), "{name}");
            assert_ne!(mesh.positions(), generate(kind, 2).positions(), "{name}");
            let colors = ColorSpace::default();
            let bytes = ply(&mesh);
            assert!(bytes == ply(&generate(kind, 1)), "{name}");
            let again = read(&bytes, MeshFormat::Ply, name, &no_files, colors, &Silent).unwrap();
            assert_eq!(again.len(), mesh.len(), "{name}");
            for number in (0..mesh.len()).step_by(97) {
                let (a, b) = (mesh.triangle(number), again.triangle(number));
                assert_eq!(a.corners, b.corners, "{name}");
                assert!((a.colors[0] - b.colors[0]).length() < 0.01, "{name}");
                assert!((a.normals[2] - b.normals[2]).length() < 1e-6, "{name}");
            }
        }
    }
}
