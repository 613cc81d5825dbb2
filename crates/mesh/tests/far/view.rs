//! The view: culling, late answers, threads and batches never change a picture.

use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::{FarCounts, FarViewer, Opacity, ViewOptions};
use shiftvox_mesh::far::{BuildOptions, FarFile};

use super::city::{city, far, far_of, file_of, light, options, view};
use super::shared::{area, on_threads, triangles};

fn file() -> FarFile {
    file_of(&far(&options()))
}

#[test]
fn culling_and_late_answers_never_change_the_picture() {
    let data = far_of(true, false, &options());
    let file = file_of(&data);
    let mut hidden = 0;
    for opacity in [Opacity::None, Opacity::Scalar, Opacity::Six] {
        let mut viewers: Vec<FarViewer<'_>> = (0..3).map(|_| FarViewer::new(&file)).collect();
        for step in 0..8 {
            // Before the wall twice, behind it, from above.
            let (turn, height, voxel_px) = [
                (0.0, 0.02, 1.0),
                (0.0, 0.02, 2.0),
                (180.0, 0.15, 1.0),
                (0.0, 3.0, 0.1),
            ][step % 4];
            let step = step as f64;
            let view = view(step * 4.0 - 12.0 + turn, height, 45.0 + 8.0 * step, 160);
            let options = ViewOptions {
                voxel_px,
                opacity,
                light: light(&view),
                culling: false,
                ..ViewOptions::default()
            };
            let (expected, _) = FarViewer::new(&file).draw(&view, &options).unwrap();
            // Viewers that remember, with answers sooner and later.
            for (late, viewer) in [0, 1, 4].into_iter().zip(&mut viewers) {
                let culled = ViewOptions {
                    culling: true,
                    late,
                    ..options
                };
                let (picture, counts) = viewer.draw(&view, &culled).unwrap();
                assert!(picture == expected, "{opacity:?}, step {step}, late {late}");
                hidden += counts.hidden;
                // Wrong memories: any third, and the ground alone.
                let any = |node: usize| node % 3 == step as usize % 3;
                let low = |node: usize| file.nodes()[node].high[1] < 0.0;
                for is_low in [false, true] {
                    let mut wrong = FarViewer::new(&file);
                    wrong.remember(|node| if is_low { low(node) } else { any(node) });
                    let (picture, _) = wrong.draw(&view, &culled).unwrap();
                    assert!(
                        picture == expected,
                        "{opacity:?}, step {step}, wrong {is_low}"
                    );
                }
            }
        }
    }
    assert!(hidden > 20, "{hidden} nodes were hidden");
}

#[test]
fn hidden_branches_cost_no_work() {
    let data = far_of(true, true, &options());
    let file = file_of(&data);
    // Before the wall: it hides the city.
    let view = view(0.0, 0.02, 80.0, 160);
    let draw = |viewer: &mut FarViewer<'_>, culling| {
        let options = ViewOptions {
            culling,
            voxel_px: 0.1,
            ..ViewOptions::default()
        };
        viewer.draw(&view, &options).unwrap()
    };
    let mut viewer = FarViewer::new(&file);
    let (picture, all) = draw(&mut viewer, false);
    let (first, _) = draw(&mut viewer, true);
    let (second, culled) = draw(&mut viewer, true);
    assert!(picture == first && picture == second);
    assert!(culled.hidden > 0);
    let drawn = |counts: &FarCounts| counts.voxel_nodes + counts.leaves;
    // A branch is tested once, and nothing below it is visited.
    assert!(
        culled.hidden + drawn(&culled) < drawn(&all),
        "{culled:?} {all:?}"
    );
    assert!(culled.visited < all.visited, "{culled:?} {all:?}");
    assert!(
        culled.triangles * 4 < all.triangles * 3,
        "{culled:?} {all:?}"
    );
    // Of a hidden node not even the data is read: its damage does not matter.
    let seen: std::collections::HashSet<i32> = picture.node.iter().copied().collect();
    let unseen = (0..data.nodes.len()).rev().find(|&n| {
        let node = &data.nodes[n];
        let is_inside = node.high[2] < 30.0;
        !seen.contains(&(n as i32)) && node.is_leaf() && is_inside
    });
    let mut bytes = encode(&data).unwrap();
    let data_at = bytes.len() - data.packed.len();
    bytes[data_at + data.nodes[unseen.unwrap()].data_at as usize] ^= 1;
    let damaged = FarFile::from_bytes(&bytes).unwrap();
    assert!(damaged.verify().is_err());
    let (same, _) = draw(&mut FarViewer::new(&damaged), true);
    assert!(same == picture);
}

