//! Large objects stay opaque, thin ones keep their area, and surfaces of hybrid nodes join.

use std::collections::BTreeSet;

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::far::record::Node;
use shiftvox_mesh::far::view::{Opacity, ViewOptions};
use shiftvox_mesh::far::{BuildOptions, FarData, build};
use shiftvox_mesh::raster::NOTHING;
use shiftvox_mesh::{Material, Mesh, MeshBuilder};

use super::city::{draw, file_of};
use super::shared::{DISC, area, around, card, directions, disc, shape, sheet, sphere, triangles};

pub(crate) fn hybrid(mesh: &Mesh, leaf_triangles: u32) -> FarData {
    let options = BuildOptions {
        hybrid: true,
        rays: Some(60_000),
        leaf_triangles,
        ..BuildOptions::default()
    };
    build(mesh, &options, &Silent).unwrap()
}

fn options(opacity: Opacity) -> ViewOptions {
    ViewOptions {
        opacity,
        background: Some([255; 3]),
        ..ViewOptions::default()
    }
}

/// A white sphere of radius 10 and so many rows around a red one.
fn nested_spheres(rows: u32, inner: f64) -> Mesh {
    let mut builder = MeshBuilder::new();
    let white = builder.material(Material::of_srgb("white", [255; 3]));
    let red = builder.material(Material::of_srgb("red", [255, 0, 0]));
    sphere(&mut builder, DVec3::ZERO, 10.0, [rows, rows], white);
    sphere(&mut builder, DVec3::ZERO, inner, [24, 24], red);
    builder.finish("spheres").unwrap()
}

/// White around red from all sides: red must not show. Surfaces of hybrid nodes of several levels join without a gap,
/// also where they are close together.
#[test]
fn closed_spheres_hide_everything_inside() {
    for (rows, inner, is_hybrid) in [(64, 9.0, false), (32, 9.6, true)] {
        let mesh = nested_spheres(rows, inner);
        let data = match is_hybrid {
            true => hybrid(&mesh, 60),
            false => build(&mesh, &BuildOptions::default(), &Silent).unwrap(),
        };
        assert!(!is_hybrid || data.nodes.iter().all(|node| node.voxels() == 0));
        let file = file_of(&data);
        let (mut inner_nodes, mut mixed) = (0, 0);
        for (number, towards) in directions(24).enumerate() {
            let opacity = [Opacity::Scalar, Opacity::Six][number / 12];
            let size = [12, 40, 120, 300][number % 4];
            let distance = 0.6 + 0.4 * (number % 12) as f64;
            let view = around(&mesh, towards, distance, size);
            let (picture, _) = draw(&file, &view, &options(opacity));
            let is_red = |p: &[u8; 4]| p[0].abs_diff(p[1]) > 2;
            assert!(!picture.rgba.iter().any(is_red), "{opacity:?} {size}");
            let nodes = picture.seen.iter().filter(|&&node| node != NOTHING);
            let nodes: BTreeSet<u32> = nodes.copied().collect();
            let nodes: Vec<&Node> = nodes.into_iter().map(|n| &data.nodes[n as usize]).collect();
            inner_nodes += nodes.iter().filter(|node| !node.is_leaf()).count();
            let levels: BTreeSet<u16> = nodes.iter().map(|node| node.level).collect();
            mixed += usize::from(levels.len() > 1);
            // The outline of a ball is convex: between two pixels of a row surfaces cover all.
            for row in picture.coverage.chunks_exact(size as usize) {
                let mut covered = (0..row.len()).filter(|&x| row[x] > 0.0);
                if let (Some(first), Some(last)) = (covered.next(), covered.next_back()) {
                    let has_gap = row[first..=last].iter().any(|&cover| cover < 1.0);
                    assert!(!(is_hybrid && has_gap), "{size} pixels: {row:?}");
                }
            }
        }
        let is_mixed = inner_nodes >= 10 && (mixed >= 8 || !is_hybrid);
        assert!(is_mixed, "{inner_nodes} {mixed}");
    }
}

