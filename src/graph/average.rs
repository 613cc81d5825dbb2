//! Averages of colour and normal, exact and independent of the order.
//!
//! Colours are averaged in linear light, in 24 bits; normals in 2^-20. Sums of up to 2^32 voxels fit 64 bits.

use std::sync::LazyLock;

use glam::DVec3;

use super::PackedNormal;
use crate::srgb::to_linear;

const FULL: f64 = 16_777_215.0;
const UNIT_NORMAL: f64 = 1_048_576.0;

static LINEAR: LazyLock<[u32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|value| {
        let linear = to_linear(value as f64 / 255.0);
        libm::round(linear * FULL) as u32
    })
});

/// By the upper half of a light's bits: the first value that is no darker.
static NO_DARKER: LazyLock<[u8; 4096]> = LazyLock::new(|| {
    std::array::from_fn(|upper| LINEAR.partition_point(|&light| light < (upper as u32) << 12) as u8)
});

/// By the bits of a packed normal: its direction times [`UNIT_NORMAL`], towards zero for both signs. Zero is no normal.
static DIRECTIONS: LazyLock<Vec<[i32; 3]>> = LazyLock::new(|| {
    let direction = |bits| PackedNormal(bits).decode().unwrap_or(DVec3::ZERO);
    (0..=u16::MAX)
        .map(|bits| {
            direction(bits)
                .to_array()
                .map(|part| (part * UNIT_NORMAL) as i32)
        })
        .collect()
});

fn encode(linear: u64) -> u8 {
    let linear = linear.min(FULL as u64) as u32;
    let table: &[u32; 256] = &LINEAR;
    let mut above = NO_DARKER[(linear >> 12) as usize];
    while table[usize::from(above)] < linear {
        above += 1;
    }
    let below = above.saturating_sub(1);
    let to_above = table[usize::from(above)] - linear;
    let to_below = linear - table[usize::from(below)];
    above - u8::from(to_above > to_below)
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Sum {
    count: u64,
    light: [u64; 3],
    normal: [i64; 3],
}

impl Sum {
    pub(super) fn add_voxel(&mut self, color: [u8; 3], normal: PackedNormal) {
        self.count += 1;
        let linear: &[u32; 256] = &LINEAR;
        for (light, value) in self.light.iter_mut().zip(color) {
            *light += u64::from(linear[usize::from(value)]);
        }
        let direction = DIRECTIONS[usize::from(normal.0)];
        for (sum, part) in self.normal.iter_mut().zip(direction) {
            *sum += i64::from(part);
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.count += other.count;
        for c in 0..3 {
            self.light[c] += other.light[c];
            self.normal[c] += other.normal[c];
        }
    }

    pub(super) fn color(&self) -> [u8; 3] {
        let count = self.count.max(1);
        let mut color = [0; 3];
        for (value, light) in color.iter_mut().zip(self.light) {
            *value = encode((light + count / 2) / count);
        }
        color
    }

    pub(super) fn normal(&self) -> PackedNormal {
        let [x, y, z] = self.normal.map(|part| part as f64);
        PackedNormal::encode(DVec3::new(x, y, z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_value_is_found_for_every_light() {
        // Between two values the nearer, on the middle the brighter; each step of both.
        for value in 0..255usize {
            let (below, above) = (u64::from(LINEAR[value]), u64::from(LINEAR[value + 1]));
            for linear in below..=above {
                let nearer = usize::from(above - linear <= linear - below) + value;
                assert_eq!(usize::from(encode(linear)), nearer, "{linear}");
            }
        }
        assert_eq!((encode(1 << 24), encode(u64::MAX)), (255, 255));
    }
}
