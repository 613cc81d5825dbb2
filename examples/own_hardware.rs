//! Cycles of modified hardware: the shipped `paper` description with other numbers of lanes and contexts.

use hwmodel::cycles::Hardware;
use shiftvox::{Camera, Renderer, Scene, hwmodel};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::generate("menger,depth=3")?;
    let camera = Camera::fit(&scene);
    let renderer = Renderer::new().word(32, None);
    let mut last = u64::MAX;
    for lanes in [1, 2, 4] {
        let mut hardware = Hardware::preset("paper")?;
        hardware.lanes = lanes;
        hardware.contexts = 4;
        let simulated = renderer.simulate(&scene, &camera, 128, 128, &hardware)?;
        let cycles = simulated.cycles.cycles;
        let ms = cycles as f64 / (hardware.clock_mhz * 1e3);
        println!(
            "{lanes} lanes: {cycles} cycles, {ms:.2} ms at {} MHz",
            hardware.clock_mhz
        );
        assert!(cycles < last, "another lane makes it no faster");
        last = cycles;
    }
    Ok(())
}
