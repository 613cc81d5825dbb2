//! Time and memory of a surface of a million voxels; the time is printed, not judged.
//!
//! `cargo test --release --test graph speed -- --ignored --nocapture` takes the larger ones too.
#![allow(clippy::unwrap_used, reason = "the helpers of tests fail like tests")]

use std::time::Instant;

use shiftvox::graph::{BuildOptions, Builder, Graph, MergeBy, Normals, Silent, Voxel, merge};

/// A bumpy surface over a square, closed by steps, coloured by height.
fn surface(side: i32) -> Vec<Voxel> {
    let height = |x: i32, y: i32| {
        let wave = |t: i32| (t % 512 - 256).abs();
        (wave(x + y / 2) + wave(y * 2 - x / 3) / 2 + wave(x * 5) / 8) / 4
    };
    let mut voxels = Vec::new();
    for x in 0..side {
        for y in 0..side {
            let top = height(x, y);
            let low = height(x + 1, y).min(height(x, y + 1)).min(top - 1);
            for z in low + 1..=top {
                voxels.push(Voxel {
                    index: [x, y, z],
                    color: [z as u8, 128, (z / 4) as u8],
                    normal: None,
                });
            }
        }
    }
    voxels
}

fn timed<T>(what: &str, voxels: usize, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    let seconds = start.elapsed().as_secs_f64();
    eprintln!("{what}: {voxels} voxels, {seconds:.3} s");
    result
}

fn build(voxels: &[Voxel], normals: Normals) -> Graph {
    let mut builder = Builder::new(BuildOptions { normals });
    builder.reserve(voxels.len());
    builder.extend(voxels.iter().copied());
    builder.finish(([0.0; 3], 1.0), &Silent).unwrap()
}

/// Voxels of a ball that have an open face.
fn sphere(radius: i32) -> Vec<Voxel> {
    let inside = |x: i32, y: i32, z: i32| {
        let twice = |c: i32| i64::from(2 * c + 1).pow(2);
        twice(x) + twice(y) + twice(z) <= i64::from(2 * radius).pow(2)
    };
    let mut voxels = Vec::new();
    for i in 0..(2 * radius).pow(2) {
        let (x, y) = (i / (2 * radius) - radius, i % (2 * radius) - radius);
        let covered = |z: i32| {
            [
                (1, 0, 0),
                (-1, 0, 0),
                (0, 1, 0),
                (0, -1, 0),
                (0, 0, 1),
                (0, 0, -1),
            ]
            .iter()
            .all(|(dx, dy, dz)| inside(x + dx, y + dy, z + dz))
        };
        voxels.extend(
            (-radius..radius)
                .filter(|&z| inside(x, y, z) && !covered(z))
                .map(|z| Voxel {
                    index: [x, y, z],
                    color: [x as u8, y as u8, z as u8],
                    normal: None,
                }),
        );
    }
    voxels
}

#[test]
fn a_surface_takes_at_most_ten_bytes_a_voxel() {
    // Five bytes a voxel, 10 an inner node; a surface has 0.41 to 0.49 of those for each voxel.
    for (name, voxels, limit) in [("sphere", sphere(340), 9.9), ("steps", surface(1100), 9.4)] {
        assert!(voxels.len() > 1_000_000, "{}", voxels.len());
        let graph = timed(name, voxels.len(), || build(&voxels, Normals::FromSurface));
        graph.validate().unwrap();
        assert_eq!(graph.voxels, voxels.len() as u64);
        let bytes = graph.bytes() as f64 / graph.voxels as f64;
        eprintln!("{name}: {bytes:.2} bytes a voxel, {} nodes", graph.len());
        assert!(bytes <= limit, "{bytes}");
    }
}

#[test]
#[ignore = "takes some seconds and 300 MB"]
fn four_million_voxels() {
    let voxels = surface(1700);
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            eprintln!("{threads} threads");
            timed("without normals", voxels.len(), || {
                build(&voxels, Normals::None)
            });
            let graph = timed("with normals", voxels.len(), || {
                build(&voxels, Normals::FromSurface)
            });
            for by in [MergeBy::ShapeAndAttributes, MergeBy::Shape] {
                let (_, report) = timed("merge", voxels.len(), || merge(&graph, by, &Silent));
                eprintln!("{by:?}: gain {:.2}, {report:?}", report.gain());
            }
            timed("validate", voxels.len(), || graph.validate()).unwrap();
            let sum = timed("walk", voxels.len(), || {
                graph.voxels().map(|c| u64::from(c.node)).sum::<u64>()
            });
            std::hint::black_box(sum);
        });
    }
}
