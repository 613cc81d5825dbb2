//! Bricks: nodes whose 64 grandchildren (parts) are solids. For each open sample three look-ups give the parts that its
//! line may meet, nearest first (`strips.rs`); it shows the first that the line meets (`lines.rs`).
//!
//! Where voxels are hardly larger than samples, the parts are blocks, each with 64 parts: the same look-ups twice. The
//! blocks that lines may meet are read first, once for a brick.
//!
//! Processors cannot predict the part that a line meets. So each step is taken for all samples, without branches, and
//! only the first two attempts: processors overlap short steps. Few samples remain for a third one.

use super::band::{Band, Brick, BrickBlocks, Hit, Record, voxel_at};
use super::directions::{SAMPLES, Samples, each_square};
use super::lanes::Isa;
use super::lines::{BLOCKS, Line, Lines, OFFSETS};
use super::parts::Part;
use super::projection::Projection;
use super::strips::Row;
use super::waiting::MOST;
use super::window::{Window, bits};
use crate::graph::{GraphView, prefetch};

#[inline(always)]
pub(super) fn draw<I: Isa, const DEEP: bool>(
    band: &mut Band<'_, I>,
    brick: Brick<'_>,
    window: &Window,
) {
    band.counters.bricks += 1;
    let isa = band.isa;
    let level = &band.constants.levels[brick.record.level as usize];
    let across = if DEEP { 16.0 } else { 4.0 };
    let projection = Projection::new(isa, band.constants, level, brick.record.centre, across);
    let window = if window.right - window.left > 7 || window.bottom - window.top > 7 {
        let parts = brick.parts.exist;
        projection.window(isa, band.constants, level, across, parts, window)
    } else {
        *window
    };
    if window.is_empty() {
        return;
    }
    if DEEP {
        band.brick_blocks.ready = 0;
        brick.parts.prefetch_masks(band.graph);
    } else {
        brick.parts.prefetch(band.graph);
    }
    each_square(
        band,
        &window,
        #[inline(always)]
        |band, samples| draw_samples::<I, DEEP>(band, brick, &projection, samples),
    );
}

