//! Time per frame of the fast engine, by instruction set. Whole frames: `docs/performance.md`.
//!
//! ```text
//! cargo bench --bench fast
//! ```
#![allow(missing_docs, reason = "the functions that criterion makes")]

#[path = "../tests/machine/scenes/mod.rs"]
mod scenes;

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec3;
use shiftvox::drawing::{Drawable, GraphDrawing, GraphStyle};
use shiftvox::fast::{Fast, FastOptions, Instructions};
use shiftvox::frame::Frame;
use shiftvox::machine::Machine;
use shiftvox::project::{Camera, Engine, FrameSetup, SetupOptions};
use shiftvox::{Background, Renderer, Scene, Shading, View};

use scenes::graph_of_spec;

/// A generator, and eye and target as fractions of its side: benchmark scenes, large voxels, and a cyclic graph.
const SUBJECTS: [(&str, [f64; 3], [f64; 3]); 4] = [
    ("gen:terrain,depth=9", [1.6, -0.7, 1.25], [0.5, 0.5, 0.3]),
    (
        "gen:menger,depth=4",
        [0.47, -0.95, 0.53],
        [0.475, 0.5, 0.475],
    ),
    ("gen:sphere,depth=5", [1.1, -0.4, 0.8], [0.5, 0.5, 0.5]),
    (
        "gen:sierpinski,depth=12",
        [1.2, -0.9, 0.9],
        [0.45, 0.45, 0.4],
    ),
];

const SETS: [(&str, Instructions); 2] = [
    ("scalar", Instructions::Scalar),
    ("avx2", Instructions::Avx2),
];

fn frames(criterion: &mut Criterion) {
    for (spec, eye, target) in SUBJECTS {
        let graph = graph_of_spec(spec);
        let side = f64::from(1u32 << graph.depth);
        let camera = Camera {
            eye: DVec3::from_array(eye) * side,
            target: DVec3::from_array(target) * side,
            up: DVec3::Z,
            fov_degrees: 60.0,
            width: 1024,
            height: 1024,
        };
        let mut group = criterion.benchmark_group(spec);
        for lod_px in [0.0, 1.0] {
            let options = SetupOptions {
                lod_px,
                ..SetupOptions::default()
            };
            let setup =
                FrameSetup::new(&camera, &graph.placement, graph.depth, &options).expect("a frame");
            for (name, instructions) in SETS {
                if !instructions.are_available() {
                    continue;
                }
                let options = FastOptions {
                    threads: 1,
                    instructions,
                    ..FastOptions::default()
                };
                let mut fast = Fast::new(options, Box::new(Machine::default()));
                let mut frame = Frame::nodes_only(setup.width, setup.height);
                let id = BenchmarkId::new(name, format!("level of detail {lod_px}"));
                group.bench_function(id, |bencher| {
                    bencher.iter(|| {
                        fast.draw(&graph.view(), &setup, &mut frame)
                            .expect("a frame");
                        black_box(&frame.node);
                    });
                });
            }
        }
        group.finish();
    }
}

/// Small pictures in a loop: frames of `render --repeat`, one renderer, and a new renderer per picture.
fn small_pictures(criterion: &mut Criterion) {
    let scene = Scene::from(graph_of_spec("gen:menger,depth=4"));
    let camera = shiftvox::Camera::fit(&scene);
    for size in [64, 256] {
        let mut group = criterion.benchmark_group(format!("pictures of {size} x {size}"));
        let style = GraphStyle {
            options: SetupOptions::default(),
            shading: Shading::Flat,
            background: Background::default(),
            buffers: Vec::new(),
            is_hashed: false,
        };
        let options = FastOptions {
            threads: 1,
            ..FastOptions::default()
        };
        let engine = || -> Box<dyn Engine + Send> {
            Box::new(Fast::new(options, Box::new(Machine::default())))
        };
        let drawing = GraphDrawing::new(scene.graph(), scene.up(), style, engine);
        let placed = camera.of_size(size, size).expect("a camera");
        let mut frame = drawing.frames(&placed).expect("a frame");
        group.bench_function("--repeat", |bencher| {
            bencher.iter(|| frame().expect("a frame"));
        });
        let renderer = Renderer::new().shading(Shading::Flat).threads(1);
        let mut pixels = vec![[0; 4]; (size * size) as usize];
        group.bench_function("a renderer that is kept", |bencher| {
            bencher.iter(|| {
                renderer
                    .render_into(&scene, &camera, size, size, &mut pixels)
                    .expect("a picture")
            });
        });
        group.bench_function("a new renderer for each", |bencher| {
            bencher.iter(|| {
                let renderer = renderer.clone();
                renderer
                    .render(&scene, &camera, size, size)
                    .expect("a picture")
            });
        });
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    targets = frames, small_pictures
}
criterion_main!(benches);
