//! The few steps that work on many lanes at once, and the instruction sets
//! that have them: a scalar twin that defines what they do, and faster ones
//! that must equal it (tests at the end of this file).
//!
//! An instruction set is a value that can only be had where the processor has
//! it. Whoever holds one may call its steps. The walk itself is compiled once
//! for each set ([`Isa::clip`], [`Isa::screen`] and the others), so that the steps become a
//! few instructions in the middle of it and not calls.

mod reals;
mod scalar;
#[cfg(target_arch = "x86_64")]
mod x86;
#[cfg(target_arch = "x86_64")]
mod x86_eight;
#[cfg(target_arch = "x86_64")]
mod x86_reals;

pub(super) use reals::Reals;
pub(super) use scalar::Scalar;
#[cfg(target_arch = "x86_64")]
pub(super) use x86::{Avx2, Avx512};

use super::canvas::{Extent, Window, Windows};
use super::clip::ClipRecord;
use super::parts::Parts;
use super::planes::Exact;
use super::screen::ScreenRecord;
use super::subtree::{LANES, STRIPS, Subtree};
use super::tables::{Coarse, Tables};
use super::walk::{Bounds, Walk};

/// An instruction set.
pub(super) trait Isa: Copy + Send + Sync + 'static {
    /// A clip-space record's turn: [`super::clip::turn`] compiled for this set.
    fn clip(self, walk: &mut Walk<'_, Self>, record: &ClipRecord);

    /// Changes a clip-space record to screen space and goes on there:
    /// `clip::change` compiled for this set. `false`: it may not change.
    fn change(self, walk: &mut Walk<'_, Self>, record: &ClipRecord) -> bool;

    /// A screen-space record's turn: [`super::screen::turn`] compiled for this set.
    fn screen(self, walk: &mut Walk<'_, Self>, subtree: &Subtree, record: &ScreenRecord);

    /// `screen::look_at_absent` compiled for this set.
    fn absent(self, walk: &mut Walk<'_, Self>, subtree: &Subtree, record: &ScreenRecord);

    /// Draws a solid tile by tile: `screen::draw_tiles` compiled for this set.
    fn tiles(self, walk: &mut Walk<'_, Self>, subtree: &Subtree, record: &ScreenRecord);

    /// Draws a node by samples: `brick::draw_node` compiled for this set.
    fn brick(
        self,
        walk: &mut Walk<'_, Self>,
        subtree: &Subtree,
        record: &ScreenRecord,
        octant: u8,
        parts: &Parts,
    );

    /// Draws a node three levels above the finest by samples: `tall::draw_node` compiled for this set.
    fn tall(
        self,
        walk: &mut Walk<'_, Self>,
        subtree: &Subtree,
        record: &ScreenRecord,
        octant: u8,
        parts: &Parts,
    );

    /// Makes the tables of a subtree's parts: [`Tables::make_parts`] compiled for this set.
    fn tables(self, tables: &mut Tables, subtree: &Subtree, left: u32, octant: u8);

    /// Whether a sample is in a cube's silhouette: [`Exact::covers`] compiled for this set.
    fn covers(self, exact: &Exact, min: [i32; 3], side: i32, sample: [i32; 2]) -> bool;

    /// Eight `f64`.
    type Reals: Reals;

    /// Takes eight `f64`.
    fn reals(self, values: &[f64; 8]) -> Self::Reals;

    /// Eight times the same `f64`.
    fn real(self, value: f64) -> Self::Reals;

    /// Whole numbers below 2^31 as such.
    fn whole(self, values: Self::Reals) -> Self::Eight;

    /// The samples from the least to the greatest of eight places, in samples,
    /// across and down, widened by a margin. What is beyond 2^30 is cut.
    fn samples_between(self, x: Self::Reals, y: Self::Reals, margin: f64) -> Window;

    /// Eight functions' values.
    type Eight: Copy;

    /// Takes eight values.
    fn load(self, values: &[i32; LANES]) -> Self::Eight;

    /// Lane by lane, `a + b`, modulo 2^32.
    fn add(self, a: Self::Eight, b: Self::Eight) -> Self::Eight;

    /// Lane by lane, `a - b`, modulo 2^32.
    fn sub(self, a: Self::Eight, b: Self::Eight) -> Self::Eight;

    /// Lane by lane, `a + b times`, modulo 2^32.
    fn plus_times(self, a: Self::Eight, b: Self::Eight, times: i32) -> Self::Eight;

    /// Whether `0 <= a <= b` in all lanes; no lane of `b` is negative.
    fn all_within(self, a: Self::Eight, b: Self::Eight) -> bool;

    /// The eight values.
    fn store(self, values: Self::Eight) -> [i32; LANES];

    /// Lane by lane, `-a`.
    fn negative(self, a: Self::Eight) -> Self::Eight;

    /// Lane by lane, `a + (b << places)`.
    fn plus_shifted(self, a: Self::Eight, b: Self::Eight, places: u32) -> Self::Eight;

    /// The samples that a box holds, cut to the band's, and how many they are: `(lane + bias) >> box bits` of the last four lanes, and the origin.
    fn window(
        self,
        place: Self::Eight,
        bias: &[i32; 4],
        subtree: &Subtree,
        bounds: &Bounds,
    ) -> (Window, Extent);

    /// [`Isa::window`] of all eight children at once. `place`: their parent's;
    /// `left`: levels from them to the finest.
    fn windows(
        self,
        place: &[i32; LANES],
        left: u32,
        bias: &[i32; 4],
        subtree: &Subtree,
        bounds: &Bounds,
    ) -> Windows;

    /// The samples from column `x` and row `y` of a tile on, of the tile and the
    /// one below (`across` entries on, less than 2^16), moved to column 0; and
    /// of those to the right of both, moved to column `8 - x`. What is beyond
    /// the tiles' end is 0.
    fn square_of(self, tiles: &[u64], at: usize, across: usize, x: u32, y: u32) -> [u64; 2];

    /// Puts `value` to the entries of `rows` that `samples` has bits for, eight
    /// bits a row of `width` entries, from entry `first` on.
    fn put(self, rows: &mut [u32], first: usize, width: usize, samples: u64, value: u32);

    /// The samples `i` of a square for which `start + table[i]` is within
    /// twice the bound for all three strips, modulo 2^16.
    fn square_within(
        self,
        tables: &[[i16; 64]; STRIPS],
        start: Self::Eight,
        bound: &[i32; LANES],
    ) -> u64;

    /// The children `i` with `value - table[i] <= width`, modulo 2^32, without
    /// sign, for all of the tables' functions: the three strips, which are the
    /// first lanes of `value` and `width`, and the box, the fifth and sixth.
    fn children_within(
        self,
        tables: &[[i32; 8]; STRIPS + 2],
        value: Self::Eight,
        width: &[i32; LANES],
    ) -> u8;

    /// The lanes `i` with `byte - table[i] <= width`, modulo 2^8, without sign,
    /// for all three strips; `byte` is a strip's value after its shift. `few`:
    /// only the first 8 lanes are of interest.
    fn strips_within(self, coarse: &Coarse, start: Self::Eight, few: bool) -> u64;

    /// In byte `8 i + j`: `(2 children[i] >> shift) + (children[j] >> shift)`,
    /// modulo 2^8. `few`: in byte `j` of the first eight `children[j] >> shift`.
    fn byte_table(self, table: &mut [u8; 64], children: &[i32; 8], shift: u32, few: bool);

    /// In entry `8 y + x`: `across x + down y`, modulo 2^16.
    fn square_table(self, table: &mut [i16; 64], across: i32, down: i32);

    /// The lowest bytes spread to those bytes that `mask` has a bit for, in
    /// order; `exist`: a byte of ones for each such bit.
    fn spread(self, bytes: u64, mask: u8, exist: u64) -> u64;

    /// Eight child masks, by octant, with children and masks in occlusion order.
    fn masks_in_order(self, masks: u64, octant: u8) -> u64;

    /// The lanes `i` with `start + table[i] <= width`, modulo 2^32, without sign.
    fn within_wide(self, table: &[i32; 64], start: i32, width: u32) -> u64;
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// All steps of a set, and of the scalar twin, on the same numbers.
    fn agrees<I: Isa>(isa: I, bytes: &[u8], words: &[i32], few: bool) {
        let eight = |at: usize| -> [i32; LANES] { std::array::from_fn(|i| words[at + i]) };
        let coarse = Coarse {
            parts: std::array::from_fn(|t| std::array::from_fn(|i| bytes[64 * t + i])),
            width: std::array::from_fn(|t| [bytes[320 + t]; 32]),
            shift: std::array::from_fn(|t| i32::from(bytes[330 + t] & 31)),
        };
        let relevant = if few { 0xff } else { u64::MAX };
        let start = eight(0);
        assert_eq!(
            isa.strips_within(&coarse, isa.load(&start), few) & relevant,
            Scalar.strips_within(&coarse, start, few) & relevant
        );
        for width in [
            eight(8).map(|w| w & i32::MAX),
            [-1; LANES],
            [i32::MAX; LANES],
        ] {
            let tables = std::array::from_fn(|f| std::array::from_fn(|i| words[8 * f + i + 1]));
            assert_eq!(
                isa.children_within(&tables, isa.load(&start), &width),
                Scalar.children_within(&tables, start, &width)
            );
        }
        for shift in [0, 3, 17] {
            let (mut mine, mut twin) = ([0; 64], [0; 64]);
            let children: [i32; 8] = std::array::from_fn(|i| words[80 + i] >> 2);
            isa.byte_table(&mut mine, &children, shift, few);
            Scalar.byte_table(&mut twin, &children, shift, few);
            let count = if few { 8 } else { 64 };
            assert_eq!(mine[..count], twin[..count]);
        }
        let (mut mine, mut twin) = ([0; 64], [0; 64]);
        isa.square_table(&mut mine, words[93], words[94]);
        Scalar.square_table(&mut twin, words[93], words[94]);
        assert_eq!(mine, twin);
        let tiles: [u64; 8] =
            std::array::from_fn(|i| u64::from_le_bytes(std::array::from_fn(|k| bytes[8 * i + k])));
        let samples = u64::from_le_bytes(std::array::from_fn(|i| bytes[384 + i]));
        let (mut mine, mut twin) = ([0; 70], [0; 70]);
        // The last rows end where the entries do.
        let samples = samples & 0x0f0f_0f0f_0f0f_0f0f;
        isa.put(&mut mine, 3, 9, samples, 7);
        Scalar.put(&mut twin, 3, 9, samples, 7);
        assert_eq!(mine, twin);
        for (at, across) in [(0, 4), (3, 3), (2, 5), (6, 3), (usize::MAX, 3), (0, 70)] {
            let (x, y) = (u32::from(bytes[380] & 7), u32::from(bytes[381] & 7));
            for (x, y) in [(x, y), (x, 0), (0, y)] {
                assert_eq!(
                    isa.square_of(&tiles, at, across, x, y),
                    Scalar.square_of(&tiles, at, across, x, y)
                );
            }
        }
        for mask in [0, 0xff, bytes[360], bytes[361]] {
            let exist = (0..8).fold(0u64, |all, bit| {
                all | (u64::from(mask >> bit & 1) * 0xff) << (8 * bit)
            });
            let eight = u64::from_le_bytes(std::array::from_fn(|i| bytes[370 + i]));
            assert_eq!(
                isa.spread(eight, mask, exist),
                Scalar.spread(eight, mask, exist)
            );
            for octant in 0..8 {
                assert_eq!(
                    isa.masks_in_order(eight, octant),
                    Scalar.masks_in_order(eight, octant)
                );
            }
        }
        let wide: [i32; 64] = std::array::from_fn(|i| words[16 + i]);
        assert_eq!(
            isa.within_wide(&wide, words[90], words[91] as u32),
            Scalar.within_wide(&wide, words[90], words[91] as u32)
        );
        let (a, b, times) = (eight(0), eight(8), words[92]);
        let pairs = [
            (isa.add(isa.load(&a), isa.load(&b)), Scalar.add(a, b)),
            (isa.sub(isa.load(&a), isa.load(&b)), Scalar.sub(a, b)),
            (
                isa.plus_times(isa.load(&a), isa.load(&b), times),
                Scalar.plus_times(a, b, times),
            ),
            (isa.negative(isa.load(&a)), Scalar.negative(a)),
            (
                isa.plus_shifted(isa.load(&a), isa.load(&b), 3),
                Scalar.plus_shifted(a, b, 3),
            ),
        ];
        for (mine, twin) in pairs {
            assert_eq!(isa.store(mine), twin);
        }
        let squares: [[i16; 64]; STRIPS] = std::array::from_fn(|t| {
            std::array::from_fn(|i| i16::from(bytes[64 * t + i]).wrapping_mul(257))
        });
        // Half widths as they are: twice of them fits sixteen bits.
        let half = b.map(|half| half & 0x7fff);
        assert_eq!(
            isa.square_within(&squares, isa.load(&a), &half),
            Scalar.square_within(&squares, a, &half)
        );
        let near: [i32; LANES] = std::array::from_fn(|i| a[i] >> 1);
        let limit: [i32; LANES] = std::array::from_fn(|i| (b[i] >> 1).abs() | 0x2000_0000);
        assert_eq!(
            isa.all_within(isa.load(&near), isa.load(&limit)),
            Scalar.all_within(near, limit)
        );
        for lane in 0..LANES {
            let mut one = [0; LANES];
            one[lane] = 5;
            assert!(isa.all_within(isa.load(&one), isa.load(&[5; LANES])));
            assert!(!isa.all_within(isa.load(&one), isa.load(&[4; LANES])));
            one[lane] = -5;
            assert!(!isa.all_within(isa.load(&one), isa.load(&[5; LANES])));
        }
    }

    /// The windows of a record and of its children, of a set and of the scalar
    /// twin. `words`: any numbers.
    fn windows_agree<I: Isa>(isa: I, words: &[i32], left: u32) {
        let small = |at: usize| words[at] >> 8;
        let child: [[i32; LANES]; 8] =
            std::array::from_fn(|octant| std::array::from_fn(|f| small(8 * octant + f) >> left));
        let subtree = Subtree {
            finest: 0,
            finest_side: 1,
            step: [[0; LANES]; 2],
            box_bits: 11 + left,
            half_width: [0; LANES],
            reach: [0; LANES],
            bound: [0; LANES],
            doubt: [0; LANES],
            half_edge: [[0; LANES]; 3],
            child,
            child_box: [4, 5].map(|f| child.map(|functions| functions[f])),
            origin: [64, 65, 64, 65].map(|at| small(at) & 0xff8),
            octant: None,
            is_coarse: false,
        };
        let place: [i32; LANES] = [66, 67, 68, 69, 70, 71, 70, 71].map(small);
        let bias: [i32; 4] = std::array::from_fn(|i| small(72 + i) >> 6);
        let bounds = Bounds {
            least: [-40, 0, i32::MIN, i32::MIN],
            greatest: [i32::MAX, i32::MAX, 4000, small(76) & 0xfff],
            tiles_across: words[77] & 0x3ff,
            first_tile: words[78] & 0xffff,
        };
        let mine = isa.windows(&place, left, &bias, &subtree, &bounds);
        let twin = Scalar.windows(&place, left, &bias, &subtree, &bounds);
        assert_eq!(mine, twin);
        assert_eq!(
            isa.window(isa.load(&place), &bias, &subtree, &bounds),
            Scalar.window(place, &bias, &subtree, &bounds)
        );
        for octant in 0..8 {
            let at = Scalar.plus_shifted(place, child[octant], left);
            let same_lanes = [at[0], at[1], at[2], at[3], at[4], at[5], at[4], at[5]];
            let (window, extent) = Scalar.window(same_lanes, &bias, &subtree, &bounds);
            assert_eq!(twin.at(octant), window);
            assert_eq!(twin.held >> octant & 1 == 0, extent == Extent::Empty);
            assert_eq!(twin.square >> octant & 1 != 0, extent == Extent::Square);
        }
    }

    /// All steps on `f64` of a set, and of the scalar twin. `x`: any whole
    /// numbers below 2^31; `w`: whole numbers from 1 on.
    fn reals_agree<I: Isa>(isa: I, x: &[f64; 8], y: &[f64; 8], w: &[f64; 8]) {
        let mine = (isa.reals(x), isa.reals(y), isa.reals(w));
        let twin = (Scalar.reals(x), Scalar.reals(y), Scalar.reals(w));
        // Whole numbers, so that all that is compared is exact.
        let same = |mine: I::Reals, twin| {
            assert_eq!(isa.store(isa.whole(mine)), Scalar.whole(twin));
        };
        let quotients = (mine.0.over(mine.2), twin.0.over(twin.2));
        same(quotients.0.floor(), quotients.1.floor());
        same(quotients.0.trunc(), quotients.1.trunc());
        same(mine.0.abs(), twin.0.abs());
        same(mine.0.least(mine.1), twin.0.least(twin.1));
        same(mine.0.greatest(mine.1), twin.0.greatest(twin.1));
        same(mine.0.is_at_least(mine.1), twin.0.is_at_least(twin.1));
        same(mine.0.is_at_least(mine.0), twin.0.is_at_least(twin.0));
        let half = (isa.real(0.5), Scalar.real(0.5));
        let fused = (mine.0.fused(half.0, half.0), twin.0.fused(half.1, half.1));
        same(fused.0.floor(), fused.1.floor());
        let less = (
            (mine.0 - mine.1) * isa.real(0.25) + mine.0 * isa.real(0.5),
            (twin.0 - twin.1) * Scalar.real(0.25) + twin.0 * Scalar.real(0.5),
        );
        same(less.0.floor(), less.1.floor());
        assert_eq!(mine.0.any_negative(), twin.0.any_negative());
        assert_eq!(mine.2.any_negative(), twin.2.any_negative());
        let scaled = (mine.2 * mine.2.scale_to(9), twin.2 * twin.2.scale_to(9));
        same(scaled.0.floor(), scaled.1.floor());
        let (total, edges) = mine.0.sums();
        let (twin_total, twin_edges) = twin.0.sums();
        assert_eq!(total, twin_total);
        assert_eq!(edges.first(), twin_edges.first());
        for margin in [0.0, 0.25, 2.0] {
            assert_eq!(
                isa.samples_between(quotients.0, mine.1, margin),
                Scalar.samples_between(quotients.1, twin.1, margin)
            );
        }
    }

    proptest! {
        #[test]
        fn reals_agree_with_the_scalar_twin(
            numbers in proptest::collection::vec(-(1i32 << 27)..1 << 27, 24),
        ) {
            let at = |from: usize| -> [f64; 8] {
                std::array::from_fn(|i| f64::from(numbers[from + i]))
            };
            let depths = at(16).map(|w| w.abs() + 1.0);
            if let Some(isa) = Avx2::detect() {
                reals_agree(isa, &at(0), &at(8), &depths);
            }
            if let Some(isa) = Avx512::detect() {
                reals_agree(isa, &at(0), &at(8), &depths);
            }
        }

        #[test]
        fn all_sets_agree_with_the_scalar_twin(
            bytes in proptest::collection::vec(any::<u8>(), 400),
            words in proptest::collection::vec(any::<i32>(), 100),
            few in any::<bool>(),
        ) {
            if let Some(isa) = Avx2::detect() {
                agrees(isa, &bytes, &words, few);
                windows_agree(isa, &words, u32::from(bytes[399] & 7));
            }
            if let Some(isa) = Avx512::detect() {
                agrees(isa, &bytes, &words, few);
                windows_agree(isa, &words, u32::from(bytes[399] & 7));
            }
        }
    }
}
