//! What is built: the same on any threads, better with more rays, level by level.

use glam::{DAffine3, DVec3};
use shiftvox::graph::Silent;
use shiftvox_mesh::Instances;
use shiftvox_mesh::far::record::Node;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::{FarViewer, ViewOptions};
use shiftvox_mesh::far::{BuildError, BuildOptions, FarData, FarFile, build};
use shiftvox_mesh::raster::{self, Pattern, RasterCamera, RasterOptions, Samples};

use super::city::{city, far, light, on_threads, options, view};

#[test]
fn the_same_bytes_on_one_and_two_threads() {
    let one = on_threads(1, || encode(&far(&options())).unwrap());
    let two = on_threads(2, || encode(&far(&options())).unwrap());
    assert!(one == two, "{} and {} bytes", one.len(), two.len());
}

#[test]
fn a_ray_budget_is_kept_and_other_rays_are_other_bytes() {
    let budget = |rays| {
        far(&BuildOptions {
            rays: Some(rays),
            ..options()
        })
    };
    let shot = |data: &FarData| data.nodes.iter().map(|n| u64::from(n.rays)).sum();
    let (few, more) = (budget(20_000), budget(40_000));
    let (shot_few, shot_more): (u64, u64) = (shot(&few), shot(&more));
    assert!(shot_few <= 20_000 && shot_few > 19_000, "{shot_few}");
    assert!(shot_more <= 40_000 && shot_more > 39_000, "{shot_more}");
    let sum = |data: &FarData, of: fn(&Node) -> u64| data.nodes.iter().map(of).sum::<u64>();
    let untested = |data: &FarData| sum(data, |n| u64::from(n.untested));
    let touched = |data: &FarData| sum(data, |n| u64::from(n.touched));
    // What too few rays cannot tell is kept, not taken for hidden.
    assert!(untested(&few) > untested(&more) && untested(&more) > 0);
    let enough = budget(4_000_000);
    assert_eq!((untested(&enough), touched(&enough)), (0, touched(&few)));
    let kept = |data: &FarData| sum(data, Node::voxels);
    assert!(
        kept(&few) > kept(&enough),
        "{} {}",
        kept(&few),
        kept(&enough)
    );
    assert!(few.nodes.iter().all(|n| n.voxels() <= u64::from(n.touched)));
}

#[test]
fn bad_options_are_refused() {
    let tries = [
        BuildOptions {
            grid: 1,
            ..options()
        },
        BuildOptions {
            grid: 256,
            ..options()
        },
        BuildOptions {
            leaf_triangles: 1,
            ..options()
        },
        BuildOptions {
            distance_voxels: f64::NAN,
            ..options()
        },
    ];
    for options in tries {
        let refused = build(&city(), &options, &Silent);
        assert!(matches!(refused, Err(BuildError::Option(_))), "{options:?}");
    }
}

#[test]
fn voxels_shrink_from_level_to_level() {
    let data = far(&options());
    // The voxel of the next node above that has any. Parents come first.
    let mut above = vec![f32::INFINITY; data.nodes.len()];
    let (mut sizes, mut without) = (Vec::new(), 0);
    for (number, node) in data.nodes.iter().enumerate() {
        let is_inner = !node.is_leaf();
        without += usize::from(is_inner && !node.has_grid());
        if node.has_grid() {
            // The root of the hierarchy and what is above it have halves; rounded layers add a little.
            assert!(node.voxel <= 0.75 * above[number], "{number}");
            sizes.push(node.voxel);
        }
        for child in node.below() {
            above[child] = if node.has_grid() {
                node.voxel
            } else {
                above[number]
            };
        }
    }
    let shrunk = sizes[0] / sizes.iter().copied().fold(f32::INFINITY, f32::min);
    assert!(shrunk > 8.0, "{shrunk}");
    assert!(without > 3, "boxes halved across another axis: {without}");
}

