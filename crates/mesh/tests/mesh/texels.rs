//! Textures and opacities in pictures and voxels, against colours and areas by hand.

use std::f64::consts::PI;
use std::fs;

use glam::DVec3;
use image::{Rgba, RgbaImage};
use shiftvox::graph::{Silent, sixteenths};
use shiftvox_mesh::open::read_mesh;
use shiftvox_mesh::raster::RasterPicture;
use shiftvox_mesh::{ColorSpace, Mesh, linear_to_srgb, srgb_to_linear};

use super::opacities::graph_of;
use super::shared::{DISC, bytes_of, card, disc, looking, on_threads, triangles};
use super::voxels::voxels;

/// The square seen from straight before it: so many pixels a side, and the whole picture.
fn seen(mesh: &Mesh, side: u32, samples: u32) -> RasterPicture {
    let eye = DVec3::new(0.5, 0.5, 8.0);
    let view = looking(eye, eye.with_z(0.0), [side; 2], 8.0 * f64::from(side));
    triangles(mesh, &view, samples, None)
}

/// A letter of 8 x 8 texels, in colours that are all different.
fn letter() -> RgbaImage {
    let rows = [0x00u8, 0x7c, 0x40, 0x40, 0x78, 0x40, 0x40, 0x00];
    RgbaImage::from_fn(8, 8, |x, y| {
        let is_ink = rows[y as usize] >> (7 - x) & 1 == 1;
        let (x, y) = (x as u8, y as u8);
        Rgba(if is_ink {
            [200 + x, 10 * y, 3, 255]
        } else {
            [9, 120 + 8 * x, 130 + 9 * y, 255]
        })
    })
}

fn checker() -> RgbaImage {
    RgbaImage::from_fn(64, 64, |x, y| {
        let light = if (x + y) % 2 == 0 { 255 } else { 0 };
        Rgba([light, light, light, 255])
    })
}

#[test]
fn pixels_show_texels_and_far_away_their_mean() {
    let mesh = card(&letter(), 1, 0.0, "map_Kd a.png");
    let drawn = seen(&mesh, 8, 1);
    let expected: Vec<[u8; 4]> = letter().pixels().map(|p| p.0).collect();
    assert_eq!(drawn.rgba, expected);
    // Where a texel has four pixels, these are a quarter of it off its middle.
    let drawn = seen(&card(&checker(), 1, 0.0, "map_Kd a.png"), 128, 1);
    let light = 0.75 * 0.75 + 0.25 * 0.25;
    let [light, dark] = [light, 1.0 - light].map(linear_to_srgb);
    for (at, pixel) in drawn.rgba.iter().enumerate() {
        let [x, y] = [at % 128 / 2, at / 128 / 2];
        let expected = if (x + y) % 2 == 0 { light } else { dark };
        assert_eq!(pixel[0], expected, "{x} {y}");
    }
    // Half of the light is 188.
    for samples in [1, 16] {
        let drawn = seen(&card(&checker(), 1, 0.0, "map_Kd a.png"), 8, samples);
        assert_eq!(drawn.rgba, [[188, 188, 188, 255]; 64]);
    }
    let [one, three] =
        [1, 3].map(|threads| on_threads(threads, || bytes_of(&seen(&mesh, 100, 16))));
    assert_eq!(one, three);
}

