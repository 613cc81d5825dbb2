//! Small scenes on all engines under all rules: seconds after a change (CONTRIBUTING.md).

use shiftvox::{Camera, Coverage, EngineKind, Renderer, Scene};

#[test]
fn engines_agree_on_small_scenes() {
    use Coverage::{Alpha, Any, Center, Exact};
    let all = [
        "menger,depth=2",
        "terrain,depth=5",
        "sierpinski,depth=9",
        "wires,depth=5",
    ];
    for scene in all.map(|scene| Scene::generate(scene).expect(scene)) {
        for (coverage, azimuth, size, samples, zoom) in [
            (Exact, 10.0, 96, 1, 1.0),
            (Exact, 200.0, 33, 2, 6.0),
            (Center, 45.0, 48, 1, 1.0),
            (Any, 300.0, 48, 2, 6.0),
            (Alpha, 100.0, 48, 1, 1.0),
        ] {
            let camera = Camera::fit(&scene).azimuth(azimuth).zoom(zoom);
            let hash = |engine| {
                let renderer = Renderer::new().engine(engine).coverage(coverage);
                let picture = renderer
                    .samples(samples)
                    .hashed(true)
                    .render(&scene, &camera, size, size);
                picture
                    .expect("a picture")
                    .hash()
                    .expect("a hash")
                    .to_owned()
            };
            let right = hash(EngineKind::Machine);
            assert_eq!(hash(EngineKind::Fast), right, "{coverage:?}");
            assert!(coverage != Exact || hash(EngineKind::Rays) == right);
        }
    }
}
