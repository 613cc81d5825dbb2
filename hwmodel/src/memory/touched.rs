//! Sets of touched addresses.

use super::NumberMap;

/// A set of addresses, one bit each in pages of 4096.
#[derive(Debug, Clone, Default)]
pub(super) struct Touched {
    pages: NumberMap<Box<[u64; 64]>>,
    distinct: u64,
}

impl Touched {
    pub(super) fn touch(&mut self, address: u64) {
        let page = self
            .pages
            .entry(address >> 12)
            .or_insert_with(|| Box::new([0; 64]));
        let word = &mut page[(address >> 6) as usize % 64];
        let bit = 1 << (address % 64);
        self.distinct += u64::from(*word & bit == 0);
        *word |= bit;
    }

    pub(super) fn distinct(&self) -> u64 {
        self.distinct
    }
}
