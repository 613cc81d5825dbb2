//! Small reproducible hashes.

/// The benchmark's hash of two coordinates and a seed.
#[inline]
pub(super) fn hash(a: u32, b: u32, seed: u32) -> u32 {
    let mut h =
        a.wrapping_mul(0x9E37_79B1) ^ b.wrapping_mul(0x85EB_CA77) ^ seed.wrapping_mul(0xC2B2_AE3D);
    h ^= h >> 15;
    h = h.wrapping_mul(0x2C1B_3C6D);
    h ^= h >> 12;
    h = h.wrapping_mul(0x297A_2D39);
    h ^ h >> 15
}

/// Bits to change a hash seed with; none for seed 1, different ones for every other.
pub(super) fn variation(seed: u32) -> u32 {
    seed.wrapping_sub(1).wrapping_mul(0x9E37_79B9)
}
