//! Memory of generated scenes: bytes per voxel of the graph, and the peak of a build out of core.

use shiftvox::graph::{ExternalBuilder, ExternalOptions, Silent};
use shiftvox::scene::generate::Spec;

use crate::{PLACE, build, generated};

/// Bytes per voxel that each scene may take: surfaces and solids at most ten, loose voxels and thin bars more, because
/// nearly every voxel there has inner nodes of its own.
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
fn bytes_per_voxel_of_each_generator() {
    for (spec, limit) in SCENES {
        let graph = build(&generated(spec));
        let [bytes, inner] =
            [graph.bytes(), graph.mask.len() as u64].map(|n| n as f64 / graph.voxels as f64);
        let voxels = graph.voxels;
        eprintln!("{spec}: {voxels} voxels, {inner:.3} inner nodes and {bytes:.2} bytes per voxel");
        assert!(bytes <= limit && bytes > 5.0, "{spec}: {bytes:.3}");
    }
}

/// The peak is that of the process, so the test must run alone.
#[test]
#[cfg(target_os = "linux")]
#[ignore = "needs a process of its own, and 500 MB of disk"]
fn a_scene_larger_than_its_memory_stays_within_it() {
    let folder = tempfile::tempdir().unwrap();
    let memory = 100 << 20;
    let mut builder = ExternalBuilder::new(ExternalOptions {
        memory,
        temporary: folder.path().to_owned(),
    });
    let spec = Spec::parse("gen:terrain,depth=11").unwrap();
    spec.voxels(&mut |voxel| builder.push(voxel), &Silent);
    let path = folder.path().join("out.vxg");
    let report = builder.finish(PLACE, &path, false, &Silent);
    // Twelve bytes of each voxel alone are more.
    assert!(12 * report.unwrap().voxels > memory);
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kibibytes = peak.unwrap().trim().trim_end_matches(" kB");
    assert!(
        kibibytes.parse::<u64>().unwrap() << 10 <= memory,
        "{kibibytes} KiB"
    );
}