fn spokes(radius: f64) -> Mesh {
    shape(|builder| {
        for k in 0..24 {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 24.0);
            let side = if k % 2 == 0 { 0.1 } else { -0.1 };
            let from = DVec3::new(0.1 * cos, 0.1 * sin, side);
            let axis = DVec3::new(cos, sin, 0.0) - from;
            let (right, up) = axis.normalize().any_orthonormal_pair();
            sheet(builder, [6, 8], 0, |part, side| {
                let angle = std::f64::consts::TAU * f64::from(side % 8) / 8.0;
                let (sin, cos) = libm::sincos(angle);
                from + axis * (f64::from(part) / 6.0) + (right * cos + up * sin) * radius
            });
        }
    })
}

/// Sheets, flat or wavy, whose voxels have few probes each.
#[test]
fn sheets_have_no_pinholes() {
    let (mut count, mut holes) = (0, 0);
    for (wave, sides) in [(0.0, [40, 40]), (0.0, [40, 30]), (2.0, [40, 40])] {
        let mesh = shape(|builder| {
            sheet(builder, sides, 0, |i, j| {
                let [x, y] = [i, j].map(f64::from);
                DVec3::new(x, y, wave * libm::sin(x / 8.0) + wave * y / 8.0)
            });
        });
        let file = file_of(&build(&mesh, &BuildOptions::default(), &Silent).unwrap());
        for (size, z) in [60, 50, 40]
            .into_iter()
            .flat_map(|size| [(size, 1.0), (size, -1.0)])
        {
            let view = around(&mesh, DVec3::new(0.0, 0.1, z), 1.5, size);
            let whole = triangles(&mesh, &view, 16, None).coverage;
            let drawn = draw(&file, &view, &ViewOptions::default()).0.coverage;
            // Voxels of the edge are half empty.
            let width = size as usize;
            let is_within = |at: usize| {
                let beside = [0, 1, 2, width, 2 * width];
                beside
                    .iter()
                    .all(|&by| whole[at - by] == 1.0 && whole[at + by] == 1.0)
            };
            for at in 2 * width..whole.len() - 2 * width {
                count += usize::from(is_within(at));
                holes += usize::from(is_within(at) && drawn[at] < 0.9);
            }
        }
    }
    assert!(count > 10_000 && holes < 3, "{holes} of {count}");
}

/// Within a tenth if thinner than a voxel. Spokes of two voxels, of which some hide others, grow by less than a quarter.
#[test]
fn thin_tubes_keep_their_area() {
    for (radius, most) in [(0.003, 0.1), (0.01, 0.1), (0.03, 0.25)] {
        let mesh = spokes(radius);
        let file = file_of(&build(&mesh, &BuildOptions::default(), &Silent).unwrap());
        for size in [64, 32, 16] {
            let (mut drawn, mut expected) = ([0.0; 2], 0.0);
            for towards in directions(16) {
                let view = around(&mesh, towards, 2.0, size);
                for (sum, opacity) in drawn.iter_mut().zip([Opacity::Scalar, Opacity::Six]) {
                    *sum += area(&draw(&file, &view, &options(opacity)).0.coverage);
                }
                expected += area(&triangles(&mesh, &view, 16, None).coverage);
            }
            for drawn in drawn {
                let bias: f64 = drawn / expected - 1.0;
                assert!(bias.abs() < most, "{radius}, {size} pixels: {bias:+.3}");
            }
        }
    }
}

/// A disc on a card, with nothing around it or glass. Voxels show less of a pane from straight before it than there is, as
/// many rays cross a voxel beside the pane.
#[test]
fn rays_pass_through_holes_and_glass() {
    let share = |clear: u8| {
        let mesh = card(&disc(clear), 8, 0.0, "map_Kd a.png");
        let few = BuildOptions {
            leaf_triangles: 2,
            ..BuildOptions::default()
        };
        let file = file_of(&build(&mesh, &few, &Silent).unwrap());
        let view = around(&mesh, DVec3::Z, 4.0, 48);
        let (drawn, counts) = draw(&file, &view, &ViewOptions::default());
        assert_eq!(counts.leaves, 0);
        area(&drawn.coverage)
    };
    let whole = share(255);
    for (clear, glass, within) in [(0, 0.0, 0.1), (102, 0.4, 0.25)] {
        let (found, expected) = (share(clear) / whole, DISC + glass * (1.0 - DISC));
        let error = (found / expected - 1.0).abs();
        assert!(error < within, "{found} {expected}");
    }
}
