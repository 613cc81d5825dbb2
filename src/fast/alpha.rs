//! Blending (R11; `SPEC.md`, section 11), with products where the machine adds shifts. Voxels reach the same samples in
//! the same order as under `exact`; a sample stays open until it is opaque enough.

use super::band::Band;
use super::lanes::Isa;
use super::window::bits;
use crate::graph::sixteenths;
use crate::project::{ALL_LEFT, OPAQUE_ENOUGH, OpacityEye, SHARES};

/// Weights of a voxel's visible sides: by axis, in sixteenths of its outline.
fn side_weights(eye: &OpacityEye, min: [i32; 3], side: i32) -> [u32; 3] {
    let along: [i64; 3] = std::array::from_fn(|k| {
        let centre = i64::from(min[k]) + i64::from(side / 2);
        ((centre >> eye.shift) - eye.at[k]).abs()
    });
    let all = along.iter().sum::<i64>().max(1);
    let share = |along: i64| (2 * SHARES * along / all + 1) >> 1;
    let x = share(along[0]);
    let y = share(along[1]).min(SHARES - x);
    let shares = [x, y, SHARES - x - y];
    let squared = shares.iter().map(|share| share * share).sum::<i64>();
    let length = (9..16).find(|n| squared <= n * (n + 1)).unwrap_or(16);
    shares.map(|share| ((2 * share * share / length + 1) >> 1) as u32)
}

impl<I: Isa> Band<'_, I> {
    /// Shows a voxel at open samples of a square, eight bits per row. Returns the samples that are full by that.
    #[inline(always)]
    pub(super) fn show(
        &mut self,
        corner: [i32; 2],
        samples: u64,
        node: u32,
        voxel: [i32; 4],
    ) -> u64 {
        match &self.constants.opacity_eye {
            None => {
                self.pixels.show(self.isa, corner, samples, node, voxel);
                samples
            }
            Some(eye) => self.blend(eye, corner, samples, node, voxel),
        }
    }

    #[inline(never)]
    fn blend(
        &mut self,
        eye: &OpacityEye,
        [x, y]: [i32; 2],
        samples: u64,
        node: u32,
        voxel: [i32; 4],
    ) -> u64 {
        let weight = self.weight(eye, node, voxel);
        if weight == 0 {
            return 0;
        }
        let light = self.graph.light_of(node).map(u32::from);
        let first = self.pixels.at(x, y);
        let mut full = 0;
        for bit in bits(samples) {
            let at = first + (bit >> 3) * self.pixels.width + (bit & 7);
            let Some(sample) = self.pixels.blend.get_mut(at) else {
                continue;
            };
            let before = u32::from(sample.left);
            let share = (before * weight + (ALL_LEFT >> 1)) >> 8;
            let is_full = before - share <= OPAQUE_ENOUGH;
            let share = if is_full { before } else { share };
            sample.left = (before - share) as u16;
            for (sum, light) in sample.light.iter_mut().zip(light) {
                *sum += share * light;
            }
            if before == ALL_LEFT {
                self.pixels.shown[at] = node;
                if let Some(to) = self.pixels.voxel.get_mut(at) {
                    *to = voxel;
                }
            }
            full |= u64::from(is_full) << bit;
        }
        self.counters.samples_blended += u64::from(samples.count_ones());
        full
    }

    fn weight(&self, eye: &OpacityEye, node: u32, [x, y, z, level]: [i32; 4]) -> u32 {
        let opacity = self.graph.opacity_of(node);
        let side = self.constants.levels[level as usize].side;
        let half = i64::from(side / 2);
        let min = [x, y, z];
        let covered: [u32; 3] = std::array::from_fn(|k| {
            let is_high = self.constants.eye_floor[k] >= i64::from(min[k]) + half;
            u32::from(sixteenths(opacity.from_side(k, is_high)))
        });
        if covered.contains(&(SHARES as u32)) {
            return ALL_LEFT;
        }
        let weights = side_weights(eye, min, side);
        (0..3).map(|k| covered[k] * weights[k]).sum()
    }
}
