//! Traffic to memories, counted by hand.

use crate::common::*;
use hwmodel::memory::{MemoryProbe, Widths};
use hwmodel::{Memory, Probe};

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
    let mut probe = MemoryProbe::new(widths);
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
}
