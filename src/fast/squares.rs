//! Squares: pieces of at most 8 x 8 samples of a window, the unit of work of bricks and voxels.

use super::band::Band;
use super::directions::{Directions, Samples, by_octant};
use super::lanes::Isa;
use super::window::Window;

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
