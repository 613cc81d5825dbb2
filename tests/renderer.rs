//! The renderer: settings, pictures of one that was used, threads, and stops.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use hwmodel::Overflow;
use hwmodel::cycles::Hardware;
use shiftvox::picture::Buffer;
use shiftvox::project::{CageKind, Coverage, EngineError, Stop};
use shiftvox::{Camera, EngineKind, Error, Renderer, Scene};

#[test]
fn settings_that_an_engine_does_not_have_are_rejected() {
    let scene = Scene::generate("menger,depth=2").expect("a scene");
    let (camera, new) = (Camera::fit(&scene), Renderer::new());
    let rays = new.clone().engine(EngineKind::Rays);
    let counting = new.clone().count_operations();
    let (zoomed, size) = ([0.0, -1.0, f64::NAN, f64::INFINITY], (8, 8));
    let zoomed = zoomed.map(|zoom| (new.clone(), camera.clone().zoom(zoom), size, "zoom"));
    let of = |renderer: Renderer, word| (renderer, camera.clone(), size, word);
    let too_large = |size| (new.clone(), camera.clone(), size, "too large");
    let others = [
        of(rays.clone().coverage(Coverage::Alpha), "exact"),
        of(rays.clone().coverage(Coverage::Any), "exact"),
        of(rays.clone().cage(CageKind::Corners), "cage"),
        of(rays.clone().overflow(Overflow::Wrap), "overflow"),
        of(rays.clone().tolerance(1.0), "tolerance"),
        of(new.clone().samples(3), "1, 2 or 4"),
        of(new.clone().threads(1025), "0 to 1024"),
        of(counting.clone().engine(EngineKind::Fast), "operations"),
        of(counting.clone().engine(EngineKind::Rays), "operations"),
        too_large((1 << 15, (1 << 12) + 1)),
        too_large((u32::MAX, u32::MAX)),
    ];
    for (renderer, camera, (width, height), word) in zoomed.into_iter().chain(others) {
        match renderer.render(&scene, &camera, width, height) {
            Err(Error::Setting(reason)) => assert!(reason.contains(word), "{reason}"),
            other => panic!("{word}: {other:?}"),
        }
    }
    for able in [&rays, &counting.engine(EngineKind::Machine)] {
        assert!(able.render(&scene, &camera, 8, 8).is_ok());
    }
    let drawn = new.render_into(&scene, &camera, 2, 2, &mut [[0; 4]; 5]);
    assert!(matches!(drawn, Err(Error::Setting(_))), "{drawn:?}");
    let hardware = Hardware::preset("light").expect("a preset");
    let simulated = |renderer: &Renderer| renderer.simulate(&scene, &camera, 8, 8, &hardware);
    assert!(matches!(simulated(&rays), Err(Error::Setting(_))));
    assert!(simulated(&new).is_ok());
}

/// Memory of earlier pictures, of other scenes, sizes, rules and buffers, changes no later one.
#[test]
fn a_renderer_that_was_used_draws_as_a_new_one() {
    let scenes = ["menger,depth=2", "sierpinski,depth=30", "terrain,depth=5"];
    let scenes = scenes.map(|scene| Scene::generate(scene).expect("a scene"));
    let mut used = Renderer::new();
    for round in 0..7 {
        used = used
            .coverage([Coverage::Exact, Coverage::Center, Coverage::Alpha][round % 3])
            .buffers(
                [Buffer::Depth, Buffer::Normal, Buffer::Voxel, Buffer::Node]
                    .into_iter()
                    .take(round % 5),
            )
            .hashed(round % 3 == 1)
            .samples([1, 2, 4][round % 3])
            .threads(round / 3);
        for (scene, (width, height)) in scenes.iter().flat_map(|scene| {
            let sizes = [(24, 18), (12, 15), (12, 15), (1, 1)];
            sizes.map(|size| (scene, size))
        }) {
            let camera = Camera::fit(scene).azimuth(f64::from(width));
            let [again, new] = [&used, &used.clone()].map(|renderer| {
                let drawn = renderer.render(scene, &camera, width, height);
                drawn.expect("a picture")
            });
            assert_eq!(again.rgba(), new.rgba());
            assert_eq!(again.counters(), new.counters());
            assert_eq!(again.hash().ok(), new.hash().ok());
            assert_eq!(again.depth().ok(), new.depth().ok());
            assert_eq!(again.normals().ok(), new.normals().ok());
            assert_eq!(again.voxels().ok(), new.voxels().ok());
            assert_eq!(again.nodes().ok(), new.nodes().ok());
            if round % 5 == 0 && round % 3 != 1 {
                let mut pixels = vec![[0; 4]; (width * height) as usize];
                let counted = used.render_into(scene, &camera, width, height, &mut pixels);
                assert_eq!(counted.expect("a picture"), again.counters());
                assert_eq!(pixels, again.rgba());
            }
        }
    }
}

#[test]
fn threads_may_share_a_renderer() {
    let scene = Scene::generate("menger,depth=2").expect("a scene");
    let (camera, renderer) = (Camera::fit(&scene), Renderer::new().threads(2));
    let draw = || renderer.render(&scene, &camera, 64, 64).expect("a picture");
    let alone = draw();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert_eq!(draw().rgba(), alone.rgba()));
        }
    });
}

/// A drawing ends at the question that is answered with yes, and the next one is drawn again from the beginning.
#[test]
fn every_engine_stops_in_the_middle() {
    let scene = Scene::generate("menger,depth=3").unwrap();
    let camera = Camera::fit(&scene);
    // The fast engine asks before each band, of which there may be one.
    for (engine, coverage, at) in [
        (EngineKind::Fast, Coverage::Exact, 0),
        (EngineKind::Fast, Coverage::Any, 1),
        (EngineKind::Machine, Coverage::Exact, 1),
        (EngineKind::Rays, Coverage::Exact, 1),
    ] {
        let questions = Arc::new(AtomicU32::new(0));
        let asked = Arc::clone(&questions);
        let stop = Stop::when(move || asked.fetch_add(1, Relaxed) == at);
        let renderer = Renderer::new()
            .engine(engine)
            .coverage(coverage)
            .hashed(true);
        let whole = renderer.render(&scene, &camera, 200, 200).unwrap();
        let renderer = renderer.stopped_by(&stop);
        let stopped = renderer.render(&scene, &camera, 200, 200);
        let is_stopped = matches!(stopped, Err(Error::Engine(EngineError::Stopped)));
        assert!(is_stopped, "{engine:?}, {coverage:?}");
        let again = renderer.render(&scene, &camera, 200, 200).unwrap();
        assert_eq!(again.hash().unwrap(), whole.hash().unwrap());
        assert!(questions.load(Relaxed) > at + 1);
    }
}
