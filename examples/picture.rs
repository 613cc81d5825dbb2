//! A picture of a voxel file: `cargo run --release --example picture [SCENE [PICTURE.png]]`.

use shiftvox::{Camera, Renderer, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let scene = match arguments.next() {
        Some(path) => Scene::open(path)?,
        None => Scene::from_bytes(include_bytes!("../assets/tree.vox"), "tree.vox")?,
    };
    let output = arguments.next().unwrap_or_else(|| "picture.png".to_owned());
    let picture =
        Renderer::new()
            .samples(2)
            .hashed(true)
            .render(&scene, &Camera::fit(&scene), 512, 512)?;
    picture.save_png(&output)?;
    println!(
        "{output}: {} voxels, hash {}",
        scene.voxels(),
        picture.hash()?
    );
    Ok(())
}
