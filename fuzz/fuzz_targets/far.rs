//! Any bytes as a `.far` file: rejected, or read, checked and drawn. The first byte selects whether lengths and checksums
//! are corrected first, which reaches the data behind them.

#![no_main]

#[allow(dead_code)]
#[path = "../../crates/mesh/tests/sealed/seal.rs"]
mod sealed;

use libfuzzer_sys::fuzz_target;
use shiftvox_mesh::far::FarFile;
use shiftvox_mesh::far::view::{FarViewer, Opacity, ViewOptions};
use shiftvox_mesh::raster::RasterCamera;

fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, rest)) = bytes.split_first() else {
        return;
    };
    let file = match choice & 3 {
        0 => FarFile::from_bytes(rest),
        way => match sealed::far(rest.to_vec(), way > 1) {
            Some(bytes) => FarFile::from_bytes(&bytes),
            None => return,
        },
    };
    let Ok(file) = file else {
        return;
    };
    let is_sound = file.verify().is_ok();
    let (low, high) = file.bounds();
    let size = (high - low).length();
    let forward = glam::DVec3::Z;
    let opacities = [Opacity::None, Opacity::Scalar, Opacity::Six];
    let mut viewer = FarViewer::new(&file);
    // From afar voxels are visible, from near triangles.
    for (distance, voxel_px) in [(300.0, 16.0), (0.6, 1.0)] {
        let view = RasterCamera {
            eye: (low + high) / 2.0 - forward * distance * size,
            right: glam::DVec3::X,
            up: glam::DVec3::Y,
            forward,
            focal_px: 16.0 * distance,
            width: 16,
            height: 16,
            near: 1e-6 * size,
        };
        let options = ViewOptions {
            voxel_px,
            opacity: opacities[usize::from(choice >> 2) % 3],
            culling: choice & 64 == 0,
            ..ViewOptions::default()
        };
        // A picture or an error. Culling does not change the picture of a sound file.
        let drawn = viewer.draw(&view, &options);
        let other = ViewOptions {
            culling: !options.culling,
            ..options
        };
        if let (Ok((picture, _)), Ok((again, _)), true) = (&drawn, FarViewer::new(&file).draw(&view, &other), is_sound) {
            assert_eq!(picture.rgba, again.rgba);
        }
    }
});
