//! Scenes of the experiments, and their cameras.

use glam::DVec3;

use crate::args::{CameraArgs, SceneArgs};
use crate::console::Console;
use crate::error::CliError;
use crate::scenes::{self, Scene};
use shiftvox::project::{Bounds, Camera};
use shiftvox_lab::bench::Subject;

pub(crate) const BUNDLED: &str = "bundled";
pub(crate) const DEFAULT: [&str; 3] = ["gen:terrain,depth=10", "gen:menger,depth=5", BUNDLED];

/// A camera in sides of a cube, from the cube's lowest corner: eye and target. 60 degrees, z up.
type Standpoint = [[f64; 3]; 2];

const OUTSIDE: Standpoint = [[1.6, -0.7, 1.25], [0.5, 0.5, 0.3]];
const FRONT: Standpoint = [[0.47, -0.95, 0.53], [0.475, 0.5, 0.475]];
const TREE: Standpoint = [[1.1, -0.5, 0.8], [0.5, 0.5, 0.4]];

pub(crate) fn names_or(given: &[String], default: &[&str]) -> Vec<String> {
    match given {
        [] => default.iter().map(|&name| name.to_owned()).collect(),
        given => given.to_vec(),
    }
}

/// Opens a scene. Without camera flags, terrain, sponge and the bundled tree have their standard cameras. All others are
/// fitted into `size`.
pub(crate) fn open(
    name: &str,
    camera: &CameraArgs,
    scene_args: &SceneArgs,
    size: (u32, u32),
    console: &Console,
) -> Result<Subject, CliError> {
    camera.check().map_err(CliError::usage)?;
    let scene = match name {
        BUNDLED => scenes::demo(console.progress())?,
        name => scenes::open(name, scene_args, console)?,
    };
    let standard = standard_camera(name, &scene, size).filter(|_| *camera == CameraArgs::default());
    let camera = standard.unwrap_or_else(|| {
        let bounds = Bounds::of(&scene.graph);
        camera.camera(&bounds, scene.up, size, 0.0)
    });
    Ok(Subject {
        name: name.to_owned(),
        graph: scene.graph,
        camera,
    })
}

fn standard_camera(name: &str, scene: &Scene, (width, height): (u32, u32)) -> Option<Camera> {
    let placement = &scene.graph.placement;
    let side = (1u64 << scene.graph.depth) as f64 * placement.voxel_size;
    let mut low = DVec3::from_array(placement.world_origin);
    // Generators fill a cube from index 0, whether or not its lowest layers are empty.
    let standpoint = match name.split(',').next() {
        Some("gen:terrain") => OUTSIDE,
        Some("gen:menger") => FRONT,
        Some(BUNDLED) => {
            let lowest = DVec3::from_array(placement.origin_index.map(|c| c as f64));
            low += lowest * placement.voxel_size;
            TREE
        }
        _ => return None,
    };
    let [eye, target] = standpoint.map(|at| low + DVec3::from_array(at) * side);
    Some(Camera::looking(eye, target, 60.0, (width, height)))
}
