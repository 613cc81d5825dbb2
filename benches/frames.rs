//! Time of a frame: of the fast engine by instruction set, of the machine by picture size, alone and counted, and of small
//! pictures in a loop. Whole pictures: `docs/performance.md`.
//!
//! ```text
//! cargo bench
//! ```
#![allow(missing_docs, reason = "the functions that criterion makes")]

#[path = "../tests/machine/scenes/mod.rs"]
mod scenes;

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use hwmodel::count::Counter;
use hwmodel::{NoProbe, Probe};
use shiftvox::fast::{Fast, FastOptions, Instructions};
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::project::{CageKind, Camera, Coverage, Engine, FrameSetup, SetupOptions};
use shiftvox::{Renderer, Scene, Shading};

use scenes::graph_of_spec;

/// A generator, and eye and target as parts of its side: the cameras of the benchmark scenes, large voxels, and a cyclic
/// graph.
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

fn set_up(
    graph: &Graph,
    (eye, target): ([f64; 3], [f64; 3]),
    size: u32,
    options: &SetupOptions,
) -> FrameSetup {
    let side = f64::from(1u32 << graph.depth);
    let camera = Camera {
        eye: DVec3::from_array(eye) * side,
        target: DVec3::from_array(target) * side,
        up: DVec3::Z,
        fov_degrees: 60.0,
        width: size,
        height: size,
    };
    FrameSetup::new(&camera, &graph.placement, graph.depth, options).expect("a frame")
}

fn fast(criterion: &mut Criterion) {
    for (spec, eye, target) in SUBJECTS {
        let graph = graph_of_spec(spec);
        let mut group = criterion.benchmark_group(format!("fast/{spec}"));
        for lod_px in [0.0, 1.0] {
            let options = SetupOptions {
                lod_px,
                ..SetupOptions::default()
            };
            let setup = set_up(&graph, (eye, target), 1024, &options);
            for instructions in [Instructions::Scalar, Instructions::Avx2] {
                let options = FastOptions {
                    threads: 1,
                    instructions,
                    ..FastOptions::default()
                };
                let mut fast = Fast::new(options, Box::new(Machine::default()));
                let mut frame = Frame::nodes_only(setup.width, setup.height);
                let id = BenchmarkId::new(
                    format!("{instructions:?}"),
                    format!("level of detail {lod_px}"),
                );
                group.bench_function(id, |bencher| {
                    bencher.iter(|| {
                        fast.draw(&graph.view(), &setup, &mut frame)
                            .expect("a frame")
                    });
                });
            }
        }
    }
}

fn machine(criterion: &mut Criterion) {
    fn draw<P: Probe>(machine: &mut Machine, graph: &Graph, setup: &FrameSetup, probe: P) -> P {
        let mut frame = Frame::new(setup.width, setup.height, false);
        let drawn = machine.render_probed(black_box(&graph.view()), setup, &mut frame, probe);
        drawn.expect("no overflow in 64 bits").1
    }
    let paper = SetupOptions {
        cage: CageKind::Corners,
        tolerance_px: f64::INFINITY,
        ..SetupOptions::of(Coverage::Any)
    };
    let mut machine = Machine::default();
    for (spec, eye, target) in &SUBJECTS[..2] {
        let graph = graph_of_spec(spec);
        for (rule, options) in [("exact", SetupOptions::default()), ("paper", paper)] {
            let mut group = criterion.benchmark_group(format!("machine/{spec}/{rule}"));
            for size in [128, 512] {
                let setup = set_up(&graph, (*eye, *target), size, &options);
                let records = draw(&mut machine, &graph, &setup, Counter::new()).records();
                group.throughput(Throughput::Elements(records));
                group.bench_function(BenchmarkId::new("alone", size), |bencher| {
                    bencher.iter(|| draw(&mut machine, &graph, &setup, NoProbe));
                });
                group.bench_function(BenchmarkId::new("counted", size), |bencher| {
                    bencher.iter(|| draw(&mut machine, &graph, &setup, Counter::new()).ops());
                });
            }
        }
    }
}

/// Small pictures in a loop: a renderer that is kept, and a new one for each.
fn small_pictures(criterion: &mut Criterion) {
    let scene = Scene::from(graph_of_spec("gen:menger,depth=4"));
    let camera = shiftvox::Camera::fit(&scene);
    let renderer = Renderer::new().shading(Shading::Flat).threads(1);
    for size in [64, 256] {
        let mut group = criterion.benchmark_group(format!("pictures of {size} x {size}"));
        let mut pixels = vec![[0; 4]; (size * size) as usize];
        group.bench_function("a renderer that is kept", |bencher| {
            bencher.iter(|| {
                let drawn = renderer.render_into(&scene, &camera, size, size, &mut pixels);
                drawn.expect("a picture")
            });
        });
        group.bench_function("a new renderer for each", |bencher| {
            bencher.iter(|| {
                let drawn = renderer.clone().render(&scene, &camera, size, size);
                drawn.expect("a picture")
            });
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
