//! The fast engine, the machine without multiplication and the exact oracle draw the same picture.

use std::time::Instant;

use shiftvox::{Camera, Coverage, EngineKind, Renderer, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::generate("menger,depth=3")?;
    let camera = Camera::fit(&scene);
    let mut hashes = Vec::new();
    for engine in [EngineKind::Fast, EngineKind::Machine, EngineKind::Rays] {
        let started = Instant::now();
        let picture = Renderer::new()
            .engine(engine)
            .hashed(true)
            .render(&scene, &camera, 256, 256)?;
        println!("{engine:?}: {} in {:?}", picture.hash()?, started.elapsed());
        hashes.push(picture.hash()?.to_owned());
    }
    assert!(hashes.iter().all(|hash| *hash == hashes[0]));
    // Coverage `any` draws every sample that a voxel's box overlaps, which gives another picture.
    let any = Renderer::new().coverage(Coverage::Any).hashed(true);
    assert_ne!(any.render(&scene, &camera, 256, 256)?.hash()?, hashes[0]);
    Ok(())
}
