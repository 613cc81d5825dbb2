//! Tests with known answers: voxels whose opacity follows without shooting rays.

use glam::DVec3;

use super::clusters::{Occluders, Part};
use super::count::Seen;
use super::grid::Grid;
use super::rays::Around;
use super::sample::{MOST_VISIBILITY_RAYS, Rays, Sampled, Triangles};
use super::shader_fit::{self, ShaderFit};
use super::shot::{Own, Target};
use super::{MOST_RAYS, Ordered};
use crate::far::blend::by_cosines;
use crate::far::record::{Opacity, OpacityKind, STEEPNESSES};
use crate::shared::{cuboid, quad, shape};
use crate::{Material, Mesh, Surface};

/// A mesh of boxes.
fn boxes(boxes: &[([f32; 3], [f32; 3])]) -> Mesh {
    shape(|builder| {
        for &(low, high) in boxes {
            cuboid(builder, low, high, 0);
        }
    })
}

/// The voxels and counts of a node with unit voxels, whose own triangles are the mesh's first.
fn sampled(
    mesh: &Mesh,
    own: usize,
    cells: [u8; 3],
    rays: u32,
) -> (Vec<(Seen, ShaderFit)>, Sampled) {
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
    let occluders = Occluders::new(&[part], corners, None).unwrap();
    let grid = Grid {
        origin: DVec3::ZERO,
        voxel: 1.0,
        cells,
    };
    let target = Target {
        occluders: &occluders,
        grid,
        own: Own::all(0..own),
        distance: 64.0,
    };
    let mut seen = Vec::new();
    let keep = |voxel: &Seen, shown: &ShaderFit, _| seen.push((voxel.clone(), *shown));
    let found = target.sample(Rays::InAll(rays), MOST_RAYS, 7, &triangles, |_| (), keep);
    (seen, found.unwrap())
}

/// The voxels and counts of a node that is the whole mesh.
fn all(mesh: &Mesh, cells: [u8; 3], rays: u32) -> (Vec<(Seen, ShaderFit)>, Sampled) {
    sampled(mesh, Surface::len(mesh), cells, rays)
}

/// The six opacities of a voxel.
fn six(seen: &[(Seen, ShaderFit)], place: [u8; 3]) -> [f64; 6] {
    let (seen, _) = seen.iter().find(|(seen, _)| seen.place == place).unwrap();
    let [front, back] = [0, 1].map(|side| seen.counted_below(side, STEEPNESSES));
    front.with(&back).six()
}

#[test]
fn an_opaque_slab_is_opaque_from_six_directions() {
    // Almost two layers thick, so that its faces are within them.
    let slab = boxes(&[([0.3, 0.3, 2.001], [7.7, 7.7, 3.999])]);
    let (seen, _) = all(&slab, [8, 8, 6], 100_000);
    // The slab fills the voxels of the rim in part.
    let is_inner = |seen: &Seen| seen.place[..2].iter().all(|c| (1..7).contains(c));
    let inner: Vec<_> = seen.iter().filter(|(seen, _)| is_inner(seen)).collect();
    assert_eq!(inner.len(), 2 * 6 * 6);
    for (seen, shown) in inner {
        let voxel = shader_fit::fit(seen, shown.shader, Opacity::Six);
        for eye in DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
            let opacity = voxel.opacity_from(eye, Opacity::Six);
            let least = if eye.z == 0.0 { 0.9 } else { 1.0 };
            assert!(opacity >= least, "{:?} {eye} {opacity}", seen.place);
        }
    }
}

