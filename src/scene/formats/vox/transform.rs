//! Rotations in one byte, and the index of a transformed voxel.

/// A signed permutation of the axes and a translation, applied in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Transform {
    /// `source[row]`: the axis whose coordinate goes to axis `row`.
    source: [u8; 3],
    sign: [i64; 3],
    translation: [i64; 3],
}

impl Transform {
    pub(super) const IDENTITY: Self = Self {
        source: [0, 1, 2],
        sign: [1; 3],
        translation: [0; 3],
    };

    /// Bits 0-1 and 2-3 are the columns of the first and the second row's entry, bits 4 to 6 negative rows. The third
    /// row takes the column that is left. `None` where two rows claim one column, or a column does not exist.
    pub(super) fn from_rotation_byte(byte: u8) -> Option<Self> {
        let first = byte & 3;
        let second = byte >> 2 & 3;
        if first == 3 || second == 3 || first == second || byte >> 7 != 0 {
            return None;
        }
        let sign = |bit: u8| if byte >> bit & 1 == 1 { -1 } else { 1 };
        Some(Self {
            source: [first, second, 3 - first - second],
            sign: [sign(4), sign(5), sign(6)],
            translation: [0; 3],
        })
    }

    pub(super) fn with_translation(self, translation: [i32; 3]) -> Self {
        Self {
            translation: translation.map(i64::from),
            ..self
        }
    }

    #[inline]
    fn rotate(&self, v: [i64; 3]) -> [i64; 3] {
        std::array::from_fn(|row| self.sign[row] * v[usize::from(self.source[row])])
    }

    /// First `inner`, then `self`. `None` where the translation leaves 62 bits.
    pub(super) fn after(&self, inner: &Self) -> Option<Self> {
        let moved = self.rotate(inner.translation);
        let mut translation = [0; 3];
        for axis in 0..3 {
            let sum = moved[axis].checked_add(self.translation[axis])?;
            if sum.unsigned_abs() >> 62 != 0 {
                return None;
            }
            translation[axis] = sum;
        }
        Some(Self {
            source: std::array::from_fn(|row| inner.source[usize::from(self.source[row])]),
            sign: std::array::from_fn(|row| {
                self.sign[row] * inner.sign[usize::from(self.source[row])]
            }),
            translation,
        })
    }

    /// The index of a transformed voxel of a model of this size.
    ///
    /// MagicaVoxel rotates a model about the lattice point `floor(size / 2)`. In units of half a voxel, a voxel's centre
    /// is `2 (p - floor(size / 2)) + 1`. Half of the rotated centre, rounded down, is the index.
    #[inline]
    pub(super) fn place(&self, position: [i64; 3], size: [u32; 3]) -> [i64; 3] {
        let center: [i64; 3] =
            std::array::from_fn(|axis| 2 * (position[axis] - i64::from(size[axis] / 2)) + 1);
        let turned = self.rotate(center);
        std::array::from_fn(|axis| (turned[axis] >> 1) + self.translation[axis])
    }
}
