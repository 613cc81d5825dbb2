//! Hashes of files, pictures and counts of work. The last bit of a vector product differs between processors.
#![cfg(target_arch = "x86_64")]

use shiftvox::graph::Silent;
use shiftvox_mesh::far::record::RECORD_BYTES;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::{Opacity, ViewOptions};
use shiftvox_mesh::far::{BuildOptions, FarFile, build};
use shiftvox_mesh::generate::{Kind, generate};

use super::city::{city, draw, lit, options, view};
use super::shared::{hash, on_threads};

type Build = (bool, Option<u64>, u32, u32, [u32; 2]);

/// Hybrid, rays, grid, leaf triangles; hashes of the city and a village.
const FILES: [Build; 4] = [
    (false, Some(60_000), 24, 60, [0x7789_a3d1, 0x97a8_6322]),
    (false, None, 16, 300, [0x91a2_698f, 0x3bc0_b2a9]),
    (true, Some(60_000), 24, 200, [0xd486_a4be, 0x70c9_3d0c]),
    (true, None, 16, 300, [0x9825_b7ef, 0xa25f_24b0]),
];

/// Distance, height, voxel size, samples across, opacities, hash.
const PICTURES: [(f64, f64, f64, u32, Opacity, u32); 6] = [
    (60.0, 0.02, 1.0, 1, Opacity::Six, 0x4e36_0ac4),
    (60.0, 1.5, 3.0, 2, Opacity::Scalar, 0xe6c2_af5f),
    (110.0, 0.6, 2.0, 1, Opacity::Six, 0x9c70_ea2d),
    (110.0, 0.6, 2.0, 3, Opacity::None, 0xf0a6_49e7),
    (300.0, 0.1, 1.0, 4, Opacity::Six, 0x81dd_dba7),
    (300.0, 2.0, 6.0, 1, Opacity::Scalar, 0xf4bb_8d6d),
];

#[test]
fn files_and_pictures_have_their_hashes_on_any_number_of_threads() {
    let meshes = [city(false), generate(Kind::Village, 3)];
    let mut counts = [0; RECORD_BYTES.len()];
    let mut files = Vec::new();
    for (number, row) in FILES.into_iter().enumerate() {
        let (hybrid, rays, grid, leaf_triangles, expected) = row;
        let options = BuildOptions {
            hybrid,
            rays,
            grid,
            leaf_triangles,
            ..options()
        };
        let built = meshes.each_ref().map(|mesh| {
            let data = on_threads(1 + 2 * (number % 2), || {
                build(mesh, &options, &Silent).unwrap()
            });
            for node in &data.nodes {
                for (sum, count) in counts.iter_mut().zip(node.counts) {
                    *sum += count;
                }
            }
            encode(&data).unwrap()
        });
        let found = built.each_ref().map(|bytes| hash(bytes));
        assert_eq!(found, expected, "{hybrid} {rays:?}: {found:#x?}");
        files.push(FarFile::from_bytes(&built[0]).unwrap());
    }
    assert!(counts.iter().all(|&count| count > 10), "{counts:?}");
    for (distance, height, voxel_px, samples_across, opacity, expected) in PICTURES {
        let view = view(30.0, height, distance, 96);
        let mut bytes = Vec::new();
        for background in [None, Some([240, 240, 245])] {
            let options = ViewOptions {
                samples_across,
                opacity,
                background,
                ..lit(&view, voxel_px)
            };
            for file in &files {
                let (picture, counts) = draw(file, &view, &options);
                bytes.extend(picture.rgba.as_flattened());
                let reals = picture.depth.iter().chain(&picture.coverage);
                bytes.extend(reals.flat_map(|real| real.to_le_bytes()));
                bytes.extend(picture.seen.iter().flat_map(|node| node.to_le_bytes()));
                bytes.extend(format!("{counts:?}").bytes());
            }
        }
        let found = hash(&bytes);
        assert_eq!(found, expected, "{distance} {height}: {found:#x}");
    }
}
