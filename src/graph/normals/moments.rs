//! Moments of a voxel's neighbourhood, and the normal that follows from them.

use glam::DVec3;

use super::cluster::Surroundings;
use crate::graph::PackedNormal;

/// Weight of a voxel by its distance along an axis, -2 to 2.
const WEIGHT: [i32; 5] = [1, 2, 2, 2, 1];
/// Mass of half a neighbourhood. A wall of two voxels has it; a flat face has five eighths of a full one.
const HALF_MASS: i32 = 8 * 8 * 8 / 2;
const LONE_MASS: i32 = 2 * 2 * 2;
/// Least distance of the centre of mass, in voxels, at which it determines the normal: 0.8 is a flat face, 0.5 a wall
/// of two.
const ONE_SIDED: f64 = 0.6;
/// Weight of the centre of mass, in voxels, against the object's middle, when choosing the outer side of a wall.
const OFFSET_SHARE: f64 = 0.25;

/// Bits per moment where three are packed in one number: the largest is 1152.
const FIELD: u32 = 20;

/// Packed mass, first and second moment of a row of five voxels, by its bits.
const ROW_MOMENTS: [i64; 32] = {
    let mut table = [0; 32];
    let mut bits = 0;
    while bits < 32 {
        let mut place = 0;
        while place < 5 {
            if bits >> place & 1 == 1 {
                let distance = place as i64 - 2;
                let moments = 1 + (distance << FIELD) + ((distance * distance) << (2 * FIELD));
                table[bits] += WEIGHT[place] as i64 * moments;
            }
            place += 1;
        }
        bits += 1;
    }
    table
};

/// Weighted sums of five numbers, times the place to the power of 0, 1 and 2.
#[inline(always)]
fn along(of: impl Fn(usize) -> i64) -> [i64; 3] {
    let [a, b, c, d, e] = [of(0), of(1), of(2), of(3), of(4)];
    let (ends, inner) = (a + e, b + d);
    [
        ends + 2 * (inner + c),
        2 * (d + e - a - b),
        4 * ends + 2 * inner,
    ]
}

#[inline(always)]
fn fields(sum: i64) -> [i32; 3] {
    let low = |sum: i64| sum << (64 - FIELD) >> (64 - FIELD);
    let first = low(sum);
    let rest = (sum - first) >> FIELD;
    let second = low(rest);
    [
        first as i32,
        second as i32,
        ((rest - second) >> FIELD) as i32,
    ]
}

/// Moments of a voxel's neighbourhood about the voxel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Moments {
    mass: i32,
    first: [i32; 3],
    /// xx, yy, zz, xy, xz, yz.
    second: [i32; 6],
}

impl Moments {
    #[inline]
    pub(super) fn around(rows: &Surroundings, [x, y, z]: [usize; 3]) -> Self {
        let planes: [[i64; 3]; 5] = std::array::from_fn(|k| {
            let rows = &rows[z + k];
            along(|j| ROW_MOMENTS[usize::from(rows[y + j] >> x & 31)])
        });
        let [all, by_z, by_zz] = along(|k| planes[k][0]);
        let [by_y, by_yz, _] = along(|k| planes[k][1]);
        let [by_yy, ..] = along(|k| planes[k][2]);
        let [mass, mx, xx] = fields(all);
        let [mz, xz, _] = fields(by_z);
        let [zz, ..] = fields(by_zz);
        let [my, xy, _] = fields(by_y);
        let [yz, ..] = fields(by_yz);
        let [yy, ..] = fields(by_yy);
        Self {
            mass,
            first: [mx, my, mz],
            second: [xx, yy, zz, xy, xz, yz],
        }
    }