/// However large or small the numbers of a mesh are, it has the same voxels and looks the same.
#[test]
fn size_does_not_matter() {
    let options = options();
    let mesh = city();
    let usual = far(&options);
    let picture = |data: &FarData, scale: f64| {
        let file = FarFile::from_bytes(&encode(data).unwrap()).unwrap();
        let mut view = view(30.0, 0.6, 150.0, 192);
        view.eye *= scale;
        view.near *= scale;
        let shown = shown(&view, 2.0);
        FarViewer::new(&file).draw(&view, &shown).unwrap().0.rgba
    };
    let expected = picture(&usual, 1.0);
    let voxels = |data: &FarData| data.nodes.iter().map(Node::voxels).sum::<u64>();
    // Powers of two, 10^-12 to 10^12 about: nothing is rounded, and triangles are split alike.
    for scale in [-40, -17, 40].map(|power| 2f64.powi(power)) {
        let place = DAffine3::from_scale(DVec3::splat(scale));
        let data = build(
            &Instances::new(mesh.clone(), vec![place]),
            &options,
            &Silent,
        )
        .unwrap();
        let (found, all) = (voxels(&data), voxels(&usual));
        assert_eq!(found, all, "{scale}");
        let pairs = picture(&data, scale).into_iter().zip(&expected);
        let square = |(a, b): ([u8; 4], &[u8; 4])| {
            let channels = (0..3).map(|k| (f64::from(a[k]) - f64::from(b[k])).powi(2));
            channels.sum::<f64>() / 3.0
        };
        let mean = pairs.map(square).sum::<f64>() / expected.len() as f64;
        // Other numbers round otherwise, and so some rays end elsewhere.
        assert!(mean.sqrt() < 2.0, "{scale}: {}", mean.sqrt());
    }
}

/// Root mean square difference of the channels to 256 samples a pixel.
fn error(file: &FarFile, view: &RasterCamera, options: &ViewOptions) -> f64 {
    let reference = raster::draw(
        &city(),
        view,
        &RasterOptions {
            samples: Samples::new(256, Pattern::Regular).unwrap(),
            light: options.light,
            background: options.background,
        },
        &Silent,
    )
    .unwrap();
    let (picture, _) = FarViewer::new(file).draw(view, options).unwrap();
    let pairs = picture.rgba.iter().zip(&reference.rgba);
    let square = |(a, b): (&[u8; 4], &[u8; 4])| {
        let channels = (0..3).map(|k| (f64::from(a[k]) - f64::from(b[k])).powi(2));
        channels.sum::<f64>() / 3.0
    };
    (pairs.map(square).sum::<f64>() / picture.rgba.len() as f64).sqrt()
}

fn shown(view: &RasterCamera, voxel_px: f64) -> ViewOptions {
    ViewOptions {
        voxel_px,
        light: light(view),
        background: Some([240, 240, 245]),
        ..ViewOptions::default()
    }
}

#[test]
fn finer_levels_have_less_error() {
    let data = far(&BuildOptions {
        rays: Some(800_000),
        ..options()
    });
    let file = FarFile::from_bytes(&encode(&data).unwrap()).unwrap();
    let view = view(30.0, 0.6, 150.0, 256);
    let errors: Vec<f64> = [1.0, 2.0, 4.0]
        .into_iter()
        .map(|px| error(&file, &view, &shown(&view, px)))
        .collect();
    assert!(
        errors.windows(2).all(|pair| pair[0] < pair[1]),
        "{errors:?}"
    );
}

#[test]
fn more_rays_never_raise_the_error_beyond_noise() {
    let view = view(30.0, 0.6, 150.0, 192);
    let errors: Vec<f64> = [15_000, 60_000, 240_000, 960_000]
        .into_iter()
        .map(|rays| {
            let data = far(&BuildOptions {
                rays: Some(rays),
                ..options()
            });
            let file = FarFile::from_bytes(&encode(&data).unwrap()).unwrap();
            error(&file, &view, &shown(&view, 2.0))
        })
        .collect();
    assert!(
        errors.windows(2).all(|pair| pair[1] < pair[0] * 1.03),
        "{errors:?}"
    );
    assert!(errors[3] < errors[0], "{errors:?}");
}

/// More triangles than a cluster of the ray hierarchy has (2^17).
#[test]
fn a_mesh_of_several_clusters_is_built() {
    let mesh = city();
    let copies = 140_000usize.div_ceil(mesh.triangles().len());
    let places =
        (0..copies).map(|number| DAffine3::from_translation(DVec3::X * 50.0 * number as f64));
    let many = Instances::new(mesh, places.collect());
    let options = BuildOptions {
        rays: Some(20_000),
        leaf_triangles: 50_000,
        ..options()
    };
    let data = build(&many, &options, &Silent).unwrap();
    assert!(data.triangles() > 1 << 17, "{}", data.triangles());
    assert!(data.nodes[0].voxels() > 0);
}
