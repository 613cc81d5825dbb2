//! The models of the shared data: counts, times and memory.

use std::time::Instant;

use shiftvox::graph::Silent;
use shiftvox_mesh::LoadOptions;
use shiftvox_mesh::voxelize::{Grid, voxelize};

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
#[ignore = "needs the folder SHIFTVOX_DATA"]
fn models_have_their_triangles_and_voxels() {
    eprintln!("model                  triangles  load ms  mesh MB   depth 8 voxels  touches    ms");
    for (name, in_file, drawn, voxels) in MODELS {
        let path = model(name);
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
