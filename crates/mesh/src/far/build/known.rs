//! Tests with known answers: voxels whose opacity follows without shooting rays.

use glam::DVec3;

use super::clusters::{Occluders, Part};
use super::count::Seen;
use super::grid::Grid;
use super::rays::Around;
use super::sample::{MOST_VISIBILITY_RAYS, Rays, Triangles};
use super::shader_fit::ShaderFit;
use super::shot::{Own, Target};
use super::{MOST_RAYS, Ordered, shader_fit};
use crate::far::blend::by_cosines;
use crate::far::record::{Opacity, OpacityKind, STEEPNESSES};
use crate::generate::maker::Maker;
use crate::{Material, Mesh, MeshBuilder, Surface};

/// A mesh of boxes.
fn boxes(boxes: &[(DVec3, DVec3)]) -> Mesh {
    let mut maker = Maker::new(0);
    for &(low, high) in boxes {
        maker.block(low, high, 0);
    }
    maker.finish()
}

/// Unit voxels from the origin.
fn unit(cells: [u8; 3]) -> Grid {
    Grid {
        origin: DVec3::ZERO,
        voxel: 1.0,
        cells,
    }
}

/// The result of a node's rays.
struct Sampled {
    seen: Vec<(Seen, ShaderFit)>,
    touched: u32,
    untested: u32,
    rays: u32,
    hits: u32,
}

fn sampled(mesh: &Mesh, own: usize, grid: Grid, rays: u32) -> Sampled {
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
    let target = Target {
        occluders: &occluders,
        grid,
        own: Own::all(0..own),
        distance: 64.0,
    };
    let mut seen = Vec::new();
    let keep = |voxel: &Seen, shown: &ShaderFit, _| seen.push((voxel.clone(), *shown));
    let rays = Rays::InAll(rays);
    let found = target.sample(rays, MOST_RAYS, 7, &triangles, |_| (), keep);
    let found = found.unwrap();
    Sampled {
        seen,
        touched: found.touched,
        untested: found.untested,
        rays: found.rays,
        hits: found.hits,
    }
}

fn all(mesh: &Mesh, grid: Grid, rays: u32) -> Sampled {
    sampled(mesh, Surface::len(mesh), grid, rays)
}

fn at(sampled: &Sampled, place: [u8; 3]) -> &Seen {
    let mut seen = sampled.seen.iter().map(|(seen, _)| seen);
    seen.find(|seen| seen.place == place).unwrap()
}

/// Six opacities, of all that was counted.
fn six(seen: &Seen) -> [f64; 6] {
    let [front, back] = [0, 1].map(|side| seen.counted_below(side, STEEPNESSES));
    front.with(&back).six()
}

#[test]
fn an_opaque_slab_is_opaque_from_six_directions() {
    // Two layers thick, but for so little that its faces are within them.
    let slab = boxes(&[(DVec3::new(0.3, 0.3, 2.001), DVec3::new(7.7, 7.7, 3.999))]);
    let sampled = all(&slab, unit([8, 8, 6]), 100_000);
    let mut inner = 0;
    for (seen, shown) in &sampled.seen {
        let [x, y, _] = seen.place;
        // The rim's voxels are filled in part.
        if (1..7).contains(&x) && (1..7).contains(&y) {
            let voxel = shader_fit::fit(seen, shown.shader, Opacity::Six);
            inner += 1;
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                for eye in [axis, -axis] {
                    let opacity = voxel.opacity_from(eye, Opacity::Six);
                    let least = if eye.z == 0.0 { 0.9 } else { 1.0 };
                    assert!(opacity >= least, "{:?} {eye} {opacity}", seen.place);
                }
            }
        }
    }
    assert_eq!(inner, 2 * 6 * 6);
}

#[test]
fn a_voxel_whose_lower_half_is_solid() {
    let half = boxes(&[(DVec3::ZERO, DVec3::new(1.0, 0.5, 1.0))]);
    let sampled = all(&half, unit([1, 1, 1]), 60_000);
    let opacity = six(at(&sampled, [0, 0, 0]));
    for (k, expected) in [0.5, 0.5, 1.0, 1.0, 0.5, 0.5].into_iter().enumerate() {
        assert!((opacity[k] - expected).abs() < 0.02, "{k}: {opacity:?}");
    }
}

