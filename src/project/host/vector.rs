//! Vectors of the host's numbers, in the order of operations that `glam` has.

use super::{Host, Num, Number};

/// A vector of numbers that `by` is told about.
pub(crate) fn lift_all<H: Host, T: Number>(by: H, values: [T; 3]) -> [Num<H, T>; 3] {
    values.map(|value| by.lift(value))
}

/// The plain numbers.
pub(crate) fn values<H: Host, T: Number>(vector: [Num<H, T>; 3]) -> [T; 3] {
    vector.map(|c| c.value)
}

/// Each component times `factor`.
pub(crate) fn times<H: Host, T: Number>(
    vector: [Num<H, T>; 3],
    factor: Num<H, T>,
) -> [Num<H, T>; 3] {
    vector.map(|c| c * factor)
}

/// The sum of the products: 3 multiplies, 2 adds.
pub(crate) fn dot<H: Host, T: Number>(a: [Num<H, T>; 3], b: [Num<H, T>; 3]) -> Num<H, T> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cross product: 6 multiplies, 3 subtracts.
pub(crate) fn cross<H: Host, T: Number>(a: [Num<H, T>; 3], b: [Num<H, T>; 3]) -> [Num<H, T>; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::{Kind, Step, Tally, Untold};
    use super::*;

    fn counted(tally: &Tally, kind: Kind) -> Vec<(Step, u64)> {
        let of_kind = tally.cells().filter(|cell| cell.kind == kind);
        of_kind.map(|cell| (cell.step, cell.times)).collect()
    }

    #[test]
    fn a_cross_product_is_six_multiplies_and_three_subtracts() {
        let tally = Tally::default();
        let by = &tally;
        let product = cross(lift_all(by, [1i128, 2, 3]), lift_all(by, [-4, 5, 6]));
        assert_eq!(values(product), [-3, -18, 13]);
        let steps = [(Step::Add, 3), (Step::Multiply, 6)];
        assert_eq!(counted(&tally, Kind::LongInteger), steps);
        assert_eq!(counted(&tally, Kind::Float), []);
    }

    #[test]
    fn a_vector_is_made_one_long() {
        let tally = Tally::default();
        let by = &tally;
        let vector = lift_all(by, [2.0, -3.0, 6.0]);
        let unit = times(vector, by.lift(1.0) / dot(vector, vector).sqrt());
        assert_eq!(
            values(unit),
            DVec3::new(2.0, -3.0, 6.0).normalize().to_array()
        );
        let steps = [
            (Step::Add, 2),
            (Step::Multiply, 6),
            (Step::Divide, 1),
            (Step::SquareRoot, 1),
        ];
        assert_eq!(counted(&tally, Kind::Float), steps);
    }

    #[test]
    fn the_bits_are_those_of_glam() {
        let a = DVec3::new(0.1, -7.3e5, 1.0 / 3.0);
        let b = DVec3::new(-2.7, 0.03, 1e-9);
        let lift = |v: DVec3| lift_all(Untold, v.to_array());
        assert_eq!(values(cross(lift(a), lift(b))), a.cross(b).to_array());
        assert_eq!(dot(lift(a), lift(b)).value, a.dot(b));
    }

    #[test]
    fn an_untold_number_is_as_large_as_a_number() {
        assert_eq!(size_of::<Num<Untold, f64>>(), size_of::<f64>());
    }
}