/// Stripes, seen from the side or squeezed by the texture's places: small pictures are the means of large ones.
#[test]
fn samples_are_as_long_and_as_wide_as_the_surface_shows_them() {
    let stripes = RgbaImage::from_fn(64, 64, |x, _| {
        let light = if x / 8 % 2 == 0 { 255 } else { 0 };
        Rgba([light, light, light, 255])
    });
    let error = |mesh: &Mesh, eye: DVec3, tall: u32, samples: u32| {
        let target = DVec3::new(0.5, 0.5, 0.0);
        let focal = f64::from(tall) * (eye - target).length();
        let picture = |times: u32, samples: u32| {
            let size = [tall * times; 2];
            let view = looking(eye, target, size, focal * f64::from(times));
            let drawn = triangles(mesh, &view, samples, Some([0; 3]));
            let light = drawn
                .rgba
                .into_iter()
                .map(|p| f64::from(srgb_to_linear(p[0])));
            light.collect::<Vec<f64>>()
        };
        let (coarse, fine) = (picture(1, samples), picture(16, 16));
        let squares = (0..tall * tall).map(|at| {
            let [x, y] = [at % tall, at / tall].map(|c| c * 16);
            let row = |j: u32| ((y + j) * tall * 16 + x) as usize;
            let sum: f64 = (0..16).flat_map(|j| &fine[row(j)..row(j) + 16]).sum();
            (coarse[at as usize] - sum / 256.0).powi(2)
        });
        (squares.sum::<f64>() / f64::from(tall * tall)).sqrt()
    };
    let plain = card(&stripes, 1, 0.0, "map_Kd a.png");
    let grazing = DVec3::new(0.5, -8.0, 0.7);
    let squeezed = card(&stripes, 1, 0.0, "map_Kd -s 0.02 8 a.png");
    let turned = card(&stripes, 1, 0.0, "map_Kd -s 8 0.02 a.png");
    let ahead = DVec3::new(0.5, 0.5, 8.0);
    for (mesh, eye) in [(&plain, grazing), (&squeezed, ahead), (&turned, ahead)] {
        for samples in [16, 256] {
            let off = error(mesh, eye, 12, samples);
            assert!(off < 0.01, "{off} from {eye} with {samples}");
        }
    }
}

#[test]
fn voxels_show_texels_or_their_mean() {
    // The middles of voxels are those of texels, but not of the outermost, of which half is there, and along the
    // diagonal, where two triangles meet.
    let whole = |mesh: &Mesh| {
        let mut found = voxels(mesh, 3);
        found.retain(|voxel| {
            let [x, y, _] = voxel.index;
            (x - y).abs() > 1 && [x, y].iter().all(|c| (1..7).contains(c))
        });
        assert_eq!(found.len(), 20);
        found
    };
    let mesh = card(&letter(), 1, 1.0 / 16.0, "map_Kd a.png");
    let found = on_threads(3, || whole(&mesh));
    assert_eq!(found, on_threads(1, || whole(&mesh)));
    for voxel in found {
        let [x, y, _] = voxel.index.map(|c| c as u32);
        let [r, g, b, _] = letter().get_pixel(x, 7 - y).0;
        assert_eq!(voxel.color, [r, g, b], "{x} {y}");
    }
    let grey = whole(&card(&checker(), 1, 0.0, "map_Kd a.png"));
    assert!(grey.iter().all(|voxel| voxel.color == [188; 3]));
}

#[test]
fn opacities_are_shares_of_light() {
    let plain = card(&disc(102), 1, 0.0, "map_Kd a.png\nd 0.5");
    let drawn = seen(&plain, 32, 256);
    let share = drawn.coverage.iter().map(|&c| f64::from(c)).sum::<f64>() / 1024.0;
    assert!(
        (share - 0.5 * (DISC + 0.4 * (1.0 - DISC))).abs() < 0.002,
        "{share}"
    );
    let middle = 16 * 32 + 16;
    assert_eq!(drawn.rgba[middle], [255, 128, 0, 128]);
    // The brightness of a picture without opacities.
    let grey = RgbaImage::from_pixel(4, 4, Rgba([102, 0, 0, 255]));
    let drawn = seen(&card(&grey, 1, 0.0, "Kd 0 1 0\nmap_d a.png"), 4, 1);
    assert_eq!(drawn.rgba, [[0, 255, 0, 102]; 16]);
}

