//! Solids under the rule that blends: closed surfaces hide everything inside them.

use std::fmt::Write as _;

use glam::{DQuat, DVec3, EulerRot};
use shiftvox::{Background, Camera, Coverage, Renderer, Scene, Shading};
use shiftvox_mesh::{Mesh, SceneOptions, Surface};

use super::shared::{ball, one_box};

/// A white shell around the same shape in red, smaller.
fn nested(mesh: &Mesh, turn: DQuat) -> Scene {
    let mut text = String::new();
    for (scale, color) in [(1.0, "1 1 1"), (0.9, "1 0 0")] {
        for number in 0..mesh.len() {
            for corner in Surface::corners(mesh, number) {
                let DVec3 { x, y, z } = turn * corner * scale;
                writeln!(text, "v {x} {y} {z} {color}").unwrap();
            }
            text += "f -3 -2 -1\n";
        }
    }
    let options = SceneOptions::new().mesh_depth(8).opacities(true);
    options.from_bytes(text.as_bytes(), "nested.obj").unwrap()
}

#[test]
fn a_closed_surface_hides_everything_inside() {
    let tilted = DQuat::from_euler(EulerRot::XYZ, 0.3, 0.5, 0.2);
    let cube = one_box([-1.0; 3], [1.0; 3]);
    let renderer = Renderer::new()
        .coverage(Coverage::Alpha)
        .shading(Shading::Flat)
        .background(Background::Color([0; 3]));
    for scene in [
        nested(&ball(48), DQuat::IDENTITY),
        nested(&cube, DQuat::IDENTITY),
        nested(&cube, tilted),
    ] {
        // From more than a pixel per voxel to the whole scene in a few pixels.
        for (zoom, azimuth, elevation) in [
            (1.6, 45.0, 35.26),
            (0.8, 2.0, 3.0),
            (0.8, 140.0, -50.0),
            (0.4, 200.0, 85.0),
            (0.2, 310.0, 60.0),
        ] {
            let fitted = Camera::fit(&scene).zoom(zoom);
            let camera = fitted.azimuth(azimuth).elevation(elevation);
            let picture = renderer.render(&scene, &camera, 160, 160).unwrap();
            let seen = picture.rgba().iter().filter(|pixel| pixel[0] > 0);
            let excess: Vec<i32> = seen
                .map(|[r, g, ..]| i32::from(*r) - i32::from(*g))
                .collect();
            let (most, sum) = (excess.iter().max(), excess.iter().sum::<i32>());
            let is_white = most <= Some(&8) && sum * 10 < excess.len() as i32;
            assert!(
                is_white,
                "zoom {zoom}, {azimuth}, {elevation}: {most:?} {sum}"
            );
        }
    }
}
