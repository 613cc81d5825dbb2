//! Scenes by name, and cameras drawn from a seed.
#![expect(unreachable_pub, reason = "a module of several test crates")]
#![allow(dead_code, reason = "each test uses a part of it")]

use std::path::Path;

use glam::DVec3;
use shiftvox::graph::{Graph, Silent};
use shiftvox::project::Camera;
use shiftvox::scene::{NoMeshes, OpenOptions, Source, open_source};
use shiftvox::split_mix::SplitMix;

/// The graph of a generator, or of a file of `tests/data`.
pub fn graph_of(name: &str) -> Graph {
    let source = match Source::is_generated(name) {
        true => Source::Generated(name.to_owned()),
        false => {
            let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
            Source::find(data.join(name)).expect(name)
        }
    };
    let opened = open_source(source, &OpenOptions::default(), &NoMeshes, &Silent);
    opened.expect(name).graph
}

/// Lowest corner and side of a graph's cube, world units.
pub fn cube(graph: &Graph) -> (DVec3, f64) {
    let place = &graph.placement;
    let origin = DVec3::from_array(place.origin_index.map(|c| c as f64));
    (
        DVec3::from_array(place.world_origin) + origin * place.voxel_size,
        (1u64 << graph.depth) as f64 * place.voxel_size,
    )
}

/// Reproducible random numbers.
#[derive(Debug, Clone)]
pub struct Dice(SplitMix);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Self(SplitMix::new(seed))
    }

    /// A number from `low` up to, not including, `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.unit()
    }

    pub fn below(&mut self, end: u32) -> u32 {
        self.0.below(u64::from(end)) as u32
    }

    pub fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u32) as usize]
    }

    /// A point of the cube `[low, high)^3`.
    pub fn point(&mut self, low: f64, high: f64) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| self.between(low, high)))
    }
}

/// The lowest corner of a random voxel, world units.
pub fn any_voxel(graph: &Graph, dice: &mut Dice) -> DVec3 {
    let mut at = DVec3::ZERO;
    let mut node = graph.root;
    let mut side = (1u64 << graph.depth) as f64;
    for _ in 0..graph.depth {
        side /= 2.0;
        let child = |octant| Some((octant, graph.view().child(node, octant as u8)?));
        let children: Vec<(u32, u32)> = (0..8).filter_map(child).collect();
        // A solid leaf consists of all its voxels.
        let (octant, child) = match children.len() {
            0 => (dice.below(8), node),
            n => children[dice.below(n as u32) as usize],
        };
        let bits = [octant >> 2, octant >> 1 & 1, octant & 1];
        at += side * DVec3::from_array(bits.map(f64::from));
        node = child;
    }
    cube(graph).0 + at * graph.placement.voxel_size
}

/// A place of the eye, relative to the object's cube or to a voxel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraPlace {
    /// Up to one and a half sides away.
    Outside,
    Inside,
    Solid,
    VoxelFace,
    VoxelCorner,
    CubeFace,
}

use CameraPlace::{CubeFace, Inside, Outside, Solid, VoxelCorner, VoxelFace};

pub const PLACES: [CameraPlace; 6] = [Outside, Inside, Solid, VoxelFace, VoxelCorner, CubeFace];

/// A camera with its eye at a place, looking at a voxel or, one time in four, from beside one along an axis, so that
/// ties abound. 5 to 150 degrees.
pub fn camera_at(place: CameraPlace, graph: &Graph, size: (u32, u32), dice: &mut Dice) -> Camera {
    let (low, side) = cube(graph);
    let voxel = graph.placement.voxel_size;
    loop {
        let axis = dice.below(3) as usize;
        let end = f64::from(dice.below(2));
        let mut eye = match place {
            Outside | Inside | CubeFace => low + dice.point(0.0, side),
            Solid | VoxelFace => any_voxel(graph, dice) + dice.point(0.0, voxel),
            VoxelCorner => any_voxel(graph, dice) + voxel * dice.point(0.0, 2.0).floor(),
        };
        match place {
            Outside => {
                let out = dice.between(0.02, 1.5) * side;
                eye[axis] = low[axis] + end * side + (2.0 * end - 1.0) * out;
            }
            VoxelFace => {
                let from_low = ((eye[axis] - low[axis]) / voxel).floor() + end;
                eye[axis] = low[axis] + from_low * voxel;
            }
            CubeFace => eye[axis] = low[axis] + end * side,
            Inside | Solid | VoxelCorner => {}
        }
        let mut target = any_voxel(graph, dice) + dice.point(0.0, voxel);
        if dice.below(4) == 0 {
            let way = target - eye;
            let longest = (0..3).max_by(|&a, &b| way[a].abs().total_cmp(&way[b].abs()));
            let along = longest.unwrap_or(axis);
            target = eye + DVec3::AXES[along] * way[along];
        }
        let camera = Camera {
            up: up_of(target - eye),
            ..Camera::looking(eye, target, dice.between(5.0, 150.0), size)
        };
        if camera.axes().is_ok() {
            return camera;
        }
    }
}

/// From a whole or half voxel along an axis with 90 degrees: every ray through a corner, an edge or along a face is
/// met.
fn camera_of_ties(side: f64, dice: &mut Dice) -> Camera {
    let eye = dice.point(-4.0, 2.0 * side + 5.0).floor() / 2.0;
    let axis = dice.below(3) as usize;
    let size = dice.of(&[7, 8, 16]);
    let target = eye + DVec3::AXES[axis] * dice.of(&[1.0, -1.0]);
    Camera {
        up: DVec3::AXES[(axis + 1 + dice.below(2) as usize) % 3] * dice.of(&[1.0, -1.0]),
        ..Camera::looking(eye, target, 90.0, (size, size))
    }
}

/// From any place, one time in three with many ties, one time in four with parallel rays.
pub fn any_camera(graph: &Graph, sizes: std::ops::Range<u32>, dice: &mut Dice) -> Camera {
    let mut side = || sizes.start + dice.below(sizes.end - sizes.start);
    let size = (side(), side());
    let camera = match dice.below(3) {
        0 => camera_of_ties(cube(graph).1, dice),
        _ => camera_at(dice.of(&PLACES), graph, size, dice),
    };
    let ortho = (dice.below(4) == 0).then(|| any_height(graph, dice));
    Camera { ortho, ..camera }
}

/// A height of a picture with parallel rays, from a hundredth of the object's side to three sides; every other time so
/// many whole voxels.
pub fn any_height(graph: &Graph, dice: &mut Dice) -> f64 {
    let side = cube(graph).1;
    let height = side * 10f64.powf(dice.between(-2.0, 0.5));
    let voxel = graph.placement.voxel_size;
    match dice.below(2) {
        0 => height,
        _ => (height / voxel).ceil() * voxel,
    }
}

/// Z, or Y for a camera that looks along Z.
pub fn up_of(forward: DVec3) -> DVec3 {
    match forward.normalize_or_zero().z.abs() > 0.9 {
        true => DVec3::Y,
        false => DVec3::Z,
    }
}
