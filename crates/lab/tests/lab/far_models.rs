//! Models of the shared data: what holds of the city holds of what people made.

use std::path::PathBuf;

use shiftvox::graph::Silent;
use shiftvox_lab::far_path::{FarPathPlan, camera};
use shiftvox_mesh::LoadOptions;
use shiftvox_mesh::drawing::mesh_view::view_of;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::{FarViewer, Opacity, ViewOptions};
use shiftvox_mesh::far::{BuildOptions, FarFile, build};

/// A model in the folder `SHIFTVOX_DATA`.
fn model(name: &str) -> PathBuf {
    let folder =
        std::env::var_os("SHIFTVOX_DATA").expect("SHIFTVOX_DATA names a folder with mesh/");
    PathBuf::from(folder).join("mesh").join(name)
}

/// Does `work` on so many threads.
fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(work)
}

/// One and two threads build the same bytes; along a walk up to the model and away, what is left out
/// because it is hidden, answers that come late, and a budget of a quarter of the file change no pixel.
#[test]
#[ignore = "needs the folder SHIFTVOX_DATA"]
fn nothing_but_time_changes_on_a_walk() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["as_AC14-FZK-Haus.obj"] {
        let path = model(name);
        let (mesh, _) =
            shiftvox_mesh::open::read_mesh(&path, &LoadOptions::default(), &Silent).unwrap();
        let options = BuildOptions {
            rays: Some(150_000),
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
        let plan = FarPathPlan {
            frames: 10,
            size: (160, 90),
            voxel_px: 1.0,
            opacities: Vec::new(),
            culling: true,
            runs: 1,
        };
        let mut hidden = 0;
        for opacity in [Opacity::None, Opacity::Six] {
            let mut viewers: Vec<(usize, FarViewer<'_>)> =
                [0, 1, 4].map(|late| (late, FarViewer::new(&file))).into();
            viewers.extend(within.iter().map(|file| (0, FarViewer::new(file))));
            for frame in 0..plan.frames {
                let view = view_of(&camera(&file, frame, &plan), file.bounds()).unwrap();
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
        assert!(hidden > 40, "{name}: {hidden} nodes were hidden");
        if let Ok(within) = &within {
            let resident = within.resident().unwrap();
            assert!(resident.most_bytes <= budget, "{name}: {resident:?}");
            assert!(resident.released > 0, "{name}: {resident:?}");
        }
        eprintln!("{name}: {} bytes, {hidden} nodes hidden", bytes[0].len());
    }
}
