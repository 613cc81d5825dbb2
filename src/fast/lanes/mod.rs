//! The few steps that work on many lanes at once, and the instruction sets
//! that have them: plain code that defines what they do, and AVX2.
//!
//! An instruction set is a value that can only be had where the processor has
//! it. Whoever holds one may call its steps. The traversal is compiled once
//! for each set (`compiled.rs`), so that these steps become a
//! few instructions in the middle of it and not calls.
//!
//! Sets may round differently (AVX2 multiplies and adds in one step). No
//! picture depends on that: what rounding could decide is decided exactly.

mod scalar;
#[cfg(target_arch = "x86_64")]
mod x86;

pub(super) use scalar::Scalar;
#[cfg(target_arch = "x86_64")]
pub(super) use x86::Avx2;

use super::constants::Constants;
use super::strips::Row;
use super::window::Window;

/// Four `f32`: three axes, and a fourth lane that is not used.
pub(super) trait Four: Copy + Send + Sync + std::fmt::Debug {
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    /// `self * by + plus`.
    fn fma(self, by: Self, plus: Self) -> Self;
    /// `self * by - less`.
    fn fms(self, by: Self, less: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn min(self, other: Self) -> Self;
    fn abs(self) -> Self;
    /// With the sign turned where `signs` (0 or -0) has one.
    fn flip(self, signs: Self) -> Self;
    /// By axis, the value along the next axis (modulo 3).
    fn next(self) -> Self;
    /// By axis, the value along the axis after that.
    fn last(self) -> Self;
    /// Sign bits, the first lane's lowest.
    fn signs(self) -> u32;
    /// Whole parts of the first three, as cells of a table: what is outside is the last one.
    fn cells(self) -> [usize; 3];
    fn values(self) -> [f32; 4];
    /// Rounded down.
    fn floor(self) -> Self;
    /// All lanes' sums: this one's, the other's, and both again.
    fn sums(self, other: Self) -> Self;
    /// Whole numbers, of lanes that are whole and small.
    fn whole(self) -> [i32; 4];
}

/// The windows of a node's eight children, by octant, cut to the band.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Windows {
    /// Left, top, right and bottom.
    pub(super) sides: [[i32; 8]; 4],
    /// Which have a sample, one bit each. Of those that are near: of no meaning.
    pub(super) held: u8,
    /// Which reach to the eye's plane or behind it.
    pub(super) near: u8,
}

impl Windows {
    #[inline(always)]
    pub(super) fn at(&self, octant: u8) -> Window {
        let [left, top, right, bottom] =
            [0, 1, 2, 3].map(|i| self.sides[i][usize::from(octant & 7)]);
        Window {
            left,
            top,
            right,
            bottom,
        }
    }
}

/// Beyond the rounding that it is for, what windows are wider by, in samples.
pub(super) const WINDOW_MARGIN: f32 = 1.0 / 512.0;
/// The rounding of `f32`, with room: of positions, and of extents.
const WINDOW_ROUNDING: f32 = 1.0 / (1 << 21) as f32;
/// What extents are larger by, for an inverse of 11 bits and their own rounding.
const WINDOW_SCALE: f32 = 1.0 + 1.0 / 256.0;
/// What windows in `f64` are wider by, of what they are made of and in samples.
const TINY_WINDOW_MARGIN: f64 = 1.0 / (1u64 << 40) as f64;
/// Columns and rows beyond all pictures.
pub(super) const BEYOND: f64 = 40_000.0;

/// An instruction set.
pub(super) trait Isa: Copy + Send + Sync + std::fmt::Debug + 'static {
    type Four: Four;
    /// A number of 16 bits for each sample of a square.
    type Distances: Copy;

    fn four(self, values: &[f32; 4]) -> Self::Four;
    fn splat(self, value: f32) -> Self::Four;

    /// The windows of the children of a node of level `level`, whose centre's
    /// clip vector is given, in a band. A child's window holds all samples in its box.
    fn windows(
        self,
        constants: &Constants,
        level: usize,
        centre: &[f64; 3],
        band: &Window,
    ) -> Windows;

    /// By open sample of a square, which of the `wanted` parts the tables name, in
    /// `candidates`; returns the open samples that have any, eight bits a row. `cells`: the three
    /// functions' values in cells at the first sample, and what a column and a row add.
    fn parts_of_samples(
        self,
        tables: [&Row; 3],
        cells: &[Self::Four; 3],
        wanted: u64,
        open: u64,
        candidates: &mut Candidates,
    ) -> u64;

    /// How far the three functions are from 0 at most, by sample of a square: values, at the first
    /// sample and by column and row, are rounded to whole numbers; where they leave 16 bits the
    /// answer is of no use.
    fn distances(self, values: &[Self::Four; 3]) -> Self::Distances;

    /// The samples at which distances are below a limit, eight bits a row.
    fn below(self, distances: &Self::Distances, limit: i16) -> u64;

    /// The middle and half the extent, along each axis, of the box around parts of a node: from its
    /// centre, in sides of a part.
    fn extent(self, parts: u64) -> [Self::Four; 2];

    /// What a step of a column, and of a row, adds to moments about what lies at `centre`
    /// (column and row): `edges` by coordinate, times `unit`.
    fn steps(self, edges: &[[f64; 4]; 3], centre: [f64; 2], unit: f64) -> [Self::Four; 2];

    /// [`super::orders::turned_parts`].
    fn turned_parts(self, parts: u64, octant: u8) -> u64;

    /// Bytes one after the other at the places of a mask's bits, and ones there.
    fn spread(self, bytes: u64, mask: u8) -> (u64, u64);

    /// Asks the memory for an entry that will be read soon, if there is such an entry.
    fn prefetch<T>(self, entries: &[T], at: usize);

    /// Writes a value to rows of eight entries, `width` apart, where samples are.
    fn put(self, rows: &mut [u32], first: usize, width: usize, samples: u64, value: u32);
}

/// By sample of a square: the parts that its line may meet.
#[derive(Debug)]
#[repr(C, align(32))]
pub(super) struct Candidates(pub(super) [u64; 64]);
