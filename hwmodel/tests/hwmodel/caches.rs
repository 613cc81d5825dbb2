//! Caches and miss curves against the plainest possible models.

use hwmodel::memory::{Cache, MemoryProbe, MissCurve, Widths};
use hwmodel::{Memory, Probe, Stage, StageLevel};
use proptest::prelude::*;

/// A cache as a list of lists, the line used last at the end.
struct Naive {
    sets: Vec<Vec<u64>>,
    ways: usize,
    line: u64,
}

impl Naive {
    fn new(sets: usize, ways: usize, line: u64) -> Self {
        let sets = vec![Vec::new(); sets];
        Self { sets, ways, line }
    }

    fn access(&mut self, address: u64) -> bool {
        let line = address / self.line;
        let count = self.sets.len() as u64;
        let set = &mut self.sets[(line % count) as usize];
        let hit = set.contains(&line);
        set.retain(|&other| other != line);
        set.push(line);
        if set.len() > self.ways {
            set.remove(0);
        }
        hit
    }
}

/// Addresses with some locality: jumps, steps and repeats.
fn addresses() -> impl Strategy<Value = Vec<u64>> {
    let one = prop_oneof![
        0u64..100,
        0u64..2000,
        Just(64),
        (0u64..6).prop_map(|i| i * 4096),
        any::<u32>().prop_map(u64::from)
    ];
    prop::collection::vec(one, 0..400)
}

proptest! {
    #[test]
    fn a_cache_is_lists_of_lines(
        addresses in addresses(), sets in 1usize..9, ways in 1usize..9, line in 1u64..100,
    ) {
        let size = sets as u64 * ways as u64 * line;
        let mut cache = Cache::new(size, ways as u32, line as u32).unwrap();
        let mut naive = Naive::new(sets, ways, line);
        let mut hits = 0;
        for &address in &addresses {
            let hit = naive.access(address);
            prop_assert_eq!(cache.access(address), hit);
            hits += u64::from(hit);
        }
        prop_assert_eq!(cache.hits(), hits);
        prop_assert_eq!(cache.misses(), addresses.len() as u64 - hits);
    }

    #[test]
    fn the_curve_is_all_fully_associative_caches(addresses in addresses(), line in 1u32..100) {
        let mut curve = MissCurve::new(line);
        for &address in &addresses {
            curve.access(address, 1);
        }
        prop_assert_eq!(curve.accesses(), addresses.len() as u64);
        prop_assert_eq!(curve.misses(0), addresses.len() as u64);
        for lines in 1..=64u32 {
            let size = u64::from(lines) * u64::from(line);
            let mut cache = Cache::new(size, lines, line).unwrap();
            for &address in &addresses {
                cache.access(address);
            }
            prop_assert_eq!(curve.misses(u64::from(lines)), cache.misses(), "{} lines", lines);
        }
        prop_assert_eq!(curve.misses(u64::MAX), curve.distinct_lines());
    }
}

/// Long enough that times are renumbered many times, with more lines than the first table holds.
#[test]
fn a_long_run_agrees_too() {
    let mut state = 12345u64;
    let mut random = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        state >> 33
    };
    let mut curve = MissCurve::new(32);
    let sizes = [1u32, 2, 7, 64, 1000, 5000, 9000];
    let mut caches = sizes.map(|lines| Cache::new(u64::from(lines) * 32, lines, 32).unwrap());
    for i in 0..60_000u64 {
        let address = match i % 4 {
            0 => random() % (9000 * 32),
            1 => random() % (300 * 32),
            2 => i / 4 * 8 % (9000 * 32),
            _ => random() % 64,
        };
        curve.access(address, 1);
        for cache in &mut caches {
            cache.access(address);
        }
    }
    for (lines, cache) in sizes.into_iter().zip(&caches) {
        assert_eq!(
            curve.misses(u64::from(lines)),
            cache.misses(),
            "{lines} lines"
        );
    }
    assert!(curve.distinct_lines() > 8000);
    // First accesses and distances are all there is.
    let others: u64 = curve.distances().iter().sum();
    assert_eq!(curve.distinct_lines() + others, curve.accesses());
    let points = curve.points();
    assert!(points.is_sorted_by(|a, b| a.misses >= b.misses && a.lines * 2 == b.lines));
    assert_eq!(points.last().unwrap().misses, curve.distinct_lines());
    assert_eq!(points[3].bytes, 8 * 32);
}