#[inline(always)]
fn draw_samples<I: Isa, const DEEP: bool>(
    band: &mut Band<'_, I>,
    brick: Brick<'_>,
    projection: &Projection<I>,
    samples: &Samples<'_, I>,
) -> u64 {
    let (square, open, octant) = (samples.square, samples.open, samples.octant);
    let isa = band.isa;
    band.counters.samples_tested += u64::from(open.count_ones());
    let lines = Lines::new(isa, band.constants, projection, samples);
    let tables = lines.strips.map(|strips| &strips.touched);
    let exist = isa.turned(brick.parts.exist, octant);
    let cells = lines.in_cells(isa, if DEEP { 0.25 } else { 1.0 });
    let [any, all] = band.candidates.look_up(isa, tables, &cells, exist, open);
    let pair = u32::from(octant) * 9;
    // Samples with parts to try, those with more blocks, and those that only have blocks.
    let (mut found, mut more, mut left, mut drawn) = (any, 0, 0, 0);
    if DEEP && any != 0 {
        prepare(band, brick, all, octant);
        [found, more] = next_blocks(band, &lines, tables, any, true);
        left = more & !found;
    }
    if !band.blends {
        drawn = meet_first::<I, DEEP>(band, &lines, found, pair);
        let [met, none] = meet_second::<I, DEEP>(band, &lines, found & !drawn, pair);
        drawn |= met;
        found &= !(drawn | none);
        if DEEP {
            let wanted = left | none & more;
            let [begun, others] = next_blocks(band, &lines, tables, wanted, false);
            let met = meet_first::<I, DEEP>(band, &lines, begun, pair);
            drawn |= met;
            (found, left) = ((found | begun) & !met, others & !begun);
        }
    }
    for bit in bits(left | found) {
        let sample = lines.line(isa, &SAMPLES[bit]);
        let cells = lines.line_in_cells(isa, &sample);
        let (mut line, mut parts) = (sample, band.candidates.0[bit]);
        let (mut block, mut blocks) = (0, 0);
        if DEEP {
            block = u64::from(band.hits[bit].block & 63);
            blocks = band.brick_blocks.others[bit];
            line = sample.about(isa, &BLOCKS[block as usize]);
        }
        'sample: loop {
            while parts != 0 {
                let part = parts.trailing_zeros() as usize & 63;
                parts &= parts - 1;
                let [is_met, may_be_met] = lines.are_inside(isa, &line, &OFFSETS[part]);
                if !may_be_met {
                    continue;
                }
                let hit = Hit {
                    block: block as u8,
                    part: (part as u32 ^ pair) as u8,
                };
                if !is_met && !is_hit::<I, DEEP>(band, brick, square, bit, hit, pair) {
                    continue;
                }
                if band.blends {
                    let (is_full, levels) = blend::<I, DEEP>(band, brick, square, bit, hit, pair);
                    if !is_full {
                        let same = match levels {
                            0 => u64::MAX,
                            1 => 0xff << (part & 0x38),
                            _ => 0,
                        };
                        parts &= !same;
                        continue;
                    }
                }
                drawn |= 1 << bit;
                band.hits[bit] = hit;
                break 'sample;
            }
            if blocks == 0 {
                break;
            }
            [block, parts, blocks] = band.brick_blocks.next(isa, tables, &cells, blocks);
            line = sample.about(isa, &BLOCKS[block as usize]);
        }
    }
    if !band.blends {
        show_hits::<I, DEEP>(band, brick, square, drawn, pair);
    }
    band.counters.samples_drawn += u64::from(drawn.count_ones());
    drawn
}

/// Looks up the parts of a next block by sample. Returns the samples that have any, and those that have more blocks.
#[inline(always)]
fn next_blocks<I: Isa>(
    band: &mut Band<'_, I>,
    lines: &Lines<I>,
    tables: [&Row; 3],
    any: u64,
    is_first: bool,
) -> [u64; 2] {
    let isa = band.isa;
    let (mut found, mut others) = (0, 0);
    for bit in bits(any) {
        let line = lines.line(isa, &SAMPLES[bit]);
        let cells = lines.line_in_cells(isa, &line);
        let blocks = match is_first {
            true => band.candidates.0[bit],
            false => band.brick_blocks.others[bit],
        };
        let [block, parts, blocks] = band.brick_blocks.next(isa, tables, &cells, blocks);
        band.hits[bit].block = block as u8;
        band.candidates.0[bit] = parts;
        band.brick_blocks.others[bit] = blocks;
        found |= u64::from(parts != 0) << bit;
        others |= u64::from(blocks != 0) << bit;
    }
    [found, others]
}

/// Of samples, those whose lines certainly meet the first part that they may meet. Without branches, because the outcome
/// is unpredictable.
#[inline(always)]
fn meet_first<I: Isa, const DEEP: bool>(
    band: &mut Band<'_, I>,
    lines: &Lines<I>,
    found: u64,
    pair: u32,
) -> u64 {
    let mut met = 0;
    for bit in bits(found) {
        let line = line_of::<I, DEEP>(band, lines, bit);
        let part = band.candidates.0[bit].trailing_zeros() & 63;
        let [is_met, _] = lines.are_inside(band.isa, &line, &OFFSETS[part as usize]);
        band.hits[bit].part = (part ^ pair) as u8;
        met |= u64::from(is_met) << bit;
    }
    met
}

