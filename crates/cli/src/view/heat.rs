//! The picture of where records went.

/// Colours from little to much: dark violet, blue, green, yellow.
const STOPS: [[f32; 3]; 5] = [
    [68.0, 1.0, 84.0],
    [59.0, 82.0, 139.0],
    [33.0, 145.0, 140.0],
    [94.0, 201.0, 98.0],
    [253.0, 231.0, 37.0],
];

/// Records by sample, as colours on a logarithmic scale, and the greatest
/// number. A record counts 1, spread evenly over its quadtree node's samples.
pub(super) fn colors(records: &[f32]) -> (Vec<[u8; 4]>, f32) {
    let most = records.iter().copied().fold(0.0f32, f32::max);
    let scale = libm::log1pf(most).max(f32::MIN_POSITIVE);
    let pixels = records
        .iter()
        .map(|&count| color(libm::log1pf(count) / scale));
    (pixels.collect(), most)
}

fn color(share: f32) -> [u8; 4] {
    let place = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let first = (place as usize).min(STOPS.len() - 2);
    let along = place - first as f32;
    let [r, g, b] = std::array::from_fn(|k| {
        let (from, to) = (STOPS[first][k], STOPS[first + 1][k]);
        libm::roundf(from + (to - from) * along) as u8
    });
    [r, g, b, 255]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn none_is_dark_and_most_is_bright() {
        let (pixels, most) = colors(&[0.0, 3.0, 15.0]);
        // Half of the way: log 4 is half of log 16.
        let expected = [[68, 1, 84, 255], [33, 145, 140, 255], [253, 231, 37, 255]];
        assert_eq!((&pixels[..], most), (&expected[..], 15.0));
    }
}
