//! Models of the shared data: triangles, voxels, and pictures against ray casting.

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::LoadOptions;
use shiftvox_mesh::open::read_mesh;
use shiftvox_mesh::voxelize::{Grid, voxelize};

use super::raster::against_rays;
use super::shared::{looking, model};

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
#[ignore = "needs the shared data"]
fn models_have_their_triangles_voxels_and_pictures() {
    for (name, in_file, drawn, voxels) in MODELS {
        let options = LoadOptions::default();
        let (mesh, y_up) = read_mesh(&model(name), &options, &Silent).unwrap();
        assert!(y_up, "{name}");
        assert_eq!(mesh.triangles().len(), drawn, "{name}");
        let left_out = format!("{} of {in_file} ", in_file - drawn as u64);
        let is_reported = mesh.warnings().iter().any(|w| w.starts_with(&left_out));
        assert_eq!(is_reported, in_file > drawn as u64, "{name}");
        // Every triangle's material was found.
        assert!(mesh.material_of().iter().all(|&m| m > 0), "{name}");
        let grid = Grid::around(&mesh, 8).unwrap();
        let (mut low, mut high) = ([i32::MAX; 3], 0);
        let mut extend = |voxel: shiftvox::graph::Voxel| {
            low = [0, 1, 2].map(|k| low[k].min(voxel.index[k]));
            high = voxel.index.into_iter().fold(high, i32::max);
        };
        let report = voxelize(&mesh, &grid, &mut extend, &Silent);
        assert_eq!(report.voxels, voxels, "{name}");
        assert_eq!((low, high), ([0; 3], 255), "{name}");
        let (low, high) = mesh.bounds();
        let centre = (low + high) / 2.0;
        let eye = centre + DVec3::new(0.5, 0.4, 0.8) * (high - low).length();
        let view = looking(eye, centre, [240, 240], 240.0);
        assert_eq!(against_rays(&mesh, &view), 0, "{name}");
    }
}
