//! SplitMix64: reproducible random numbers.

#[derive(Debug, Clone)]
pub struct SplitMix(u64);

impl SplitMix {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    pub fn below(&mut self, count: u64) -> u64 {
        self.bits() % count.max(1)
    }

    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// 64 bits that look random: the first of the seed `value`.
pub fn mix(value: u64) -> u64 {
    SplitMix(value).bits()
}

#[cfg(test)]
mod tests {
    /// The first number of the authors' program for the seed 1234567.
    #[test]
    fn the_numbers_are_those_of_the_reference() {
        assert_eq!(super::mix(1_234_567), 6_457_827_717_110_365_317);
    }
}
