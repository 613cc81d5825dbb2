//! Memory of generated scenes: bytes per voxel of the graph, and the peak of a build out of core.

use shiftvox::graph::{BuildOptions, Builder, Graph, Silent};
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

/// `-- --nocapture` prints the table of `spec/graph.md`.
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

/// The peak is that of the process, so the test must run alone.
#[test]
#[cfg(target_os = "linux")]
#[ignore = "needs a process of its own, and 500 MB of disk"]
fn a_scene_larger_than_its_memory_stays_within_it() {
    use shiftvox::graph::{ExternalBuilder, ExternalOptions};
    let folder = tempfile::tempdir().unwrap();
    let memory = 100 << 20;
    let mut builder = ExternalBuilder::new(ExternalOptions {
        build: BuildOptions::default(),
        memory,
        temporary: folder.path().to_owned(),
    });
    let spec = Spec::parse("gen:terrain,depth=11").unwrap();
    spec.voxels(&mut |voxel| builder.push(voxel), &Silent);
    let path = folder.path().join("out.vxg");
    let report = builder.finish(([0.0; 3], 1.0), &path, false, &Silent);
    // Twelve bytes of each voxel alone are more.
    assert!(12 * report.unwrap().voxels > memory);
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kibibytes: u64 = peak
        .unwrap()
        .trim()
        .trim_end_matches(" kB")
        .parse()
        .unwrap();
    assert!(kibibytes << 10 <= memory, "{kibibytes} KiB");
}