#[test]
fn a_voxel_with_a_solid_lower_half_has_opacities_that_blend_by_cosines() {
    let half = boxes(&[([0.0; 3], [1.0, 0.5, 1.0])]);
    let opacity = six(&all(&half, [1; 3], 60_000).0, [0; 3]);
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
fn wires_have_the_opacity_of_their_width() {
    // Square wires along z in every other column: each is alone in its voxels along y.
    let widths = [0.1f32, 0.2, 0.3, 0.4, 0.5];
    let wire = |i: usize| {
        let (x, half) = (2.0 * i as f32 + 0.5, widths[i] / 2.0);
        ([x - half, 0.5 - half, 0.0], [x + half, 0.5 + half, 8.0])
    };
    let wires: Vec<_> = (0..5).map(wire).collect();
    let (seen, _) = all(&boxes(&wires), [9, 1, 8], 200_000);
    for (i, width) in widths.into_iter().enumerate() {
        for k in [2, 3] {
            let rows = (2..6).map(|z| six(&seen, [2 * i as u8, 0, z])[k]);
            let mean = rows.sum::<f64>() / 4.0;
            let error = mean - f64::from(width);
            assert!(error.abs() < 0.05, "width {width}, direction {k}: {mean}");
        }
    }
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
    let (both, _) = all(&boxes(&[core, shell]), [8; 3], 20_000);
    let is_outer = |seen: &Seen| seen.place.iter().any(|&c| c == 0 || c == 7);
    assert!(both.iter().all(|(seen, _)| is_outer(seen)));
}

#[test]
fn probes_find_neighbours_of_visible_voxels_through_a_window() {
    // A picture on the wall of a closed room, in one layer of voxels. The wall opposite has a window.
    let room = [
        ([2.1, 2.1, 1.4], [13.9, 13.9, 1.6]),
        ([0.0, 0.0, 0.5], [16.0, 16.0, 0.6]),
        ([0.0, 0.0, 0.5], [16.0, 0.1, 15.0]),
        ([0.0, 15.9, 0.5], [16.0, 16.0, 15.0]),
        ([0.0, 0.0, 0.5], [0.1, 16.0, 15.0]),
        ([15.9, 0.0, 0.5], [16.0, 16.0, 15.0]),
        // Around the window.
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

#[test]
fn a_thin_floor_has_no_holes() {
    // Tilted, across the middle of voxels.
    let corners = [
        (0.5, 1.2, 0.5),
        (7.5, 2.9, 0.5),
        (7.5, 2.9, 7.5),
        (0.5, 1.2, 7.5),
    ];
    let floor = shape(|builder| quad(builder, corners.map(|(x, y, z)| [x, y, z]), 0));
    let (seen, _) = all(&floor, [8, 4, 8], 100_000);
    // A voxel with a corner of the floor is not taken for a thin thing: no column is transparent.
    for mode in [Opacity::Scalar, Opacity::Six] {
        for eye in [DVec3::Y, DVec3::NEG_Y] {
            let mut through = [[1.0; 8]; 8];
            for (seen, shown) in &seen {
                let [x, _, z] = seen.place.map(usize::from);
                let voxel = shader_fit::fit(seen, shown.shader, Opacity::Six);
                through[z][x] *= 1.0 - voxel.opacity_from(eye, mode);
            }
            let inner = through[1..7].iter().flat_map(|row| &row[1..7]);
            let most = inner.copied().fold(0.0, f64::max);
            assert!(most < 0.02, "{mode:?} {eye}: {through:?}");
        }
    }
}

#[test]
fn untested_voxels_are_kept_and_look_like_their_triangles() {
    // Red walls in a row, with one ray for eight of their voxels.
    let walls = shape(|builder| {
        let red = builder.material(Material::of_srgb("red", [255, 0, 0]));
        for x in (0..16u8).map(|i| f32::from(i) + 0.5) {
            let corners = [[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]];
            quad(builder, corners.map(|[y, z]| [x, y, z]), red);
        }
    });
    let (seen, few) = all(&walls, [16, 8, 8], 128);
    assert_eq!((few.touched, few.rays), (1024, 128));
    assert_eq!(seen.len(), 1024, "none is known to be hidden");
    assert!(few.untested > 512, "{}", few.untested);
    for (seen, shown) in &seen {
        let (normal, color) = shown.shader.seen_from(DVec3::X);
        assert!(normal.x.abs() > 0.99 && color.x > 0.9 && color.y < 0.1);
        if seen.crossings == 0 {
            let voxel = shader_fit::fit(seen, shown.shader, Opacity::Six);
            assert_eq!(voxel.opacity_kind, OpacityKind::Opaque);
        }
    }
    // Enough rays test all voxels.
    let (_, enough) = all(&walls, [16, 8, 8], 100_000);
    assert_eq!((enough.touched, enough.untested), (1024, 0));
}

#[test]
fn no_more_voxels_are_kept_than_touched() {
    // Walls exactly between voxels: rays see the end on either side.
    let walls = [2.0, 4.0, 6.0].map(|x| ([x, 1.0, 1.0], [x + 1.0, 7.0, 7.0]));
    let (seen, found) = all(&boxes(&walls), [8; 3], 200_000);
    let kept = seen.len();
    assert!(
        kept <= found.touched as usize,
        "{kept} of {}",
        found.touched
    );
}
