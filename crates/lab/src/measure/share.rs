//! How much of each pixel shows something, against a reference of many
//! samples: too much (bloat), too little, and the same on thin things alone.

use serde::Serialize;

use super::SizeError;
use super::color::check_sizes;

/// The share of each pixel that shows something, 0 to 1, and the picture's size.
pub type Shares<'s> = (u32, u32, &'s [f32]);

/// How far the shares of two pictures are apart, over some pixels.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct ShareError {
    /// Pixels examined.
    pub pixels: u64,
    /// Sum of the reference's shares, pixels: the area that is seen.
    pub area: f64,
    /// Sum of `test - reference`, pixels. Above 0: things are too large.
    pub signed: f64,
    /// Sum of `|test - reference|`, pixels.
    pub absolute: f64,
}

impl ShareError {
    /// Bloat as a part of the area: 0.1 if a tenth too much is covered, 0 without any area.
    #[must_use]
    pub fn bias(&self) -> f64 {
        self.of_area(self.signed)
    }

    /// Excess plus lack, as a part of the area.
    #[must_use]
    pub fn relative(&self) -> f64 {
        self.of_area(self.absolute)
    }

    fn of_area(&self, sum: f64) -> f64 {
        if self.area > 0.0 {
            sum / self.area
        } else {
            0.0
        }
    }

    fn add(&mut self, test: f32, reference: f32) {
        let (test, reference) = (f64::from(test), f64::from(reference));
        self.pixels += 1;
        self.area += reference;
        self.signed += test - reference;
        self.absolute += (test - reference).abs();
    }
}

/// The errors on all pixels, and on thin ones alone.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct CoverageBias {
    /// All pixels.
    pub all: ShareError,
    /// Pixels of things that are thinner than a pixel: see [`is_thin`].
    pub thin: ShareError,
}

impl CoverageBias {
    /// Compares the shares of a picture with those of a reference.
    ///
    /// # Errors
    /// When the sizes differ.
    pub fn between(test: Shares<'_>, reference: Shares<'_>) -> Result<Self, SizeError> {
        check_sizes((test.0, test.1), (reference.0, reference.1))?;
        let mut bias = Self::default();
        for (at, (&t, &r)) in test.2.iter().zip(reference.2).enumerate() {
            bias.all.add(t, r);
            if is_thin(reference, at) {
                bias.thin.add(t, r);
            }
        }
        Ok(bias)
    }
}

/// Whether a pixel shows a thing that is thinner than a pixel: it is covered
/// in part, and none of its eight neighbours is covered in full.
///
/// A pixel on a straight outline has a fully covered neighbour on the inner side. So has a pixel at a
/// corner of a right angle or more. A wire thinner than a pixel has none, wherever it lies. (Empty
/// neighbours on both sides would be too strict: a wire can touch two rows.) Structures that are
/// porous below a pixel count as thin, too.
#[must_use]
pub fn is_thin((width, height, shares): Shares<'_>, at: usize) -> bool {
    let here = shares[at];
    if here <= 0.0 || here >= 1.0 {
        return false;
    }
    let (width, height) = (width as usize, height as usize);
    let (x, y) = (at % width, at / width);
    let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    near(y, height).all(|y| near(x, width).all(|x| shares[y * width + x] < 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bloat_has_a_sign() {
        let reference = [0.0, 0.25, 1.0, 0.0];
        let between = |test: &[f32]| CoverageBias::between((4, 1, test), (4, 1, &reference));
        let same = between(&reference).unwrap().all;
        assert_eq!((same.signed, same.absolute, same.area), (0.0, 0.0, 1.25));
        let more = between(&[0.0, 1.0, 1.0, 0.5]).unwrap().all;
        assert_eq!((more.signed, more.absolute), (1.25, 1.25));
        assert_eq!((more.bias(), more.relative()), (1.0, 1.0));
        // Too much in one place and too little in another cancel in one sum only.
        let moved = between(&[0.25, 0.0, 1.0, 0.0]).unwrap().all;
        assert_eq!((moved.signed, moved.absolute), (0.0, 0.5));
        let less = between(&[0.0; 4]).unwrap().all;
        assert_eq!((less.bias(), less.relative()), (-1.0, 1.0));
        assert!(CoverageBias::between((2, 1, &[0.0; 2]), (1, 2, &[0.0; 2])).is_err());
        assert_eq!(ShareError::default().bias(), 0.0);
    }

    #[test]
    fn wires_are_thin_and_rims_are_not() {
        // A wire down the second column, one across a border of columns, and a
        // block from the eighth on with a rim covered by half.
        let row = [0.0, 0.3, 0.0, 0.6, 0.2, 0.0, 0.0, 0.5, 1.0, 1.0];
        let shares: Vec<f32> = [[0.0; 10], row, row].concat();
        let thin: Vec<usize> = (0..shares.len())
            .filter(|&at| is_thin((10, 3, &shares), at))
            .collect();
        assert_eq!(thin, [11, 13, 14, 21, 23, 24]);
        // The corner of a block is not thin: its inner neighbour is full.
        let corner = [0.0, 0.0, 0.0, 0.0, 0.2, 0.5, 0.0, 0.5, 1.0];
        assert!((0..9).all(|at| !is_thin((3, 3, &corner), at)));
    }

    #[test]
    fn thin_errors_are_those_of_thin_pixels() {
        let reference = [0.0, 0.25, 0.0, 0.5, 1.0];
        let test = [0.0, 1.0, 0.0, 0.5, 0.0];
        let bias = CoverageBias::between((5, 1, &test), (5, 1, &reference)).unwrap();
        assert_eq!((bias.thin.pixels, bias.thin.signed), (1, 0.75));
        assert_eq!(bias.thin.bias(), 3.0);
        assert_eq!(bias.all.signed, -0.25);
    }
}
