//! Coverage error: differences between the `voxel` buffers of two pictures.

use serde::Serialize;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct CoverageError {
    pub pixels: u64,
    pub covered: u64,
    pub extra: u64,
    pub missing: u64,
    /// Pixels that show something in both, but another voxel or level.
    pub wrong_voxel: u64,
}

impl CoverageError {
    /// Compares two voxel buffers: index and level of each pixel, level -1 for nothing.
    /// Buffers of different lengths are compared as far as both go.
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

    pub fn differing(&self) -> u64 {
        self.extra + self.missing + self.wrong_voxel
    }
}

/// Pixels at which both show something, and the voxel of `test` neither is that of the reference nor
/// holds it. So a coarser voxel in the right place, as level of detail draws it, is not counted.
/// The object has `depth` levels.
pub(crate) fn count_elsewhere(test: &[[i32; 4]], reference: &[[i32; 4]], depth: u32) -> u64 {
    let holds = |outer: &[i32; 4], inner: &[i32; 4]| {
        let levels = (depth as i32 - outer[3]).clamp(0, 31);
        (0..3).all(|k| (outer[k] ^ inner[k]) as u32 >> levels == 0) || levels > 30
    };
    let both = test.iter().zip(reference);
    both.filter(|(t, r)| t[3] >= 0 && r[3] >= 0 && !holds(t, r))
        .count() as u64
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
        const NONE: [i32; 4] = [0, 0, 0, -1];
        let (v, w) = ([1, 2, 3, 4], [1, 2, 3, 5]);
        let of = CoverageError::between(&[v, v, NONE, NONE, v], &[v, w, v, NONE, NONE]);
        let found = [of.pixels, of.covered, of.extra, of.missing, of.wrong_voxel];
        assert_eq!((found, of.differing()), ([5, 3, 1, 1, 1], 3));
        assert_eq!(count_differing(&[1, 2, 3], &[1, 5]), 2);
        // A coarser voxel in its place is not elsewhere. Of a depth of 3: level 2 holds two voxels a side.
        let tests = [
            [5, 6, 7, 3],
            [4, 6, 6, 2],
            [0, 6, 6, 2],
            [5, 6, 6, 3],
            [0; 4],
            NONE,
        ];
        let elsewhere = tests.map(|test| count_elsewhere(&[test], &[tests[0]], 3));
        assert_eq!(elsewhere, [0, 0, 1, 1, 0, 0]);
        assert_eq!(count_elsewhere(&[v], &[NONE], 3), 0);
    }
}
