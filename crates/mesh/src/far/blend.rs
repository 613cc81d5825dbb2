//! The six main directions, and how values for them are blended.
//!
//! A direction points from the surface to the eye, so `+x` is the view of an eye far out on the x axis. Main directions
//! are numbered `+x -x +y -y +z -z`. The three nearest ones share a direction.

use glam::DVec3;

/// Number of main directions.
pub const DIRECTIONS: usize = 6;

/// Numbers of main directions and their shares, which sum to 1.
pub type Shares = [(usize, f64); 3];

/// The shares of a unit vector by squared direction cosines: for normals and materials.
pub fn by_squares(towards_eye: DVec3) -> Shares {
    shares(towards_eye, towards_eye * towards_eye)
}

/// The shares of a unit vector by direction cosines over their sum: for opacities. The share of a cube's outline that an
/// axis-aligned box in it fills is blended exactly by these.
pub fn by_cosines(towards_eye: DVec3) -> Shares {
    shares(towards_eye, towards_eye.abs())
}

fn shares(towards_eye: DVec3, raw: DVec3) -> Shares {
    let sum = raw.x + raw.y + raw.z;
    [0, 1, 2].map(|axis| {
        let number = 2 * axis + usize::from(towards_eye[axis] < 0.0);
        let share = if sum > 0.0 {
            raw[axis] / sum
        } else {
            1.0 / 3.0
        };
        (number, share)
    })
}

/// Least squares for one to several values of the main directions.
///
/// Observations `v` of direction `d` are fitted by the blend of six unknowns. Directions without rays take the value that
/// they are drawn to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit<const N: usize> {
    matrix: [[f32; DIRECTIONS]; DIRECTIONS],
    right: [[f32; N]; DIRECTIONS],
}

/// Most turns of the relaxation.
const TURNS: usize = 30;
/// It ends when no value changes by more than this, which is finer than the stored precision.
const STEADY: f64 = 1e-4;

impl<const N: usize> Fit<N> {
    pub(super) fn new() -> Self {
        Self {
            matrix: [[0.0; DIRECTIONS]; DIRECTIONS],
            right: [[0.0; N]; DIRECTIONS],
        }
    }

    /// Adds an observation of a weight.
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

    /// Adds all observations of another.
    pub(super) fn merge(&mut self, other: &Self) {
        let matrix = self.matrix.as_flattened_mut().iter_mut();
        let right = self.right.as_flattened_mut().iter_mut();
        let others = other.matrix.as_flattened().iter();
        let others = others.chain(other.right.as_flattened());
        matrix
            .chain(right)
            .zip(others)
            .for_each(|(sum, v)| *sum += v);
    }

    /// The sum over all observations of their weight times the square of a blend of six values.
    pub(super) fn square_of(&self, values: &[f64; DIRECTIONS]) -> f64 {
        let rows = self.matrix.iter().zip(values);
        let row = |(row, value): (&[f32; DIRECTIONS], &f64)| {
            let products = row.iter().zip(values).map(|(&m, v)| f64::from(m) * v);
            value * products.sum::<f64>()
        };
        rows.map(row).sum()
    }

    /// The six values, each kept in `low..=high` and drawn to `prior` with the weight of `pull` observations.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shared::directions;

    #[test]
    fn six_values_are_found_again() {
        let truth = [0.1, 0.9, 0.3, 1.0, 0.0, 0.5];
        for blend in [by_squares, by_cosines] {
            assert_eq!(blend(DVec3::NEG_Z)[2], (5, 1.0));
            let (mut fit, mut square) = (Fit::<1>::new(), 0.0);
            for direction in directions(2000) {
                let shares = blend(direction);
                assert!((shares.iter().map(|s| s.1).sum::<f64>() - 1.0).abs() < 1e-12);
                let value = shares.iter().map(|&(k, share)| share * truth[k]).sum();
                fit.add(&shares, &[value], 2.0);
                square += 2.0 * value * value;
            }
            assert!((fit.square_of(&truth) - square).abs() < 1e-3 * square);
            let found = fit.solve(&[1.0], 1e-6, (0.0, 1.0));
            let is_near = (0..DIRECTIONS).all(|k| (found[k][0] - truth[k]).abs() < 1e-3);
            assert!(is_near, "{found:?}");
        }
        // Without observations, the default.
        let nothing = Fit::<1>::new().solve(&[0.75], 0.25, (0.0, 1.0));
        assert!(nothing.iter().all(|v| (v[0] - 0.75).abs() < 1e-12));
    }
}
