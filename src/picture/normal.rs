//! Stand-in for the octahedral codec of `graph::PackedNormal`.
// wired by the lead: replace with `PackedNormal::decode`, then drop this file.

use glam::DVec3;

use crate::graph::PackedNormal;

/// Grid steps from the middle of the octahedron's square to its edge.
const STEPS: f64 = 127.0;

/// The unit vector of a packed normal, if there is one.
pub(super) fn decode(packed: PackedNormal) -> Option<DVec3> {
    if packed.0 == 0 {
        return None;
    }
    let step = |byte: u16| (f64::from(byte) - 128.0).max(-STEPS) / STEPS;
    let (u, v) = (step(packed.0 >> 8), step(packed.0 & 0xff));
    let z = 1.0 - u.abs() - v.abs();
    let sign = |value: f64| if value < 0.0 { -1.0 } else { 1.0 };
    let (x, y) = if z < 0.0 {
        ((1.0 - v.abs()) * sign(u), (1.0 - u.abs()) * sign(v))
    } else {
        (u, v)
    };
    Some(DVec3::new(x, y, z).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_exact() {
        let of = |u: u16, v: u16| decode(PackedNormal(u << 8 | v));
        assert_eq!(of(255, 128), Some(DVec3::X));
        assert_eq!(of(1, 128), Some(DVec3::NEG_X));
        assert_eq!(of(128, 128), Some(DVec3::Z));
        assert_eq!(of(255, 255), Some(DVec3::NEG_Z));
        assert_eq!(decode(PackedNormal(0)), None);
    }
}
