//! Cost of a picture on the machine: operations by class and stage, records by level, and energy.

use hwmodel::cost::{CostTable, energy_of};
use shiftvox::{Camera, Renderer, Scene, hwmodel};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::generate("terrain,depth=7,seed=1")?;
    let renderer = Renderer::new().word(32, None).count_operations();
    let picture = renderer.render(&scene, &Camera::fit(&scene), 256, 256)?;
    let counter = picture.operations().ok_or("nothing was counted")?;
    for (class, count) in counter.sum_by(|cell| cell.class) {
        println!("{class:?}: {count}");
    }
    for (stage, count) in counter.sum_by(|cell| cell.stage) {
        println!("{stage:?}: {count}");
    }
    for (level, records) in counter.records_by_level() {
        println!("octree level {level}: {records} records");
    }
    let energy = energy_of(counter, &CostTable::load_shipped()?)?;
    println!(
        "{} operations, {:.1} uJ in adders and logic",
        counter.ops(),
        energy.total / 1e6
    );
    Ok(())
}
