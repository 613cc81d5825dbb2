//! Faces of any number of corners, in triangles.

use earcut::Earcut;
use glam::DVec3;

/// Turns the other way by less than this share of the face's area are rounding.
const STRAIGHT: f64 = 1e-9;
/// Ears of a flat face have its area, to this share.
const WHOLE: f64 = 1e-6;

/// Triangles of a face, by its corners' numbers, turned as the face is: a fan from the first corner, or ears cut off
/// where a fan would leave the face.
pub(super) fn triangles(
    count: usize,
    corner: &dyn Fn(usize) -> DVec3,
) -> impl Iterator<Item = [usize; 3]> + use<> {
    let corners: Vec<DVec3> = (0..count).filter(|_| count > 3).map(corner).collect();
    let ears = ears(&corners);
    let in_fan = if ears.is_empty() { count } else { 0 };
    let fan = (2..in_fan).map(|last| [0, last - 1, last]);
    ears.into_iter().chain(fan)
}

/// Nothing of a convex face, and of one that crosses itself, is bent, or lies in a line.
fn ears(corners: &[DVec3]) -> Vec<[usize; 3]> {
    let count = corners.len();
    let at = |number: usize| corners[number % count];
    // Twice the area, towards the side from which the face turns left.
    let doubled = (2..count).map(|last| (at(last - 1) - at(0)).cross(at(last) - at(0)));
    let area: DVec3 = doubled.sum();
    let turns_back = |number: usize| {
        let [a, b, c] = [0, 1, 2].map(|next| at(number + next));
        (b - a).cross(c - b).dot(area) < -STRAIGHT * area.length_squared()
    };
    if !(0..count).any(turns_back) {
        return Vec::new();
    }
    let axis = area.abs().max_position();
    let [across, up] = [[1, 2], [2, 0], [0, 1]][axis];
    let flat = corners.iter().map(|corner| [corner[across], corner[up]]);
    let flat: Vec<[f64; 2]> = flat.collect();
    let mut numbers: Vec<usize> = Vec::new();
    Earcut::new().earcut(flat.iter().copied(), &[], &mut numbers);
    let turned = |&[a, b, c]: &[usize; 3]| {
        let [a2, b2, c2] = [flat[a], flat[b], flat[c]];
        let turn = (b2[0] - a2[0]) * (c2[1] - a2[1]) - (c2[0] - a2[0]) * (b2[1] - a2[1]);
        match (turn < 0.0) == (area[axis] < 0.0) {
            true => [a, b, c],
            false => [a, c, b],
        }
    };
    let ears: Vec<[usize; 3]> = numbers.as_chunks::<3>().0.iter().map(turned).collect();
    let of_ear = |&[a, b, c]: &[usize; 3]| (at(b) - at(a)).cross(at(c) - at(a)).length();
    let sum: f64 = ears.iter().map(of_ear).sum();
    // Corners between two others on a line may have no ear.
    let is_whole = ears.len() == count - 2 || (sum / area.length() - 1.0).abs() < WHOLE;
    if is_whole { ears } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(corners: &[DVec3]) -> Vec<[usize; 3]> {
        triangles(corners.len(), &|number| corners[number]).collect()
    }

    /// The area of triangles, and of their sum as vectors.
    fn areas(corners: &[DVec3]) -> [f64; 2] {
        let triangles = of(corners);
        let area = |[a, b, c]: [usize; 3]| {
            let [a, b, c] = [corners[a], corners[b], corners[c]];
            (b - a).cross(c - a) / 2.0
        };
        let areas: Vec<DVec3> = triangles.into_iter().map(area).collect();
        let alone = areas.iter().map(|area| area.length()).sum();
        [alone, areas.into_iter().sum::<DVec3>().length()]
    }

    #[test]
    fn concave_faces_are_covered_once_and_convex_ones_are_fans() {
        // An arrow, and a comb of two teeth; from all sides and directions.
        let arrow = [[0.0, 0.0], [4.0, -2.0], [1.0, 0.0], [4.0, 2.0]];
        let comb = [
            [0.0, 0.0],
            [5.0, 0.0],
            [5.0, 3.0],
            [4.0, 3.0],
            [4.0, 1.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [0.0, 3.0],
        ];
        for (face, expected) in [(&arrow[..], 2.0), (&comb[..], 9.0)] {
            for first in 0..face.len() {
                for (right, up) in [
                    (DVec3::X, DVec3::Y),
                    (DVec3::Y, DVec3::X),
                    (DVec3::Z, DVec3::Y),
                    (DVec3::X, DVec3::new(0.0, 0.6, 0.8)),
                ] {
                    let corner = |k: usize| {
                        let [x, y] = face[(first + k) % face.len()];
                        right * x + up * y
                    };
                    let corners: Vec<DVec3> = (0..face.len()).map(corner).collect();
                    let [alone, together] = areas(&corners);
                    assert!((alone - expected).abs() < 1e-9, "{first}: {alone}");
                    assert!((together - expected).abs() < 1e-9, "{first}: {together}");
                }
            }
        }
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 1.0], [0.0, 1.0]];
        let square = square.map(|[x, y]| DVec3::new(x, y, 3.0));
        assert_eq!(of(&square), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        let line = [0.0, 2.0, 1.0, 3.0].map(|x| DVec3::new(x, 0.0, 0.0));
        assert_eq!(of(&line).len(), 2);
        assert_eq!(of(&line[..2]).len(), 0);
        // A bent sheet, and a face that crosses itself.
        let bent = [
            [0, 0, 0],
            [2, 0, 0],
            [2, 1, 0],
            [1, 1, 0],
            [1, 1, 1],
            [0, 1, 1],
        ];
        let crossed = [[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]];
        for face in [&bent[..], &crossed] {
            let corners: Vec<DVec3> = face.iter().map(|p| p.map(f64::from).into()).collect();
            assert_eq!(of(&corners).len(), face.len() - 2);
        }
    }
}
