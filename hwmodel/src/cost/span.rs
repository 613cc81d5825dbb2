//! Two ways to find the least and the greatest of several values.

use serde::{Deserialize, Serialize};

/// The hardware of a span: the least and the greatest of `n` values.
///
/// The machine executes `n - 1` minima and `n - 1` maxima, each a compare and a select: 7 + 7 for the eight vertices of a
/// cage. In pairs, one compare orders two values and serves both. The smaller ones then enter a tree of minima and the
/// larger ones one of maxima: 4 + 3 + 3 = 10 compares. There are still 14 selects: 8 for the pairs, 3 + 3 in the trees.
///
/// ```
/// use hwmodel::cost::MinMaxUnits;
///
/// assert_eq!(MinMaxUnits::Each.compares_and_selects(8), (14, 14));
/// assert_eq!(MinMaxUnits::Pairs.compares_and_selects(8), (10, 14));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum MinMaxUnits {
    /// Each minimum and each maximum alone: 7 and 7 for eight values.
    #[default]
    #[cfg_attr(feature = "clap", value(name = "trees"))]
    Each,
    /// Values in pairs first: 10 compares and 14 selects. Only for corner cages.
    Pairs,
}

impl MinMaxUnits {
    /// Compares and selects for the span of `values` values; none for fewer than two.
    pub const fn compares_and_selects(self, values: u64) -> (u64, u64) {
        if values < 2 {
            return (0, 0);
        }
        let each = 2 * (values - 1);
        match self {
            Self::Each => (each, each),
            // An odd one enters both trees.
            Self::Pairs => (each - values / 2, each),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Does it, counting.
    fn in_pairs(values: &[i32]) -> ((i32, i32), (u64, u64)) {
        let (mut compares, mut selects) = (0, 0);
        let (mut least, mut greatest) = (Vec::new(), Vec::new());
        for pair in values.chunks(2) {
            match *pair {
                [a, b] => {
                    compares += 1;
                    selects += 2;
                    least.push(if a < b { a } else { b });
                    greatest.push(if a < b { b } else { a });
                }
                _ => {
                    least.push(pair[0]);
                    greatest.push(pair[0]);
                }
            }
        }
        let mut tree = |of: &[i32], choose: fn(i32, i32) -> i32| {
            of.iter().copied().reduce(|a, b| {
                compares += 1;
                selects += 1;
                choose(a, b)
            })
        };
        let span = (tree(&least, i32::min), tree(&greatest, i32::max));
        ((span.0.unwrap(), span.1.unwrap()), (compares, selects))
    }

    #[test]
    fn pairs_find_the_span_in_so_many_steps() {
        for n in 2..=17u64 {
            let values: Vec<i32> = (0..n as i32).map(|i| (i * 7919) % 101 - 50).collect();
            let (span, counts) = in_pairs(&values);
            let expected = (*values.iter().min().unwrap(), *values.iter().max().unwrap());
            assert_eq!(span, expected, "{n} values");
            assert_eq!(
                MinMaxUnits::Pairs.compares_and_selects(n),
                counts,
                "{n} values"
            );
        }
        assert_eq!(MinMaxUnits::Pairs.compares_and_selects(8), (10, 14));
        assert_eq!(MinMaxUnits::Each.compares_and_selects(1), (0, 0));
    }
}
