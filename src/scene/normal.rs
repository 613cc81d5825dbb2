//! Normals of files to packed normals and back.
//!
//! The packing is the graph's: octahedral, a byte an axis, `-127..=127` as
//! `1..=255`, so that 0 is free to mean none.

use glam::DVec3;

use crate::graph::PackedNormal;

/// Grid steps from the middle of the square to its edge.
const STEPS: f64 = 127.0;

/// The nearest packed normal to a direction of any length; `None` for zero and
/// for directions that are not finite.
pub(crate) fn pack(direction: [f64; 3]) -> Option<PackedNormal> {
    let direction = DVec3::from_array(direction);
    let length_l1 = direction.x.abs() + direction.y.abs() + direction.z.abs();
    if !(length_l1.is_finite() && length_l1 > 0.0) {
        return None;
    }
    let unit = direction / length_l1;
    let (mut u, mut v) = (unit.x, unit.y);
    if unit.z < 0.0 {
        (u, v) = fold(u, v);
    }
    let low_u = libm::floor(u * STEPS).clamp(-STEPS, STEPS - 1.0);
    let low_v = libm::floor(v * STEPS).clamp(-STEPS, STEPS - 1.0);
    let mut best = (f64::NEG_INFINITY, 0);
    for (du, dv) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)] {
        let (u, v) = (low_u + du, low_v + dv);
        let likeness = unit.dot(unfold(u, v));
        if likeness > best.0 {
            // From -127 to 127, so from 1 to 255.
            let byte = |step: f64| (step as i16 + 128) as u16;
            best = (likeness, byte(u) << 8 | byte(v));
        }
    }
    Some(PackedNormal(best.1))
}

/// The unit vector of a packed normal; `None` where it says that there is none.
pub(crate) fn unpack(normal: PackedNormal) -> Option<[f64; 3]> {
    let step = |byte: u16| (f64::from(byte) - 128.0).max(-STEPS);
    (normal.0 != 0).then(|| unfold(step(normal.0 >> 8), step(normal.0 & 0xff)).to_array())
}

/// Turns the lower half of the octahedron out, and back in.
fn fold(u: f64, v: f64) -> (f64, f64) {
    let sign = |value: f64| if value < 0.0 { -1.0 } else { 1.0 };
    ((1.0 - v.abs()) * sign(u), (1.0 - u.abs()) * sign(v))
}

/// The unit vector of a grid point.
fn unfold(u: f64, v: f64) -> DVec3 {
    let (mut u, mut v) = (u / STEPS, v / STEPS);
    let z = 1.0 - u.abs() - v.abs();
    if z < 0.0 {
        (u, v) = fold(u, v);
    }
    // Never zero: one of the three is at least a third.
    let vector = DVec3::new(u, v, z);
    vector / libm::sqrt(vector.length_squared())
}
