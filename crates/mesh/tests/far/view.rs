//! The view: culling and memory budgets never change a picture.

use shiftvox_mesh::far::FarFile;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::{FarCounts, FarViewer, Opacity, ViewOptions};

use super::city::{city, draw, far, file_of, lit, view};
use super::shared::triangles;

#[test]
fn culling_saves_work_and_never_changes_the_picture() {
    let file = file_of(&far(true));
    // Turn, height and size of voxels: before the wall twice, behind it, from above.
    let places = [
        (0.0, 0.02, 1.0),
        (0.0, 0.02, 2.0),
        (180.0, 0.15, 1.0),
        (0.0, 3.0, 0.1),
    ];
    let [mut culled_work, mut all_work] = [[0; 4]; 2];
    let add = |sums: &mut [u64; 4], c: &FarCounts| {
        let work = [c.hidden, c.visited, c.triangles, c.bytes];
        *sums = [0, 1, 2, 3].map(|k| sums[k] + work[k]);
    };
    for opacity in [Opacity::None, Opacity::Scalar, Opacity::Six] {
        let mut viewer = FarViewer::new(&file);
        for number in 0..8 {
            let (turn, height, voxel_px) = places[number % 4];
            let step = number as f64;
            let view = view(step * 4.0 - 12.0 + turn, height, 45.0 + 8.0 * step, 160);
            let culled = ViewOptions {
                opacity,
                ..lit(&view, voxel_px)
            };
            let all = ViewOptions {
                culling: false,
                ..culled
            };
            let (expected, whole) = draw(&file, &view, &all);
            // Memories of the last view, and of one from elsewhere.
            let mut other = FarViewer::new(&file);
            let elsewhere = self::view(step * 45.0, 0.3, 70.0, 64);
            other.draw(&elsewhere, &culled).unwrap();
            for viewer in [&mut viewer, &mut other] {
                let (picture, counts) = viewer.draw(&view, &culled).unwrap();
                assert!(picture == expected, "{opacity:?}, step {step}");
                add(&mut culled_work, &counts);
                add(&mut all_work, &whole);
            }
        }
    }
    let is_less = (1..4).all(|k| 40 * culled_work[k] < 39 * all_work[k]);
    assert!(
        culled_work[0] > 40 && is_less,
        "{culled_work:?} {all_work:?}"
    );
}

#[test]
#[cfg(unix)]
fn a_budget_below_the_size_of_the_file_never_changes_the_picture() {
    let bytes = encode(&far(true)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("city.far");
    std::fs::write(&path, &bytes).unwrap();
    let whole = FarFile::open(&path).unwrap();
    let budget = bytes.len() as u64 / 3;
    let within = FarFile::open_within(&path, budget).unwrap();
    let mut viewers = [&whole, &within].map(FarViewer::new);
    for step in (0..6).map(f64::from) {
        let view = view(step * 60.0, 0.4, 60.0 + 20.0 * step, 128);
        let pictures = viewers.each_mut().map(|viewer| {
            let options = ViewOptions::default();
            viewer.draw(&view, &options).unwrap().0
        });
        assert!(pictures[0] == pictures[1], "step {step}");
    }
    assert!(within.resident().unwrap().released > 10);
    within.verify().unwrap();
    let resident = within.resident().unwrap();
    assert!(resident.most_bytes <= budget, "{resident:?} {budget}");
    assert_eq!(whole.resident(), None);
}

#[test]
fn tiny_voxels_are_replaced_by_the_triangles() {
    let view = view(20.0, 0.3, 60.0, 200);
    let options = ViewOptions {
        voxel_px: 1e-6,
        background: Some([10, 20, 30]),
        ..ViewOptions::default()
    };
    let (picture, counts) = draw(&file_of(&far(false)), &view, &options);
    assert_eq!((counts.voxel_nodes, counts.opaque_voxels), (0, 0));
    let expected = triangles(&city(false), &view, 1, options.background);
    // Colours are stored as bytes, and where two faces meet the order decides.
    let pairs = picture.rgba.iter().zip(&expected.rgba);
    assert!(pairs.filter(|(a, b)| a != b).count() < 40);
    assert_eq!(picture.depth, expected.depth);
}
