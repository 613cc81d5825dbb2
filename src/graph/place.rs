//! Bounds on world positions: beyond them squares and products overflow, or neighbouring voxels fall on one number.
//! Files with such positions are rejected.

/// Largest distance from the origin and shortest length: their cubes have full precision.
const FARTHEST: f64 = 1e90;
const SHORTEST: f64 = 1e-90;
/// Largest distance from the origin in steps that remain distinct.
const STEPS: f64 = (1u64 << 52) as f64;

/// Most parts along the longest side of an object.
pub const MOST_PARTS: f64 = (1u64 << 21) as f64;

/// The origin of a mesh's single-precision coordinates: zero, or the box's middle where the box is far from zero.
pub fn centre(low: [f64; 3], high: [f64; 3]) -> [f64; 3] {
    let (mut extent, mut farthest) = (0.0f64, 0.0f64);
    for k in 0..3 {
        extent = extent.max(high[k] - low[k]);
        farthest = farthest.max(low[k].abs()).max(high[k].abs());
    }
    match farthest > 16.0 * extent {
        true => [0, 1, 2].map(|k| (low[k] + high[k]) / 2.0),
        false => [0.0; 3],
    }
}

/// Whether a camera can show a box of the world and resolve its parts of length `finest`.
pub fn can_be_seen(low: [f64; 3], high: [f64; 3], finest: f64) -> bool {
    let most = FARTHEST.min(finest * STEPS);
    // NaN is not within.
    let is_near = |c: f64| (-most..=most).contains(&c);
    (SHORTEST..=FARTHEST).contains(&finest) && low.into_iter().chain(high).all(is_near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_told_apart_can_be_seen() {
        let seen =
            |origin: f64, finest| can_be_seen([0.0, origin, 0.0], [origin + finest; 3], finest);
        assert!(seen(0.0, 1.0) && seen(-1e15, 1.0) && seen(1e80, 1e80) && seen(0.0, 1e-80));
        assert!(!seen(1e16, 1.0) && !seen(0.0, 1e308) && !seen(0.0, 5e-324) && !seen(0.0, 0.0));
        for odd in [f64::NAN, f64::INFINITY] {
            assert!(!seen(odd, 1.0) && !seen(0.0, odd));
        }
    }
}
