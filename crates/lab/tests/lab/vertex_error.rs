//! How far the image-order paper's screen-space midpoints are from exact projection.
//!
//! A perspective projection keeps lines but not midpoints. Here a cube's lattice of vertices is
//! projected exactly for the first levels. Then it is halved on the screen, with floor midpoints in
//! fixed point, as the machine does with `--cage corners`. The arithmetic is independent of the
//! machine's: it works on whole lattices, not on eight corners.

use glam::DVec3;
use shiftvox::graph::Placement;
use shiftvox::machine::{Cage, cages_along};
use shiftvox::project::{Camera, FrameSetup, SetupOptions};

const HALF_DIAGONAL: f64 = 0.866_025_403_784_438_6;

/// Four views of the unit cube, 1024 x 1024, with its centre in the middle. Three are in direction
/// (1, 0.9, 0.6), from 1.5, 4 and 16 sides away, counted from half a side off the centre. A sphere
/// around the cube fills their field of view. The fourth is 0.3 sides before a face, seven eighths
/// along its width and at half its height, and has 60 degrees.
fn views() -> [Camera; 4] {
    let centre = DVec3::splat(0.5);
    let camera = |eye: DVec3, fov_degrees: f64| Camera {
        eye,
        target: centre,
        up: DVec3::Z,
        fov_degrees,
        width: 1024,
        height: 1024,
    };
    let direction = DVec3::new(1.0, 0.9, 0.6).normalize();
    let away = |away: f64| {
        let fov = 2.0 * (HALF_DIAGONAL / away).atan();
        camera(centre + direction * (away + 0.5), fov.to_degrees())
    };
    let near = camera(DVec3::new(0.875, -0.3, 0.5), 60.0);
    [away(1.5), away(4.0), away(16.0), near]
}

/// The paper's machine on a unit cube of `2^depth` voxels a side.
fn set_up(camera: &Camera, depth: u32) -> FrameSetup {
    let placement = Placement {
        voxel_size: 0.5f64.powi(depth as i32),
        ..Placement::default()
    };
    FrameSetup::new(camera, &placement, depth, &SetupOptions::paper()).unwrap()
}

/// All `(cells + 1)^3` points of a lattice, x slowest, z fastest.
fn points(cells: i64) -> impl Iterator<Item = [i64; 3]> {
    let side = move || 0..=cells;
    side().flat_map(move |x| side().flat_map(move |y| side().map(move |z| [x, y, z])))
}

/// Exact pixel positions of the vertices of the finest lattice.
fn exact(camera: &Camera, depth: u32) -> Vec<[f64; 2]> {
    let axes = camera.axes().unwrap();
    let cells = 1i64 << depth;
    let project = |point: [i64; 3]| {
        let offset = DVec3::from(point.map(|c| c as f64 / cells as f64)) - camera.eye;
        let depth = offset.dot(axes.forward);
        assert!(depth > 0.0, "a part of the cube is not before the eye");
        let x = f64::from(camera.width) / 2.0 + axes.focal_px * offset.dot(axes.right) / depth;
        let y = f64::from(camera.height) / 2.0 - axes.focal_px * offset.dot(axes.up) / depth;
        [x, y]
    };
    points(cells).map(project).collect()
}

/// Screen positions of the vertices of the finest lattice: projected down to a level, halved below.
fn held(setup: &FrameSetup, exact_levels: u32) -> Vec<[i64; 2]> {
    let bits = setup.levels + setup.format.frac();
    let step = 1i64 << (setup.depth - exact_levels);
    let project = |point: [i64; 3]| {
        let clip = [0, 1, 2].map(|c| {
            let along =
                (0..3).map(|k| i128::from(point[k] * step) * i128::from(setup.edge_clip[k][c]));
            i128::from(setup.origin_clip[c]) + along.sum::<i128>()
        });
        [clip[0], clip[1]].map(|x| i64::try_from((x << bits).div_euclid(clip[2])).unwrap())
    };
    let mut cells = 1usize << exact_levels;
    let mut vertices: Vec<[i64; 2]> = points(cells as i64).map(project).collect();
    for _ in exact_levels..setup.depth {
        (cells, vertices) = (2 * cells, halved(cells, &vertices));
    }
    vertices
}

