//! Hills under floating balls, hollow: the benchmark's large scene.
//!
//! A column is a list of solid spans, and three rows of columns are held at a time. `row` is the benchmark's z and our y,
//! `height` its y and our z. For seed 1 all voxels and colours are its.

use super::hash;
use super::list::Settings;
use crate::graph::{Progress, Voxel};

const OCTAVES: u32 = 7;
const BALLS: u32 = 48;

/// A solid part of a column: heights `from..to`.
type Span = (i32, i32);

struct Ball {
    center: [i32; 3],
    radius: i32,
}

struct Terrain {
    depth: u32,
    side: i32,
    /// Changes the seeds of the hashes; 0 for seed 1.
    variation: u32,
    balls: Vec<Ball>,
}

#[derive(Default)]
struct RowSpans {
    spans: Vec<Span>,
    /// Where each column begins, and the end; empty for a row outside.
    start: Vec<u32>,
}

impl RowSpans {
    fn column(&self, x: i32) -> &[Span] {
        let x = x as usize;
        match (self.start.get(x), self.start.get(x.wrapping_add(1))) {
            (Some(&from), Some(&to)) => &self.spans[from as usize..to as usize],
            _ => &[],
        }
    }
}

/// The voxels of the terrain that have one of their six neighbours outside of it.
pub(super) fn voxels(settings: &Settings, sink: &mut dyn FnMut(Voxel), progress: &dyn Progress) {
    let terrain = Terrain::new(settings);
    let side = terrain.side;
    progress.begin("generating terrain", side as u64);
    let mut before = RowSpans::default();
    let mut here = terrain.row(0);
    let mut inside = Vec::new();
    let mut spare = Vec::new();
    for row in 0..side {
        let after = if row + 1 < side {
            terrain.row(row + 1)
        } else {
            RowSpans::default()
        };
        for x in 0..side {
            let column = here.column(x);
            inside.clear();
            inside.extend(column.iter().map(|&(from, to)| (from + 1, to - 1)));
            for around in [
                here.column(x - 1),
                here.column(x + 1),
                before.column(x),
                after.column(x),
            ] {
                common(&inside, around, &mut spare);
                std::mem::swap(&mut inside, &mut spare);
            }
            outside(column, &inside, |height| {
                sink(Voxel {
                    index: [x, row, height],
                    color: terrain.color(x, height, row),
                    normal: None,
                });
            });
        }
        before = std::mem::replace(&mut here, after);
        progress.advance(1);
    }
    progress.end();
}

fn common(a: &[Span], b: &[Span], out: &mut Vec<Span>) {
    out.clear();
    for &(a_from, a_to) in a {
        for &(b_from, b_to) in b {
            let (from, to) = (a_from.max(b_from), a_to.min(b_to));
            if from < to {
                out.push((from, to));
            }
        }
    }
}

/// Heights of `column` that are not in `inside`, whose spans are growing and each within one of `column`.
fn outside(column: &[Span], inside: &[Span], mut each: impl FnMut(i32)) {
    let mut inside = inside.iter().peekable();
    for &(from, to) in column {
        let mut height = from;
        while let Some(&&(hole_from, hole_to)) = inside.peek() {
            if hole_from >= to {
                break;
            }
            (height..hole_from).for_each(&mut each);
            height = hole_to;
            inside.next();
        }
        (height..to).for_each(&mut each);
    }
}

impl Terrain {
    fn new(settings: &Settings) -> Self {
        let side = 1u32 << settings.depth;
        let variation = settings.seed.wrapping_sub(1).wrapping_mul(0x9E37_79B9);
        let balls = (0..BALLS)
            .map(|i| {
                let place = hash(i, 77, 5 ^ variation);
                let height = hash(i, 78, 6 ^ variation);
                let size = hash(i, 79, 7 ^ variation);
                Ball {
                    center: [
                        (place % side) as i32,
                        (side * 7 / 16 + height % (side * 5 / 16)) as i32,
                        ((place >> 12) % side) as i32,
                    ],
                    radius: (side / 64 + size % (side / 24)) as i32,
                }
            })
            .collect();
        Self {
            depth: settings.depth,
            side: side as i32,
            variation,
            balls,
        }
    }

    fn row(&self, row: i32) -> RowSpans {
        let near: Vec<&Ball> = self
            .balls
            .iter()
            .filter(|ball| (row - ball.center[2]).abs() <= ball.radius)
            .collect();
        let mut spans = Vec::new();
        let mut start = vec![0];
        let mut column: Vec<Span> = Vec::new();
        for x in 0..self.side {
            column.clear();
            column.push((0, self.ground(x, row)));
            column.extend(near.iter().filter_map(|ball| ball.chord(x, row)));
            column.sort_unstable();
            let first = spans.len();
            for &(from, to) in &column {
                let (from, to) = (from.max(0), to.min(self.side));
                if from >= to {
                    continue;
                }
                match spans[first..].last_mut() {
                    Some((_, end)) if from <= *end => *end = to.max(*end),
                    _ => spans.push((from, to)),
                }
            }
            start.push(spans.len() as u32);
        }
        RowSpans { spans, start }
    }

    /// Height of the ground: octaves of value noise, from a quarter of the side down to two voxels.
    fn ground(&self, x: i32, row: i32) -> i32 {
        let sum: i64 = (0..OCTAVES)
            .filter(|octave| octave + 3 <= self.depth)
            .map(|octave| {
                let cell_log2 = self.depth - 2 - octave;
                i64::from(self.noise(x, row, cell_log2, octave + 1) >> octave)
            })
            .sum();
        ((sum * i64::from(self.side) * 11 / 32) >> 17) as i32 + self.side / 16
    }

    /// Value noise, 0 to 65535: cells of `2^cell_log2` voxels, bilinear between smoothed positions.
    fn noise(&self, x: i32, row: i32, cell_log2: u32, seed: u32) -> i32 {
        let seed = seed ^ self.variation;
        let (cell_x, cell_row) = ((x >> cell_log2) as u32, (row >> cell_log2) as u32);
        let within = |c: i32| {
            let t = i64::from(c & ((1 << cell_log2) - 1)) << 16 >> cell_log2;
            (((t * t) >> 16) * (3 * 65536 - 2 * t)) >> 16
        };
        let (fraction_x, fraction_row) = (within(x), within(row));
        let corner = |dx, drow| i64::from(hash(cell_x + dx, cell_row + drow, seed) & 65535);
        let between = |a: i64, b: i64, t: i64| a + (((b - a) * t) >> 16);
        between(
            between(corner(0, 0), corner(1, 0), fraction_x),
            between(corner(0, 1), corner(1, 1), fraction_x),
            fraction_row,
        ) as i32
    }

    fn color(&self, x: i32, height: i32, row: i32) -> [u8; 3] {
        let speckle = hash((x * 31 + height) as u32, row as u32, 9 ^ self.variation);
        let bright = (height * 255 / self.side / 2) as u32;
        [
            (40 + bright + (speckle & 31)) as u8,
            (100 + (speckle >> 5 & 63) + ((height as u32 / 8) & 1) * 40) as u8,
            (30 + bright + (speckle >> 11 & 31)) as u8,
        ]
    }
}

impl Ball {
    fn chord(&self, x: i32, row: i32) -> Option<Span> {
        let [dx, drow] = [x - self.center[0], row - self.center[2]];
        let rest = i64::from(self.radius).pow(2) - i64::from(dx).pow(2) - i64::from(drow).pow(2);
        (rest >= 0).then(|| {
            let half = rest.isqrt() as i32;
            (self.center[1] - half, self.center[1] + half + 1)
        })
    }
}