#[test]
fn cosines_blend_a_box_exactly() {
    let half = boxes(&[(DVec3::ZERO, DVec3::new(1.0, 0.5, 1.0))]);
    let opacity = six(at(&sampled(&half, 12, unit([1; 3]), 60_000), [0; 3]));
    for degrees in 0..=90 {
        let (sin, cos) = libm::sincos(f64::from(degrees).to_radians());
        let shares = by_cosines(DVec3::new(cos, sin, 0.0)).into_iter();
        let blended: f64 = shares.map(|(k, share)| opacity[k] * share).sum();
        let error = blended - (0.5 * cos + sin) / (cos + sin);
        assert!(error.abs() < 0.02, "{degrees}: {error}");
    }
}

#[test]
fn a_fan_of_wires_has_analytic_coverage() {
    // Square wires along z, one in the middle of every other column, so that
    // each is alone in its voxels seen along y.
    let wires: Vec<(DVec3, DVec3)> = (0..5)
        .map(|i| {
            let width = 0.1 + 0.1 * f64::from(i);
            let x = 2.0 * f64::from(i) + 0.5;
            let low = DVec3::new(x - width / 2.0, 0.5 - width / 2.0, 0.0);
            (low, DVec3::new(x + width / 2.0, 0.5 + width / 2.0, 8.0))
        })
        .collect();
    let sampled = all(&boxes(&wires), unit([9, 1, 8]), 200_000);
    for i in 0..5u8 {
        let width = 0.1 + 0.1 * f64::from(i);
        let rows: Vec<&Seen> = (2..6).map(|z| at(&sampled, [2 * i, 0, z])).collect();
        for k in [2, 3] {
            let mean = rows.iter().map(|seen| six(seen)[k]).sum::<f64>() / rows.len() as f64;
            assert!(
                (mean - width).abs() < 0.05,
                "width {width}, direction {k}: {mean}"
            );
        }
    }
}

#[test]
fn what_is_enclosed_is_dropped_and_what_hides_it_need_not_be_the_nodes_own() {
    let core = (DVec3::splat(3.2), DVec3::splat(4.8));
    let shell = (DVec3::splat(0.5), DVec3::splat(7.5));
    let open = sampled(&boxes(&[core]), 12, unit([8; 3]), 4000);
    assert_eq!(open.seen.len(), 8);
    // The shell is environment: not of the node, but around it.
    let hidden = sampled(&boxes(&[core, shell]), 12, unit([8; 3]), 4000);
    assert_eq!((hidden.seen.len(), hidden.hits), (0, 0));
    assert_eq!(
        hidden.rays,
        8 * MOST_VISIBILITY_RAYS,
        "all are visibility rays and there is nothing to probe"
    );
    let both = all(&boxes(&[core, shell]), unit([8; 3]), 20_000);
    assert!(
        both.seen
            .iter()
            .all(|(seen, _)| seen.place.iter().any(|&c| c == 0 || c == 7))
    );
}

#[test]
fn what_a_window_shows_is_found_from_what_is_beside_it() {
    // A picture on the wall of a closed room, in one layer of voxels; the wall opposite has a
    // window.
    let picture = (DVec3::new(2.1, 2.1, 1.4), DVec3::new(13.9, 13.9, 1.6));
    let wall = |low: [f64; 3], high: [f64; 3]| (DVec3::from_array(low), DVec3::from_array(high));
    let room = [
        picture,
        wall([0.0, 0.0, 0.5], [16.0, 16.0, 0.6]),
        wall([0.0, 0.0, 0.5], [16.0, 0.1, 15.0]),
        wall([0.0, 15.9, 0.5], [16.0, 16.0, 15.0]),
        wall([0.0, 0.0, 0.5], [0.1, 16.0, 15.0]),
        wall([15.9, 0.0, 0.5], [16.0, 16.0, 15.0]),
        // Around the window.
        wall([0.0, 0.0, 14.9], [6.0, 16.0, 15.0]),
        wall([10.0, 0.0, 14.9], [16.0, 16.0, 15.0]),
        wall([6.0, 0.0, 14.9], [10.0, 6.0, 15.0]),
        wall([6.0, 10.0, 14.9], [10.0, 16.0, 15.0]),
    ];
    // So few rays that probes, which find something too, do not find all.
    let sampled = sampled(&boxes(&room), 12, unit([16, 16, 3]), 7000);
    // The window covers at most a 150th of a voxel's directions. So 24 random rays would find one voxel in seven, and
    // with probes one in five. All 144 can be seen.
    assert_eq!(sampled.touched, 144);
    assert!(sampled.seen.len() > 72, "{}", sampled.seen.len());
}