#[test]
fn of_layers_the_front_one_counts_first() {
    let folder = tempfile::tempdir().unwrap();
    let mtl = "newmtl red\nKd 1 0 0\nd 0.5\nnewmtl green\nKd 0 1 0\nd 0.5\nnewmtl blue\nKd 0 0 1\n\
        newmtl card\nmap_Kd -clamp on a.png\n";
    fs::write(folder.path().join("a.mtl"), mtl).unwrap();
    let square = |z: f64, name: &str| {
        format!("usemtl {name}\nv 0 0 {z}\nv 1 0 {z}\nv 1 1 {z}\nv 0 1 {z}\nf -4 -3 -2 -1\n")
    };
    // Out of order, and red has two sides.
    let squares = [(0.0, "green"), (-1.0, "blue"), (0.1, "red"), (0.1, "red")];
    let squares: String = squares.map(|(z, name)| square(z, name)).concat();
    let mesh_of = |text: String| {
        let path = folder.path().join("a.obj");
        fs::write(&path, "mtllib a.mtl\n".to_owned() + &text).unwrap();
        read_mesh(&path, ColorSpace::default(), None, &Silent)
            .unwrap()
            .0
    };
    let drawn = seen(&mesh_of(squares), 4, 4);
    // Half red, a quarter green, a quarter blue.
    let [half, quarter] = [0.5, 0.25].map(linear_to_srgb);
    assert_eq!(drawn.rgba[5], [half, quarter, quarter, 255]);
    // The opaque part of a card, too, lies on a wall in its plane.
    let mut picture = RgbaImage::from_pixel(2, 2, Rgba([255, 255, 0, 255]));
    picture.put_pixel(1, 1, Rgba([0; 4]));
    picture.save(folder.path().join("a.png")).unwrap();
    let card = "usemtl card\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf -4/1 -3/2 -2/3 -1/4\n";
    let mesh = mesh_of(square(0.0, "blue") + card);
    let drawn = seen(&mesh, 4, 1);
    let corners = [0, 15].map(|pixel| drawn.rgba[pixel]);
    assert_eq!(corners, [[255, 255, 0, 255], [0, 0, 255, 255]]);
    // A voxel shows the mean of both.
    let mut voxels = voxels(&mesh, 3).into_iter();
    let voxel = voxels.find(|voxel| voxel.index[..2] == [1, 6]);
    assert_eq!(voxel.map(|voxel| voxel.color), Some([188; 3]));
}

#[test]
fn voxels_have_holes() {
    let mesh = card(&disc(0), 1, 0.0, "map_Kd a.png");
    let found = voxels(&mesh, 6);
    let radius = |index: [i32; 3]| {
        let [x, y] = [0, 1].map(|k| f64::from(index[k]) - 31.5);
        x.hypot(y) / 63.0
    };
    let kept: Vec<f64> = found.iter().map(|voxel| radius(voxel.index)).collect();
    assert!(kept.iter().all(|&r| r < 0.375 + 1.5 / 63.0));
    let within = |r: f64| kept.iter().filter(|&&kept| kept < r).count() as f64;
    let whole = PI * (0.375 * 63.0 - 1.0f64).powi(2);
    assert!(
        within(0.375 - 1.0 / 63.0) > 0.97 * whole,
        "{}",
        within(0.36)
    );
    assert!(found.iter().all(|voxel| voxel.color == [255, 128, 0]));
    // Opacities along z keep the area, at each level.
    let (graph, _) = graph_of(&mesh, 6);
    for level in 3..=6 {
        let nodes = graph.level_start[level]..graph.level_start[level + 1];
        let opacity =
            |node: u32| f64::from(sixteenths(graph.opacity[node as usize].from_side(2, true)));
        let faces = nodes.map(opacity).sum::<f64>() / 16.0;
        let side = graph.placement.voxel_size * f64::from(1u32 << (6 - level));
        let share = faces * side * side / DISC;
        assert!((0.9..1.1).contains(&share), "{level}: {share}");
    }
}

/// The sum over a pane of the weights that `SPEC.md`, R11, blends.
#[test]
fn a_pane_stops_as_much_at_an_angle() {
    let grey = RgbaImage::from_pixel(4, 4, Rgba([102, 0, 0, 255]));
    let (graph, _) = graph_of(&card(&grey, 1, 0.0, "Kd 0 1 0\nmap_d a.png"), 6);
    let area = graph.placement.voxel_size.powi(2);
    let finest = &graph.opacity[graph.level_start[6] as usize..];
    for cosine in [1.0, 0.7, 0.5, 0.35] {
        let rest = (1.0 - cosine * cosine) / 2.0;
        let squares = [rest, rest, cosine * cosine];
        let stopped = finest.iter().map(|opacity| {
            let of = |k: usize| squares[k] * f64::from(sixteenths(opacity.from_side(k, true)));
            (0..3).map(of).sum::<f64>() / 16.0 * area
        });
        let share = stopped.sum::<f64>() / (0.4 * cosine);
        assert!((0.85..1.25).contains(&share), "{cosine}: {share}");
    }
}

#[test]
fn triangles_whose_texture_is_clear_are_left_out() {
    let all = card(&disc(1), 8, 0.0, "map_Kd a.png").triangles().len();
    let shown = card(&disc(0), 8, 0.0, "map_Kd a.png").triangles().len();
    // The disc takes 44 % of the card.
    assert!(all == 128 && (56..104).contains(&shown), "{all} {shown}");
}
