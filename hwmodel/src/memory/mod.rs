//! Traffic to the machine's memories: bits by kind, distinct addresses, depth of the stack, and miss curves.

mod cache;
mod curve;
mod records;
mod traffic;

pub use cache::{Cache, CacheError};
pub use curve::{MissCurve, MissPoint};
pub use records::{RecordAccesses, RecordBits, RecordKind, RecordProbe};
pub use traffic::{ACCUMULATOR_BITS, MemoryProbe, PIXEL_BITS, Widths};

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// A map from the number of a line or page. The numbers are small and dense, so one multiplication spreads them.
type NumberMap<V> = HashMap<u64, V, BuildHasherDefault<NumberHasher>>;

#[derive(Debug, Clone, Copy, Default)]
struct NumberHasher(u64);

impl Hasher for NumberHasher {
    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u64(u64::from(byte));
        }
    }

    fn write_u64(&mut self, number: u64) {
        let product = u128::from(self.0 ^ number) * 0x9e37_79b9_7f4a_7c15;
        // Both ends of the hash are used: for the table's index and for the tag.
        self.0 = (product >> 64) as u64 ^ product as u64;
    }

    fn finish(&self) -> u64 {
        self.0
    }
}
