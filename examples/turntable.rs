//! Twelve pictures around an object, all from the same distance.

use shiftvox::{Camera, Renderer, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::from_bytes(include_bytes!("../assets/tree.vox"), "tree.vox")?;
    let camera = Camera::fit(&scene).for_turning().elevation(20.0);
    for step in 0..12 {
        let camera = camera.clone().azimuth(30.0 * f64::from(step));
        let picture = Renderer::new()
            .samples(2)
            .render(&scene, &camera, 200, 200)?;
        picture.save_png(format!("turn-{step:02}.png"))?;
    }
    println!("turn-00.png to turn-11.png");
    Ok(())
}
