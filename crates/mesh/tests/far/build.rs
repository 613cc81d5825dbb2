//! Building: threads, ray budgets, scales, clusters.

use glam::{DAffine3, DVec3};
use shiftvox::graph::Silent;
use shiftvox_mesh::Instances;
use shiftvox_mesh::far::record::Node;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::{BuildError, BuildOptions, FarData, build};
use shiftvox_mesh::generate::{Kind, generate};

use super::city::{city, draw, far, file_of, lit, options, view, with_rays};
use super::hybrid::hybrid;
use super::shared::{difference, on_any_threads};

fn sum(data: &FarData, of: fn(&Node) -> u64) -> u64 {
    data.nodes.iter().map(of).sum()
}

#[test]
fn files_have_the_same_bytes_on_any_number_of_threads() {
    on_any_threads(|| encode(&far()).unwrap());
    let wheel = generate(Kind::Wheel, 3);
    on_any_threads(|| encode(&hybrid(&wheel, 300)).unwrap());
}

#[test]
fn a_ray_budget_is_kept() {
    let [few, more, enough] = [20_000, 40_000, 4_000_000].map(with_rays);
    for (data, budget) in [(&few, 20_000), (&more, 40_000)] {
        let shot = sum(data, |n| u64::from(n.rays));
        assert!(shot <= budget && shot > budget - 1000, "{shot}");
    }
    // A voxel that no ray reached is kept and not regarded as hidden.
    let untested = [&few, &more, &enough].map(|data| sum(data, |n| u64::from(n.untested)));
    assert!(untested[0] > untested[1] && untested[1] > 0 && untested[2] == 0);
    let touched = [&few, &enough].map(|data| sum(data, |n| u64::from(n.touched)));
    assert_eq!(touched[0], touched[1]);
    let kept = [&few, &enough].map(|data| sum(data, Node::voxels));
    assert!(kept[0] > kept[1], "{kept:?}");
    assert!(few.nodes.iter().all(|n| n.voxels() <= u64::from(n.touched)));
}

#[test]
fn invalid_options_are_refused() {
    let faults: [fn(&mut BuildOptions); 4] = [
        |options| options.grid = 1,
        |options| options.grid = 256,
        |options| options.leaf_triangles = 1,
        |options| options.distance_voxels = f64::NAN,
    ];
    for fault in faults {
        let mut options = options();
        fault(&mut options);
        let refused = build(&city(), &options, &Silent);
        assert!(matches!(refused, Err(BuildError::Option(_))), "{options:?}");
    }
}

/// From 10^-12 to 10^12.
#[test]
fn a_mesh_scaled_by_a_power_of_two_has_the_same_picture() {
    let usual = far();
    let picture = |data: &FarData, scale: f64| {
        let mut view = view(30.0, 0.6, 150.0, 192);
        view.eye *= scale;
        view.near *= scale;
        draw(&file_of(data), &view, &lit(&view, 2.0)).0.rgba
    };
    let expected = picture(&usual, 1.0);
    for scale in [-40, -17, 40].map(|power| 2f64.powi(power)) {
        let place = DAffine3::from_scale(DVec3::splat(scale));
        let scaled = Instances::new(city(), vec![place]);
        let data = build(&scaled, &options(), &Silent).unwrap();
        let voxels = [&data, &usual].map(|data| sum(data, Node::voxels));
        assert_eq!(voxels[0], voxels[1], "{scale}");
        // Rounding differs, and so some rays end elsewhere.
        let error = difference(&picture(&data, scale), &expected, f64::from);
        assert!(error < 2.0, "{scale}: {error}");
    }
}

/// A cluster of the ray hierarchy has at most 2^17 triangles.
#[test]
fn a_mesh_of_several_clusters_is_built() {
    let mesh = city();
    let copies = 140_000usize.div_ceil(mesh.triangles().len());
    let places = (0..copies).map(|n| DAffine3::from_translation(DVec3::X * 50.0 * n as f64));
    let options = BuildOptions {
        rays: Some(20_000),
        leaf_triangles: 50_000,
        ..options()
    };
    let many = Instances::new(mesh, places.collect());
    let data = build(&many, &options, &Silent).unwrap();
    assert!(data.triangles() > 1 << 17, "{}", data.triangles());
    assert!(data.nodes[0].voxels() > 0);
}
