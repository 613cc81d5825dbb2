//! Voxels one after the other, nearest first, each against the 64 samples of a square in 16-bit numbers. Samples near an
//! outline are decided one by one.

use super::band::{Band, Brick};
use super::bricks::{Path, is_covered};
use super::directions::{SAMPLES, Samples, each_square};
use super::lanes::{F32x4, Floats, Isa, Lanes, Shorts};
use super::lines::{InUnits, Lines, OFFSETS, Offset};
use super::projection::Projection;
use super::strips::{CELLS, CELLS_PER_WIDTH, MIDDLE, Strips};
use super::window::{Window, bits};
use crate::graph::prefetch;

const UNIT: f32 = 2048.0;
/// Rounding in units: of the first value and of seven steps of a column and of a row, half each, and a unit.
const ROUNDING: f32 = 8.5;
const LARGEST: f32 = 30_000.0;

/// Words of a square's samples.
#[repr(align(32))]
struct Words([u32; 64]);

#[inline(always)]
pub(super) fn draw<I: Isa>(band: &mut Band<'_, I>, brick: Brick<'_>, window: &Window) {
    let is_single = brick.parts.is_single();
    let level = &band.constants.levels[brick.record.level as usize];
    let across = if is_single { 1.0 } else { 4.0 };
    let projection = Projection::new(band.isa, band.constants, level, brick.record.centre, across);
    band.counters.bricks += u64::from(!is_single);
    // A line of the cache holds 21 colours.
    if let Some(first) = brick.parts.first_node(band.graph) {
        (0..4).for_each(|line| prefetch(band.pixels.color, first as usize + 21 * line));
    }
    let window = if is_single {
        *window
    } else {
        projection.window(
            band.isa,
            band.constants,
            level,
            across,
            brick.parts.exist,
            window,
        )
    };
    each_square(
        band,
        &window,
        #[inline(always)]
        |band, samples| draw_samples(band, brick, &projection, samples),
    );
}

#[inline(always)]
fn draw_samples<I: Isa>(
    band: &mut Band<'_, I>,
    brick: Brick<'_>,
    projection: &Projection<I>,
    samples: &Samples<'_, I>,
) -> u64 {
    let is_single = brick.parts.is_single();
    let (square, open, octant) = (samples.square, samples.open, samples.octant);
    let isa = band.isa;
    band.pixels.prefetch(square);
    let lines = Lines::new(isa, band.constants, projection, samples);
    let mut wanted = if is_single {
        1
    } else {
        candidates(isa, &lines, open) & isa.turned(brick.parts.exist, octant)
    };
    if wanted == 0 {
        return 0;
    }
    // Within a square only a strip's width changes: a quarter of the tables' error.
    let error = (0.25 * lines.error + lines.rounding) * UNIT + ROUNDING;
    let most = ((0.5 * UNIT + error) as i16).saturating_add(1);
    let sees = i16::from(!lines.has_blind);
    let limits = [most, sees * (0.5 * UNIT - error) as i16];
    let size =
        [square.right - square.left, square.bottom - square.top].map(|s| isa.splat(s as f32));
    let units = lines.in_units(isa, UNIT);
    let pair = u32::from(octant) * 9;
    let corner = [square.left, square.top];
    let limits = (units.reach(isa, size) <= LARGEST).then_some(limits);
    let offset_of = |number: usize| &OFFSETS[if is_single { 64 } else { number & 63 }];
    // Several voxels are put together before they are written to the picture, whose rows lie far apart.
    let is_joined = !is_single && !band.blends && !band.pixels.wants_voxels();
    let mut words = Words([0; 64]);
    let (mut left, mut drawn) = (open, 0u64);
    let mut number = wanted.trailing_zeros() as usize;
    let mut masks = square_masks(isa, &units, offset_of(number), limits);
    while wanted != 0 && left != 0 {
        let (offset, part_number, [held, certain]) =
            (offset_of(number), number as u32 ^ pair, masks);
        wanted &= wanted - 1;
        // One voxel ahead, as whether a voxel is held is unpredictable.
        number = wanted.trailing_zeros() as usize;
        if wanted != 0 {
            masks = square_masks(isa, &units, offset_of(number), limits);
        }
        let held = held & left;
        if held == 0 {
            continue;
        }
        let part = brick.parts.part(band.graph, part_number);
        let path = Path {
            block: None,
            part: part_number,
            levels: part.levels,
        };
        let mut covered = held & certain;
        for bit in bits(held & !certain) {
            let line = lines.line(isa, &SAMPLES[bit]);
            let [is_met, may_be_met] = lines.are_inside(isa, &line, offset);
            let is_met = is_met || (may_be_met && is_covered(band, brick, square, bit, &path));
            covered |= u64::from(is_met) << bit;
        }
        if covered != 0 {
            band.counters.solids += 1;
            let full = if is_joined {
                let word = [band.pixels.word(part.node); 8];
                isa.store_masked(&mut words.0, 8, covered, &word, 0);
                covered
            } else {
                let voxel = path.voxel(band, brick);
                band.show(corner, covered, part.node, voxel)
            };
            left &= !full;
            drawn |= full;
        }
    }
    if is_joined && drawn != 0 {
        band.pixels.write(isa, corner, drawn, &words.0, 8);
    }
    band.counters.samples_drawn += u64::from(drawn.count_ones());
    drawn
}