#[test]
fn an_access_across_lines_touches_each() {
    let mut curve = MissCurve::new(64);
    curve.access(60, 8);
    curve.access(60, 4);
    curve.access(64, 0);
    assert_eq!((curve.accesses(), curve.distinct_lines()), (4, 2));
    let empty = MissCurve::new(0);
    assert_eq!(empty.line_bytes(), 1);
    assert_eq!(empty.points().len(), 1);
    assert_eq!(empty.points()[0].miss_rate, 0.0);
}

#[test]
fn shapes_that_are_no_caches() {
    for (size, ways, line, says) in [
        (1024, 4, 0, "a cache line has at least 1 byte, not 0"),
        (1024, 0, 32, "1 to 65535 ways, not 0"),
        (1 << 20, 65536, 1, "1 to 65535 ways, not 65536"),
        (0, 4, 32, "a cache of 0 bytes is not made of whole sets"),
        (
            1000,
            4,
            32,
            "a cache of 1000 bytes is not made of whole sets of 4 lines of 32 bytes",
        ),
        (1 << 40, 4, 32, "is too large"),
    ] {
        let error = Cache::new(size, ways, line).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
    assert_eq!(Cache::new(64, 1, 64).unwrap().hit_rate(), None);
}

const PLACE: StageLevel = StageLevel {
    stage: Stage::Pop,
    level: 0,
};

const WIDTHS: Widths = Widths {
    stack_bits: 100,
    node_bits: 64,
    attribute_bits: 56,
    fill_vector_bits: 4,
    pixel_bits: 24,
};

#[test]
fn traffic_by_kind() {
    let mut probe = MemoryProbe::new(WIDTHS)
        .with_curve(Memory::Node, 32)
        .with_curve(Memory::Node, 64)
        .with_curve(Memory::FillVector, 1);
    for node in [0, 1, 3, 4, 7, 8, 0] {
        probe.read(Memory::Node, node, PLACE);
    }
    for quad in [0, 1, 2, 0] {
        probe.read(Memory::FillVector, quad, PLACE);
        probe.write(Memory::FillVector, quad, PLACE);
    }
    probe.write(Memory::Pixel, u64::MAX, PLACE);
    probe.write(Memory::Pixel, 1 << 40, PLACE);
    assert_eq!(probe.reads(Memory::Node), 7);
    assert_eq!(probe.read_bits(Memory::Node), 7 * 64);
    assert_eq!(probe.distinct(Memory::Node), 6);
    assert_eq!(probe.written_bits(Memory::FillVector), 4 * 4);
    assert_eq!(probe.distinct(Memory::FillVector), 3);
    assert_eq!(probe.distinct(Memory::Pixel), 2);
    assert_eq!(probe.writes(Memory::Pixel), 2);
    // Nodes 0 1 3 | 4 7 | 8 in lines of four, 0 1 3 4 7 | 8 in lines of eight;
    // two fill vectors are a byte.
    let lines: Vec<u64> = probe
        .curves()
        .iter()
        .map(|(_, curve)| curve.distinct_lines())
        .collect();
    assert_eq!(lines, [3, 2, 2]);
    assert_eq!(probe.curves()[0].1.misses(2), 4);
    assert_eq!(probe.curves()[2].1.accesses(), 8);
}

#[test]
fn the_stack_s_depths() {
    let mut probe = MemoryProbe::new(WIDTHS);
    assert_eq!(probe.deepest_stack(), 0);
    for address in [0, 1, 2, 2, 1] {
        probe.write(Memory::Stack, address, PLACE);
    }
    probe.read(Memory::Stack, 9, PLACE);
    assert_eq!(probe.deepest_stack(), 3);
}
