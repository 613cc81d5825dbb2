//! Triangles of simple shapes.

use glam::DVec3;

use crate::{Material, Mesh, MeshBuilder};
use shiftvox::split_mix::SplitMix;

pub(crate) struct Maker {
    builder: MeshBuilder,
    pub(super) lot: SplitMix,
}

const TURN: f64 = core::f64::consts::TAU;

impl Maker {
    pub(crate) fn new(seed: u64) -> Self {
        Self {
            builder: MeshBuilder::new(),
            lot: SplitMix::new(seed),
        }
    }

    pub(crate) fn finish(self) -> Mesh {
        self.builder.finish("generated").unwrap_or_default()
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.lot.unit()
    }

    pub(super) fn material(&mut self, color: [u8; 3]) -> u32 {
        self.builder.material(Material::of_srgb("made", color))
    }

    /// A triangle with the normals of its corners, or its plane's.
    pub(super) fn triangle(
        &mut self,
        points: [DVec3; 3],
        normals: Option<[DVec3; 3]>,
        material: u32,
    ) {
        let corners = points.map(|p| self.builder.position(p.as_vec3().to_array()));
        let normals = normals.map(|normals| normals.map(|n| n.as_vec3().to_array()));
        let _ = self.builder.triangle(corners, normals, material);
    }

    pub(super) fn quad(&mut self, [a, b, c, d]: [DVec3; 4], material: u32) {
        self.triangle([a, b, c], None, material);
        self.triangle([a, c, d], None, material);
    }

    pub(crate) fn block(&mut self, low: DVec3, high: DVec3, material: u32) {
        let corner = |bits: u32| {
            let pick = |k: u32| if bits >> k & 1 == 1 { high } else { low };
            DVec3::new(pick(0).x, pick(1).y, pick(2).z)
        };
        let faces = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        for face in faces {
            self.quad(face.map(corner), material);
        }
    }

    /// A tube between two points with a radius at each, closed at its ends.
    pub(super) fn tube(&mut self, ends: [DVec3; 2], radii: [f64; 2], sides: u32, material: u32) {
        let along = (ends[1] - ends[0]).normalize_or(DVec3::Y);
        let (u, v) = along.any_orthonormal_pair();
        let ray = |i: u32| {
            let angle = TURN * f64::from(i % sides) / f64::from(sides);
            u * libm::cos(angle) + v * libm::sin(angle)
        };
        for i in 0..sides {
            let [n, m] = [ray(i), ray(i + 1)];
            let at = |end: usize, ray: DVec3| ends[end] + ray * radii[end];
            let (a, b, c, d) = (at(0, n), at(0, m), at(1, m), at(1, n));
            self.triangle([a, b, c], Some([n, m, m]), material);
            self.triangle([a, c, d], Some([n, m, n]), material);
            self.triangle([ends[0], b, a], Some([-along; 3]), material);
            self.triangle([ends[1], d, c], Some([along; 3]), material);
        }
    }

    pub(super) fn ring(&mut self, centre: DVec3, radii: [f64; 2], steps: [u32; 2], material: u32) {
        let at = |i: u32, j: u32| {
            let angle = |i: u32, of: u32| TURN * f64::from(i % of) / f64::from(of);
            let (a, b) = (angle(i, steps[0]), angle(j, steps[1]));
            let out = DVec3::new(libm::cos(a), libm::sin(a), 0.0);
            let normal = out * libm::cos(b) + DVec3::Z * libm::sin(b);
            (centre + out * radii[0] + normal * radii[1], normal)
        };
        for i in 0..steps[0] {
            for j in 0..steps[1] {
                let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                for [a, b, c] in [[0, 1, 2], [0, 2, 3]].map(|of| of.map(|k: usize| corners[k])) {
                    self.triangle([a.0, b.0, c.0], Some([a.1, b.1, c.1]), material);
                }
            }
        }
    }

    /// A grid of points, whose triangles share corners, with colours; `wraps` around columns.
    pub(super) fn sheet(
        &mut self,
        [rows, columns]: [u32; 2],
        at: impl Fn(u32, u32) -> (DVec3, [u8; 3]),
    ) {
        let white = self.material([255; 3]);
        let mut numbers = Vec::new();
        for row in 0..=rows {
            for column in 0..columns {
                let (point, color) = at(row, column);
                let point = point.as_vec3().to_array();
                numbers.push(self.builder.colored_position(point, color));
            }
        }
        let number = |row: u32, column: u32| numbers[(row * columns + column % columns) as usize];
        for row in 0..rows {
            for column in 0..columns {
                let [a, b] = [number(row, column), number(row, column + 1)];
                let [d, c] = [number(row + 1, column), number(row + 1, column + 1)];
                // At the poles two corners are one point.
                if row > 0 {
                    let _ = self.builder.triangle([a, b, c], None, white);
                }
                if row + 1 < rows {
                    let _ = self.builder.triangle([a, c, d], None, white);
                }
            }
        }
    }
}
