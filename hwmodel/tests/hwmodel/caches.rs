//! Caches, miss curves and traffic against plain models.

use crate::common::*;
use hwmodel::memory::{Cache, MemoryProbe, MissCurve, Widths};
use hwmodel::{Memory, Probe};
use proptest::prelude::*;

/// Compares a curve with a list of lines, the one used last at the front: a cache of `n` lines has the first `n`.
fn check_curve(addresses: &[u64], line: u32) {
    let mut curve = MissCurve::new(line);
    let (mut lines, mut distances) = (Vec::new(), Vec::new());
    for &address in addresses {
        curve.access(address, 1);
        let number = address / u64::from(line);
        let place = lines.iter().position(|&other| other == number);
        distances.push(place.map_or(u64::MAX, |place| place as u64));
        match place {
            Some(place) => lines[..=place].rotate_right(1),
            None => lines.insert(0, number),
        }
    }
    assert_eq!(curve.accesses(), addresses.len() as u64);
    let distinct = lines.len() as u64;
    assert_eq!(
        (curve.distinct_lines(), curve.misses(u64::MAX)),
        (distinct, distinct)
    );
    for size in (0..=64).chain([1000, 5000, 9000]) {
        let misses = distances.iter().filter(|&&distance| distance >= size);
        assert_eq!(curve.misses(size), misses.count() as u64, "{size} lines");
    }
    let points = curve.points();
    assert!(points[0].lines == 1 && points.is_sorted_by(|a, b| a.lines * 2 == b.lines));
    let last = points.last().unwrap().lines;
    assert_eq!(last, distinct.max(1).next_power_of_two());
    for point in points {
        assert_eq!(point.bytes, point.lines * u64::from(line));
        assert_eq!(point.misses, curve.misses(point.lines));
        let rate = point.misses as f64 / addresses.len().max(1) as f64;
        assert_eq!(point.miss_rate, rate);
    }
}

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
    /// Each set is a cache of its own lines.
    #[test]
    fn a_cache_is_a_curve_per_set(
        addresses in addresses(), sets in 1u32..9, ways in 1u32..9, line in 1u32..100,
    ) {
        let mut cache = Cache::new(sets * ways * line, ways, line);
        let mut curves = vec![MissCurve::new(1); sets as usize];
        for &address in &addresses {
            cache.access(address);
            let number = address / u64::from(line);
            curves[(number % u64::from(sets)) as usize].access(number, 1);
        }
        let misses: u64 = curves.iter().map(|curve| curve.misses(ways.into())).sum();
        prop_assert_eq!((cache.hits(), cache.misses()), (addresses.len() as u64 - misses, misses));
    }

    #[test]
    fn the_curve_is_all_fully_associative_caches(addresses in addresses(), line in 1u32..100) {
        check_curve(&addresses, line);
    }
}

/// Long enough that times are renumbered many times, with more lines than the first table holds.
#[test]
fn a_long_run_agrees_too() {
    let random = |i: u64| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
    let address = |i: u64| match i % 4 {
        0 => random(i) % (9000 * 32),
        1 => random(i) % (300 * 32),
        2 => i / 4 * 8 % (9000 * 32),
        _ => random(i) % 64,
    };
    check_curve(&(0..60_000).map(address).collect::<Vec<_>>(), 32);
}

#[test]
fn an_access_across_lines_touches_each() {
    let mut curve = MissCurve::new(64);
    for (address, bytes) in [(60, 8), (60, 4), (64, 0)] {
        curve.access(address, bytes);
    }
    assert_eq!((curve.accesses(), curve.distinct_lines()), (4, 2));
    assert_eq!(MissCurve::new(0).line_bytes(), 1);
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
    let place = at(RecordStage::Pop, 0);
    let mut probe = MemoryProbe::new(widths)
        .with_curve(Memory::Node, 32)
        .with_curve(Memory::Node, 64)
        .with_curve(Memory::FillVector, 1);
    assert_eq!(probe.deepest_stack(), 0);
    for (memory, reads, writes, distinct) in [
        (Memory::Node, &[0, 1, 3, 4, 7, 8, 0][..], &[][..], 6),
        (Memory::FillVector, &[0, 1, 2, 0], &[0, 1, 2, 0], 3),
        (Memory::Pixel, &[], &[u64::MAX, 1 << 40], 2),
        (Memory::Stack, &[9], &[0, 1, 2, 2, 1], 4),
    ] {
        reads
            .iter()
            .for_each(|&address| probe.read(memory, address, place));
        writes
            .iter()
            .for_each(|&address| probe.write(memory, address, place));
        let [reads, writes] = [reads, writes].map(|addresses| addresses.len() as u64);
        let bits = u64::from(widths.of(memory));
        assert_eq!((probe.reads(memory), probe.writes(memory)), (reads, writes));
        assert_eq!(probe.read_bits(memory), reads * bits);
        assert_eq!(probe.written_bits(memory), writes * bits);
        assert_eq!(probe.distinct(memory), distinct);
    }
    assert_eq!(probe.deepest_stack(), 3);
    // Nodes 0 1 3 | 4 7 | 8 in lines of four, 0 1 3 4 7 | 8 in lines of eight; two fill vectors are a byte.
    let curves = probe
        .curves()
        .iter()
        .map(|(_, curve)| curve.distinct_lines());
    assert!(curves.eq([3, 2, 2]));
    assert_eq!(probe.curves()[0].1.misses(2), 4);
    assert_eq!(probe.curves()[2].1.accesses(), 8);
}
