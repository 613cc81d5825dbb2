//! Meshes of any size, anywhere, have the same voxels.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use shiftvox::graph::Silent;
use shiftvox_mesh::textured::{BuildOptions, build};
use shiftvox_mesh::{Mesh, MeshFormat};

use super::shapes::load;
use super::shared::{ball, soup};
use super::voxels::voxels;

/// A ball read from a text in whole thousandths, which loses no digits.
fn scaled(scale: f64, moved: f64) -> Mesh {
    let mut text = String::new();
    for corner in soup(&ball(20)).into_flattened() {
        let [x, y, z] = corner.map(|c| (f64::from(c) * 1000.0).round());
        let [x, y, z] = [x, y * 0.7, z * 0.4].map(|c| c.round() * 0.015 * scale + moved);
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    for first in (1..text.lines().count()).step_by(3) {
        writeln!(text, "f {first} {} {}", first + 1, first + 2).unwrap();
    }
    let mesh = load(text.as_bytes(), MeshFormat::Obj).unwrap();
    assert_eq!(mesh.warnings(), [""; 0]);
    mesh
}

#[test]
fn meshes_of_any_size_have_the_same_voxels() {
    let textured = |mesh: &Mesh| {
        let data = build(mesh, &BuildOptions::default(), &Silent).unwrap();
        let voxels = data.grids[0].voxels.iter();
        voxels.map(|v| (v.cell, v.depth)).collect::<Vec<_>>()
    };
    let mesh = scaled(1.0, 0.0);
    let expected = (voxels(&mesh, 6), textured(&mesh));
    assert!(expected.0.len() > 3000 && expected.1.len() > 300);
    for scale in [1e-12, 1e-5, 1e6] {
        let mesh = scaled(scale, 0.0);
        assert!(voxels(&mesh, 6) == expected.0, "{scale}");
        assert!(scale < 1e-5 || textured(&mesh) == expected.1, "{scale}");
    }
}

/// 30 m at the coordinates of a country's grid, and 1 m at 1000 km: single precision has steps of 50 and 6 cm there.
#[test]
fn meshes_far_from_the_origin_lose_nothing() {
    for (scale, moved) in [(1.0, 5.4e6), (1.0 / 30.0, 1e6)] {
        let [near, far] = [0.0, moved].map(|moved| {
            let found = voxels(&scaled(scale, moved), 6);
            found.iter().map(|v| v.index).collect::<BTreeSet<_>>()
        });
        // Doubles have steps of a billionth of a metre there: two voxels in a thousand may differ.
        let differing = far.symmetric_difference(&near).count();
        assert!(differing * 500 <= near.len(), "{moved}: {differing}");
    }
}