#[test]
#[cfg(unix)]
fn a_budget_below_the_files_size_changes_nothing_but_time() {
    let data = far_of(true, false, &options());
    let bytes = encode(&data).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("city.far");
    std::fs::write(&path, &bytes).unwrap();
    let whole = FarFile::open(&path).unwrap();
    let budget = bytes.len() as u64 / 3;
    let within = FarFile::open_within(&path, budget).unwrap();
    let mut viewers = (FarViewer::new(&whole), FarViewer::new(&within));
    for step in 0..6 {
        let view = view(
            f64::from(step) * 60.0,
            0.4,
            60.0 + 20.0 * f64::from(step),
            128,
        );
        let options = ViewOptions::default();
        let (expected, _) = viewers.0.draw(&view, &options).unwrap();
        let (picture, _) = viewers.1.draw(&view, &options).unwrap();
        assert!(picture == expected, "step {step}");
        let resident = within.resident().unwrap();
        assert!(resident.most_bytes <= budget, "{resident:?} {budget}");
    }
    let resident = within.resident().unwrap();
    assert!(resident.released > 10, "{resident:?}");
    within.verify().unwrap();
    assert!(within.resident().unwrap().most_bytes <= budget);
    assert_eq!(whole.resident(), None);
}

#[test]
fn threads_never_change_the_picture() {
    let file = file();
    let view = view(35.0, 0.4, 90.0, 200);
    let draw = |threads| {
        on_threads(threads, || {
            FarViewer::new(&file)
                .draw(&view, &ViewOptions::default())
                .unwrap()
        })
    };
    assert!(draw(1) == draw(2));
}

#[test]
fn near_enough_it_is_the_triangles() {
    let file = file();
    let view = view(20.0, 0.3, 60.0, 200);
    let options = ViewOptions {
        voxel_px: 1e-6,
        background: Some([10, 20, 30]),
        ..ViewOptions::default()
    };
    let (picture, counts) = FarViewer::new(&file).draw(&view, &options).unwrap();
    assert_eq!((counts.voxel_nodes, counts.opaque_voxels), (0, 0));
    let expected = triangles(&city(), &view, 1, None, options.background);
    // Colours are stored as bytes, and where two faces meet the order decides.
    let differing = picture
        .rgba
        .iter()
        .zip(&expected.rgba)
        .filter(|(a, b)| a != b);
    assert!(differing.count() < 40);
    assert_eq!(picture.depth, expected.depth);
}

#[test]
fn opacities_make_thin_parts_thin() {
    let data = far(&BuildOptions {
        rays: Some(500_000),
        ..options()
    });
    let file = file_of(&data);
    let view = view(30.0, 0.5, 200.0, 200);
    let reference = triangles(&city(), &view, 256, None, None);
    let bias = |opacity| {
        let options = ViewOptions {
            voxel_px: 3.0,
            opacity,
            ..ViewOptions::default()
        };
        let (picture, _) = FarViewer::new(&file).draw(&view, &options).unwrap();
        area(&picture.coverage) / area(&reference.coverage) - 1.0
    };
    let (none, six) = (bias(Opacity::None), bias(Opacity::Six));
    assert!(none > 0.1, "opaque voxels are bloated: {none}");
    assert!(six.abs() < none / 2.0, "{six} {none}");
}