#[test]
fn a_thin_floor_has_no_holes() {
    // Two triangles across the middle of voxels, and tilted.
    let mut builder = MeshBuilder::new();
    let corners = [
        [0.5, 1.2, 0.5],
        [7.5, 2.9, 0.5],
        [7.5, 2.9, 7.5],
        [0.5, 1.2, 7.5],
    ];
    let corners = corners.map(|p| builder.position(p));
    for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
        builder
            .triangle([corners[a], corners[b], corners[c]], None, 0)
            .unwrap();
    }
    let floor = builder.finish("floor").unwrap();
    let sampled = all(&floor, unit([8, 4, 8]), 100_000);
    // A corner of the floor in a voxel is distinguished from a thin thing: one sees through
    // no column, from above or below.
    for mode in [Opacity::Scalar, Opacity::Six] {
        for eye in [DVec3::Y, DVec3::NEG_Y] {
            let mut through = [[1.0; 8]; 8];
            for (seen, shown) in &sampled.seen {
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
fn what_was_not_tested_is_kept_and_looks_like_its_triangles() {
    // Red walls in a row; one ray for eight voxels of them.
    let mut builder = MeshBuilder::new();
    let red = builder.material(Material::of_srgb("red".to_owned(), [255, 0, 0]));
    for i in 0..16u8 {
        let x = f32::from(i) + 0.5;
        let corners = [[x, 0.0, 0.0], [x, 8.0, 0.0], [x, 8.0, 8.0], [x, 0.0, 8.0]];
        let corners = corners.map(|p| builder.position(p));
        for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
            let triangle = [corners[a], corners[b], corners[c]];
            builder.triangle(triangle, None, red).unwrap();
        }
    }
    let walls = builder.finish("walls").unwrap();
    let few = all(&walls, unit([16, 8, 8]), 128);
    assert_eq!((few.touched, few.rays), (1024, 128));
    assert_eq!(few.seen.len(), 1024, "none is known to be hidden");
    assert!(few.untested > 512, "{}", few.untested);
    for (seen, shown) in &few.seen {
        let (normal, color) = shown.shader.seen_from(DVec3::X);
        assert!(normal.x.abs() > 0.99 && color.x > 0.9 && color.y < 0.1);
        if seen.crossings == 0 {
            let voxel = shader_fit::fit(seen, shown.shader, Opacity::Six);
            assert_eq!(voxel.opacity_kind, OpacityKind::Opaque, "a wall");
        }
    }
    // With enough rays all voxels are tested, and those between the walls are hidden.
    let enough = all(&walls, unit([16, 8, 8]), 100_000);
    assert_eq!((enough.touched, enough.untested), (1024, 0));
}

#[test]
fn no_more_is_kept_than_is_touched() {
    // Walls exactly between voxels, of which rays see the end on either side.
    let walls: Vec<(DVec3, DVec3)> = (1..4)
        .map(|i| {
            let x = f64::from(2 * i);
            (DVec3::new(x, 1.0, 1.0), DVec3::new(x + 1.0, 7.0, 7.0))
        })
        .collect();
    let sampled = all(&boxes(&walls), unit([8; 3]), 200_000);
    assert!(
        sampled.seen.len() <= sampled.touched as usize,
        "{} of {}",
        sampled.seen.len(),
        sampled.touched
    );
}