/// Twice as many cells a side: floor midpoints along x, then y, then z.
fn halved(cells: usize, coarse: &[[i64; 2]]) -> Vec<[i64; 2]> {
    let side = 2 * cells + 1;
    let mut fine = vec![[0; 2]; side * side * side];
    for (vertex, point) in coarse.iter().zip(points(cells as i64)) {
        let [x, y, z] = point.map(|c| 2 * c as usize);
        fine[(x * side + y) * side + z] = *vertex;
    }
    let strides = [side * side, side, 1];
    for axis in 0..3 {
        for point in points(side as i64 - 1) {
            let point = point.map(|c| c as usize);
            // Along this axis odd places are new; along later axes only even ones exist yet.
            if point[axis] % 2 == 0 || point[axis + 1..].iter().any(|c| c % 2 == 1) {
                continue;
            }
            let at: usize = (0..3).map(|k| point[k] * strides[k]).sum();
            let (a, b) = (fine[at - strides[axis]], fine[at + strides[axis]]);
            fine[at] = [0, 1].map(|c| (a[c] + b[c]) >> 1);
        }
    }
    fine
}

/// Worst and mean error in pixels of a lattice with so many exact levels.
fn errors(camera: &Camera, depth: u32, exact_levels: u32) -> (f64, f64) {
    let setup = set_up(camera, depth);
    let unit = 0.5f64.powi(setup.format.frac() as i32);
    let held = held(&setup, exact_levels);
    let off = held.iter().zip(exact(camera, depth)).map(|(held, exact)| {
        let [x, y] = [0, 1].map(|c| held[c] as f64 * unit - exact[c]);
        x.hypot(y)
    });
    let off: Vec<f64> = off.collect();
    let worst = off.iter().copied().fold(0.0, f64::max);
    (worst, off.iter().sum::<f64>() / off.len() as f64)
}

/// By view: worst and mean error in pixels with 0 to 4 exact levels of 5, as published. The cameras
/// were not, so the comparison has a tolerance.
const PUBLISHED: [[f64; 10]; 4] = [
    [42.0, 12.5, 14.0, 3.6, 4.3, 0.93, 1.2, 0.26, 0.31, 0.08],
    [17.0, 6.4, 4.9, 1.7, 1.3, 0.44, 0.35, 0.12, 0.09, 0.04],
    [4.5, 2.0, 1.2, 0.5, 0.30, 0.13, 0.08, 0.04, 0.02, 0.01],
    [656.0, 204.0, 386.0, 53.0, 190.0, 13.0, 77.0, 3.3, 27.0, 0.7],
];

/// Half a unit of the last published digit.
fn rounding(published: f64) -> f64 {
    match published {
        10.0.. if published.fract() == 0.0 => 0.5,
        0.5.. => 0.05,
        _ => 0.005,
    }
}

#[test]
fn the_published_table_is_reproduced() {
    for (view, published) in views().iter().zip(PUBLISHED) {
        let mut before = f64::INFINITY;
        for (exact_levels, published) in (0..).zip(published.chunks(2)) {
            let found = errors(view, 5, exact_levels);
            for (is, &was) in [found.0, found.1].into_iter().zip(published) {
                let beyond = ((is - was).abs() - rounding(was)).max(0.0) / was;
                assert!(
                    beyond <= 0.06,
                    "{view:?}, {exact_levels}: {is}, published {was}"
                );
            }
            // Each exact level divides the mean by about four.
            assert!(exact_levels == 0 || (3.0..5.0).contains(&(before / found.1)));
            before = found.1;
        }
        // With all levels exact, only the rounding of positions and view is left.
        let (worst, mean) = errors(view, 3, 3);
        assert!(worst < 4.0 / 65536.0 && mean > 0.0, "{view:?}: {worst}");
    }
}

#[test]
fn the_lattice_is_the_machines() {
    const DEPTH: u32 = 3;
    for view in views() {
        let setup = set_up(&view, DEPTH);
        for exact_levels in 0..=DEPTH {
            let vertices = held(&setup, exact_levels);
            let mut changing = setup.clone();
            changing.screen_depth[..exact_levels as usize].fill(i64::MAX);
            for cell in points(7) {
                // The way down to the cell.
                let octant = |bit: u32| {
                    let octant = cell
                        .iter()
                        .fold(0, |octant, c| octant << 1 | (c >> bit & 1));
                    octant as u8
                };
                let way: Vec<u8> = (0..DEPTH).rev().map(octant).collect();
                let cages = cages_along(&changing, &way).unwrap();
                let changed = &cages[exact_levels as usize..];
                let [Cage::Screen(_), ..] = changed else {
                    panic!("a record that may change: {cages:?}");
                };
                let [.., Cage::Screen(corners)] = changed else {
                    panic!("{cages:?}");
                };
                for corner in 0..8 {
                    let [x, y, z] = [0, 1, 2].map(|k| cell[k] as usize + (corner >> (2 - k) & 1));
                    let held = vertices[(x * 9 + y) * 9 + z];
                    let found = [corners[0][corner], corners[1][corner]];
                    assert_eq!(
                        found, held,
                        "{view:?}, {exact_levels} exact, {cell:?}, {corner}"
                    );
                }
            }
        }
    }
}
