//! A property test on random scenes: nodes visited later never occlude earlier ones.
//!
//! The machine visits nodes in the order of `OCCLUSION_ORDER`, xor the octant of the eye, and draws each sample once. So
//! its picture shows the nearest voxels only if the order is right. The oracle casts an exact ray per sample, without an
//! order, and must show the same voxels.

use shiftvox::{Buffer, Camera, EngineKind, OCCLUSION_ORDER, Renderer, Scene, Voxel};

/// A linear congruential generator.
struct Dice(u64);

impl Dice {
    fn below(&mut self, end: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 33) % end
    }

    fn near(&mut self, middle: f64, range: u64) -> f64 {
        middle + self.below(2 * range) as f64 - range as f64 + 0.37
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut dice = Dice(1);
    let voxels = Renderer::new().buffers([Buffer::Voxel]);
    let machine = voxels.clone().engine(EngineKind::Machine);
    let oracle = voxels.engine(EngineKind::Rays);
    let mut seen = 0;
    for _ in 0..60 {
        let voxel = |dice: &mut Dice| Voxel {
            index: [0; 3].map(|_: i32| dice.below(16) as i32),
            color: [0; 3].map(|_: u8| dice.below(256) as u8),
            normal: None,
        };
        let count = 1 + dice.below(400);
        let scene = Scene::from_voxels((0..count).map(|_| voxel(&mut dice)))?;
        // Eyes around and within the scene, in all octants of its nodes.
        let eye = [0; 3].map(|_: i32| dice.near(8.0, 24));
        let camera = Camera::look_at(eye, [0; 3].map(|_: i32| dice.near(8.0, 6)));
        let drawn = machine.render(&scene, &camera.clone().field_of_view(70.0), 48, 48)?;
        let exact = oracle.render(&scene, &camera.field_of_view(70.0), 48, 48)?;
        assert_eq!(
            drawn.voxels()?,
            exact.voxels()?,
            "a hidden voxel was drawn first"
        );
        seen += exact.voxels()?.iter().filter(|voxel| voxel[3] >= 0).count();
    }
    println!("{OCCLUSION_ORDER:?}: {seen} samples of 60 scenes, none out of order");
    Ok(())
}
