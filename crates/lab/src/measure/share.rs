//! How much of each pixel shows something, against a reference of many samples: too much (bloat),
//! too little, and the same on thin things alone.

/// Width of a picture, and the covered share of each pixel, 0 to 1.
pub(crate) type Shares<'s> = (usize, &'s [f32]);

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct ShareError {
    pub(crate) area: f64,
    /// `test - reference`. Above 0: things are too large.
    signed: f64,
    /// `|test - reference|`.
    absolute: f64,
}

impl ShareError {
    /// Bloat as a part of the area: 0.1 if a tenth too much is covered, 0 without any area.
    pub(crate) fn bias(&self) -> f64 {
        self.of_area(self.signed)
    }

    pub(crate) fn relative(&self) -> f64 {
        self.of_area(self.absolute)
    }

    fn of_area(&self, sum: f64) -> f64 {
        match self.area > 0.0 {
            true => sum / self.area,
            false => 0.0,
        }
    }

    fn add(&mut self, test: f32, reference: f32) {
        let apart = f64::from(test) - f64::from(reference);
        self.area += f64::from(reference);
        self.signed += apart;
        self.absolute += apart.abs();
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct CoverageBias {
    pub(crate) all: ShareError,
    pub(crate) thin: ShareError,
}

impl CoverageBias {
    pub(crate) fn between(test: &[f32], reference: Shares<'_>) -> Self {
        let mut bias = Self::default();
        for (at, (&t, &r)) in test.iter().zip(reference.1).enumerate() {
            bias.all.add(t, r);
            if is_thin(reference, at) {
                bias.thin.add(t, r);
            }
        }
        bias
    }
}

/// Whether a pixel shows a thing that is thinner than a pixel: it is covered in part, and none of its
/// eight neighbours is covered in full.
///
/// A pixel on an outline or at a corner has a fully covered neighbour on the inner side. A wire thinner
/// than a pixel has none.
fn is_thin((width, shares): Shares<'_>, at: usize) -> bool {
    let here = shares[at];
    if here <= 0.0 || here >= 1.0 {
        return false;
    }
    let (x, y) = (at % width, at / width);
    let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    near(y, shares.len() / width).all(|y| near(x, width).all(|x| shares[y * width + x] < 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bloat_has_a_sign() {
        let reference = [0.0, 0.25, 1.0, 0.0];
        for (test, signed, absolute) in [
            (reference, 0.0, 0.0),
            ([0.0, 1.0, 1.0, 0.5], 1.25, 1.25),
            // Too much in one place and too little in another cancel in one sum only.
            ([0.25, 0.0, 1.0, 0.0], 0.0, 0.5),
            ([0.0; 4], -1.25, 1.25),
        ] {
            let all = CoverageBias::between(&test, (4, &reference)).all;
            let found = (all.area, all.bias(), all.relative());
            assert_eq!(found, (1.25, signed / 1.25, absolute / 1.25));
        }
        assert_eq!(ShareError::default().bias(), 0.0);
    }

    #[test]
    fn wires_are_thin_and_rims_are_not() {
        let thin = |width: usize, shares: &[f32]| -> Vec<usize> {
            let is = |at: &usize| is_thin((width, shares), *at);
            (0..shares.len()).filter(is).collect()
        };
        // A wire down the second column, one across a border of columns, and a block from the eighth on
        // with a rim covered by half.
        let row = [0.0, 0.3, 0.0, 0.6, 0.2, 0.0, 0.0, 0.5, 1.0, 1.0];
        assert_eq!(
            thin(10, &[[0.0; 10], row, row].concat()),
            [11, 13, 14, 21, 23, 24]
        );
        // The corner of a block is not thin: its inner neighbour is full.
        assert!(thin(3, &[0.0, 0.0, 0.0, 0.0, 0.2, 0.5, 0.0, 0.5, 1.0]).is_empty());
        // Errors on thin pixels are counted by themselves.
        let bias = CoverageBias::between(&[0., 1., 0., 0.5, 0.], (5, &[0., 0.25, 0., 0.5, 1.]));
        assert_eq!((bias.thin.bias(), bias.all.signed), (3.0, -0.25));
    }
}
