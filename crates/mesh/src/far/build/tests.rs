//! Tests with known answers: voxels whose opacity follows without shooting rays.

use glam::DVec3;

use super::clusters::{Occluders, Part};
use super::count::Seen;
use super::grid::Grid;
use super::rays::Around;
use super::sample::{MOST_VISIBILITY_RAYS, Rays, Sampled};
use super::shot::Target;
use super::split::split;
use super::{MOST_RAYS, Ordered};
use crate::far::blend::by_cosines;
use crate::far::record::STEEPNESSES;
use crate::shared::{cuboid, shape};
use crate::{Mesh, Surface};

fn boxes(boxes: &[([f32; 3], [f32; 3])]) -> Mesh {
    shape(|builder| {
        for &(low, high) in boxes {
            cuboid(builder, low, high, 0);
        }
    })
}

/// Samples a grid with the first triangles, which the others may hide.
fn sampled(mesh: &Mesh, own: usize, cells: [u8; 3], rays: u32) -> (Vec<Seen>, Sampled) {
    let order: Vec<u32> = (0..Surface::len(mesh) as u32).collect();
    let triangles = Ordered {
        surface: mesh,
        order: &order,
        centre: DVec3::ZERO,
        scale: 1.0,
    };
    let (low, high) = mesh.bounds();
    let part = Part {
        triangles: 0..order.len(),
        around: Around::of(low, high),
    };
    let corners = |own: std::ops::Range<usize>| own.map(|number| triangles.corners(number));
    let occluders = Occluders::new(vec![part], corners, None).unwrap();
    let grid = Grid {
        origin: DVec3::ZERO,
        voxel: 1.0,
        cells,
    };
    let target = Target {
        occluders: &occluders,
        grid,
        own: 0..own,
        taken: None,
        distance: 64.0,
    };
    let mut seen = Vec::new();
    let keep = |voxel: &Seen, _: &_, _| seen.push(voxel.clone());
    let found = target.sample(Rays::InAll(rays), MOST_RAYS, 7, &triangles, |_| (), keep);
    (seen, found.unwrap())
}

#[test]
fn a_voxel_with_a_solid_lower_half_has_opacities_that_blend_by_cosines() {
    let half = boxes(&[([0.0; 3], [1.0, 0.5, 1.0])]);
    let (seen, _) = sampled(&half, 12, [1; 3], 60_000);
    let [front, back] = [0, 1].map(|side| seen[0].counted_below(side, STEEPNESSES));
    let opacity = front.with(&back).six();
    for (found, expected) in opacity.into_iter().zip([0.5, 0.5, 1.0, 1.0, 0.5, 0.5]) {
        assert!((found - expected).abs() < 0.02, "{opacity:?}");
    }
    for degrees in 0..=90 {
        let (sin, cos) = libm::sincos(f64::from(degrees).to_radians());
        let shares = by_cosines(DVec3::new(cos, sin, 0.0)).into_iter();
        let blended: f64 = shares.map(|(k, share)| opacity[k] * share).sum();
        let error = blended - (0.5 * cos + sin) / (cos + sin);
        assert!(error.abs() < 0.02, "{degrees}: {error}");
    }
}

#[test]
fn equal_triangles_are_split_by_number() {
    let (branches, _) = split(100, |_| [DVec3::ZERO, DVec3::X, DVec3::Y], 2);
    let leaves = branches.iter().filter(|b| b.children.is_none());
    assert_eq!(leaves.count(), 100);
}

#[test]
fn enclosed_voxels_are_dropped_whoever_hides_them() {
    let core = ([3.2; 3], [4.8; 3]);
    let shell = ([0.5; 3], [7.5; 3]);
    assert_eq!(sampled(&boxes(&[core]), 12, [8; 3], 4000).0.len(), 8);
    // The shell belongs to another node.
    let (seen, found) = sampled(&boxes(&[core, shell]), 12, [8; 3], 4000);
    assert_eq!((seen.len(), found.hits), (0, 0));
    // All rays are visibility rays, because there is nothing to probe.
    assert_eq!(found.rays, 8 * MOST_VISIBILITY_RAYS);
    let (both, _) = sampled(&boxes(&[core, shell]), 24, [8; 3], 20_000);
    let is_outer = |seen: &Seen| seen.place.iter().any(|&c| c == 0 || c == 7);
    assert!(both.iter().all(is_outer));
}

#[test]
fn probes_find_neighbours_of_visible_voxels_through_a_window() {
    let room = [
        ([2.1, 2.1, 1.4], [13.9, 13.9, 1.6]),
        ([0.0, 0.0, 0.5], [16.0, 16.0, 0.6]),
        ([0.0, 0.0, 0.5], [16.0, 0.1, 15.0]),
        ([0.0, 15.9, 0.5], [16.0, 16.0, 15.0]),
        ([0.0, 0.0, 0.5], [0.1, 16.0, 15.0]),
        ([15.9, 0.0, 0.5], [16.0, 16.0, 15.0]),
        ([0.0, 0.0, 14.9], [6.0, 16.0, 15.0]),
        ([10.0, 0.0, 14.9], [16.0, 16.0, 15.0]),
        ([6.0, 0.0, 14.9], [10.0, 6.0, 15.0]),
        ([6.0, 10.0, 14.9], [10.0, 16.0, 15.0]),
    ];
    // All 144 voxels can be seen. The window covers at most a 150th of a voxel's directions, so that 24 random rays
    // would find one voxel in seven, and with probes one in five.
    let (seen, found) = sampled(&boxes(&room), 12, [16, 16, 3], 7000);
    assert_eq!(found.touched, 144);
    assert!(seen.len() > 72, "{}", seen.len());
}
