//! Blends of values for the six main directions, `+x -x +y -y +z -z` from the surface to the eye. The three nearest ones
//! share a direction.

use glam::DVec3;

pub(super) const DIRECTIONS: usize = 6;

pub(super) type Shares = [(usize, f64); 3];

/// By squared direction cosines: for normals and materials.
pub(super) fn by_squares(towards_eye: DVec3) -> Shares {
    shares(towards_eye, towards_eye * towards_eye)
}

/// By direction cosines over their sum: for opacities. The outline of an axis-aligned box is blended exactly.
pub(super) fn by_cosines(towards_eye: DVec3) -> Shares {
    shares(towards_eye, towards_eye.abs())
}

fn shares(towards_eye: DVec3, raw: DVec3) -> Shares {
    let sum = raw.x + raw.y + raw.z;
    [0, 1, 2].map(|axis| {
        let number = 2 * axis + usize::from(towards_eye[axis] < 0.0);
        let is_direction = sum > 0.0;
        (
            number,
            if is_direction {
                raw[axis] / sum
            } else {
                1.0 / 3.0
            },
        )
    })
}

/// Least squares: observations are fitted by the blend of six unknowns.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit<const N: usize> {
    matrix: [[f32; DIRECTIONS]; DIRECTIONS],
    right: [[f32; N]; DIRECTIONS],
}

const TURNS: usize = 30;
const STEADY: f64 = 1e-4;

impl<const N: usize> Fit<N> {
    pub(super) fn new() -> Self {
        Self {
            matrix: [[0.0; DIRECTIONS]; DIRECTIONS],
            right: [[0.0; N]; DIRECTIONS],
        }
    }

    pub(super) fn add(&mut self, shares: &Shares, value: &[f64; N], weight: f64) {
        for &(i, share_i) in shares {
            for &(j, share_j) in shares {
                self.matrix[i][j] += (weight * share_i * share_j) as f32;
            }
            for (sum, &v) in self.right[i].iter_mut().zip(value) {
                *sum += (weight * share_i * v) as f32;
            }
        }
    }

    pub(super) fn merge(&mut self, other: &Self) {
        let matrices = self.matrix.as_flattened_mut().iter_mut();
        let matrices = matrices.zip(other.matrix.as_flattened());
        let rights = self.right.as_flattened_mut().iter_mut();
        let rights = rights.zip(other.right.as_flattened());
        matrices.chain(rights).for_each(|(sum, v)| *sum += v);
    }

    pub(super) fn square_of(&self, values: &[f64; DIRECTIONS]) -> f64 {
        let rows = self.matrix.iter().zip(values);
        let row = |(row, value): (&[f32; DIRECTIONS], &f64)| {
            let products = row.iter().zip(values).map(|(&m, v)| f64::from(m) * v);
            value * products.sum::<f64>()
        };
        rows.map(row).sum()
    }

    /// The values, each kept in `low..=high` and drawn to `prior` with the weight of `pull` observations.
    pub(super) fn solve(
        &self,
        prior: &[f64; N],
        pull: f64,
        (low, high): (f64, f64),
    ) -> [[f64; N]; DIRECTIONS] {
        let mut values = [*prior; DIRECTIONS];
        for k in 0..N {
            for _ in 0..TURNS {
                let mut most = 0.0f64;
                for i in 0..DIRECTIONS {
                    let mut rest = f64::from(self.right[i][k]) + pull * prior[k];
                    for j in (0..DIRECTIONS).filter(|&j| j != i) {
                        rest -= f64::from(self.matrix[i][j]) * values[j][k];
                    }
                    let weight = f64::from(self.matrix[i][i]) + pull;
                    let value = (rest / weight).clamp(low, high);
                    most = most.max((value - values[i][k]).abs());
                    values[i][k] = value;
                }
                if most < STEADY {
                    break;
                }
            }
        }
        values
    }
}