    /// `outward` is the preferred side of a thin wall.
    pub(super) fn normal(&self, outward: DVec3) -> PackedNormal {
        if self.mass <= LONE_MASS {
            return PackedNormal::NONE;
        }
        let mass = f64::from(self.mass);
        let mean = DVec3::from_array(self.first.map(f64::from)) / mass;
        if self.mass > HALF_MASS || mean.length_squared() >= ONE_SIDED * ONE_SIDED {
            return PackedNormal::encode(-mean);
        }
        let thin = thinnest(&self.second.map(|moment| f64::from(moment) / mass), mean);
        let hint = outward.normalize_or_zero() - mean * OFFSET_SHARE;
        let turned = thin.map(|column| column.dot(hint));
        let direction = DVec3::from_array(turned);
        if direction.length() > 0.02 {
            return PackedNormal::encode(direction);
        }
        // The hint lies in the wall: choose either side.
        let longest = thin
            .into_iter()
            .max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
        let either = longest.unwrap_or(DVec3::ZERO);
        let up = either.z + 1e-3 * (either.y + 1e-3 * either.x);
        PackedNormal::encode(if up < 0.0 { -either } else { either })
    }
}

/// A projection to the directions of least variance, by columns (symmetric).
///
/// The adjugate of the covariance has the same axes, its largest value at the covariance's least; five squarings leave
/// nearly only that. Where two variances are least, it projects to their plane.
fn thinnest(second: &[f64; 6], mean: DVec3) -> [DVec3; 3] {
    // Keeps the adjugate of a straight row of voxels from vanishing.
    const FLOOR: f64 = 1e-3;
    let xx = second[0] - mean.x * mean.x + FLOOR;
    let yy = second[1] - mean.y * mean.y + FLOOR;
    let zz = second[2] - mean.z * mean.z + FLOOR;
    let xy = second[3] - mean.x * mean.y;
    let xz = second[4] - mean.x * mean.z;
    let yz = second[5] - mean.y * mean.z;
    // By rows above the diagonal: xx, xy, xz, yy, yz, zz.
    let mut m = [
        yy * zz - yz * yz,
        yz * xz - xy * zz,
        xy * yz - yy * xz,
        zz * xx - xz * xz,
        xz * xy - yz * xx,
        xx * yy - xy * xy,
    ];
    for squaring in 0..6 {
        // Variances are above the floor, so the trace is positive.
        let scale = 1.0 / (m[0] + m[3] + m[5]);
        m = m.map(|number| number * scale);
        if squaring < 5 {
            let [xx, xy, xz, yy, yz, zz] = m;
            m = [
                xx * xx + xy * xy + xz * xz,
                xx * xy + xy * yy + xz * yz,
                xx * xz + xy * yz + xz * zz,
                xy * xy + yy * yy + yz * yz,
                xy * xz + yy * yz + yz * zz,
                xz * xz + yz * yz + zz * zz,
            ];
        }
    }
    let [xx, xy, xz, yy, yz, zz] = m;
    [
        DVec3::new(xx, xy, xz),
        DVec3::new(xy, yy, yz),
        DVec3::new(xz, yz, zz),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::cluster::MORTON_TO_XYZ;
    use super::*;
    use crate::split_mix::SplitMix;

    #[test]
    fn moments_match_a_plain_sum() {
        let mut random = SplitMix::new(1);
        let rows = [(); 8].map(|()| random.bits().to_le_bytes());
        for at in MORTON_TO_XYZ {
            let mut plain = Moments::default();
            for d in (0..125).map(|i| [i / 25 - 2, i / 5 % 5 - 2, i % 5 - 2]) {
                let [x, y, z] = [0, 1, 2].map(|k| (at[k] as i32 + d[k] + 2) as usize);
                if rows[z][y] >> x & 1 == 0 {
                    continue;
                }
                let weight: i32 = d.map(|d| WEIGHT[(d + 2) as usize]).iter().product();
                plain.mass += weight;
                for (k, [a, b]) in [[0, 1], [0, 2], [1, 2]].into_iter().enumerate() {
                    plain.first[k] += weight * d[k];
                    plain.second[k] += weight * d[k] * d[k];
                    plain.second[3 + k] += weight * d[a] * d[b];
                }
            }
            assert_eq!(Moments::around(&rows, at), plain);
        }
    }
}
