//! Depths, normals and voxel indices as NumPy arrays.

use shiftvox::{Buffer, Camera, Renderer, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::generate("terrain,depth=7,seed=1")?;
    let camera = Camera::fit(&scene).azimuth(20.0).elevation(40.0);
    let picture = Renderer::new()
        .buffers([Buffer::Depth, Buffer::Normal, Buffer::Voxel])
        .render(&scene, &camera, 320, 200)?;
    for (buffer, name) in [
        (Buffer::Depth, "depth.npy"),
        (Buffer::Normal, "normal.npy"),
        (Buffer::Voxel, "voxel.npy"),
    ] {
        picture.save_npy(buffer, name)?;
    }
    let seen = picture.depth()?.iter().filter(|depth| depth.is_finite());
    println!("python3 -c 'import numpy; print(numpy.load(\"depth.npy\").shape)'");
    println!("{} of {} pixels show a voxel", seen.count(), 320 * 200);
    Ok(())
}
