//! The lit share of a sample's colour, by its node's normal: for most samples a look-up, a product and two compares.
//!
//! The shares of each of the 65536 packed normals and of its opposite are cached. The sample's ray decides between them
//! (`is_turned`): normal times direction against a quarter of the direction's length, both nearly linear along a row
//! and computed in `f32`. Where they are too close, the rule itself decides. So the result is always that of
//! [`Shader::light`](super::Shader::light).

use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec3, Vec3};

use super::color::Light;
use super::shade::AWAY;
use super::sight::Sight;
use crate::budget::{self, Shortage};
use crate::graph::PackedNormal;

pub(super) const TOGETHER: usize = 16;

const NORMALS: usize = 1 << 16;

/// Error bound of `f32`, as a share of the three columns' lengths together: ten times the eight roundings of 2^-24 in the
/// product and ten in the length.
const MARGIN: f32 = 1e-5;

pub(super) struct Shares {
    light: Light,
    /// Object direction of a step across the image root, of one down, and of its corner; of any common length.
    columns: [DVec3; 3],
    columns_f32: [Vec3; 3],
    step: f32,
    margin: f32,
    /// By packed normal: the change of its product with the direction across and down the image root, its start, and both
    /// shares. Zeros are not made yet. Every thread computes the same values. The shares are stored last.
    entries: Vec<[AtomicU32; 4]>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Facing {
    /// Normal times direction is `along * u + base`.
    along: f32,
    base: f32,
    /// Lit share of the normal's colour, of 256.
    pub(super) front: u32,
    pub(super) back: u32,
}

impl Facing {
    pub(super) const FLAT: Self = Self {
        along: 0.0,
        base: f32::NEG_INFINITY,
        front: 256,
        back: 256,
    };
    pub(super) const UNKNOWN: Self = Self {
        base: f32::NAN,
        ..Self::FLAT
    };
}

pub(super) struct Run {
    across: [f32; TOGETHER],
    /// A normal whose product with the direction is above this is turned,
    limit: [f32; TOGETHER],
    /// unless it is closer than this.
    margin: f32,
}

impl Shares {
    pub(super) fn new(sight: &Sight, light: Light) -> Result<Self, Shortage> {
        let m = sight.to_object;
        let columns = [m.x_axis, m.y_axis, m.z_axis];
        // Lengths around 1, so that no square leaves the range of `f32`.
        let longest = columns.iter().fold(0.0f64, |l, c| l.max(c.length()));
        let columns = columns.map(|column| column / longest);
        let columns_f32 = columns.map(|column| column.as_vec3());
        let lengths: f64 = columns.iter().map(|column| column.length()).sum();
        // Memory that the system has zeroed: a small picture touches little of it.
        let entries = bytemuck::try_zeroed_vec(NORMALS);
        Ok(Self {
            light,
            columns,
            columns_f32,
            step: (1.0 / sight.root_doubled) as f32,
            margin: MARGIN * lengths as f32,
            entries: entries
                .map_err(|()| budget::refused::<[AtomicU32; 4]>("the light by normal", NORMALS))?,
        })
    }

    pub(super) fn down(&self, y: u32) -> f32 {
        self.across(y)
    }

    #[inline]
    fn across(&self, x: u32) -> f32 {
        (2 * x + 1) as i32 as f32 * self.step
    }

    #[inline]
    pub(super) fn run(&self, x: u32, down: f32) -> Run {
        let [right, low, corner] = self.columns_f32;
        let start = low * down + corner;
        let mut run = Run {
            margin: self.margin,
            ..Run::FLAT
        };
        // Plain loops over numbers: four at a time.
        for (i, across) in run.across.iter_mut().enumerate() {
            *across = self.across(x + i as u32);
        }
        for (limit, &u) in run.limit.iter_mut().zip(&run.across) {
            let dx = right.x * u + start.x;
            let dy = right.y * u + start.y;
            let dz = right.z * u + start.z;
            *limit = AWAY as f32 * (dx * dx + dy * dy + dz * dz).sqrt();
        }
        run
    }

    /// A normal's numbers in a row at `down`; none without a normal.
    #[inline]
    pub(super) fn facing(&self, packed: PackedNormal, down: f32) -> Option<Facing> {
        let entry = self.entries.get(usize::from(packed.0))?;
        let mut shares = entry[3].load(Ordering::Acquire);
        if shares == 0 {
            shares = self.make(packed, entry)?;
        }
        let number = |i: usize| f32::from_bits(entry[i].load(Ordering::Relaxed));
        Some(Facing {
            along: number(0),
            base: number(1) * down + number(2),
            front: shares & 0xffff,
            back: shares >> 16,
        })
    }

    #[cold]
    fn make(&self, packed: PackedNormal, entry: &[AtomicU32; 4]) -> Option<u32> {
        let normal = packed.decode()?;
        for (word, column) in entry.iter().zip(self.columns) {
            let product = normal.dot(column) as f32;
            word.store(product.to_bits(), Ordering::Relaxed);
        }
        // At least the ambient share each, so never 0.
        let shares = self.light.on(normal) | self.light.on(-normal) << 16;
        entry[3].store(shares, Ordering::Release);
        Some(shares)
    }
}

impl Run {
    pub(super) const FLAT: Self = Self {
        across: [0.0; TOGETHER],
        limit: [0.0; TOGETHER],
        margin: 0.0,
    };

    /// The share of sample `i`; none where the rule decides.
    #[inline]
    pub(super) fn share(&self, i: usize, facing: &Facing) -> Option<u32> {
        let above = facing.along * self.across[i] + facing.base - self.limit[i];
        if above < -self.margin {
            Some(facing.front)
        } else if above > self.margin {
            Some(facing.back)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Shading;
    use super::super::shade::is_turned;
    use super::*;
    use crate::graph::Placement;
    use crate::project::{Camera, FrameSetup, SetupOptions};

    #[test]
    fn shares_are_those_of_the_rule_for_every_normal() {
        let side = 37u32;
        let mut undecided = 0u32;
        for (fov_degrees, target) in [
            (60.0, DVec3::new(3.0, 2.0, 1.0)),
            (0.01, DVec3::new(-5.0, 2.0, 9.0)),
            (170.0, DVec3::new(3.0, -7.0, 1.0)),
        ] {
            let eye = DVec3::new(40.0, -30.0, 25.0);
            let camera = Camera::looking(eye, target, fov_degrees, (side, side));
            let options = SetupOptions::default();
            let setup = FrameSetup::new(&camera, &Placement::default(), 5, &options).unwrap();
            let sight = Sight::new(&setup);
            let light = Light::new(Shading::Lambert, sight.axes());
            let shares = Shares::new(&sight, light).unwrap();
            for bits in 0..=u16::MAX {
                let packed = PackedNormal(bits);
                let (x, y) = (u32::from(bits) % side, u32::from(bits) / side % side);
                let down = shares.down(y);
                let facing = shares.facing(packed, down);
                assert_eq!(facing.is_none(), packed.is_none());
                let facing = facing.unwrap_or(Facing::UNKNOWN);
                let found = shares.run(x, down).share(0, &facing);
                let Some(normal) = packed.decode() else {
                    assert_eq!(found, None);
                    continue;
                };
                let turned = is_turned(normal, sight.ray(x, y));
                let expected = light.on(if turned { -normal } else { normal });
                undecided += u32::from(found.is_none());
                assert!(found.is_none_or(|found| found == expected), "{bits:x}");
            }
        }
        // A margin of 1e-5 leaves about so many of each 1e5.
        assert!(undecided < 40, "{undecided}");
    }
}
