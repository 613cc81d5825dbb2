//! A mesh, and all that is made of it, is seen from one place.

use std::path::Path;

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox::project::{Bounds, DEFAULT_FOV, Direction, Up, fit_camera};
use shiftvox::{Camera, Renderer, Scene};
use shiftvox_mesh::open::read_mesh;
use shiftvox_mesh::{LoadOptions, SceneOptions, mesh_box};

use crate::program::{Folder, ROOT};

#[test]
fn the_library_fits_the_camera_of_the_program() {
    let (folder, knot) = (Folder::new(), Path::new(ROOT).join("assets/knot.obj"));
    let scene = SceneOptions::new().mesh_depth(5).open(&knot).unwrap();
    scene.save_vxg(folder.at("a.vxg")).unwrap();
    let kept = Scene::open(folder.at("a.vxg")).unwrap();
    assert_eq!((scene.up(), kept.up()), (Up::Y, Up::Y));
    assert_eq!(Camera::fit(&scene), Camera::fit(&kept));
    // Its box is that of the voxels all the same.
    let [low, high] = kept.bounds();
    let mesh = kept.graph().placement.mesh.unwrap();
    assert!((0..3).all(|k| low[k] < mesh.low[k] && mesh.high[k] < high[k]));
    let renderer = Renderer::new().hashed(true);
    let picture = renderer.render(&kept, &Camera::fit(&kept), 40, 30).unwrap();
    let hash = folder.stdout("render a.vxg --size 40x30 --hash");
    assert_eq!(picture.hash().unwrap(), hash.trim_end());
    kept.with_up(Up::Z).save_vxg(folder.at("z.vxg")).unwrap();
    assert_eq!(Scene::open(folder.at("z.vxg")).unwrap().up(), Up::Z);

    // Its distance, in hundredths: by the vertices, by the stored hull, by the box. `spec/mesh.md`, "Fitted camera".
    let (mesh, _) = read_mesh(&knot, &LoadOptions::default(), &Silent).unwrap();
    let of_box = Bounds::of_box(mesh.bounds().0, mesh.bounds().1);
    let hull = mesh
        .positions()
        .iter()
        .map(|p| DVec3::from_array(*p))
        .collect();
    let of_vertices = Bounds {
        hull,
        ..of_box.clone()
    };
    let of_mesh = Bounds::of_mesh(&mesh_box(&mesh, true));
    let distances = [of_vertices, of_mesh, of_box].map(|bounds| {
        let camera = fit_camera(
            &bounds,
            Up::Y,
            Direction::CORNER,
            DEFAULT_FOV,
            1.0,
            (512, 512),
        );
        (camera.eye.distance(camera.target) * 100.0).round()
    });
    assert_eq!(distances, [1092.0, 1199.0, 1457.0]);
}
