//! The models of the shared data: triangles, voxels, and pictures against ray casting.

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::open::read_mesh;
use shiftvox_mesh::voxelize::{Grid, voxelize};
use shiftvox_mesh::{LoadOptions, Mesh};

use super::raster::{NEAR_PX, against_rays};
use super::shared::{looking, model};

fn read(name: &str) -> Mesh {
    let (mesh, y_up) = read_mesh(&model(name), &LoadOptions::default(), &Silent).unwrap();
    assert!(y_up);
    mesh
}

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
fn models_have_their_triangles_and_voxels() {
    for (name, in_file, drawn, voxels) in MODELS {
        let mesh = read(name);
        assert_eq!(mesh.triangles().len(), drawn, "{name}");
        let left_out = format!("{} of {in_file} ", in_file - drawn as u64);
        let is_reported = mesh.warnings().iter().any(|w| w.starts_with(&left_out));
        assert_eq!(is_reported, in_file > drawn as u64, "{name}");
        // All of them have materials that were found.
        assert!(mesh.material_of().iter().all(|&m| m > 0), "{name}");
        let grid = Grid::around(&mesh, 8).unwrap();
        let (mut low, mut high) = ([i32::MAX; 3], [i32::MIN; 3]);
        let mut extend = |voxel: shiftvox::graph::Voxel| {
            for k in 0..3 {
                low[k] = low[k].min(voxel.index[k]);
                high[k] = high[k].max(voxel.index[k]);
            }
        };
        let report = voxelize(&mesh, &grid, &mut extend, &Silent);
        assert_eq!(report.voxels, voxels, "{name}");
        assert_eq!((low, high.iter().max()), ([0; 3], Some(&255)), "{name}");
    }
}

#[test]
#[ignore = "needs the shared data"]
fn pictures_of_models_are_those_of_ray_casting() {
    for name in [
        "platform.obj",
        "tree_Oak_Large.obj",
        "kitchen.obj",
        "CG-57.obj",
    ] {
        let mesh = read(name);
        let (low, high) = mesh.bounds();
        let centre = (low + high) / 2.0;
        let eye = centre + DVec3::new(0.5, 0.4, 0.8) * (high - low).length();
        let view = looking(eye, centre, [240, 240], 240.0);
        assert_eq!(against_rays(&mesh, &view, NEAR_PX), 0, "{name}");
    }
}
