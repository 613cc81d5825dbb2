//! Time per frame of the scalar machine, by picture size, with and without counting. Whole frames: `docs/benchmarks.md`.
//!
//! ```text
//! cargo bench --bench machine
//! ```
//!
//! Times are CPU times of the drawing thread where the system reports them, otherwise wall times.
#![allow(missing_docs, reason = "the functions that criterion makes")]

#[path = "../tests/machine/scenes/mod.rs"]
mod scenes;

use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

use criterion::{
    BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main,
};
use glam::DVec3;
use hwmodel::count::Counter;
use hwmodel::{NoProbe, Probe};
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::project::{CageKind, Camera, Coverage, FrameSetup, SetupOptions};

use scenes::{cube, graph_of_file, graph_of_spec, shared_data};

const SIZES: [u32; 5] = [64, 128, 256, 512, 1024];

/// A scene and its camera, as fractions of its cube's side.
struct Subject {
    name: &'static str,
    graph: Graph,
    eye: [f64; 3],
    target: [f64; 3],
}

/// The cameras of terrain and sponge are those of the benchmark scenes.
fn subjects() -> Vec<Subject> {
    let (name, file) = shared_data()
        .map(|data| ("tree.vox", data.join("vox/tree.vox")))
        .filter(|(_, file)| file.exists())
        .unwrap_or_else(|| {
            let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
            ("extended.vox", data.join("extended.vox"))
        });
    vec![
        Subject {
            name: "terrain-9",
            graph: graph_of_spec("gen:terrain,depth=9"),
            eye: [1.6, -0.7, 1.25],
            target: [0.5, 0.5, 0.3],
        },
        Subject {
            name: "menger-4",
            graph: graph_of_spec("gen:menger,depth=4"),
            eye: [0.47, -0.95, 0.53],
            target: [0.475, 0.5, 0.475],
        },
        Subject {
            name,
            graph: graph_of_file(&file).expect("a scene"),
            eye: [1.1, -0.5, 0.8],
            target: [0.5, 0.5, 0.4],
        },
    ]
}

fn set_up(subject: &Subject, size: u32, options: &SetupOptions) -> FrameSetup {
    let (low, side) = cube(&subject.graph);
    let camera = Camera {
        eye: low + DVec3::from_array(subject.eye) * side,
        target: low + DVec3::from_array(subject.target) * side,
        up: DVec3::Z,
        fov_degrees: 60.0,
        width: size,
        height: size,
    };
    let graph = &subject.graph;
    FrameSetup::new(&camera, &graph.placement, graph.depth, options).expect("a frame")
}

fn paper() -> SetupOptions {
    SetupOptions {
        cage: CageKind::Corners,
        tolerance_px: f64::INFINITY,
        coverage: Coverage::Any,
        ..SetupOptions::of(Coverage::Any)
    }
}

fn time(frames: u64, mut draw: impl FnMut()) -> Duration {
    let started = Instant::now();
    for _ in 0..frames {
        draw();
    }
    started.elapsed()
}

/// One frame: clear and traverse.
fn draw<P: Probe>(
    machine: &mut Machine,
    subject: &Subject,
    setup: &FrameSetup,
    frame: &mut Frame,
    probe: P,
) -> P {
    let view = subject.graph.view();
    let drawn = machine.render_probed(black_box(&view), setup, frame, probe);
    drawn.expect("no overflow in 64 bits").1
}

fn by_size(criterion: &mut Criterion) {
    for subject in subjects() {
        for (settings, options) in [("default", SetupOptions::default()), ("paper", paper())] {
            let mut group = criterion.benchmark_group(format!("{}/{settings}", subject.name));
            group
                .sample_size(10)
                .sampling_mode(SamplingMode::Flat)
                .warm_up_time(Duration::from_millis(300))
                .measurement_time(Duration::from_secs(2));
            for size in SIZES {
                let setup = set_up(&subject, size, &options);
                let mut frame = Frame::new(size, size, false);
                let mut machine = Machine::default();
                group.throughput(Throughput::Elements(u64::from(size) * u64::from(size)));
                group.bench_function(BenchmarkId::from_parameter(size), |bencher| {
                    bencher.iter_custom(|frames| {
                        time(frames, || {
                            draw(&mut machine, &subject, &setup, &mut frame, NoProbe);
                        })
                    });
                });
            }
        }
    }
}

fn probes(criterion: &mut Criterion) {
    let subject = &subjects()[1];
    let setup = set_up(subject, 256, &SetupOptions::default());
    let mut frame = Frame::new(256, 256, false);
    let mut machine = Machine::default();
    let mut group = criterion.benchmark_group("probe");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    group.bench_function("none", |bencher| {
        bencher.iter_custom(|frames| {
            time(frames, || {
                draw(&mut machine, subject, &setup, &mut frame, NoProbe);
            })
        });
    });
    group.bench_function("counter", |bencher| {
        bencher.iter_custom(|frames| {
            time(frames, || {
                let counter = draw(&mut machine, subject, &setup, &mut frame, Counter::new());
                black_box(counter.ops());
            })
        });
    });
    group.finish();
}

/// Records per second under the image-order paper's rule, without and with counting: 512 x 512 for times, 128 x 128 for
/// instruction counts.
fn records(criterion: &mut Criterion) {
    for subject in &subjects()[..2] {
        for size in [128, 512] {
            let setup = set_up(subject, size, &paper());
            let mut frame = Frame::new(size, size, false);
            let mut machine = Machine::default();
            let mut group = criterion.benchmark_group(format!("records/{}/{size}", subject.name));
            group
                .sample_size(10)
                .sampling_mode(SamplingMode::Flat)
                .throughput(Throughput::Elements(records_of(subject, &setup)))
                .warm_up_time(Duration::from_millis(300))
                .measurement_time(Duration::from_secs(2));
            group.bench_function("alone", |bencher| {
                bencher.iter_custom(|frames| {
                    time(frames, || {
                        draw(&mut machine, subject, &setup, &mut frame, NoProbe);
                    })
                });
            });
            group.bench_function("counted", |bencher| {
                bencher.iter_custom(|frames| {
                    time(frames, || {
                        let counter =
                            draw(&mut machine, subject, &setup, &mut frame, Counter::new());
                        black_box(counter.ops());
                    })
                });
            });
            group.finish();
        }
    }
}

/// Records of a frame.
fn records_of(subject: &Subject, setup: &FrameSetup) -> u64 {
    let mut frame = Frame::new(setup.width, setup.height, false);
    let mut machine = Machine::default();
    let counter = draw(&mut machine, subject, setup, &mut frame, Counter::new());
    counter.records()
}

criterion_group!(benches, by_size, probes, records);
criterion_main!(benches);
