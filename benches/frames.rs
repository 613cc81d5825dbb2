//! Time of a frame: of the fast engine by instruction set, of the machine, alone and counted, and of small pictures in a
//! loop. Whole pictures: `docs/performance.md`.
//!
//! ```text
//! cargo bench -p shiftvox-benches
//! ```
#![allow(missing_docs, reason = "the functions that criterion makes")]

use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use hwmodel::NoProbe;
use shiftvox::fast::{Fast, FastOptions, Instructions};
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::project::{Camera, Engine, FrameSetup, SetupOptions};
use shiftvox::{Renderer, Scene, Shading};

/// A generator, and eye and target as parts of its side: the cameras of the benchmark scenes, and a cyclic graph.
const SUBJECTS: [(&str, [[f64; 3]; 2]); 3] = [
    ("terrain,depth=9", [[1.6, -0.7, 1.25], [0.5, 0.5, 0.3]]),
    ("menger,depth=4", [[0.47, -0.95, 0.53], [0.475, 0.5, 0.475]]),
    ("sierpinski,depth=12", [[1.2, -0.9, 0.9], [0.45, 0.45, 0.4]]),
];

fn set_up(graph: &Graph, places: [[f64; 3]; 2], size: u32, options: &SetupOptions) -> FrameSetup {
    let side = f64::from(1u32 << graph.depth);
    let [eye, target] = places.map(|place| DVec3::from_array(place) * side);
    let camera = Camera::looking(eye, target, 60.0, (size, size));
    FrameSetup::new(&camera, &graph.placement, graph.depth, options).expect("a frame")
}

fn fast(criterion: &mut Criterion) {
    for (name, places) in SUBJECTS {
        let scene = Scene::generate(name).expect(name);
        let graph = scene.graph();
        let setup = set_up(graph, places, 1024, &SetupOptions::default());
        let mut group = criterion.benchmark_group(format!("fast/{name}"));
        for instructions in [Instructions::Scalar, Instructions::Auto] {
            let options = FastOptions {
                threads: 1,
                instructions,
                ..FastOptions::default()
            };
            let mut fast = Fast::new(options, Box::new(Machine::default()));
            let mut frame = Frame::nodes_only(setup.width, setup.height);
            group.bench_function(format!("{instructions:?}"), |bencher| {
                let mut draw = || fast.render(&graph.view(), &setup, &mut frame);
                bencher.iter(|| draw().expect("a frame"));
            });
        }
    }
}

fn machine(criterion: &mut Criterion) {
    let mut machine = Machine::default();
    for (name, places) in &SUBJECTS[..2] {
        let scene = Scene::generate(name).expect(name);
        let view = scene.graph().view();
        for (rule, options) in [
            ("exact", SetupOptions::default()),
            ("paper", SetupOptions::paper()),
        ] {
            let mut group = criterion.benchmark_group(format!("machine/{name}/{rule}"));
            for size in [128, 512] {
                let setup = set_up(scene.graph(), *places, size, &options);
                let mut frame = Frame::new(setup.width, setup.height, false);
                let drawn = machine.count(&view, &setup, &mut frame);
                let (_, counter) = drawn.expect("a frame");
                group.throughput(Throughput::Elements(counter.records()));
                group.bench_function(BenchmarkId::new("alone", size), |bencher| {
                    let mut draw = || machine.render_probed(&view, &setup, &mut frame, NoProbe);
                    bencher.iter(|| draw().expect("a frame"));
                });
                group.bench_function(BenchmarkId::new("counted", size), |bencher| {
                    let mut draw = || machine.count(&view, &setup, &mut frame);
                    bencher.iter(|| draw().expect("a frame"));
                });
            }
        }
    }
}

/// Small pictures in a loop: a renderer that is kept, and a new one for each.
fn small_pictures(criterion: &mut Criterion) {
    let scene = Scene::generate(SUBJECTS[1].0).expect("a scene");
    let camera = shiftvox::Camera::fit(&scene);
    let renderer = Renderer::new().shading(Shading::Flat).threads(1);
    for size in [64, 256] {
        let mut group = criterion.benchmark_group(format!("pictures of {size} x {size}"));
        let mut pixels = vec![[0; 4]; (size * size) as usize];
        group.bench_function("a renderer that is kept", |bencher| {
            let mut draw = || renderer.render_into(&scene, &camera, size, size, &mut pixels);
            bencher.iter(|| draw().expect("a picture"));
        });
        group.bench_function("a new renderer for each", |bencher| {
            let draw = || renderer.clone().render(&scene, &camera, size, size);
            bencher.iter(|| draw().expect("a picture"));
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    targets = fast, machine, small_pictures
}
criterion_main!(benches);
