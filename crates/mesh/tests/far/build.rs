//! Building: threads, ray budgets, scales, refused options.

use glam::{DAffine3, DVec3};
use shiftvox::graph::Silent;
use shiftvox_mesh::far::record::Node;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::{FarViewer, ViewError, ViewOptions};
use shiftvox_mesh::far::{BuildError, BuildOptions, FarFile, build};
use shiftvox_mesh::generate::{Kind, generate};
use shiftvox_mesh::raster::RasterCamera;
use shiftvox_mesh::{Instances, Surface};

use super::city::{city, draw, far, file_of, lit, options, view};
use super::shared::{difference, on_any_threads};
use super::solid::hybrid;

#[test]
fn threads_never_change_files_and_pictures() {
    let view = view(35.0, 0.4, 90.0, 200);
    on_any_threads(|| {
        let bytes = encode(&far(false)).unwrap();
        let file = FarFile::from_bytes(&bytes).unwrap();
        (bytes, draw(&file, &view, &ViewOptions::default()))
    });
    on_any_threads(|| encode(&hybrid(&generate(Kind::Wheel, 3), 300)).unwrap());
}

#[test]
fn a_ray_budget_is_kept() {
    let [few, more, enough] = [20_000, 40_000, 4_000_000].map(|rays| {
        let rays = Some(rays);
        let data = build(&city(), &BuildOptions { rays, ..options() }, &Silent).unwrap();
        let sum = |of: fn(&Node) -> u64| -> u64 { data.nodes.iter().map(of).sum() };
        (
            sum(|n| n.rays.into()),
            sum(|n| n.untested.into()),
            sum(|n| n.touched.into()),
            sum(Node::voxels),
        )
    });
    assert!((19_000..=20_000).contains(&few.0) && (39_000..=40_000).contains(&more.0));
    // A voxel that no ray reached is kept and not regarded as hidden.
    assert!(few.1 > more.1 && more.1 > 0 && enough.1 == 0);
    assert!(few.2 == enough.2 && few.3 > enough.3, "{few:?} {enough:?}");
}

/// From 10^-12 to 10^12.
#[test]
fn a_mesh_scaled_by_a_power_of_two_has_the_same_picture() {
    let drawn = |scale: f64| {
        let place = DAffine3::from_scale(DVec3::splat(scale));
        let scaled = Instances::new(city(), vec![place]);
        let data = build(&scaled, &options(), &Silent).unwrap();
        let mut view = view(30.0, 0.6, 150.0, 192);
        view.eye *= scale;
        view.near *= scale;
        let picture = draw(&file_of(&data), &view, &lit(&view, 2.0)).0;
        (
            data.nodes.iter().map(Node::voxels).sum::<u64>(),
            picture.rgba,
        )
    };
    let usual = drawn(1.0);
    for scale in [-40, -17, 40].map(|power| 2f64.powi(power)) {
        let scaled = drawn(scale);
        assert_eq!(scaled.0, usual.0, "{scale}");
        // Rounding differs, and so some rays end elsewhere.
        let error = difference(&scaled.1, &usual.1, f64::from);
        assert!(error < 2.0, "{scale}: {error}");
    }
}

#[test]
fn invalid_options_are_refused() {
    let refused = |harm: fn(&mut BuildOptions), surface: &dyn Surface| {
        let mut options = options();
        harm(&mut options);
        build(surface, &options, &Silent).unwrap_err()
    };
    let faults: [fn(&mut BuildOptions); 4] = [
        |options| options.grid = 1,
        |options| options.grid = 256,
        |options| options.leaf_triangles = 1,
        |options| options.distance_voxels = f64::NAN,
    ];
    for (number, fault) in faults.into_iter().enumerate() {
        let error = refused(fault, &city());
        assert!(matches!(error, BuildError::Option(_)), "{number}: {error}");
    }
    let nothing = Instances::new(city(), Vec::new());
    assert_eq!(refused(|_| (), &nothing), BuildError::Empty);
    let file = file_of(&far(false));
    let drawn = |voxel_px: f64, samples_across: u32, width: u32| {
        let options = ViewOptions {
            voxel_px,
            samples_across,
            ..ViewOptions::default()
        };
        let view = RasterCamera {
            width,
            ..view(0.0, 0.5, 60.0, 8)
        };
        FarViewer::new(&file).draw(&view, &options).unwrap_err()
    };
    for samples in [0, 17] {
        assert!(matches!(drawn(1.0, samples, 8), ViewError::Samples(_)));
    }
    for voxel_px in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(drawn(voxel_px, 1, 8), ViewError::VoxelSize(_)));
    }
    assert!(matches!(drawn(1.0, 1, 0), ViewError::Raster(_)));
}
