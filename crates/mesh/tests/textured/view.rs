//! Pictures: the coverage of levels, any camera, the choice of level.

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::generate::{Kind, generate};
use shiftvox_mesh::raster::{RasterCamera, RasterPicture};
use shiftvox_mesh::textured::view::{
    Detail, TexturedCounts, ViewError, ViewOptions, choose, choose_grid, draw,
};
use shiftvox_mesh::textured::{Element, TexturedFile, build};

use super::scenes::{balls, built, file_of, options};
use super::shared::{difference, directions, looking, on_any_threads, plain, triangles};

fn view(eye: DVec3, target: DVec3, side: u32, fov_degrees: f64) -> RasterCamera {
    let focal_px = f64::from(side) / 2.0 / libm::tan(fov_degrees.to_radians() / 2.0);
    RasterCamera {
        near: 1e-4,
        ..looking(eye, target, [side; 2], focal_px)
    }
}

fn shown(detail: Detail) -> ViewOptions {
    ViewOptions {
        detail,
        raster: plain(1),
    }
}

fn drawn(file: &TexturedFile, view: &RasterCamera, level: u32) -> (RasterPicture, TexturedCounts) {
    draw(file, view, &shown(Detail::Level { grid: 0, level })).unwrap()
}

fn covered(picture: &RasterPicture) -> Vec<bool> {
    picture.depth.iter().map(|d| d.is_finite()).collect()
}

/// The number of pixels of `a` farther than `radius` (in rows or columns) from all of `b`.
fn beyond(a: &[bool], b: &[bool], width: usize, radius: usize) -> usize {
    let is_near = |at: usize| {
        let (x, y) = (at % width, at / width);
        let columns = x.saturating_sub(radius)..(x + radius + 1).min(width);
        let mut rows = y.saturating_sub(radius)..(y + radius + 1).min(a.len() / width);
        rows.any(|row| b[row * width..][columns.clone()].contains(&true))
    };
    (0..a.len()).filter(|&at| a[at] && !is_near(at)).count()
}

fn count(pixels: &[bool]) -> usize {
    pixels.iter().filter(|p| **p).count()
}

fn middle(file: &TexturedFile) -> DVec3 {
    let (low, high) = file.bounds();
    (low + high) * 0.5
}

#[test]
fn along_an_axis_levels_cover_the_same_as_the_mesh_within_a_texel() {
    let mesh = balls();
    let file = file_of(&built(&mesh, 16, 16, Element::Cube));
    for away in DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
        let view = view(middle(&file) + away * 4000.0, middle(&file), 300, 0.16);
        let full = covered(&triangles(&mesh, &view, 1, None, None));
        assert!(count(&full) > 10_000);
        for level in 0..=file.grid(0).levels().last() {
            let found = covered(&drawn(&file, &view, level).0);
            // Texels, perspective and rounding: 4 pixels. Faces seen edge on show as hairs.
            let hairs = beyond(&found, &full, 300, 4);
            assert!(hairs < count(&full) / 100, "{away} {level}: {hairs}");
            assert_eq!(beyond(&full, &found, 300, 4), 0, "{away} {level}");
        }
    }
}

/// Surfels are faces of cells that hold a part of the mesh.
#[test]
fn from_anywhere_levels_cover_at_most_a_cell_around_the_mesh() {
    let mesh = balls();
    let file = file_of(&built(&mesh, 16, 16, Element::Cube));
    let cell = file.grid(0).cell_grid().cell_size().length();
    let last = file.grid(0).levels().last();
    let (mut missing, mut extra, mut all) = (0, 0, 0);
    for direction in directions(12) {
        let view = view(middle(&file) + direction * 22.0, middle(&file), 256, 32.0);
        let mesh = triangles(&mesh, &view, 1, None, None);
        let full = covered(&mesh);
        let radius = (cell * view.focal_px / 14.0).ceil() as usize + 1;
        for level in 0..last {
            let found = covered(&drawn(&file, &view, level).0);
            assert_eq!(beyond(&found, &full, 256, radius), 0, "{direction} {level}");
            if level == 0 {
                missing += beyond(&full, &found, 256, 0);
                extra += beyond(&found, &full, 256, 0);
                all += count(&full);
            }
        }
        let (picture, counts) = drawn(&file, &view, last);
        assert!(picture.depth == mesh.depth && picture.rgba == mesh.rgba);
        assert_eq!((counts.surfels, counts.voxels), (0, 0));
    }
    // The bias that spec/textured.md states for this scene.
    let shares = [missing, extra].map(|n| n as f64 / all as f64);
    assert!(shares[0] < 0.22 && shares[1] < 0.51, "{shares:?}");
}

