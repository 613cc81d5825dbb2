//! Far voxels along a walk: neither threads, occlusion, latency nor a memory budget changes a pixel.

use glam::{DAffine3, DQuat, DVec3};
use shiftvox::graph::Silent;
use shiftvox::project::Camera;
use shiftvox_mesh::drawing::mesh_view::view_of;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::{FarViewer, Opacity, ViewOptions};
use shiftvox_mesh::far::{BuildOptions, FarFile, build};
use shiftvox_mesh::{Instances, generate};

const FRAMES: u32 = 10;

/// The camera of a frame of Wagner et al. 2007, Fig. 5: once around, from two and a half sizes away
/// to a third of one and back, from a little above.
fn camera(file: &FarFile, frame: u32) -> Camera {
    let (low, high) = file.bounds();
    let target = (low + high) / 2.0;
    let size = (high - low).length();
    let way = f64::from(frame) / f64::from(FRAMES);
    let near = 0.5 - 0.5 * (std::f64::consts::TAU * way).cos();
    let distance = size * (2.5 + (0.33 - 2.5) * near);
    let up = if file.settings.y_up {
        DVec3::Y
    } else {
        DVec3::Z
    };
    let side = if file.settings.y_up {
        DVec3::Z
    } else {
        DVec3::X
    };
    let turned = DQuat::from_axis_angle(up, std::f64::consts::TAU * way) * side;
    Camera {
        eye: target + (turned + up * 0.3).normalize() * distance,
        target,
        up,
        fov_degrees: 50.0,
        width: 160,
        height: 90,
    }
}

#[test]
fn only_times_change_on_a_walk() {
    // Blocks of houses behind, beside and above each other.
    let (kind, seed) = generate::parse("mesh:village,seed=1").unwrap();
    let village = generate::generate(kind, seed);
    let (low, high) = village.bounds();
    let places = (0..27).map(|at| {
        let steps = DVec3::new(f64::from(at % 3), f64::from(at / 3 % 3), f64::from(at / 9));
        DAffine3::from_translation(steps * (high - low))
    });
    let mesh = Instances::new(village, places.collect());
    let options = BuildOptions {
        rays: Some(200_000),
        leaf_triangles: 500,
        ..BuildOptions::default()
    };
    let bytes = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let built = || build(&mesh, &options, &Silent).unwrap();
        encode(&pool.build().unwrap().install(built)).unwrap()
    });
    assert!(bytes[0] == bytes[1], "two threads build other bytes");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("village.far");
    std::fs::write(&path, &bytes[0]).unwrap();
    let file = FarFile::open(&path).unwrap();
    let budget = bytes[0].len() as u64 / 4;
    let within = FarFile::open_within(&path, budget);
    let mut hidden = 0;
    for opacity in [Opacity::None, Opacity::Six] {
        let mut viewers = vec![FarViewer::new(&file)];
        viewers.extend(within.iter().map(FarViewer::new));
        for frame in 0..FRAMES {
            let view = view_of(&camera(&file, frame), file.bounds()).unwrap();
            let all = ViewOptions {
                opacity,
                culling: false,
                ..ViewOptions::default()
            };
            let (expected, _) = FarViewer::new(&file).draw(&view, &all).unwrap();
            for (number, viewer) in viewers.iter_mut().enumerate() {
                let culled = ViewOptions {
                    culling: true,
                    ..all
                };
                let (picture, counts) = viewer.draw(&view, &culled).unwrap();
                assert!(picture == expected, "{opacity:?}, {frame}, {number}");
                hidden += counts.hidden;
            }
        }
    }
    assert!(hidden > 0, "no node was hidden");
    if let Ok(within) = &within {
        let resident = within.resident().unwrap();
        assert!(resident.most_bytes <= budget, "{resident:?}");
        assert!(resident.released > 0, "{resident:?}");
    }
}
