//! Places in the world that can be drawn.
//!
//! Numbers of double precision reach farther than a camera does: its squares and products overflow, and far from the
//! origin neighbours fall on one number. What lies there cannot be looked at, so files that say so are refused.

/// Farthest from the origin, and shortest: the cubes of both are numbers of full precision.
const FARTHEST: f64 = 1e90;
const SHORTEST: f64 = 1e-90;
/// Steps from the origin that differ from their neighbours.
const STEPS: f64 = (1u64 << 52) as f64;

/// Parts along the longest side of what is drawn, or less.
pub const MOST_PARTS: f64 = (1u64 << 21) as f64;

/// What single precision coordinates of a mesh are relative to: zero, unless it is so far from it that they would not
/// hold its parts.
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

/// Whether a box of the world can be looked at, and its parts of length `finest` told apart.
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