#[test]
fn any_camera_is_drawn_the_same_on_any_number_of_threads() {
    let file = file_of(&built(&balls(), 16, 4, Element::Cube));
    let (low, high) = file.bounds();
    let corner = file.grid(0).cell_grid().corner([4, 4, 4]);
    let beside = DVec3::new(low.x, high.y, low.z - 5.0);
    // From inside, on a corner of cells, behind, and grazing a face; and whether anything is seen.
    for (eye, target, is_seen) in [
        (middle(&file), low, true),
        (corner, high, true),
        (high + DVec3::ONE, high + DVec3::splat(5.0), false),
        (beside, beside.with_z(high.z), true),
    ] {
        // A narrow view may miss the balls, and in a wide one they may be too small.
        for (fov, is_checked) in [(1.0, false), (60.0, true), (170.0, false)] {
            let view = view(eye, target, 96, fov);
            for level in [0, 1, 9] {
                let picture = on_any_threads(|| drawn(&file, &view, level).0);
                let seen = covered(&picture).contains(&true);
                assert!(!is_checked || seen == is_seen, "{eye} {level}");
                let is_depth = |d: &f32| *d >= view.near as f32;
                assert!(picture.depth.iter().all(is_depth), "{eye} {level}");
            }
        }
    }
}

#[test]
fn levels_are_chosen_by_the_size_of_texels() {
    let grids = options(&[2, 4, 8, 16, 32], 8, Element::Cube);
    let file = file_of(&build(&balls(), &grids, &Silent).unwrap());
    let centre = middle(&file);
    let direction = DVec3::new(1.0, 0.7, -0.5).normalize();
    let mut faces_before = u64::MAX;
    for away in [12.0, 20.0, 40.0, 80.0, 160.0, 320.0, 1000.0, 4000.0] {
        let view = view(centre + direction * away, centre, 256, 40.0);
        let auto = shown(Detail::Auto { texel_px: 1.0 });
        let chosen = draw(&file, &view, &auto).unwrap().1.choice;
        let is_fine = chosen.texel_px <= 1.0 && chosen.behind_px <= 1.0;
        let row = file.grid(chosen.grid).levels().row(chosen.level);
        assert!(is_fine && row.faces <= faces_before, "{away}: {chosen:?}");
        faces_before = row.faces;
        // The coarsest grid from afar.
        assert!(away < 4000.0 || chosen.grid == 0);
    }
    // From near, only primitives.
    let near = choose(&file, &view(centre, DVec3::ZERO, 256, 40.0), 1.0);
    assert_eq!(near.texel_px, 0.0);
    assert_eq!(near.level, file.grid(near.grid).levels().last());
    let far = view(centre + DVec3::X * 1e5, centre, 64, 40.0);
    let near = view(centre + DVec3::X * 6.0, centre, 2048, 40.0);
    assert_eq!(
        [&far, &near].map(|view| choose_grid(&file, view, 0)),
        [0, 4]
    );
    let with = |detail| draw(&file, &far, &shown(detail));
    let (_, counts) = with(Detail::Level { grid: 1, level: 77 }).unwrap();
    assert_eq!(counts.choice.level, file.grid(1).levels().last());
    let none = with(Detail::Level { grid: 5, level: 0 });
    assert!(matches!(none, Err(ViewError::Grid(5, 5))));
    for texel_px in [0.0, -1.0, f64::NAN] {
        let auto = with(Detail::Auto { texel_px });
        assert!(matches!(auto, Err(ViewError::TexelSize(_))));
    }
}

fn psnr(reference: &[[u8; 4]], picture: &[[u8; 4]]) -> f64 {
    -20.0 * libm::log10(difference(reference, picture, |b| f64::from(b) / 255.0).max(1e-5))
}

#[test]
fn the_automatic_level_is_about_as_good_as_triangles_at_one_sample() {
    let background = Some([20, 20, 30]);
    // Of a level with texels of a pixel alone, decibel.
    let mut worst_by_texels: f64 = 0.0;
    let mut with_textures = 0;
    for kind in [Kind::Village, Kind::Tree, Kind::Wheel, Kind::Garden] {
        let mesh = generate(kind, 3);
        let grids = options(&[4, 16, 64], 16, Element::Sides);
        let file = file_of(&build(&mesh, &grids, &Silent).unwrap());
        let (low, high) = mesh.bounds();
        for direction in [[0.3, 1.0, 0.2], [1.0, 0.6, 0.8], [0.05, 0.1, -1.0]] {
            for radii in [3.0, 12.0, 60.0, 400.0] {
                let away = DVec3::from_array(direction).normalize() * (high - low).length() / 2.0;
                let view = view(middle(&file) + away * radii, middle(&file), 128, 40.0);
                let [reference, one] =
                    [256, 1].map(|samples| triangles(&mesh, &view, samples, None, background).rgba);
                let drawn = |detail| {
                    let mut options = shown(detail);
                    options.raster.background = background;
                    let (picture, counts) = draw(&file, &view, &options).unwrap();
                    (psnr(&reference, &picture.rgba), counts.choice.texel_px)
                };
                let rival = psnr(&reference, &one);
                let (auto, texel) = drawn(Detail::Auto { texel_px: 1.0 });
                // From 48 dB on the error is less than a step of a byte.
                let is_good = auto > (rival - 1.0).min(48.0);
                assert!(is_good, "{kind:?} {direction:?} {radii}: {auto} {rival}");
                with_textures += u32::from(texel > 0.0);
                let (coarse, texel) = drawn(Detail::Level { grid: 2, level: 0 });
                if texel <= 1.0 {
                    worst_by_texels = worst_by_texels.max(rival - coarse);
                }
            }
        }
    }
    assert!(worst_by_texels > 3.0 && with_textures > 0);
}
