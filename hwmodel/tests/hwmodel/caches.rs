//! Caches, miss curves and traffic against plain models.

use crate::common::at;
use hwmodel::memory::{Cache, MemoryProbe, MissCurve, Widths};
use hwmodel::{Memory, Probe, Stage};
use proptest::prelude::*;

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

fn check_curve(addresses: &[u64], line: u32, sizes: impl IntoIterator<Item = u32>) {
    let mut curve = MissCurve::new(line);
    for &address in addresses {
        curve.access(address, 1);
    }
    assert_eq!(curve.accesses(), addresses.len() as u64);
    assert_eq!(curve.misses(0), addresses.len() as u64);
    for lines in sizes {
        let size = u64::from(lines) * u64::from(line);
        let mut cache = Cache::new(size, lines, line).unwrap();
        for &address in addresses {
            cache.access(address);
        }
        assert_eq!(
            curve.misses(u64::from(lines)),
            cache.misses(),
            "{lines} lines"
        );
    }
    let lines = curve.distinct_lines();
    assert_eq!(curve.misses(u64::MAX), lines);
    let points = curve.points();
    assert!(points[0].lines == 1 && points.is_sorted_by(|a, b| a.lines * 2 == b.lines));
    let last = points.last().unwrap().lines;
    assert!(
        last >= lines && (last == 1 || last / 2 < lines),
        "{last} of {lines}"
    );
    for point in points {
        assert_eq!(point.bytes, point.lines * u64::from(line));
        assert_eq!(point.misses, curve.misses(point.lines));
        let rate = point.misses as f64 / addresses.len().max(1) as f64;
        assert_eq!(point.miss_rate, rate);
    }
}

proptest! {
    /// The plain model: lists of lines, the one used last at the end.
    #[test]
    fn a_cache_is_lists_of_lines(
        addresses in addresses(), sets in 1usize..9, ways in 1usize..9, line in 1u64..100,
    ) {
        let size = sets as u64 * ways as u64 * line;
        let mut cache = Cache::new(size, ways as u32, line as u32).unwrap();
        let mut lists = vec![Vec::new(); sets];
        let mut hits = 0;
        for &address in &addresses {
            let number = address / line;
            let list = &mut lists[number as usize % sets];
            let hit = list.contains(&number);
            list.retain(|&other| other != number);
            list.push(number);
            if list.len() > ways {
                list.remove(0);
            }
            prop_assert_eq!(cache.access(address), hit);
            hits += u64::from(hit);
        }
        prop_assert_eq!((cache.hits(), cache.misses()), (hits, addresses.len() as u64 - hits));
    }

    #[test]
    fn the_curve_is_all_fully_associative_caches(addresses in addresses(), line in 1u32..100) {
        check_curve(&addresses, line, 1..=64);
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
    let address = |i: u64| match i % 4 {
        0 => random() % (9000 * 32),
        1 => random() % (300 * 32),
        2 => i / 4 * 8 % (9000 * 32),
        _ => random() % 64,
    };
    let addresses: Vec<u64> = (0..60_000).map(address).collect();
    check_curve(&addresses, 32, [1, 2, 7, 64, 1000, 5000, 9000]);
}

#[test]
fn an_access_across_lines_touches_each() {
    let mut curve = MissCurve::new(64);
    curve.access(60, 8);
    curve.access(60, 4);
    curve.access(64, 0);
    assert_eq!((curve.accesses(), curve.distinct_lines()), (4, 2));
    assert_eq!(MissCurve::new(0).line_bytes(), 1);
}

#[test]
fn shapes_that_are_no_caches() {
    for (size, ways, line, is_sound) in [
        (1024, 4, 0, false),
        (1024, 0, 32, false),
        (65535, 65535, 1, true),
        (1 << 20, 65536, 1, false),
        (0, 4, 32, false),
        (1000, 4, 32, false),
        ((1 << 28) + 1, 1, 1, false),
    ] {
        assert_eq!(
            Cache::new(size, ways, line).is_ok(),
            is_sound,
            "{size} {ways} {line}"
        );
    }
}

#[test]
fn traffic_by_kind() {
    let widths = Widths {
        stack_bits: 100,
        node_bits: 64,
        attribute_bits: 56,
        fill_vector_bits: 4,
        pixel_bits: 24,
    };
    let place = at(Stage::Pop, 0);
    let mut probe = MemoryProbe::new(widths)
        .with_curve(Memory::Node, 32)
        .with_curve(Memory::Node, 64)
        .with_curve(Memory::FillVector, 1);
    assert_eq!(probe.deepest_stack(), 0);
    for node in [0, 1, 3, 4, 7, 8, 0] {
        probe.read(Memory::Node, node, place);
    }
    for quad in [0, 1, 2, 0] {
        probe.read(Memory::FillVector, quad, place);
        probe.write(Memory::FillVector, quad, place);
    }
    for address in [u64::MAX, 1 << 40] {
        probe.write(Memory::Pixel, address, place);
    }
    for address in [0, 1, 2, 2, 1] {
        probe.write(Memory::Stack, address, place);
    }
    probe.read(Memory::Stack, 9, place);
    for (memory, reads, writes, distinct) in [
        (Memory::Node, 7, 0, 6),
        (Memory::FillVector, 4, 4, 3),
        (Memory::Pixel, 0, 2, 2),
        (Memory::Stack, 1, 5, 4),
    ] {
        let bits = u64::from(widths.of(memory));
        assert_eq!((probe.reads(memory), probe.writes(memory)), (reads, writes));
        assert_eq!(probe.read_bits(memory), reads * bits);
        assert_eq!(probe.written_bits(memory), writes * bits);
        assert_eq!(probe.distinct(memory), distinct);
    }
    assert_eq!(probe.deepest_stack(), 3);
    // Nodes 0 1 3 | 4 7 | 8 in lines of four, 0 1 3 4 7 | 8 in lines of eight; two fill vectors are a byte.
    let curves = probe.curves().iter().map(|(_, curve)| curve);
    let lines: Vec<u64> = curves.map(MissCurve::distinct_lines).collect();
    assert_eq!(lines, [3, 2, 2]);
    assert_eq!(probe.curves()[0].1.misses(2), 4);
    assert_eq!(probe.curves()[2].1.accesses(), 8);
}
