//! Decimated meshes keep their areas and their budgets.

use glam::DVec3;
use shiftvox_mesh::decimate::{Decimation, compact, decimate};
use shiftvox_mesh::generate::{Kind, generate};
use shiftvox_mesh::{Material, Surface};

use super::shared::{shape, sheet};

#[test]
fn flat_parts_lose_triangles_and_keep_their_materials() {
    let square = shape(|builder| {
        let other = builder.material(Material::of_srgb("other", [0; 3]));
        for (left, material) in [(0, 0), (8, other)] {
            let at = |i, j| DVec3::new(f64::from(left + j), f64::from(i), 0.0);
            sheet(builder, [16, 8], material, at);
        }
    });
    let few = decimate(&square, Decimation::Error(0.01)).unwrap().unwrap();
    assert!(few.len() <= 8, "{}", few.len());
    for material in [0, 1] {
        let own = (0..few.len()).filter(|&n| few.material_of()[n] == material);
        let doubled = own.map(|number| {
            let [a, b, c] = Surface::corners(&few, number);
            (b - a).cross(c - a).length()
        });
        assert!((doubled.sum::<f64>() / 2.0 - 128.0).abs() < 1e-3);
    }
    assert!(few.corner_normals().iter().flatten().all(|n| n[2] > 0.999));
}

#[test]
fn a_budget_is_kept_and_small_parts_vanish_in_it_alone() {
    let scan = generate(Kind::Scan, 1);
    let few = decimate(&scan, Decimation::Count(500)).unwrap().unwrap();
    assert!((300..=500).contains(&few.len()));
    let (rounded, bytes) = compact(&few);
    let extent = (few.bounds().1 - few.bounds().0).max_element();
    for (a, b) in few.positions().iter().zip(rounded.positions()) {
        assert!(DVec3::from(*a).distance((*b).into()) < extent / 30_000.0);
    }
    assert!(bytes < 500 * 52);
    let tree = generate(Kind::Tree, 1);
    let pruned = decimate(&tree, Decimation::Count(0)).unwrap();
    assert!(pruned.is_none_or(|mesh| mesh.len() < 100));
    let whole = decimate(&tree, Decimation::Error(100.0)).unwrap();
    assert!(whole.unwrap().len() > 1000);
}
