//! A camera that sees all of an object.

use glam::DVec3;

use super::Camera;
use crate::graph::{Graph, MeshBox};

/// Vertical field of view by default, degrees.
pub const DEFAULT_FOV: f64 = 40.0;
/// Largest share of the picture that a fitted object fills.
const FILL: f64 = 0.94;
/// Most nodes of one level that are followed to find an object's box. Where there are more, it ends at their outer side.
const MOST_NODES: usize = 1 << if cfg!(any(fuzzing, test)) { 8 } else { 23 };

/// The world axis that is up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Up {
    /// +Y, the custom of meshes; the front looks towards +Z.
    Y,
    /// +Z, the custom of voxel files; the front looks towards -Y.
    Z,
}

impl Up {
    pub fn y_or_z(is_y: bool) -> Self {
        if is_y { Self::Y } else { Self::Z }
    }

    /// The vertical axis of a graph: that of its mesh, otherwise +Z.
    pub fn of(graph: &Graph) -> Self {
        Self::y_or_z(graph.placement.mesh.is_some_and(|mesh| mesh.y_up))
    }

    pub fn axis(self) -> DVec3 {
        match self {
            Self::Z => DVec3::Z,
            Self::Y => DVec3::Y,
        }
    }

    /// The direction from the object to a viewer in front of it.
    fn front(self) -> DVec3 {
        match self {
            Self::Z => DVec3::NEG_Y,
            Self::Y => DVec3::Z,
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    pub low: DVec3,
    pub high: DVec3,
    pub hull: Vec<DVec3>,
}

impl Bounds {
    /// The box of a graph's voxels in object coordinates, finest voxels. With millions of nodes along a side it may be too
    /// large, by less than a node of the level that has them.
    fn in_voxels(graph: &Graph) -> Option<([i64; 3], [i64; 3])> {
        let low = [0, 1, 2].map(|k| distance_from_side(graph, k, false));
        let high = [0, 1, 2].map(|k| (1 << graph.depth) - distance_from_side(graph, k, true));
        (!graph.is_empty()).then_some((low, high))
    }

    /// The least indices of a graph's voxels in the file, and the greatest plus one, as [`Bounds::in_voxels`].
    pub fn in_file(graph: &Graph) -> Option<[[i64; 3]; 2]> {
        let (low, high) = Self::in_voxels(graph)?;
        let origin = graph.placement.origin_index;
        Some([low, high].map(|at| [0, 1, 2].map(|k| at[k] + origin[k])))
    }

    pub fn of(graph: &Graph) -> Self {
        match &graph.placement.mesh {
            Some(mesh) => Self::of_mesh(mesh),
            None => Self::of_voxels(graph),
        }
    }

    /// A mesh's box, with its bevels.
    pub fn of_mesh(mesh: &MeshBox) -> Self {
        Self {
            low: mesh.low.into(),
            high: mesh.high.into(),
            hull: mesh.hull().map(DVec3::from_array).collect(),
        }
    }

    pub fn of_voxels(graph: &Graph) -> Self {
        let Some((low, high)) = Self::in_voxels(graph) else {
            return Self::of_box(DVec3::ZERO, DVec3::ONE);
        };
        let placement = &graph.placement;
        let world = |corner: [i64; 3]| {
            let index = |k: usize| (corner[k] + placement.origin_index[k]) as f64;
            DVec3::from_array(placement.world_origin)
                + DVec3::new(index(0), index(1), index(2)) * placement.voxel_size
        };
        let mut hull: Vec<DVec3> = coarse_corners(graph).into_iter().map(world).collect();
        let (low, high) = (world(low), world(high));
        for point in &mut hull {
            *point = point.clamp(low, high);
        }
        Self { low, high, hull }
    }

    pub fn of_box(low: DVec3, high: DVec3) -> Self {
        let corner = |i: u32| {
            let pick = |bit: u32, k: usize| if i >> bit & 1 == 1 { high[k] } else { low[k] };
            DVec3::new(pick(2, 0), pick(1, 1), pick(0, 2))
        };
        Self {
            low,
            high,
            hull: (0..8).map(corner).collect(),
        }
    }

    /// Revolved around the up axis, so that a fitted distance is the same from all sides.
    pub fn revolved(&self, up: Up) -> Self {
        let centre = (self.low + self.high) / 2.0;
        let axis = up.axis();
        let side = axis.cross(up.front());
        let mut rings: Vec<(f64, f64)> = self
            .hull
            .iter()
            .map(|&point| {
                let offset = point - centre;
                let height = offset.dot(axis);
                (height, (offset - axis * height).length())
            })
            .collect();
        rings.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
        // Only the widest ring of each height matters.
        rings.dedup_by_key(|ring| ring.0);
        let turns =
            (0..RING_POINTS).map(|i| sin_cos(360.0 * f64::from(i) / f64::from(RING_POINTS)));
        let hull = turns
            .flat_map(|(sin, cos)| {
                let outward = up.front() * cos + side * sin;
                let ring =
                    move |&(height, radius): &(f64, f64)| centre + axis * height + outward * radius;
                rings.iter().map(ring).collect::<Vec<_>>()
            })
            .collect();
        Self {
            hull,
            ..self.clone()
        }
    }
}

/// The least distance of a voxel from a side of the object's cube, in finest voxels. The voxel at the end of a path along
/// that side is often as near as any could be; then no others are looked at.
fn distance_from_side(graph: &Graph, axis: usize, is_high: bool) -> i64 {
    let of_high = [0xf0, 0xcc, 0xaa][axis];
    let nearer = if is_high { of_high } else { !of_high };
    let of_path = distance_within(graph, nearer, None);
    distance_within(graph, nearer, Some(of_path))
}

/// Goes down from level to level with all nodes that are nearest to a side, until their distance, below which there is no
/// voxel, is that of a known one. Without a known one, a single node is followed to a voxel. `nearer`: the octants at the
/// side.
fn distance_within(graph: &Graph, nearer: u8, known: Option<i64>) -> i64 {
    let view = graph.view();
    let mut nodes = vec![graph.root];
    let mut at = 0;
    for level in 0..graph.depth {
        let mut masks = nodes.iter().map(|&node| view.mask(node));
        if known == Some(at) || masks.clone().any(|mask| mask == 0) {
            break;
        }
        let is_near = masks.any(|mask| mask & nearer != 0);
        if !is_near {
            at += 1 << (graph.depth - level - 1);
        }
        // Of the finest voxels the mask is enough.
        if level + 1 == graph.depth {
            break;
        }
        let octants = if is_near { nearer } else { !nearer };
        let slots = nodes
            .iter()
            .flat_map(|&node| (0..8).map(move |octant| (node, octant)));
        let mut next: Vec<u32> = slots
            .filter(|(_, octant)| octants >> octant & 1 == 1)
            .filter_map(|(node, octant)| view.child(node, octant))
            .take(if known.is_none() { 1 } else { MOST_NODES })
            .collect();
        // In a damaged file, lists of children may lead nowhere.
        if next.is_empty() || next.len() == MOST_NODES {
            break;
        }
        next.sort_unstable();
        next.dedup();
        nodes = next;
    }
    at
}

const RING_POINTS: u32 = 72;
/// Level of the nodes whose corners enclose an object.
const HULL_LEVEL: u32 = 5;

fn coarse_corners(graph: &Graph) -> Vec<[i64; 3]> {
    let view = graph.view();
    let level = HULL_LEVEL.min(graph.depth);
    let side = 1i64 << (graph.depth - level);
    let across = (1usize << level) + 1;
    let mut is_corner = vec![false; across * across * across];
    let mut open = vec![(graph.root, 0, [0usize; 3])];
    while let Some((node, at_level, at)) = open.pop() {
        let mask = view.mask(node);
        if at_level == level || mask == 0 {
            let span = 1usize << (level - at_level);
            for corner in 0..8usize {
                let place = |k: usize| at[k] * span + span * (corner >> (2 - k) & 1);
                is_corner[(place(0) * across + place(1)) * across + place(2)] = true;
            }
            continue;
        }
        for octant in 0..8u8 {
            if let Some(child) = view.child(node, octant) {
                let half = |k: usize| at[k] * 2 + usize::from(octant >> (2 - k) & 1);
                open.push((child, at_level + 1, [half(0), half(1), half(2)]));
            }
        }
    }
    (0..is_corner.len())
        .filter(|&i| is_corner[i])
        .map(|i| {
            let place = [i / (across * across), i / across % across, i % across];
            place.map(|p| p as i64 * side)
        })
        .collect()
}

/// Direction from an object to its viewer, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction {
    /// Around the up axis: 0 from the front, 90 from the right.
    pub azimuth: f64,
    pub elevation: f64,
}

impl Direction {
    /// From a corner, above: the view of isometric pictures.
    pub const CORNER: Self = Self {
        azimuth: 45.0,
        elevation: 35.264,
    };
}

/// How a fitted camera sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lens {
    /// Vertical field of view, degrees.
    Degrees(f64),
    /// Parallel rays.
    Ortho,
}

