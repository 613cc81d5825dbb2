//! Which pixels show something, and which voxel: the `voxel` buffers of two pictures.

use serde::Serialize;

/// How far two voxel buffers are apart; the first is the one under test, the
/// second the reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct CoverageError {
    /// Pixels of a picture.
    pub pixels: u64,
    /// Pixels that show something in the reference.
    pub covered: u64,
    /// Pixels that show something although the reference does not.
    pub extra: u64,
    /// Pixels that show nothing although the reference does.
    pub missing: u64,
    /// Pixels that show something in both, but another voxel or level.
    pub wrong_voxel: u64,
}

impl CoverageError {
    /// Compares two voxel buffers: index and level of each pixel, level -1 for nothing.
    /// Buffers of different lengths are compared as far as both go.
    #[must_use]
    pub fn between(test: &[[i32; 4]], reference: &[[i32; 4]]) -> Self {
        let mut error = Self::default();
        for (t, r) in test.iter().zip(reference) {
            error.pixels += 1;
            error.covered += u64::from(r[3] >= 0);
            match (t[3] >= 0, r[3] >= 0) {
                (true, false) => error.extra += 1,
                (false, true) => error.missing += 1,
                (true, true) => error.wrong_voxel += u64::from(t != r),
                (false, false) => {}
            }
        }
        error
    }

    /// Pixels that differ in any way.
    #[must_use]
    pub fn differing(&self) -> u64 {
        self.extra + self.missing + self.wrong_voxel
    }
}

/// Entries at which two sequences differ; what only one of them has counts too.
pub fn count_differing<T: PartialEq>(a: &[T], b: &[T]) -> u64 {
    let both = a.iter().zip(b).filter(|(x, y)| x != y).count();
    both as u64 + a.len().abs_diff(b.len()) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_of_error() {
        let none = [0, 0, 0, -1];
        let (v, w) = ([1, 2, 3, 4], [1, 2, 3, 5]);
        let error = CoverageError::between(&[v, v, none, none, v], &[v, w, v, none, none]);
        let expected = CoverageError {
            pixels: 5,
            covered: 3,
            extra: 1,
            missing: 1,
            wrong_voxel: 1,
        };
        assert_eq!(error, expected);
        assert_eq!(error.differing(), 3);
        assert_eq!(count_differing(&[1, 2, 3], &[1, 5]), 2);
    }
}
