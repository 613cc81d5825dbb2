//! A mesh, and all that is made of it, is seen from one place.

use std::fs;
use std::path::Path;

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox::project::{Bounds, DEFAULT_FOV, Direction, Up, fit_camera};
use shiftvox::{Camera, Renderer, Scene};
use shiftvox_mesh::SceneOptions;
use shiftvox_mesh::open::read_mesh;
use shiftvox_mesh::{LoadOptions, mesh_box};

use crate::program::{run, stdout_of, words};

/// The output of a command, without the last line's end.
fn printed(folder: &Path, line: &str) -> String {
    stdout_of(&run(folder, &words(line)).success())
        .trim_end()
        .to_owned()
}

fn put_knot(folder: &Path) {
    let assets = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("assets");
    for name in ["knot.obj", "knot.mtl"] {
        fs::copy(assets.join(name), folder.join(name)).unwrap();
    }
}

#[test]
fn the_library_fits_the_same_camera() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    put_knot(folder);
    let options = SceneOptions::new().mesh_depth(5);
    let scene = options.open(folder.join("knot.obj")).unwrap();
    scene.save_vxg(folder.join("a.vxg")).unwrap();
    let kept = Scene::open(folder.join("a.vxg")).unwrap();
    assert_eq!((scene.up(), kept.up()), (Up::Y, Up::Y));
    assert_eq!(Camera::fit(&scene), Camera::fit(&kept));
    // Its box is that of the voxels all the same.
    let [low, high] = kept.bounds();
    let mesh = kept.graph().placement.mesh.unwrap();
    assert!((0..3).all(|k| low[k] < mesh.low[k] && mesh.high[k] < high[k]));
    let picture = Renderer::new()
        .hashed(true)
        .render(&kept, &Camera::fit(&kept), 40, 30);
    let hash = printed(folder, "render a.vxg --size 40x30 --hash");
    assert_eq!(picture.unwrap().hash().unwrap(), hash);
    let turned = kept.with_up(Up::Z);
    turned.save_vxg(folder.join("z.vxg")).unwrap();
    assert_eq!(Scene::open(folder.join("z.vxg")).unwrap().up(), Up::Z);
}

/// `spec/mesh.md`, "Fitted camera", has these figures.
#[test]
fn the_camera_is_nearer_than_one_that_sees_the_whole_box() {
    let knot = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("assets/knot.obj");
    let (mesh, _) = read_mesh(&knot, &LoadOptions::default(), &Silent).unwrap();
    let (low, high) = mesh.bounds();
    let points = mesh.positions().iter();
    let of_vertices = Bounds {
        hull: points.map(|p| DVec3::from_array(*p)).collect(),
        ..Bounds::of_box(low, high)
    };
    let of_mesh = Bounds::of_mesh(&mesh_box(&mesh, true));
    let distances = [of_vertices, of_mesh, Bounds::of_box(low, high)].map(|bounds| {
        let direction = Direction::CORNER;
        let camera = fit_camera(&bounds, Up::Y, direction, DEFAULT_FOV, 1.0, (512, 512));
        ((camera.eye - camera.target).length() * 100.0).round() / 100.0
    });
    assert_eq!(distances, [10.92, 11.99, 14.57]);
}
