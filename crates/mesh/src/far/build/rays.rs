//! The first triangle on each ray. Of equally near ones it is one towards the ray, and of these the one with the lowest
//! number.

use std::io::{self, Read};

use bytemuck::Pod;
use glam::{DVec3, Vec3, Vec3A};

use super::bvh::{self, Node, Ray};
use super::clusters::Stops;
use super::shot::NOWHERE;

/// Share of an edge by which triangles reach beyond it, so that no ray slips between two.
const EDGE: f32 = 1e-5;
const MARGIN: f32 = 1.0 + 1e-3;
/// Faces of both sides of a card are equally near, as far as roundings let them.
const EQUAL: f32 = 1.0 + 1e-5;

#[derive(Debug, Clone, Copy)]
pub(super) struct Query {
    pub(super) origin: Vec3,
    pub(super) direction: Vec3,
    pub(super) most: f32,
}

impl Query {
    fn ray(&self) -> Ray {
        Ray {
            origin: self.origin.into(),
            direction: self.direction.into(),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Meeting {
    pub(super) distance: f32,
    /// In the order of the hierarchy, or [`NOWHERE`].
    pub(super) triangle: u32,
    is_towards: bool,
}

impl Meeting {
    pub(super) const NONE: Self = Self {
        distance: f32::INFINITY,
        triangle: NOWHERE,
        is_towards: false,
    };

    fn is_before(&self, other: &Self) -> bool {
        if self.is_towards != other.is_towards {
            return match self.is_towards {
                true => self.distance <= other.distance * EQUAL,
                false => self.distance * EQUAL < other.distance,
            };
        }
        (self.distance, self.triangle) < (other.distance, other.triangle)
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Around {
    pub(super) low: Vec3A,
    pub(super) high: Vec3A,
}

impl Around {
    pub(super) fn of(low: DVec3, high: DVec3) -> Self {
        let wider = 1e-5 * (high - low).length() + 1e-6 * low.abs().max(high.abs()).max_element();
        let wider = DVec3::splat(wider);
        Self {
            low: (low - wider).as_vec3a(),
            high: (high + wider).as_vec3a(),
        }
    }

    fn is_entered(&self, query: &Query, before: f32) -> bool {
        let per_unit = Vec3A::from(query.direction).recip();
        let origin = Vec3A::from(query.origin);
        let [a, b] = [self.low, self.high].map(|corner| (corner - origin) * per_unit);
        // A ray within a plane of the box gives what is not a number there, which counts as within.
        let enter = a.min(b).to_array().into_iter().fold(0.0, f32::max);
        let leave = a.max(b).to_array().into_iter().fold(before, f32::min);
        enter <= leave * MARGIN
    }

    pub(super) fn touches(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }

    /// The square of the distance from the other's middle.
    pub(super) fn square_from(&self, other: &Self) -> f32 {
        let middle = (other.low + other.high) * 0.5;
        let apart = (self.low - middle).max(middle - self.high);
        apart.max(Vec3A::ZERO).length_squared()
    }
}

/// A triangle: its first corner, and from there to the others.
type Corners = [[f32; 3]; 3];

#[derive(Debug)]
pub(super) struct Cluster {
    nodes: Vec<Node>,
    triangles: Vec<Corners>,
    numbers: Vec<u32>,
}

impl Cluster {
    pub(super) fn new(corners: impl Iterator<Item = [DVec3; 3]>) -> Self {
        let triangles: Vec<[Vec3A; 3]> = corners
            .map(|corners| corners.map(|corner| corner.as_vec3a()))
            .collect();
        let (nodes, numbers) = bvh::build(&triangles);
        let in_order = numbers.iter().map(|&number| {
            let [a, b, c] = triangles[number as usize];
            [a, b - a, c - a].map(|point| point.to_array())
        });
        Self {
            triangles: in_order.collect(),
            nodes,
            numbers,
        }
    }

    pub(super) fn bytes(&self) -> u64 {
        let [nodes, numbers, triangles] = self.sections().map(<[u8]>::len);
        (nodes + numbers + triangles) as u64
    }

    pub(super) fn sections(&self) -> [&[u8]; 3] {
        [
            bytemuck::cast_slice(&self.nodes),
            bytemuck::cast_slice(&self.numbers),
            bytemuck::cast_slice(&self.triangles),
        ]
    }

    pub(super) fn read(from: &mut impl Read, bytes: [usize; 3]) -> io::Result<Self> {
        let [nodes, numbers, triangles] = bytes;
        Ok(Self {
            nodes: read_all(from, nodes)?,
            numbers: read_all(from, numbers)?,
            triangles: read_all(from, triangles)?,
        })
    }

    fn nearest(&self, query: &Query, first: u32, stops: Option<&Stops<'_>>, meeting: &mut Meeting) {
        let most = query.most.min(meeting.distance * MARGIN);
        let ray = query.ray();
        bvh::traverse(&self.nodes, &ray, most, |place| {
            let (distance, is_towards) = meet(&self.triangles[place], &ray);
            if distance > query.most.min(meeting.distance * EQUAL) || distance.is_infinite() {
                return f32::INFINITY;
            }
            let met = Meeting {
                distance,
                triangle: first + self.numbers[place],
                is_towards,
            };
            if !met.is_before(meeting) {
                return f32::INFINITY;
            }
            let point = || (query.origin + query.direction * distance).as_dvec3();
            if stops.is_some_and(|stops| !stops(met.triangle as usize, point())) {
                return f32::INFINITY;
            }
            *meeting = met;
            distance * MARGIN
        });
    }

    pub(super) fn meet_all(
        &self,
        around: &Around,
        first: u32,
        stops: Option<&Stops<'_>>,
        queries: &[Query],
        meetings: &mut [Meeting],
    ) {
        for (query, meeting) in queries.iter().zip(meetings) {
            if around.is_entered(query, query.most.min(meeting.distance)) {
                self.nearest(query, first, stops, meeting);
            }
        }
    }
}

fn read_all<T: Pod>(from: &mut impl Read, bytes: usize) -> io::Result<Vec<T>> {
    let mut items = vec![T::zeroed(); bytes / size_of::<T>()];
    from.read_exact(bytemuck::cast_slice_mut(&mut items))?;
    Ok(items)
}

pub(super) fn is_any_entered(around: &Around, queries: &[Query], meetings: &[Meeting]) -> bool {
    let mut both = queries.iter().zip(meetings);
    both.any(|(query, meeting)| around.is_entered(query, query.most.min(meeting.distance)))
}

/// Möller and Trumbore's test, from both sides, a little beyond the edges; infinite where they do not meet. And whether
/// the ray comes from the side that sees the corners counter-clockwise.
fn meet(&[corner, to_second, to_third]: &Corners, ray: &Ray) -> (f32, bool) {
    let [corner, to_second, to_third] = [corner, to_second, to_third].map(Vec3A::from_array);
    let across = ray.direction.cross(to_third);
    let signed = to_second.dot(across);
    // All is compared times this, so that nothing is divided that does not meet.
    let scale = signed.abs();
    let sign = 1f32.copysign(signed);
    let from = ray.origin - corner;
    let u = from.dot(across) * sign;
    let over = from.cross(to_second);
    let v = ray.direction.dot(over) * sign;
    if scale == 0.0 || u.min(v).min(scale - u - v) < -EDGE * scale {
        return (f32::INFINITY, false);
    }
    let t = to_third.dot(over) * sign / scale;
    (if t >= 0.0 { t } else { f32::INFINITY }, signed > 0.0)
}

#[cfg(test)]
mod tests {
    use shiftvox::split_mix::SplitMix;

    use super::super::clusters::{Occluders, Part};
    use super::*;

    fn nearest_of_all(triangles: &[[DVec3; 3]], query: &Query, size: f32) -> Meeting {
        let ray = query.ray();
        let mut nearest = Meeting::NONE;
        for (number, corners) in triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|corner| corner.as_vec3a());
            let (distance, is_towards) = meet(&[a, b - a, c - a].map(|p| p.to_array()), &ray);
            // A ray within a triangle's plane may seem to meet it far away.
            let at = ray.origin + ray.direction * distance;
            let outside = (a.min(b).min(c) - at).max(at - a.max(b).max(c));
            let is_there = outside.max_element() <= 1e-5 * size;
            let met = Meeting {
                distance,
                triangle: number as u32,
                is_towards,
            };
            if is_there && distance <= query.most && met.is_before(&nearest) {
                nearest = met;
            }
        }
        nearest
    }

    #[test]
    fn rays_meet_the_nearest_triangle_whatever_the_clusters_and_the_memory() {
        let mut dice = SplitMix::new(7);
        let mut met = 0;
        for round in 0..200 {
            let size = [1.0, 8.0, 1e4][round % 3];
            let count = 1 + dice.below(300);
            let mut place = |around: DVec3, size: f64| {
                let coordinate = |_| (dice.below(17) as f64 - 8.0) * size / 8.0;
                around + DVec3::from_array([0; 3].map(coordinate))
            };
            let triangle = |_| {
                let around = place(DVec3::ZERO, size);
                [0; 3].map(|_| place(around, 1.0))
            };
            let mut triangles: Vec<[DVec3; 3]> = (0..count).map(triangle).collect();
            // The test of a triangle is too coarse for slivers.
            triangles.retain(|[a, b, c]| (b - a).cross(c - a).length() > 0.02);
            triangles.extend_from_within(..triangles.len() / 3);
            let query = |_| {
                let (from, to) = (place(DVec3::ZERO, 2.0 * size), place(DVec3::ZERO, size));
                Some(Query {
                    origin: from.as_vec3(),
                    direction: (to - from).try_normalize()?.as_vec3(),
                    most: [f32::INFINITY, size as f32][round % 2],
                })
            };
            let queries: Vec<Query> = (0..100).filter_map(query).collect();
            let nearest = |query: &Query| nearest_of_all(&triangles, query, size as f32);
            let expected: Vec<Meeting> = queries.iter().map(nearest).collect();
            met += expected.iter().filter(|&m| *m != Meeting::NONE).count();
            let half = DVec3::splat(2.0 * size);
            let around = Around::of(-half, half);
            for (parts, within) in [(1, None), (4, None), (5, Some(1)), (9, Some(9000))] {
                let part = |part: usize| Part {
                    triangles: triangles.len() * part / parts..triangles.len() * (part + 1) / parts,
                    around,
                };
                let corners = |number: usize| triangles[number];
                let within = within.map(|most| (tempfile::tempfile().unwrap(), most));
                let parts = (0..parts).map(part).collect();
                let occluders = Occluders::new(parts, corners, None, within).unwrap();
                let mut found = Vec::new();
                occluders.nearest(&around, &queries, &mut found).unwrap();
                for (found, expected) in found.iter().zip(&expected) {
                    // Of a ray that begins in a triangle's plane the test is too coarse.
                    let begins_there = found.distance.min(expected.distance) == 0.0;
                    assert!(begins_there || found == expected, "{found:?} {expected:?}");
                }
            }
        }
        assert!(met > 3000, "{met}");
    }
}
