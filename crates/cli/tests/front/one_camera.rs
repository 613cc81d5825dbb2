//! A mesh, and all that is made of it, is seen from one place.

use std::path::Path;

use shiftvox::project::Up;
use shiftvox::{Camera, Renderer, Scene};
use shiftvox_mesh::SceneOptions;

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
}
