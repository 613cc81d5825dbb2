//! Any bytes as a `.tvx` file: rejected, or read, checked and drawn. The first byte selects whether lengths, checksums and
//! the box are corrected first, which reaches the data behind them.

#![no_main]

#[allow(dead_code)]
#[path = "../../crates/mesh/tests/sealed/seal.rs"]
mod sealed;

use libfuzzer_sys::fuzz_target;
use shiftvox_mesh::raster::{Pattern, RasterCamera, Samples};
use shiftvox_mesh::textured::TexturedFile;
use shiftvox_mesh::textured::view::{Detail, ViewOptions, draw};

fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, rest)) = bytes.split_first() else {
        return;
    };
    let file = match choice & 3 {
        0 => TexturedFile::from_bytes(rest),
        way => match sealed::tvx(rest.to_vec(), way > 1) {
            Some(bytes) => TexturedFile::from_bytes(&bytes),
            None => return,
        },
    };
    let Ok(file) = file else {
        return;
    };
    let _ = file.verify();
    for grid in (0..file.grids()).map(|number| file.grid(number)) {
        // The last level shows every primitive and no voxel.
        let rows = grid.levels().rows();
        let last = rows.last().copied();
        assert_eq!(last.map(|row| (row.primitives, row.voxels, row.surfels)), Some((file.primitives().len() as u64, 0, 0)));
        assert!(rows.windows(2).all(|w| w[0].primitives <= w[1].primitives && w[0].voxels >= w[1].voxels));
        for voxel in 0..grid.voxels().len() {
            assert!(!grid.list(voxel).is_empty());
        }
    }
    let (low, high) = file.bounds();
    let size = (high - low).length();
    let forward = glam::DVec3::Z;
    let view = RasterCamera {
        eye: (low + high) / 2.0 - forward * 2.0 * size,
        right: glam::DVec3::X,
        up: glam::DVec3::Y,
        forward,
        focal_px: 16.0,
        width: 16,
        height: 16,
        near: 1e-6 * size,
    };
    let Ok(samples) = Samples::new(4, Pattern::Regular) else {
        return;
    };
    for detail in [
        Detail::Auto { texel_px: 1.0 },
        Detail::Level {
            grid: usize::from(choice >> 5),
            level: u32::from(choice >> 2 & 7),
        },
    ] {
        let options = ViewOptions {
            detail,
            samples,
            light: None,
            background: None,
        };
        // A picture or an error.
        let _ = draw(&file, &view, &options);
    }
});
