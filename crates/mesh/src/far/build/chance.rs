//! Random numbers of a node, which follow from its seed.

use shiftvox::split_mix::SplitMix;

/// Random numbers of a node.
pub(super) struct Chance(SplitMix);

impl Chance {
    pub(super) fn new(seed: u64) -> Self {
        let scrambled = seed.wrapping_mul(0xd134_2543_de82_ef95) ^ 0x9e37_79b9_7f4a_7c15;
        Self(SplitMix::new(scrambled))
    }

    /// 0 to 1, without 1.
    pub(super) fn unit(&mut self) -> f64 {
        self.0.unit()
    }
}