/// Of samples whose lines did not meet their first part, those that meet the second, and those that have no other.
#[inline(always)]
fn meet_second<I: Isa, const DEEP: bool>(
    band: &mut Band<'_, I>,
    lines: &Lines<I>,
    found: u64,
    pair: u32,
) -> [u64; 2] {
    let (mut met, mut none) = (0, 0);
    for bit in bits(found) {
        let line = line_of::<I, DEEP>(band, lines, bit);
        let parts = band.candidates.0[bit];
        let offset = |parts: u64| &OFFSETS[parts.trailing_zeros() as usize & 63];
        let [_, may_be_met] = lines.are_inside(band.isa, &line, offset(parts));
        if may_be_met {
            continue;
        }
        let parts = parts & parts.wrapping_sub(1);
        let [is_met, may_be_met] = lines.are_inside(band.isa, &line, offset(parts));
        band.hits[bit].part = (parts.trailing_zeros() & 63 ^ pair) as u8;
        met |= u64::from(is_met && parts != 0) << bit;
        let parts = parts & parts.wrapping_sub(u64::from(!may_be_met));
        band.candidates.0[bit] = parts;
        none |= u64::from(parts == 0) << bit;
    }
    [met, none]
}

#[inline(always)]
fn line_of<I: Isa, const DEEP: bool>(band: &Band<'_, I>, lines: &Lines<I>, bit: usize) -> Line<I> {
    let line = lines.line(band.isa, &SAMPLES[bit]);
    if !DEEP {
        return line;
    }
    let block = usize::from(band.hits[bit].block & 63);
    line.about(band.isa, &BLOCKS[block])
}

impl BrickBlocks {
    /// Of the next two blocks, the first with parts that the line may meet, these, and the blocks after it.
    #[inline(always)]
    fn next<I: Isa>(
        &self,
        isa: I,
        tables: [&Row; 3],
        cells: &Line<I>,
        mut blocks: u64,
    ) -> [u64; 3] {
        let mut two = [[0; 3]; 2];
        for found in &mut two {
            let block = blocks.trailing_zeros() as usize;
            blocks &= blocks.wrapping_sub(1);
            let [x, y, z] = cells.block_cells(isa, &BLOCKS[block]);
            let parts = tables[0][x] & tables[1][y] & tables[2][z] & self.exist[block];
            *found = [block as u64 & 63, parts, blocks];
        }
        let is_first = two[0][1] != 0;
        [0, 1, 2].map(|i| if is_first { two[0][i] } else { two[1][i] })
    }
}

impl Hit {
    #[inline(always)]
    fn part<const DEEP: bool>(
        self,
        graph: &GraphView<'_>,
        blocks: &BrickBlocks,
        brick: Brick<'_>,
    ) -> Part {
        let parts = if DEEP {
            &blocks.parts[usize::from(self.block & 63)]
        } else {
            brick.parts
        };
        parts.part(graph, u32::from(self.part))
    }

    #[inline(never)]
    fn path<I: Isa, const DEEP: bool>(
        self,
        band: &Band<'_, I>,
        brick: Brick<'_>,
        pair: u32,
    ) -> (u32, Path) {
        let part = self.part::<DEEP>(band.graph, band.brick_blocks, brick);
        let path = Path {
            block: DEEP.then(|| u32::from(self.block) ^ pair),
            part: u32::from(self.part),
            levels: part.levels,
        };
        (part.node, path)
    }
}

#[inline(always)]
fn show_hits<I: Isa, const DEEP: bool>(
    band: &mut Band<'_, I>,
    brick: Brick<'_>,
    square: &Window,
    drawn: u64,
    pair: u32,
) {
    let first = band.pixels.at(square.left, square.top);
    let (graph, blocks, hits) = (band.graph, &*band.brick_blocks, &band.hits);
    let first_node = brick.parts.first_node(graph);
    band.waiting.make_room(&mut band.pixels);
    let mut count = band.waiting.count;
    for bit in bits(drawn) {
        let hit = hits[bit];
        let node = if DEEP {
            hit.part::<DEEP>(graph, blocks, brick).node
        } else {
            let part = u32::from(hit.part);
            brick.parts.node(graph, first_node, part)
        };
        prefetch(band.pixels.color, node as usize);
        let at = first + band.sample_offsets[bit] as usize;
        band.waiting.hits[count % MOST] = (at, node);
        count += 1;
    }
    band.waiting.count = count;
    if band.pixels.wants_voxels() {
        for bit in bits(drawn) {
            let at = first + band.sample_offsets[bit] as usize;
            let path = band.hits[bit].path::<I, DEEP>(band, brick, pair).1;
            band.pixels.voxel[at] = path.voxel(band, brick);
        }
    }
}

