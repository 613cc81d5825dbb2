//! Voxels from a function of space: a hollow sphere, coloured by direction.

use shiftvox::{Camera, Renderer, Scene, Voxel};

/// The voxel at an index, if there is one.
fn voxel(index: [i32; 3]) -> Option<Voxel> {
    let squares: i32 = index.iter().map(|c| c * c).sum();
    let is_shell = (30 * 30..32 * 32).contains(&squares);
    let is_open = index[0] > 0 && index[1] < 0 && index[2] > 0;
    (is_shell && !is_open).then(|| Voxel {
        index,
        color: index.map(|c| (128 + 3 * c) as u8),
        normal: None,
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let side = || -32..=32;
    let indices = side().flat_map(|x| side().flat_map(move |y| side().map(move |z| [x, y, z])));
    let scene = Scene::from_voxels(indices.filter_map(voxel))?;
    let picture = Renderer::new().render(&scene, &Camera::fit(&scene), 256, 256)?;
    picture.save_png("sphere.png")?;
    scene.save_vxg("sphere.vxg")?;
    println!(
        "{} voxels, {} levels: sphere.png, sphere.vxg",
        scene.voxels(),
        scene.depth()
    );
    Ok(())
}
