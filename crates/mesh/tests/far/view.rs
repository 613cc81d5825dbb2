//! The view: memory budgets never change a picture.

use shiftvox_mesh::far::FarFile;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::ViewOptions;

use super::city::{city, draw, far, file_of, view};
use super::shared::triangles;

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
    for step in (0..6).map(f64::from) {
        let view = view(step * 60.0, 0.4, 60.0 + 20.0 * step, 128);
        let options = ViewOptions::default();
        assert!(draw(&whole, &view, &options) == draw(&within, &view, &options));
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
