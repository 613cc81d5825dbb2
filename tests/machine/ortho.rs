//! Parallel rays against a slow way to the same truth: each ray cut with each voxel in real numbers. Voxels are compared
//! where rays a 32nd of a sample beside agree, because the eye is not at infinity. The picture is moved by as much
//! (`SPEC.md`, "Frame set-up").

use glam::DVec3;
use shiftvox::{Buffer, Camera, Renderer, Scene, Voxel};

use crate::scenes::{Dice, up_of};

const SIDE: f64 = 12.0;
const SIZE: [u32; 2] = [48, 31];

/// The voxel that a ray meets first, from minus infinity on, and where.
fn first(voxels: &[DVec3], from: DVec3, along: DVec3) -> Option<(usize, f64)> {
    let met = |(i, low): (usize, &DVec3)| {
        let [a, b] = [*low, *low + DVec3::ONE].map(|corner| (corner - from) / along);
        let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
        (enter < leave).then_some((i, enter))
    };
    let met = voxels.iter().enumerate().filter_map(met);
    met.min_by(|a, b| a.1.total_cmp(&b.1))
}

#[test]
fn parallel_rays_see_the_voxels_and_depths_of_real_numbers() {
    let mut dice = Dice::new(39);
    let (mut compared, mut seen) = (0, 0);
    for round in 0..60 {
        let voxels: Vec<DVec3> = (0..150).map(|_| dice.point(0.0, SIDE).floor()).collect();
        let scene = Scene::from_voxels(voxels.iter().map(|at| Voxel {
            index: at.to_array().map(|c| c as i32),
            ..Voxel::default()
        }));
        let scene = scene.unwrap();
        let (eye, target) = (dice.point(-SIDE, 2.0 * SIDE), dice.point(0.0, SIDE));
        let forward = (target - eye).normalize();
        let right = forward.cross(up_of(forward)).normalize();
        let up = right.cross(forward);
        let height = dice.between(0.3, 2.0) * SIDE;
        let camera = Camera::look_at(eye.into(), target.into()).up(up_of(forward).into());
        let renderer = Renderer::new().buffers([Buffer::Voxel, Buffer::Depth]);
        let [width, pixels] = SIZE;
        let picture = renderer.render(&scene, &camera.orthographic(height), width, pixels);
        let picture = picture.unwrap();
        let pixel = height / f64::from(pixels);
        for y in 0..pixels {
            for x in 0..width {
                let met = |by: [f64; 2]| {
                    let beside = 0.5 + 1.0 / 32.0;
                    let across = f64::from(x) + beside + by[0] - f64::from(width) / 2.0;
                    let down = f64::from(y) + beside + by[1] - f64::from(pixels) / 2.0;
                    let from = eye + (right * across - up * down) * pixel;
                    first(&voxels, from, forward)
                };
                let truth = met([0.0; 2]);
                let near = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
                let near = near.map(|by| met(by.map(|b: f64| b / 32.0)));
                let place = |met: Option<(usize, f64)>| met.map(|(i, _)| voxels[i]);
                if near.iter().any(|&near| place(near) != place(truth)) {
                    continue;
                }
                compared += 1;
                let at = (y * width + x) as usize;
                let [i, j, k, level] = picture.voxels().unwrap()[at];
                let Some((expected, depth)) = truth else {
                    assert_eq!(level, -1, "round {round}, {x}, {y}");
                    continue;
                };
                seen += 1;
                let found = DVec3::new(f64::from(i), f64::from(j), f64::from(k));
                assert_eq!(found, voxels[expected], "round {round}, {x}, {y}");
                let found = f64::from(picture.depth().unwrap()[at]);
                let apart = near.iter().flatten().map(|near| (near.1 - depth).abs());
                let most = apart.fold(1e-5, f64::max);
                assert!(
                    (found - depth).abs() <= most,
                    "round {round}, {x}, {y}: {found}, {depth}"
                );
            }
        }
    }
    assert!(
        compared > 60 * 31 * 48 * 9 / 10 && seen > compared / 5,
        "{compared}, {seen}"
    );
}

/// Pictures of one voxel per pixel, also where the samples lie on borders of voxels.
#[test]
fn at_one_voxel_per_pixel_each_column_has_a_pixel() {
    for (across, size) in [(5, 16), (5, 17), (4, 5), (7, 64), (16, 33), (64, 64)] {
        let plate = (0..across * across).map(|i| Voxel {
            index: [i % across, 3, i / across],
            ..Voxel::default()
        });
        let scene = Scene::from_voxels(plate).unwrap();
        let middle = f64::from(across) / 2.0;
        let camera = Camera::look_at([middle, -9.0, middle], [middle, 3.5, middle]);
        let camera = camera.orthographic(f64::from(size));
        let renderer = Renderer::new().buffers([Buffer::Voxel]);
        let picture = renderer.render(&scene, &camera, size, size).unwrap();
        let voxels = picture.voxels().unwrap();
        let mut seen: Vec<[i32; 2]> = voxels
            .iter()
            .filter(|voxel| voxel[3] >= 0)
            .map(|voxel| [voxel[0], voxel[2]])
            .collect();
        let drawn = seen.len();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(
            [drawn, seen.len()],
            [(across * across) as usize; 2],
            "{across} in {size}"
        );
    }
}