/// The nearest camera in a direction that sees everything; `zoom` divides its distance, or the height of parallel rays.
pub fn fit_camera(
    bounds: &Bounds,
    up: Up,
    direction: Direction,
    lens: Lens,
    zoom: f64,
    (width, height): (u32, u32),
) -> Camera {
    let (sin_a, cos_a) = sin_cos(direction.azimuth);
    let (sin_e, cos_e) = sin_cos(direction.elevation);
    let right_of_front = up.axis().cross(up.front());
    let horizontal = up.front() * cos_a + right_of_front * sin_a;
    let towards_eye = horizontal * cos_e + up.axis() * sin_e;
    // Rises with the elevation, so it is never along the view axis.
    let camera_up = up.axis() * cos_e - horizontal * sin_e;
    let camera_right = camera_up.cross(towards_eye);

    let centre = (bounds.low + bounds.high) / 2.0;
    let (fov_degrees, slope_up) = match lens {
        Lens::Degrees(degrees) => {
            let half_angle = degrees * (std::f64::consts::PI / 360.0);
            (degrees, libm::tan(half_angle) * FILL)
        }
        Lens::Ortho => (DEFAULT_FOV, 0.5 * FILL),
    };
    let slope_right = slope_up * f64::from(width) / f64::from(height);
    let farthest = |of: &dyn Fn(DVec3) -> f64| {
        let offsets = bounds.hull.iter().map(|&point| point - centre);
        offsets.map(of).fold(0.0, f64::max)
    };
    let across = |offset: DVec3| {
        (offset.dot(camera_right).abs() / slope_right).max(offset.dot(camera_up).abs() / slope_up)
    };
    let before = |offset: DVec3| offset.dot(towards_eye);
    let (distance, scale, ortho) = match lens {
        Lens::Degrees(_) => {
            let distance = farthest(&|offset| across(offset) + before(offset));
            (distance / zoom, distance, None)
        }
        // The eye is before everything.
        Lens::Ortho => {
            let height = farthest(&across);
            let distance = farthest(&before) + height;
            (distance, distance, Some(tidied(height / zoom, height)))
        }
    };
    Camera {
        eye: tidy(centre + towards_eye * distance, scale),
        target: centre,
        up: tidy(camera_up, 1.0),
        fov_degrees,
        ortho,
        width,
        height,
    }
}

