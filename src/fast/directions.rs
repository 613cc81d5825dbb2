//! Squares, pieces of at most 8 x 8 samples of a window, and the directions of their lines.

use super::band::Band;
use super::constants::{Constants, DIRECTION_ERROR};
use super::exact::Exact;
use super::lanes::{F32x4, Floats, Isa};
use super::window::{Window, bits};

/// Roundings in `f32` of a line's values, each 2^-24 of the largest sum (`lines.gappa`).
const STEPS: f32 = 18.0;
/// Bound of the error in `f32` of a direction, a moment, and a distance, relative to the sizes of their terms.
pub(super) const LINE_ERROR: f32 = STEPS / (1 << 24) as f32;

#[derive(Debug, Clone, Copy)]
pub(super) struct Directions<I: Isa> {
    pub(super) middle: I::F32x4,
    pub(super) spread: I::F32x4,
    pub(super) size: I::F32x4,
    /// The octant in which lines begin: a bit for each axis along which they run downwards.
    pub(super) octant: u8,
    pub(super) is_mixed: bool,
}

impl<I: Isa> Directions<I> {
    #[inline(always)]
    pub(super) fn of(isa: I, constants: &Constants, square: &Window) -> Self {
        let [columns, rows, first] = constants.direction_lanes.map(|d| isa.four(&d));
        let half_across = isa.splat((square.right - square.left) as f32 * 0.5);
        let half_down = isa.splat((square.bottom - square.top) as f32 * 0.5);
        let x = isa.splat(square.left as f32).add(half_across);
        let y = isa.splat(square.top as f32).add(half_down);
        let middle = columns.fma(x, rows.fma(y, first));
        let right = isa.splat((square.right + 1) as f32);
        let bottom = isa.splat((square.bottom + 1) as f32);
        let size = columns
            .abs()
            .fma(right, rows.abs().fma(bottom, first.abs()));
        let spread = size.fma(
            isa.splat(LINE_ERROR),
            columns.abs().fma(half_across, rows.abs().mul(half_down)),
        );
        Self {
            middle,
            spread,
            size,
            octant: OCTANTS[middle.signs() as usize & 7],
            is_mixed: spread.sub(middle.abs()).signs() & 7 != 7,
        }
    }
}

static OCTANTS: [u8; 8] = [0, 4, 2, 6, 1, 5, 3, 7];

#[derive(Debug, Clone, Copy)]
pub(super) struct Samples<'s, I: Isa> {
    pub(super) square: &'s Window,
    pub(super) open: u64,
    pub(super) directions: Directions<I>,
    pub(super) octant: u8,
}

impl<I: Isa> Samples<'_, I> {
    #[inline(always)]
    pub(super) fn take_group(&mut self, groups: &mut [u64; 8]) -> bool {
        let first = groups.iter().position(|&group| group != 0);
        if let Some(octant) = first {
            self.octant = octant as u8;
            self.open = std::mem::take(&mut groups[octant]);
        }
        first.is_some()
    }
}

#[inline(never)]
pub(super) fn by_octant(
    constants: &Constants,
    exact: &Exact,
    square: &Window,
    open: u64,
) -> [u64; 8] {
    let mut parts = [0; 8];
    for bit in bits(open) {
        let at = [
            square.left + (bit as i32 & 7),
            square.top + (bit as i32 >> 3),
        ];
        let [x, y] = at.map(f64::from);
        let mut octant = 0;
        for k in 0..3 {
            let [along_x, along_y, first] = constants.direction[k];
            let value = along_x * x + along_y * y + first;
            let size = along_x.abs() * (x + 1.0) + along_y.abs() * (y + 1.0) + first.abs();
            let is_downwards = if value.abs() > size * DIRECTION_ERROR {
                value < 0.0
            } else {
                exact.runs_downwards(k, at)
            };
            octant = octant << 1 | usize::from(is_downwards);
        }
        parts[octant] |= 1 << bit;
    }
    parts
}

pub(super) static SAMPLES: [[f32; 2]; 64] = {
    let mut table = [[0.0; 2]; 64];
    let mut sample = 0;
    while sample < 64 {
        table[sample] = [(sample & 7) as f32, (sample >> 3) as f32];
        sample += 1;
    }
    table
};

/// Divides a window into squares, and those by the octant in which their lines begin, usually one. `draw` returns the
/// samples drawn.
#[inline(always)]
pub(super) fn each_square<I: Isa>(
    band: &mut Band<'_, I>,
    window: &Window,
    draw: impl Fn(&mut Band<'_, I>, &Samples<'_, I>) -> u64,
) {
    let mut top = window.top;
    while top <= window.bottom {
        let mut left = window.left;
        while left <= window.right {
            let [right, bottom] = [(left + 7).min(window.right), (top + 7).min(window.bottom)];
            let square = Window::of([left, top, right, bottom]);
            let open = band.fill.open_in_square(&square);
            if open != 0 {
                band.counters.squares += 1;
                let directions = Directions::of(band.isa, band.constants, &square);
                let mut samples = Samples {
                    square: &square,
                    open,
                    directions,
                    octant: directions.octant,
                };
                let mut groups = [0; 8];
                if directions.is_mixed {
                    groups = by_octant(band.constants, band.exact, &square, open);
                    samples.take_group(&mut groups);
                }
                let mut drawn = 0;
                loop {
                    drawn |= draw(band, &samples);
                    if !directions.is_mixed || !samples.take_group(&mut groups) {
                        break;
                    }
                }
                band.fill.mark_square(&square, drawn);
            }
            left += 8;
        }
        top += 8;
    }
}
