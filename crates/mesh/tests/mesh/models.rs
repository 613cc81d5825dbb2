//! Models of the shared data: triangles, voxels, and pictures against ray casting.

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::LoadOptions;
use shiftvox_mesh::open::read_mesh;

use super::raster::against_rays;
use super::shared::{looking, model};
use super::voxels::voxels;

/// File, triangles in it, triangles that can be drawn, voxels at depth 8.
const MODELS: [(&str, usize, usize, usize); 6] = [
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
    for (name, in_file, drawn, count) in MODELS {
        let (mesh, y_up) = read_mesh(&model(name), &LoadOptions::default(), &Silent).unwrap();
        assert!(y_up, "{name}");
        assert_eq!(mesh.triangles().len(), drawn, "{name}");
        let left_out = format!("{} of {in_file} ", in_file - drawn);
        let is_reported = mesh.warnings().iter().any(|w| w.starts_with(&left_out));
        assert_eq!(is_reported, in_file > drawn, "{name}");
        // Every triangle's material was found.
        assert!(mesh.material_of().iter().all(|&m| m > 0), "{name}");
        let voxels = voxels(&mesh, 8);
        assert_eq!(voxels.len(), count, "{name}");
        let coordinates = voxels.iter().flat_map(|voxel| voxel.index);
        assert_eq!(coordinates.max(), Some(255), "{name}");
        let (low, high) = mesh.bounds();
        let centre = (low + high) / 2.0;
        let eye = centre + DVec3::new(0.5, 0.4, 0.8) * (high - low).length();
        let view = looking(eye, centre, [60, 60], 60.0);
        assert_eq!(against_rays(&mesh, &view), 0, "{name}");
    }
}
