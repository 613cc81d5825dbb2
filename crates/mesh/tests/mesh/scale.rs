//! Meshes of any size, anywhere: the voxels are the same.

use std::fmt::Write as _;

use shiftvox::graph::Voxel;
use shiftvox_mesh::MeshFormat;
use shiftvox_mesh::textured::{BuildOptions, build};
use shiftvox_mesh::voxelize::{Grid, voxelize};

use super::shapes::{ball, load, soup};
use shiftvox::graph::Silent;

/// A ball as a Wavefront text, in whole thousandths, so that text loses nothing of it.
fn text(scale: f64, moved: f64) -> String {
    let mut text = String::new();
    for corners in soup(&ball(20)) {
        for [x, y, z] in corners.map(|corner| corner.map(|c| (f64::from(c) * 1000.0).round())) {
            let [x, y, z] = [x, y * 0.7, z * 0.4].map(|c| c.round() * 0.015 * scale + moved);
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
        text += "f -3 -2 -1\n";
    }
    text
}

fn voxels(text: &str, depth: u32) -> Vec<Voxel> {
    let mesh = load(text.as_bytes(), MeshFormat::Obj).unwrap();
    assert_eq!(mesh.warnings(), [""; 0]);
    let grid = Grid::around(&mesh, depth).unwrap();
    let mut voxels = Vec::new();
    voxelize(&mesh, &grid, &mut |voxel| voxels.push(voxel), &Silent);
    voxels
}

#[test]
fn a_mesh_of_any_size_has_the_same_voxels() {
    let right = voxels(&text(1.0, 0.0), 6);
    assert!(right.len() > 3000, "{}", right.len());
    for scale in [1e-5, 1e-12, 1e6] {
        assert!(voxels(&text(scale, 0.0), 6) == right, "{scale}");
    }
}

#[test]
fn a_mesh_of_any_size_has_the_same_textured_voxels() {
    let cells = |scale: f64| {
        let mesh = load(text(scale, 0.0).as_bytes(), MeshFormat::Obj).unwrap();
        let data = build(&mesh, &BuildOptions::default(), &Silent).unwrap();
        data.grids[0]
            .voxels
            .iter()
            .map(|v| (v.cell, v.depth))
            .collect::<Vec<_>>()
    };
    let right = cells(1.0);
    assert!(right.len() > 300);
    for scale in [1e-5, 1e6] {
        assert!(cells(scale) == right, "{scale}");
    }
}

/// 30 m at the coordinates of a country's grid, and 1 m at 1000 km: single precision has steps of 50 and 6 cm there.
#[test]
fn far_from_the_origin_nothing_is_lost() {
    for (scale, moved) in [(1.0, 5.4e6), (1.0 / 30.0, 1e6)] {
        let (near, far) = (voxels(&text(scale, 0.0), 6), voxels(&text(scale, moved), 6));
        let places = |voxels: &[Voxel]| voxels.iter().map(|v| v.index).collect::<Vec<_>>();
        let (near, far) = (places(&near), places(&far));
        // Doubles have steps of a billionth of a metre there: a voxel in a thousand may differ.
        let other = far
            .iter()
            .filter(|place| near.binary_search(place).is_err() && !near.contains(place));
        assert!(other.count() * 1000 <= near.len(), "{scale} at {moved}");
        assert!(
            near.len().abs_diff(far.len()) * 1000 <= near.len(),
            "{scale} at {moved}"
        );
    }
}
