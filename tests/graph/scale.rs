//! Memory of generated scenes: bytes a voxel of the graph, and the peak while building.
//!
//! `cargo test --release --test graph scale -- --ignored --nocapture` builds the largest terrain
//! and prints its peak (Linux only: resident memory is read from `/proc/self/status`).
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

use std::sync::Mutex;
use std::time::Instant;

use shiftvox::graph::{
    BuildOptions, Builder, ExternalBuilder, ExternalOptions, Graph, MergeBy, Progress, Silent,
    merge,
};
use shiftvox::scene::generate::Spec;

/// A builder that holds a scene's voxels, pushed one by one as an importer would.
fn pushed(spec: &str) -> Builder {
    let spec = Spec::parse(spec).unwrap();
    let mut builder = Builder::new(BuildOptions::default());
    spec.voxels(&mut |voxel| builder.push(voxel), &Silent);
    builder
}

fn build(spec: &str) -> Graph {
    pushed(spec).finish(([0.0; 3], 1.0), &Silent).unwrap()
}

/// A memory figure of this process in bytes, where the system reports it.
fn memory_of_process(field: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with(field))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes * 1024)
}

/// Bytes a voxel that each scene may take: surfaces and solids at most ten,
/// loose voxels and thin bars more, because nearly every voxel there has inner
/// nodes of its own.
const SCENES: [(&str, f64); 10] = [
    ("gen:terrain,depth=10", 9.2),
    ("gen:menger,depth=5", 7.8),
    ("gen:shell", 8.4),
    ("gen:sphere", 6.6),
    ("gen:maze", 8.0),
    ("gen:checker", 7.9),
    ("gen:sierpinski,depth=10", 8.4),
    ("gen:random", 14.0),
    ("gen:truss", 13.8),
    ("gen:wires", 16.0),
];

/// `cargo test --release --test graph scale bytes -- --nocapture` prints the table of `spec/graph.md`.
#[test]
fn bytes_a_voxel_of_each_generator() {
    for (spec, limit) in SCENES {
        let graph = build(spec);
        let bytes = graph.bytes() as f64 / graph.voxels as f64;
        let inner = graph.mask.len() as f64 / graph.voxels as f64;
        eprintln!(
            "{spec}: {} voxels, {inner:.3} inner nodes and {bytes:.2} bytes a voxel",
            graph.voxels
        );
        assert!(bytes <= limit, "{spec}: {bytes:.3} bytes a voxel");
    }
}

/// Large enough that pushed voxels are held in more than one piece.
#[test]
fn four_million_voxels_give_one_graph_whatever_the_threads_and_room() {
    let spec = "gen:terrain,depth=10";
    let grown = {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3);
        pool.build().unwrap().install(|| build(spec))
    };
    let mut reserved = Builder::new(BuildOptions::default());
    reserved.reserve(grown.voxels as usize);
    let spec = Spec::parse(spec).unwrap();
    spec.voxels(&mut |voxel| reserved.push(voxel), &Silent);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    let reserved = pool
        .build()
        .unwrap()
        .install(|| reserved.finish(([0.0; 3], 1.0), &Silent).unwrap());
    assert_eq!(grown.level_start, reserved.level_start);
    assert!(*grown.mask == *reserved.mask && *grown.first == *reserved.first);
    assert!(*grown.color == *reserved.color && *grown.normal == *reserved.normal);
}

/// Prints the time that each piece of work takes, and the peak of memory at its end.
struct Stopwatch(Mutex<Option<(String, Instant)>>);

impl Progress for Stopwatch {
    fn begin(&self, what: &str, _steps: u64) {
        *self.0.lock().unwrap() = Some((what.to_owned(), Instant::now()));
    }

    fn advance(&self, _steps: u64) {}

    fn end(&self) {
        if let Some((what, start)) = self.0.lock().unwrap().take() {
            let seconds = start.elapsed().as_secs_f64();
            let now = memory_of_process("VmRSS:");
            let peak = memory_of_process("VmHWM:");
            eprintln!("{what}: {seconds:.2} s, then {now:?} bytes resident, peak {peak:?}");
        }
    }
}

