//! Models of the shared data: what holds of the city holds of what people made.

use std::f64::consts::TAU;
use std::path::PathBuf;

use glam::{DQuat, DVec3};
use shiftvox::drawing::mesh_view::view_of;
use shiftvox::far::store::encode;
use shiftvox::far::view::{FarViewer, Opacity, ViewOptions};
use shiftvox::far::{BuildOptions, FarFile, build};
use shiftvox::graph::Silent;
use shiftvox::mesh::LoadOptions;
use shiftvox::project::Camera;
use shiftvox::scene;

use super::city::on_threads;

/// Where a model of the shared data is, or a note on stderr that it is skipped.
fn model(name: &str) -> Option<PathBuf> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let folder = std::env::var_os("SHIFTVOX_DATA").map_or(beside, PathBuf::from);
    let path = folder.join("mesh").join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: mesh/{name} is not among the shared data");
    None
}

const FRAMES: u32 = 24;

/// Once around, from two and a half sizes away to a third of one and back, from a little above.
fn camera(file: &FarFile, frame: u32) -> Camera {
    let (low, high) = file.bounds();
    let target = (low + high) / 2.0;
    let way = TAU * f64::from(frame) / f64::from(FRAMES);
    let near = 0.5 - 0.5 * way.cos();
    let distance = (high - low).length() * (2.5 + (0.33 - 2.5) * near);
    let up = if file.y_up() { DVec3::Y } else { DVec3::Z };
    let side = if file.y_up() { DVec3::Z } else { DVec3::X };
    let turned = DQuat::from_axis_angle(up, way) * side;
    Camera {
        eye: target + (turned + up * 0.3).normalize() * distance,
        target,
        up,
        fov_degrees: 50.0,
        width: 160,
        height: 90,
    }
}

/// One and two threads build the same bytes; along a walk up to the model and away, what is left out
/// because it is hidden, answers that come late, and a budget of a quarter of the file change no pixel.
#[test]
fn nothing_but_time_changes_on_a_walk() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["kitchen.obj", "as_AC14-FZK-Haus.obj"] {
        let Some(path) = model(name) else { continue };
        let (mesh, _) = scene::read_mesh(&path, &LoadOptions::default(), &Silent).unwrap();
        let options = BuildOptions {
            rays: Some(300_000),
            leaf_triangles: 500,
            ..BuildOptions::default()
        };
        let bytes = |threads| {
            let built = || build(&mesh, &options, &Silent).unwrap();
            encode(&on_threads(threads, built)).unwrap()
        };
        let bytes = [bytes(1), bytes(2)];
        assert!(bytes[0] == bytes[1], "{name}");
        let path = folder.path().join(name).with_extension("far");
        std::fs::write(&path, &bytes[0]).unwrap();
        let file = FarFile::open(&path).unwrap();
        let budget = bytes[0].len() as u64 / 4;
        let within = FarFile::open_within(&path, budget);
        let mut hidden = 0;
        for opacity in [Opacity::None, Opacity::Six] {
            let mut viewers: Vec<(usize, FarViewer<'_>)> =
                [0, 1, 4].map(|late| (late, FarViewer::new(&file))).into();
            viewers.extend(within.iter().map(|file| (0, FarViewer::new(file))));
            for frame in 0..FRAMES {
                let view = view_of(&camera(&file, frame), file.bounds()).unwrap();
                let all = ViewOptions {
                    opacity,
                    culling: false,
                    ..ViewOptions::default()
                };
                let (expected, _) = FarViewer::new(&file).draw(&view, &all).unwrap();
                for (number, (late, viewer)) in viewers.iter_mut().enumerate() {
                    let culled = ViewOptions {
                        culling: true,
                        late: *late,
                        ..all
                    };
                    let (picture, counts) = viewer.draw(&view, &culled).unwrap();
                    assert!(
                        picture == expected,
                        "{name}, {opacity:?}, frame {frame}, {number}"
                    );
                    hidden += counts.hidden;
                }
            }
        }
        assert!(hidden > 100, "{name}: {hidden} nodes were hidden");
        if let Ok(within) = &within {
            let resident = within.resident().unwrap();
            assert!(resident.most_bytes <= budget, "{name}: {resident:?}");
            assert!(resident.released > 0, "{name}: {resident:?}");
        }
        eprintln!("{name}: {} bytes, {hidden} nodes hidden", bytes[0].len());
    }
}
