//! Solids under the rule that blends: what is closed shows nothing of what is inside it.

use std::fmt::Write as _;

use glam::{DQuat, DVec3};
use shiftvox::{Background, Camera, Coverage, Renderer, Scene, Shading, View};
use shiftvox_mesh::Mesh;
use shiftvox_mesh::SceneOptions;

use super::shapes::{ball, cuboid, soup, turned};

const WHITE: [f32; 3] = [1.0; 3];
const RED: [f32; 3] = [1.0, 0.0, 0.0];

/// Adds a mesh to a Wavefront text, each corner in a colour, scaled and turned.
fn add(text: &mut String, mesh: &Mesh, scale: f64, turn: DQuat, color: [f32; 3]) {
    let first = text.lines().filter(|line| line.starts_with('v')).count();
    let [r, g, b] = color;
    for (number, corners) in soup(mesh).iter().enumerate() {
        for corner in corners {
            let corner = DVec3::from_array(corner.map(f64::from));
            let [x, y, z] = (turn * corner * scale).to_array();
            writeln!(text, "v {x} {y} {z} {r} {g} {b}").unwrap();
        }
        let at = first + 3 * number;
        writeln!(text, "f {} {} {}", at + 1, at + 2, at + 3).unwrap();
    }
}

/// A white shell around the same in red, smaller.
fn nested(mesh: &Mesh, inner: f64, turn: DQuat) -> String {
    let mut text = String::new();
    add(&mut text, mesh, 1.0, turn, WHITE);
    add(&mut text, mesh, inner, turn, RED);
    text
}

fn scene_of(text: &str, depth: u32) -> Scene {
    let options = SceneOptions::new().mesh_depth(depth).opacities(true);
    options.from_bytes(text.as_bytes(), "nested.obj").unwrap()
}

/// The most that red exceeds green in any pixel, and the mean of it over what is covered.
fn redness(scene: &Scene, camera: &impl View, coverage: Coverage, size: u32) -> (i32, f64) {
    let renderer = Renderer::new()
        .coverage(coverage)
        .shading(Shading::Flat)
        .background(Background::Color([0; 3]));
    let picture = renderer.render(scene, camera, size, size).unwrap();
    let seen = picture.rgba().iter().filter(|pixel| pixel[0] > 0);
    let (mut most, mut sum, mut count) = (0, 0.0, 0u32);
    for [r, g, ..] in seen {
        let excess = i32::from(*r) - i32::from(*g);
        most = most.max(excess);
        sum += f64::from(excess);
        count += 1;
    }
    (most, sum / f64::from(count.max(1)))
}

#[test]
fn a_closed_surface_shows_nothing_of_what_is_inside() {
    let tilted = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.5, 0.2);
    let can = turned(&[(-1.0, 0.0), (-1.0, 0.4), (1.0, 0.4), (1.0, 0.0)], 48);
    let cube = cuboid([-1.0; 3], [1.0; 3]);
    let shapes = [
        ("ball", nested(&ball(48), 0.9, DQuat::IDENTITY)),
        ("cube", nested(&cube, 0.9, DQuat::IDENTITY)),
        ("tilted cube", nested(&cube, 0.9, tilted)),
        ("tilted can", nested(&can, 0.85, tilted)),
    ];
    for (name, text) in &shapes {
        let scene = scene_of(text, 8);
        // From a voxel of a pixel and more to the whole of it in a few.
        for zoom in [1.6, 0.8, 0.4, 0.2] {
            for (azimuth, elevation) in [
                (0.0, 0.0),
                (2.0, 3.0),
                (11.0, 7.0),
                (45.0, 35.26),
                (75.0, 20.0),
                (140.0, -50.0),
                (200.0, 85.0),
                (260.0, 1.0),
                (310.0, 60.0),
            ] {
                let camera = Camera::fit(&scene)
                    .azimuth(azimuth)
                    .elevation(elevation)
                    .zoom(zoom);
                let (exact, _) = redness(&scene, &camera, Coverage::Exact, 160);
                let (alpha, mean) = redness(&scene, &camera, Coverage::Alpha, 160);
                assert!(
                    alpha <= exact.max(8) && mean < 0.1,
                    "{name}, zoom {zoom}, from {azimuth}, {elevation}: {alpha} of 255 in a pixel, {mean} on \
                     the average; under exact {exact}"
                );
            }
        }
    }
}

#[test]
fn a_scene_keeps_the_warnings_of_its_mesh() {
    let text = "mtllib missing.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let scene = scene_of(text, 3);
    assert!(
        scene.warnings()[0].contains("missing.mtl"),
        "{:?}",
        scene.warnings()
    );
    assert!(scene.is_verified());
}