/// Rounds to about six decimal digits of `scale`, so that a printed camera is short and exact.
fn tidy(point: DVec3, scale: f64) -> DVec3 {
    DVec3::from_array(point.to_array().map(|x| tidied(x, scale)))
}

fn tidied(x: f64, scale: f64) -> f64 {
    let digits = 6 - libm::ceil(libm::log10(scale.max(f64::MIN_POSITIVE))) as i32;
    // A power of ten up to 22 is exact, so x becomes the f64 nearest to a short decimal.
    let rounded = match digits {
        0..=22 => libm::round(x * power_of_ten(digits)) / power_of_ten(digits),
        -22..0 => libm::round(x / power_of_ten(-digits)) * power_of_ten(-digits),
        _ => x,
    };
    // Not -0.
    rounded + 0.0
}

fn power_of_ten(exponent: i32) -> f64 {
    (0..exponent).fold(1.0, |power, _| power * 10.0)
}

fn sin_cos(degrees: f64) -> (f64, f64) {
    let radians = degrees * (std::f64::consts::PI / 180.0);
    (libm::sin(radians), libm::cos(radians))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{Builder, LinkedGraph, Silent, Voxel};
    use crate::split_mix::SplitMix;

    fn camera(bounds: &Bounds, up: Up, [azimuth, elevation]: [f64; 2], size: (u32, u32)) -> Camera {
        let direction = Direction { azimuth, elevation };
        fit_camera(bounds, up, direction, Lens::Degrees(40.0), 1.0, size)
    }

    #[test]
    fn all_corners_are_seen_and_one_is_near_the_edge() {
        let cube = Bounds::of_box(DVec3::ZERO, DVec3::splat(10.0));
        for (from, up, expected) in [
            ([0.0, 0.0], Up::Z, DVec3::NEG_Y),
            ([90.0, 0.0], Up::Z, DVec3::X),
            ([0.0, 90.0], Up::Z, DVec3::Z),
            ([0.0, 0.0], Up::Y, DVec3::Z),
            ([90.0, 0.0], Up::Y, DVec3::X),
        ] {
            let camera = camera(&cube, up, from, (100, 100));
            assert_eq!((camera.eye - camera.target).normalize(), expected);
        }
        for from in [[45.0, 35.0], [0.0, 0.0], [10.0, 90.0], [200.0, -60.0]] {
            let camera = camera(&cube, Up::Z, from, (300, 200));
            let axes = camera.axes().unwrap();
            let edge = |corner: u32| {
                let bit = |b: u32| f64::from(corner >> b & 1) * 10.0;
                let offset = DVec3::new(bit(0), bit(1), bit(2)) - camera.eye;
                let scale = axes.focal_px / offset.dot(axes.forward);
                let across = (offset.dot(axes.right) * scale / 150.0).abs();
                across.max((offset.dot(axes.up) * scale / 100.0).abs())
            };
            let most = (0..8).map(edge).fold(0.0, f64::max);
            assert!((most - FILL).abs() < 1e-3, "{from:?}: {most}");
        }
    }

    fn graph_of(points: impl IntoIterator<Item = [i32; 3]>) -> Graph {
        let mut builder = Builder::default();
        for index in points {
            builder.push(Voxel {
                index,
                ..Voxel::default()
            });
        }
        builder.finish(([0.0; 3], 1.0), &Silent).unwrap()
    }

    #[test]
    fn boxes_are_those_of_all_voxels() {
        let mut dice = SplitMix::new(3);
        for _ in 0..100 {
            let side = 1 + dice.below(40);
            let points = 0..1 + dice.below(9);
            let points: Vec<_> = points
                .map(|_| [0; 3].map(|_| dice.below(side) as i32))
                .collect();
            let of = |k: usize| points.iter().map(move |point| i64::from(point[k]));
            let low = [0, 1, 2].map(|k| of(k).min().unwrap());
            let high = [0, 1, 2].map(|k| of(k).max().unwrap() + 1);
            let found = Bounds::in_file(&graph_of(points.clone()));
            assert_eq!(found, Some([low, high]));
        }
        // One voxel or a solid leaf in a corner, sheets, and cycles: a digit is a child by octant, a dot none.
        for (depth, nodes, low, high) in [
            (0, "........", [0; 3], [1; 3]),
            (1, ".......0", [1, 1, 1], [2, 2, 2]),
            (3, "1....... ........", [0, 0, 0], [4, 4, 4]),
            (3, ".....1.. .......0", [7, 2, 7], [8, 3, 8]),
            (30, "0.0.0.0.", [0, 0, 0], [1 << 30, 1 << 30, 1]),
            (30, "....0000", [(1 << 30) - 1, 0, 0], [1 << 30; 3]),
            (12, "0.1..... 1.......", [0; 3], [1, 2049, 1]),
        ] {
            let mut graph = LinkedGraph::new(depth);
            for children in nodes.split(' ') {
                let mut children = children.chars().map(|digit| digit.to_digit(10));
                graph.add_node([0; 3], std::array::from_fn(|_| children.next().flatten()));
            }
            let graph = graph.build().unwrap();
            assert_eq!(Bounds::in_voxels(&graph), Some((low, high)), "{nodes}");
        }
        // Twenty times twenty nodes of two voxels are more than are followed.
        let mut graph = graph_of((0..1600).map(|at| [at / 40, at % 40, 0]));
        assert_eq!(Bounds::in_voxels(&graph), Some(([0; 3], [40, 40, 2])));
        // Children that do not exist.
        graph.first = vec![].into();
        assert_eq!(Bounds::in_voxels(&graph), Some(([0; 3], [64, 64, 32])));
    }

    #[test]
    fn a_revolved_object_is_seen_from_the_same_distance_all_around() {
        let bounds = Bounds::of_box(DVec3::ZERO, DVec3::new(10.0, 4.0, 7.0)).revolved(Up::Z);
        let distance = |azimuth: f64| {
            let camera = camera(&bounds, Up::Z, [azimuth, 20.0], (100, 100));
            camera.eye.distance(camera.target)
        };
        for turn in [5.0, 45.0, 90.0, 210.0] {
            assert!((distance(turn) - distance(0.0)).abs() < 1e-3, "{turn}");
        }
    }
}