#[test]
#[ignore = "takes a minute and 2 GB; its peak is that of the process, so it must run alone"]
fn sixty_million_voxels_stay_within_their_memory() {
    let start = Instant::now();
    let builder = pushed("gen:terrain,depth=12");
    let voxels = builder.len();
    let peak_while_pushing = memory_of_process("VmHWM:");
    eprintln!(
        "{voxels} voxels pushed in {:.1} s, peak {peak_while_pushing:?} bytes",
        start.elapsed().as_secs_f64()
    );
    let start = Instant::now();
    let graph = builder
        .finish(([0.0; 3], 1.0), &Stopwatch(Mutex::new(None)))
        .unwrap();
    eprintln!("built in {:.1} s", start.elapsed().as_secs_f64());
    assert_eq!(graph.voxels, voxels);
    let bytes = graph.bytes();
    eprintln!("{bytes} bytes, {:.2} a voxel", bytes as f64 / voxels as f64);
    let Some(peak) = memory_of_process("VmHWM:") else {
        eprintln!("skipped: this system does not report the peak of memory");
        return;
    };
    eprintln!(
        "peak {peak} bytes, {:.2} a voxel",
        peak as f64 / voxels as f64
    );
    // The voxels pushed, the graph, a piece of pushed voxels, and the program itself.
    assert!(peak <= 20 * voxels + bytes + (64 << 20));
}

/// Builds within 256 MB, beside the default folder for temporary files; the
/// peak is that of the process, so it must run alone.
#[test]
#[ignore = "takes half a minute and 2 GB of disk"]
fn a_scene_larger_than_its_memory_stays_within_it() {
    let spec = std::env::var("SHIFTVOX_SPEC").unwrap_or("gen:terrain,depth=12".to_owned());
    let spec = Spec::parse(&spec).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let memory = 256 << 20;
    let mut builder = ExternalBuilder::new(ExternalOptions {
        build: BuildOptions::default(),
        memory,
        temporary: folder.path().to_owned(),
    });
    let start = Instant::now();
    spec.voxels(&mut |voxel| builder.push(voxel), &Silent);
    eprintln!("pushed in {:.1} s", start.elapsed().as_secs_f64());
    let path = folder.path().join("out.vxg");
    let watch = Stopwatch(Mutex::new(None));
    let report = builder
        .finish(([0.0; 3], 1.0), &path, false, &watch)
        .unwrap();
    let voxels = report.voxels as f64;
    eprintln!(
        "{report:?}\n{:.1} s, {:.2} bytes a voxel, {:.2} temporary",
        start.elapsed().as_secs_f64(),
        report.bytes as f64 / voxels,
        report.temporary_bytes as f64 / voxels
    );
    let Some(peak) = memory_of_process("VmHWM:") else {
        eprintln!("skipped: this system does not report the peak of memory");
        return;
    };
    assert!(peak <= memory, "{peak} bytes");
}

/// What merging equal subtrees saves, shape and attributes apart.
#[test]
#[ignore = "takes a minute and 3 GB"]
fn what_merging_saves_on_large_terrain() {
    for depth in [10, 11] {
        let graph = build(&format!("gen:terrain,depth={depth}"));
        let shape_bits = |graph: &Graph| {
            let bytes = graph.mask.len() + 4 * (graph.first.len() + graph.links.len());
            8.0 * bytes as f64 / graph.voxels as f64
        };
        eprintln!(
            "depth {depth}: {} voxels, a tree of {} nodes: {:.3} bits a voxel of shape, {:.2} bytes in all",
            graph.voxels,
            graph.len(),
            shape_bits(&graph),
            graph.bytes() as f64 / graph.voxels as f64
        );
        for by in [MergeBy::Shape, MergeBy::ShapeAndAttributes] {
            let (merged, report) = merge(&graph, by, &Silent);
            eprintln!(
                "  {by:?}: {} nodes, gain {:.2}; {:.3} bits a voxel of shape, {:.2} bytes in all",
                merged.len(),
                report.gain(),
                shape_bits(&merged),
                merged.bytes() as f64 / merged.voxels as f64
            );
            assert_eq!(merged.voxels, graph.voxels);
        }
    }
}
