//! A mesh, and all that is made of it, is seen from one place.

use std::fs;
use std::path::Path;

use glam::DVec3;
use serde_json::Value;
use shiftvox::graph::Silent;
use shiftvox::project::{Bounds, DEFAULT_FOV, Direction, Up, fit_camera};
use shiftvox::{Camera, Renderer, Scene};
use shiftvox_mesh::SceneOptions;
use shiftvox_mesh::open::read_mesh;
use shiftvox_mesh::{LoadOptions, mesh_box};

use crate::common::Run;

/// What a command prints, without the last line's end.
fn printed(folder: &Path, line: &str) -> String {
    let mut command = crate::common::command();
    let assert = command.current_dir(folder).args(line.split(' ')).assert();
    let output = assert.success().get_output().stdout.clone();
    String::from_utf8(output).unwrap().trim_end().to_owned()
}

fn camera_of(folder: &Path, scene: &str) -> String {
    printed(
        folder,
        &format!("render {scene} --size 40x30 --print-camera"),
    )
}

fn put_knot(folder: &Path) {
    let assets = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("assets");
    for name in ["knot.obj", "knot.mtl"] {
        fs::copy(assets.join(name), folder.join(name)).unwrap();
    }
}

#[test]
fn a_mesh_and_all_that_is_made_of_it_have_one_camera() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    put_knot(folder);
    // Far from the origin, where files keep less of a coordinate than a mesh does.
    let far_off = "v 4000 0.1 -0.7\nv 4003 0.3 0.7\nv 4001 1.9 0.33\nf 1 2 3\n";
    fs::write(folder.join("off.obj"), far_off).unwrap();
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 3 0 1\nvertex 1 2 5\n\
               endloop\nendfacet\nendsolid a\n";
    fs::write(folder.join("flat.stl"), stl).unwrap();
    let mut seen = Vec::new();
    for mesh in ["knot.obj", "off.obj", "flat.stl", "knot.obj --mesh-up z"] {
        let expected = camera_of(folder, &format!("{mesh} --depth 5"));
        let made = [
            "a.vxg --depth 6",
            "b.vxg --depth 7 --memory 64M",
            "a.far",
            "a.tvx",
        ];
        for made in made {
            let name = made.split(' ').next().unwrap();
            let (file, flags) = mesh.split_once(' ').unwrap_or((mesh, ""));
            let line = format!("convert {file} {made} --force {flags}");
            printed(folder, line.trim_end());
            assert_eq!(camera_of(folder, name), expected, "{mesh}: {made}");
        }
        printed(folder, "convert a.vxg again.vxg --force");
        assert_eq!(camera_of(folder, "again.vxg"), expected, "{mesh}: again");
        let triangles = format!("triangles {mesh} -o a.png --force --size 40x30 --json");
        let document: Value = serde_json::from_str(&printed(folder, &triangles)).unwrap();
        assert_eq!(document["camera"], expected, "{mesh}: triangles");
        seen.push(expected);
    }
    assert!(seen[0] != seen[3], "which axis is up is seen");
    // What a file says can be overruled, and what was said is kept in what is made of it.
    assert_eq!(camera_of(folder, "a.vxg --mesh-up y"), seen[0]);
    printed(folder, "convert a.vxg y.vxg --mesh-up y");
    assert_eq!(camera_of(folder, "y.vxg"), seen[0]);
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
