//! Voxels of some samples, one after the other: whole squares at a time.
//!
//! For each square of 8 x 8 samples of a brick's window: which parts its lines
//! may meet, between the least and the greatest values of the three functions
//! (`strips.rs`); then, in order, each part against all samples, in numbers of 16
//! bits. Samples well inside are drawn, those near the outline are decided one by one.

use super::band::{Band, Brick};
use super::bricks::{Path, is_covered};
use super::directions::Samples;
use super::lanes::{Four, Isa};
use super::lines::{Lines, Meeting, NO_OFFSET, OFFSETS};
use super::projection::Projection;
use super::squares::{DrawSquare, SAMPLES, each_square};
use super::strips::{CELLS_PER_WIDTH, MIDDLE, STRIPS};
use super::window::Window;

/// Units of a width in numbers of 16 bits.
const UNIT: f32 = 2048.0;
/// Rounding of values in these numbers, in units: of the first sample's, and of
/// seven steps of a column and of a row, half a unit each, and a unit.
const ROUNDING: f32 = 8.5;
/// Values up to this, in units, fit these numbers.
const LARGEST: f32 = 30_000.0;

/// Draws squares voxel by voxel.
struct ByVoxels<'b, I: Isa> {
    brick: Brick<'b>,
    projection: Projection<I>,
    /// Whether the brick is a solid.
    is_single: bool,
}

/// Draws a brick voxel by voxel, or a solid.
#[inline(always)]
pub(super) fn draw<I: Isa>(band: &mut Band<'_, I>, brick: Brick<'_>, window: &Window) {
    let is_single = brick.parts.is_single();
    let level = &band.constants.levels[brick.record.level as usize];
    let across = if is_single { 1.0 } else { 4.0 };
    let projection = Projection::new(band.isa, band.constants, level, brick.record.centre, across);
    band.counters.bricks += u64::from(!is_single);
    let drawer = ByVoxels {
        brick,
        projection,
        is_single,
    };
    each_square(band, window, &drawer);
}

impl<I: Isa> DrawSquare<I> for ByVoxels<'_, I> {
    #[inline(always)]
    fn draw(&self, band: &mut Band<'_, I>, samples: &Samples<'_, I>) -> u64 {
        draw_samples(band, self, samples)
    }
}

#[inline(always)]
fn draw_samples<I: Isa>(
    band: &mut Band<'_, I>,
    &ByVoxels {
        brick,
        projection,
        is_single,
    }: &ByVoxels<'_, I>,
    samples: &Samples<'_, I>,
) -> u64 {
    let &Samples {
        square,
        open,
        octant,
        ..
    } = samples;
    let isa = band.isa;
    let lines = Lines::new(isa, band.constants, &projection, samples);
    let mut wanted = if is_single {
        1
    } else {
        candidates(isa, &lines, square) & isa.turned_parts(brick.parts.exist, octant)
    };
    if wanted == 0 {
        return 0;
    }
    // Only a strip's width changes within a square, from which the tables' error is four times as
    // large.
    let error = (0.25 * lines.error + lines.rounding) * UNIT + ROUNDING;
    let most = ((0.5 * UNIT + error) as i16).saturating_add(1);
    let sure = if lines.has_blind {
        0
    } else {
        (0.5 * UNIT - error) as i16
    };
    let size =
        [square.right - square.left, square.bottom - square.top].map(|s| isa.splat(s as f32));
    let units = lines.in_units(isa, UNIT);
    let largest = isa.splat(LARGEST);
    let pair = u32::from(octant) * 9;
    let corner = [square.left, square.top];
    let (mut left, mut drawn) = (open, 0u64);
    while wanted != 0 && left != 0 {
        let number = wanted.trailing_zeros() as usize & 63;
        wanted &= wanted - 1;
        let offset = if is_single {
            &NO_OFFSET
        } else {
            &OFFSETS[number]
        };
        let values = units.about(isa, offset);
        let [first, step_x, step_y] = values;
        let reach = step_x
            .abs()
            .fma(size[0], step_y.abs().fma(size[1], first.abs()));
        let distances = isa.distances(&values);
        let fit = largest.sub(reach).signs() & 7 == 0;
        let held = if fit {
            isa.below(&distances, most)
        } else {
            u64::MAX
        } & left;
        if held == 0 {
            continue;
        }
        let part = brick.parts.part(band.graph, number as u32 ^ pair);
        let path = Path {
            block: None,
            part: number as u32 ^ pair,
            levels: part.levels,
        };
        let certain = if fit { isa.below(&distances, sure) } else { 0 };
        let mut covered = held & certain;
        let mut doubt = held & !certain;
        while doubt != 0 {
            let bit = doubt.trailing_zeros() as usize & 63;
            doubt &= doubt - 1;
            let line = lines.line(isa, SAMPLES[bit]);
            let is_met = match lines.meets(isa, &line, offset) {
                Meeting::Misses => false,
                Meeting::Meets => true,
                Meeting::Doubt => is_covered(band, brick, square, bit, &path),
            };
            covered |= u64::from(is_met) << bit;
        }
        if covered != 0 {
            band.counters.solids += 1;
            let voxel = if band.pixels.wants_voxels() || band.constants.opacity_eye.is_some() {
                path.voxel(
                    brick,
                    band.constants.levels[brick.record.level as usize].side,
                )
            } else {
                [0; 4]
            };
            let full = band.show(corner, covered, part.node, voxel);
            left &= !full;
            drawn |= full;
        }
    }
    band.counters.samples_drawn += u64::from(drawn.count_ones());
    drawn
}

/// The parts that a square's lines may meet.
#[inline(always)]
fn candidates<I: Isa>(isa: I, lines: &Lines<I>, square: &Window) -> u64 {
    let [first, step_x, step_y] = lines.in_widths();
    let zero = isa.splat(0.0);
    let across = step_x.mul(isa.splat((square.right - square.left) as f32));
    let down = step_y.mul(isa.splat((square.bottom - square.top) as f32));
    let least = first.add(across.min(zero)).add(down.min(zero));
    let greatest = first.add(across.max(zero)).add(down.max(zero));
    let (unit, middle) = (isa.splat(CELLS_PER_WIDTH), isa.splat(MIDDLE));
    let low = least.fma(unit, middle).max(zero);
    let high = greatest.fma(unit, middle);
    // Below the table there is nothing; above it, its last cell.
    if high.signs() & 7 != 0 {
        return 0;
    }
    STRIPS.between(lines.tables, low.cells(), high.cells())
}