/// The samples of a square that may be in all three strips of a voxel, and those that certainly are.
#[inline(always)]
fn square_masks<I: Isa>(
    isa: I,
    units: &InUnits<I>,
    offset: &Offset,
    limits: Option<[i16; 2]>,
) -> [u64; 2] {
    let Some([most, sure]) = limits else {
        return [u64::MAX, 0];
    };
    let values = &units.about(isa, offset);
    let mut distances = Distances([I::I16x16::splat(isa, 0); 4]);
    distances.add_function::<0>(isa, values);
    distances.add_function::<1>(isa, values);
    distances.add_function::<2>(isa, values);
    [distances.below(isa, most), distances.below(isa, sure)]
}

/// The largest distance of the three functions from 0, by sample: rows 0 and 2, 1 and 3, 4 and 6, and 5 and 7. No
/// meaning beyond 16 bits.
struct Distances<I: Isa>([I::I16x16; 4]);

impl<I: Isa> Distances<I> {
    #[inline(always)]
    fn add_function<const FUNCTION: i32>(&mut self, isa: I, values: &[I::F32x4; 3]) {
        let columns = I::I16x16::load(isa, &[0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7]);
        let rows = I::I16x16::load(isa, &[0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1]);
        let [first, step_x, step_y] = *values;
        let first = isa.broadcast_rounded::<FUNCTION>(first);
        let step_x = isa.broadcast_rounded::<FUNCTION>(step_x);
        let step_y = isa.broadcast_rounded::<FUNCTION>(step_y);
        let two_rows = step_y.add(step_y);
        let three_rows = two_rows.add(step_y);
        let mut at = first.add(columns.mul(step_x)).add(rows.mul(two_rows));
        for (worst, down) in self.0.iter_mut().zip([step_y, three_rows, step_y, step_y]) {
            *worst = worst.max_unsigned(at.abs());
            at = at.add(down);
        }
    }

    #[inline(always)]
    fn below(&self, isa: I, limit: i16) -> u64 {
        let limit = I::I16x16::splat(isa, limit);
        let [a, b, c, d] = self.0;
        u64::from(a.below(b, limit)) | u64::from(c.below(d, limit)) << 32
    }
}

/// Voxels whose strips may reach open samples.
#[inline(always)]
fn candidates<I: Isa>(isa: I, lines: &Lines<I>, open: u64) -> u64 {
    let [first, step_x, step_y] = lines.in_widths();
    let columns = open | open >> 32;
    let columns = columns | columns >> 16;
    let columns = (columns | columns >> 8) as u8;
    let at = |number: u32, step: I::F32x4| step.mul(isa.splat(number as f32));
    let left = at(columns.trailing_zeros(), step_x);
    let right = at(7 - columns.leading_zeros(), step_x);
    let top = at(open.trailing_zeros() / 8, step_y);
    let bottom = at(7 - open.leading_zeros() / 8, step_y);
    let least = first.add(left.min(right)).add(top.min(bottom));
    let greatest = first.add(left.max(right)).add(top.max(bottom));
    let zero = isa.splat(0.0);
    let (unit, middle) = (isa.splat(CELLS_PER_WIDTH), isa.splat(MIDDLE));
    let low = least.fma(unit, middle).max(zero);
    let high = greatest.fma(unit, middle);
    if high.signs() & 7 != 0 {
        return 0;
    }
    let (low, high) = (low.indices::<CELLS>(), high.indices::<CELLS>());
    Strips::between(lines.strips, low, high)
}
