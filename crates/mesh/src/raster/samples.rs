//! Where in a pixel the samples lie.

use shiftvox::split_mix::mix;

pub(super) const SUBPIXEL_BITS: u32 = 12;
/// Steps of the sub-pixel lattice in a pixel.
pub(super) const SUBPIXELS: i64 = 1 << SUBPIXEL_BITS;

/// How samples are spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Pattern {
    /// In the middles of equal squares.
    #[default]
    Regular,
    /// At random within equal squares, differently in each pixel. The same seed gives the same places.
    Stratified {
        /// The seed of the random places.
        seed: u64,
    },
}

/// The number of samples per pixel, and their places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Samples {
    side: u32,
    pattern: Pattern,
}

impl Samples {
    /// `4^side_log2` samples per pixel, at most 256.
    pub fn new(side_log2: u32, pattern: Pattern) -> Self {
        let side = 1 << side_log2.min(4);
        Self { side, pattern }
    }

    /// Samples of a pixel.
    pub fn per_pixel(&self) -> usize {
        (self.side * self.side) as usize
    }

    /// The sample that gives a pixel its depth, right of and below the middle.
    pub fn middle(&self) -> usize {
        (self.side / 2 * self.side + self.side / 2) as usize
    }

    /// Where sample `number` of a pixel lies in it, right and down, in 1/4096 pixel.
    pub fn place(&self, pixel: [u32; 2], number: usize) -> [i64; 2] {
        let square = SUBPIXELS / i64::from(self.side);
        let number = number as u32;
        let corner = [number % self.side, number / self.side].map(|i| i64::from(i) * square);
        let within = match self.pattern {
            Pattern::Regular => [square / 2; 2],
            Pattern::Stratified { seed } => {
                let place = u64::from(pixel[0]) << 40 | u64::from(pixel[1]) << 16;
                let random = mix(seed ^ mix(place | u64::from(number)));
                let low = square as u64 - 1;
                [(random & low) as i64, (random >> 32 & low) as i64]
            }
        };
        [corner[0] + within[0], corner[1] + within[1]]
    }
}

pub(super) struct Places {
    per_pixel: usize,
    table: Vec<[i32; 2]>,
}

impl Places {
    pub(super) fn new(samples: &Samples, corner: [u32; 2], columns: u32, rows: u32) -> Self {
        let pixels = match samples.pattern {
            Pattern::Regular => 1,
            Pattern::Stratified { .. } => columns * rows,
        };
        let per_pixel = samples.per_pixel();
        let table = (0..pixels)
            .flat_map(|i| {
                let pixel = [corner[0] + i % columns, corner[1] + i / columns];
                (0..per_pixel).map(move |number| samples.place(pixel, number).map(|c| c as i32))
            })
            .collect();
        Self { per_pixel, table }
    }

    #[inline]
    pub(super) fn of(&self, pixel: usize) -> &[[i32; 2]] {
        let is_shared = self.table.len() == self.per_pixel;
        let at = if is_shared { 0 } else { pixel * self.per_pixel };
        &self.table[at..at + self.per_pixel]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_square_has_one_sample() {
        for side_log2 in 0..=4 {
            for pattern in [Pattern::Regular, Pattern::Stratified { seed: 7 }] {
                let samples = Samples::new(side_log2, pattern);
                let square = SUBPIXELS / i64::from(samples.side);
                for number in 0..samples.per_pixel() {
                    let [x, y] = samples.place([3, 900], number).map(|c| c / square);
                    assert_eq!(y * i64::from(samples.side) + x, number as i64);
                }
            }
        }
        let [a, b] = [1, 2].map(|seed| {
            let samples = Samples::new(2, Pattern::Stratified { seed });
            [[3, 900], [4, 900], [3, 901]].map(|pixel| [0, 1].map(|n| samples.place(pixel, n)))
        });
        let mut places = [a, b].as_flattened().to_vec();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), 6, "seeds and pixels differ");
        let regular = |side_log2| Samples::new(side_log2, Pattern::Regular);
        assert_eq!([0, 1, 2].map(|log2| regular(log2).middle()), [0, 3, 10]);
    }
}
