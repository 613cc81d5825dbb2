//! Normals in two bytes: octahedral, one byte per axis.
//!
//! The sphere is projected to the octahedron `|x| + |y| + |z| = 1`, its lower half is folded over the upper, and the
//! resulting square is a grid of 255 by 255 points. A byte holds `-127..=127` as `1..=255`; 0 means "no normal". The
//! nearest grid point is taken: the error stays below 0.7 degrees.

use glam::DVec3;

use super::PackedNormal;

const STEPS: f64 = 127.0;
const ZERO: u16 = 128;

impl PackedNormal {
    pub const NONE: Self = Self(0);

    pub fn from_array(direction: [f64; 3]) -> Self {
        Self::encode(direction.into())
    }

    /// The nearest normal to a direction of any length; none for zero or a direction that is not finite.
    pub fn encode(direction: DVec3) -> Self {
        let length_l1 = direction.x.abs() + direction.y.abs() + direction.z.abs();
        if !(length_l1.is_finite() && length_l1 > 0.0) {
            return Self::NONE;
        }
        let unit = direction / length_l1;
        // No branch: unpredictable.
        let [own, folded] = [(unit.x, unit.y), fold(unit.x, unit.y)];
        let (u, v) = [own, folded][usize::from(unit.z < 0.0)];
        let floor = |x: f64| f64::from((x * STEPS + STEPS) as i32) - STEPS;
        let low_u = floor(u).clamp(-STEPS, STEPS - 1.0);
        let low_v = floor(v).clamp(-STEPS, STEPS - 1.0);
        // The four around it together, unfolded.
        let us = [low_u, low_u, low_u + 1.0, low_u + 1.0];
        let vs = [low_v, low_v + 1.0, low_v, low_v + 1.0];
        let (u, v) = (
            four(|i| us[i] * (1.0 / STEPS)),
            four(|i| vs[i] * (1.0 / STEPS)),
        );
        let z = four(|i| 1.0 - u[i].abs() - v[i].abs());
        let folded = |own: f64, other: f64| (1.0 - other.abs()).copysign(own);
        let x = four(|i| if z[i] < 0.0 { folded(u[i], v[i]) } else { u[i] });
        let y = four(|i| if z[i] < 0.0 { folded(v[i], u[i]) } else { v[i] });
        let along = four(|i| unit.x * x[i] + unit.y * y[i] + unit.z * z[i]);
        let length_squared = four(|i| x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
        let likeness = four(|i| along[i] * along[i].abs() / length_squared[i]);
        let better = |a: usize, b: usize| if likeness[b] > likeness[a] { b } else { a };
        let best = better(better(0, 1), better(2, 3));
        let byte = |step: f64| (step as i16 + ZERO as i16) as u16;
        Self(byte(us[best]) << 8 | byte(vs[best]))
    }

    /// The unit vector, if there is a normal. Any 16 bits are accepted.
    pub fn decode(self) -> Option<DVec3> {
        if self == Self::NONE {
            return None;
        }
        let step = |byte: u16| (f64::from(byte) - f64::from(ZERO)).max(-STEPS);
        let point = unfold(step(self.0 >> 8), step(self.0 & 0xff));
        // Never zero: one of the three is at least a third.
        Some(point / libm::sqrt(point.length_squared()))
    }

    pub fn is_none(self) -> bool {
        self == Self::NONE
    }
}

/// A megabyte, which a core's second cache holds: of the normals of a terrain, nine in ten are found.
const KNOWN_BITS: u32 = 15;

/// Encodes directions. Clouds repeat theirs, so the last ones are kept.
pub(crate) struct KnownNormals(Vec<(DVec3, PackedNormal)>);

impl Default for KnownNormals {
    fn default() -> Self {
        Self(vec![(DVec3::ZERO, PackedNormal::NONE); 1 << KNOWN_BITS])
    }
}

impl KnownNormals {
    pub(crate) fn encode(&mut self, direction: DVec3) -> PackedNormal {
        let [x, y, z] = direction.to_array().map(f64::to_bits);
        let mixed = (x ^ y.rotate_left(21) ^ z.rotate_left(42)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let known = &mut self.0[(mixed >> (64 - KNOWN_BITS)) as usize];
        if known.0 != direction {
            *known = (direction, PackedNormal::encode(direction));
        }
        known.1
    }
}

/// Turns the lower half of the octahedron out, and back in.
fn fold(u: f64, v: f64) -> (f64, f64) {
    let sign = |value: f64| if value < 0.0 { -1.0 } else { 1.0 };
    ((1.0 - v.abs()) * sign(u), (1.0 - u.abs()) * sign(v))
}

fn unfold(u: f64, v: f64) -> DVec3 {
    let (mut u, mut v) = (u * (1.0 / STEPS), v * (1.0 / STEPS));
    let z = 1.0 - u.abs() - v.abs();
    if z < 0.0 {
        (u, v) = fold(u, v);
    }
    DVec3::new(u, v, z)
}

#[inline(always)]
fn four(of: impl Fn(usize) -> f64) -> [f64; 4] {
    [of(0), of(1), of(2), of(3)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_decodes_to_a_unit_vector_and_canonical_ones_return() {
        for bits in 1..=u16::MAX {
            let unit = PackedNormal(bits).decode().unwrap();
            assert!((unit.length() - 1.0).abs() < 1e-12);
            let again = PackedNormal::encode(unit).decode().unwrap();
            assert!(unit.dot(again) > 1.0 - 1e-9, "{bits}: {unit} {again}");
        }
        for axis in DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
            assert_eq!(PackedNormal::encode(axis * 3.0).decode(), Some(axis));
        }
        for none in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
            assert!(PackedNormal::encode(none).is_none());
        }
    }

    #[test]
    fn error_stays_below_seven_tenths_of_a_degree() {
        // A Fibonacci sphere: even, and off the grid.
        let points = 400_000;
        let mut worst = 1.0f64;
        for i in 0..points {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(points);
            let around = f64::from(i) * 2.399_963_229_728_653;
            let ring = libm::sqrt(1.0 - z * z);
            let unit = DVec3::new(ring * libm::cos(around), ring * libm::sin(around), z);
            let near = PackedNormal::encode(unit).decode().unwrap();
            worst = worst.min(unit.dot(near));
        }
        assert!(libm::acos(worst).to_degrees() < 0.7, "{worst}");
    }
}
