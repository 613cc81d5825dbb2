//! The models of the shared data: counts, times and memory.

use std::time::Instant;

use glam::{DAffine3, DVec3};
use shiftvox::graph::Silent;
use shiftvox_mesh::voxelize::{Grid, voxelize};
use shiftvox_mesh::{Instances, LoadOptions, Surface};

use super::shapes::model;

/// File, triangles in it, triangles that can be drawn, voxels at depth 8.
const MODELS: [(&str, u64, usize, u64); 6] = [
    ("platform.obj", 1_996, 1_996, 87_647),
    ("tree_Pine_Large.obj", 19_392, 19_384, 304_203),
    ("tree_Oak_Large.obj", 22_566, 22_566, 672_608),
    ("as_AC14-FZK-Haus.obj", 35_906, 35_902, 430_618),
    ("kitchen.obj", 56_939, 56_913, 533_094),
    ("CG-57.obj", 180_063, 180_021, 42_507),
];

#[test]
fn models_have_their_triangles_and_voxels() {
    eprintln!("model                  triangles  load ms  mesh MB   depth 8 voxels  touches    ms");
    for (name, in_file, drawn, voxels) in MODELS {
        let Some(path) = model(name) else { continue };
        let started = Instant::now();
        let (mesh, y_up) =
            shiftvox_mesh::open::read_mesh(&path, &LoadOptions::default(), &Silent).unwrap();
        let load_ms = started.elapsed().as_secs_f64() * 1e3;
        assert!(y_up);
        assert_eq!(mesh.triangles().len(), drawn, "{name}");
        let left_out = in_file - drawn as u64;
        let is_reported = mesh
            .warnings()
            .iter()
            .any(|w| w.starts_with(&format!("{left_out} of {in_file} ")));
        assert_eq!(is_reported, left_out > 0, "{name}: {:?}", mesh.warnings());
        // All of them have materials that were found.
        assert!(mesh.material_of().iter().all(|&m| m > 0), "{name}");
        let grid = Grid::around(&mesh, 8).unwrap();
        let started = Instant::now();
        let mut low = [i32::MAX; 3];
        let mut high = [i32::MIN; 3];
        let report = voxelize(
            &mesh,
            &grid,
            &mut |voxel| {
                for k in 0..3 {
                    low[k] = low[k].min(voxel.index[k]);
                    high[k] = high[k].max(voxel.index[k]);
                }
            },
            &Silent,
        );
        eprintln!(
            "{name:<22} {drawn:>9} {load_ms:>8.1} {:>8.1} {:>16} {:>9} {:>6.0}",
            mesh.bytes() as f64 / 1e6,
            report.voxels,
            report.touches,
            started.elapsed().as_secs_f64() * 1e3
        );
        assert_eq!(report.voxels, voxels, "{name}");
        assert_eq!(low, [0; 3], "{name}");
        assert_eq!(high.iter().max(), Some(&255), "{name}");
    }
}

/// A fleet of 165 ships, 29.7 million triangles: `-- --ignored fleet --nocapture`.
#[test]
#[ignore = "long: thirty million triangles, three depths"]
fn a_fleet_is_voxelised_in_bounded_memory() {
    let Some(path) = model("CG-57.obj") else {
        return;
    };
    let (mesh, _) =
        shiftvox_mesh::open::read_mesh(&path, &LoadOptions::default(), &Silent).unwrap();
    let places = (0..165)
        .map(|i| DVec3::new(f64::from(i % 11) * 200.0, 0.0, f64::from(i / 11) * 40.0))
        .map(DAffine3::from_translation)
        .collect();
    let fleet = Instances::new(mesh, places);
    for depth in [10, 11, 12] {
        let grid = Grid::around(&fleet, depth).unwrap();
        let started = Instant::now();
        let mut voxels = 0u64;
        let report = voxelize(&fleet, &grid, &mut |_| voxels += 1, &Silent);
        eprintln!(
            "{} triangles, depth {depth}: {voxels} voxels, {} touches, {:.1} s, peak {} MB",
            fleet.len(),
            report.touches,
            started.elapsed().as_secs_f64(),
            peak_mb()
        );
        assert!(voxels > 0);
    }
}

/// The most memory that the process had so far.
fn peak_mb() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    kib.unwrap_or(0) / 1024
}
