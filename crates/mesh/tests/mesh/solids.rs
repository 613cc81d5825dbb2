//! Solids under the rule that blends: closed surfaces hide everything inside them.

use std::fmt::Write as _;

use glam::{DQuat, DVec3, EulerRot};
use shiftvox::{Background, Camera, Coverage, Renderer, Scene, Shading, View};
use shiftvox_mesh::{Mesh, SceneOptions, Surface};

use super::shared::{ball, one_box};

/// A white shell around the same shape in red, smaller.
fn nested(mesh: &Mesh, inner: f64, turn: DQuat) -> Scene {
    let mut text = String::from("mtllib missing.mtl\n");
    for (scale, color) in [(1.0, "1 1 1"), (inner, "1 0 0")] {
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

/// The largest difference of red and green in any pixel, and its mean over the covered pixels.
fn redness(scene: &Scene, camera: &impl View, coverage: Coverage) -> (i32, f64) {
    let renderer = Renderer::new()
        .coverage(coverage)
        .shading(Shading::Flat)
        .background(Background::Color([0; 3]));
    let picture = renderer.render(scene, camera, 160, 160).unwrap();
    let seen = picture.rgba().iter().filter(|pixel| pixel[0] > 0);
    let excess = seen.map(|[r, g, ..]| i32::from(*r) - i32::from(*g));
    let excess: Vec<i32> = excess.collect();
    let mean = f64::from(excess.iter().sum::<i32>()) / excess.len().max(1) as f64;
    (excess.into_iter().fold(0, i32::max), mean)
}

#[test]
fn a_closed_surface_hides_everything_inside() {
    let tilted = DQuat::from_euler(EulerRot::XYZ, 0.3, 0.5, 0.2);
    let cube = one_box([-1.0; 3], [1.0; 3]);
    for (name, scene) in [
        ("ball", nested(&ball(48), 0.9, DQuat::IDENTITY)),
        ("cube", nested(&cube, 0.9, DQuat::IDENTITY)),
        ("tilted cube", nested(&cube, 0.9, tilted)),
    ] {
        assert!(scene.warnings()[0].contains("missing.mtl"));
        // From more than a pixel per voxel to the whole scene in a few pixels.
        for (zoom, azimuth, elevation) in [
            (1.6, 0.0, 0.0),
            (1.6, 45.0, 35.26),
            (0.8, 2.0, 3.0),
            (0.8, 140.0, -50.0),
            (0.4, 200.0, 85.0),
            (0.2, 45.0, 35.26),
            (0.2, 310.0, 60.0),
        ] {
            let fitted = Camera::fit(&scene).zoom(zoom);
            let camera = fitted.azimuth(azimuth).elevation(elevation);
            let (exact, _) = redness(&scene, &camera, Coverage::Exact);
            let (alpha, mean) = redness(&scene, &camera, Coverage::Alpha);
            assert!(
                alpha <= exact.max(8) && mean < 0.1,
                "{name}, zoom {zoom}, {azimuth}, {elevation}: {alpha} of 255, mean {mean}; exact {exact}"
            );
        }
    }
}