/// Returns whether the hit hides everything behind it, and how many levels below the brick or block it is.
#[inline(never)]
fn blend<I: Isa, const DEEP: bool>(
    band: &mut Band<'_, I>,
    brick: Brick<'_>,
    square: &Window,
    bit: usize,
    hit: Hit,
    pair: u32,
) -> (bool, u32) {
    let (node, path) = hit.path::<I, DEEP>(band, brick, pair);
    let voxel = path.voxel(band, brick);
    let full = band.show([square.left, square.top], 1 << bit, node, voxel);
    (full != 0, path.levels)
}

#[inline(never)]
fn is_hit<I: Isa, const DEEP: bool>(
    band: &mut Band<'_, I>,
    brick: Brick<'_>,
    square: &Window,
    bit: usize,
    hit: Hit,
    pair: u32,
) -> bool {
    let (_, path) = hit.path::<I, DEEP>(band, brick, pair);
    is_covered(band, brick, square, bit, &path)
}

/// Reads the wanted blocks that were not read for the brick.
#[inline(always)]
fn prepare<I: Isa>(band: &mut Band<'_, I>, brick: Brick<'_>, wanted: u64, octant: u8) {
    let blocks = &mut *band.brick_blocks;
    if blocks.octant != octant {
        (blocks.octant, blocks.ready) = (octant, 0);
    }
    let first_node = brick.parts.first_node(band.graph);
    for number in bits(wanted & !blocks.ready) {
        let part = number as u32 ^ (u32::from(octant) * 9);
        let node = brick.parts.node(band.graph, first_node, part);
        let parts = &mut blocks.parts[number];
        parts.read(band.isa, band.graph, node, false, 0);
        parts.prefetch(band.graph);
        blocks.exist[number] = band.isa.turned(parts.exist, octant);
    }
    blocks.ready |= wanted;
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Path {
    pub(super) block: Option<u32>,
    pub(super) part: u32,
    pub(super) levels: u32,
}

impl Path {
    #[inline(never)]
    pub(super) fn voxel<I>(&self, band: &Band<'_, I>, brick: Brick<'_>) -> [i32; 4] {
        let Record {
            mut min, mut level, ..
        } = *brick.record;
        let mut side = band.constants.levels[level as usize].side;
        let mut down = |octant: u32| {
            side /= 2;
            level += 1;
            for (k, c) in min.iter_mut().enumerate() {
                *c += (octant as i32 >> (2 - k) & 1) * side;
            }
        };
        if let Some(block) = self.block {
            down(block >> 3);
            down(block & 7);
        }
        if self.levels > 0 {
            down(self.part >> 3);
        }
        if self.levels > 1 {
            down(self.part & 7);
        }
        voxel_at(min, level)
    }
}

#[inline(never)]
pub(super) fn is_covered<I: Isa>(
    band: &mut Band<'_, I>,
    brick: Brick<'_>,
    square: &Window,
    bit: usize,
    path: &Path,
) -> bool {
    band.counters.exact_samples += 1;
    let [x, y, z, level] = path.voxel(band, brick);
    let side = band.constants.levels[level as usize].side;
    let at = [
        square.left + (bit as i32 & 7),
        square.top + (bit as i32 >> 3),
    ];
    band.exact.covers([x, y, z], side, at)
}
