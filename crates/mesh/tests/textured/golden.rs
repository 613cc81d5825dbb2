//! Hashes of files, pictures and counts. The last bit of a vector product differs between processors.
#![cfg(target_arch = "x86_64")]

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox::picture::Shading;
use shiftvox::project::Camera;
use shiftvox_mesh::drawing::mesh_view::{light_of, view_of};
use shiftvox_mesh::generate::{Kind, generate};
use shiftvox_mesh::textured::store::encode;
use shiftvox_mesh::textured::view::{Erosion, ViewOptions, draw};
use shiftvox_mesh::textured::{Element, TexturedFile, build};

use super::scenes::{balls, middle, options};
use super::shared::{bytes_of, hash, on_threads, plain};

type Row = (&'static [u32], u32, Element, [[u32; 2]; 2]);

/// Grids, texels, element; hashes of files of balls and a village, and of their pictures.
const ROWS: [Row; 3] = [
    (
        &[4, 10, 16],
        5,
        Element::Cube,
        [[0x7801_07f2, 0x66af_fd7f], [0xbbbe_9a19, 0x56a5_fe56]],
    ),
    (
        &[16],
        4,
        Element::Sides,
        [[0xba7c_4cf3, 0x36bf_52e5], [0x7434_9171, 0x186b_4f44]],
    ),
    (
        &[2, 6],
        9,
        Element::Sides,
        [[0x1dc6_2ba3, 0x31f6_244a], [0xd7c5_4eb2, 0x0281_f113]],
    ),
];

/// Pictures from inside, on a corner of cells, behind, and grazing a face.
fn pictures(file: &TexturedFile) -> Vec<u8> {
    let (low, high) = file.bounds();
    let corner = file.grid(0).cell_grid().corner([1; 3]);
    let beside = DVec3::new(low.x, high.y, low.z - 5.0);
    let mut bytes = Vec::new();
    for (eye, target) in [
        (middle(file), low),
        (corner, high),
        (high + DVec3::ONE, high + DVec3::splat(5.0)),
        (beside, beside.with_z(high.z)),
    ] {
        let cells = Some(file.grid(file.grids() - 1).cell_grid().cells);
        let levels = [0, 1, 9].map(|level| Erosion::Level { level, cells });
        let auto = [0.5, 4.0].map(|texel_px| Erosion::Auto { texel_px });
        let erosions = levels.into_iter().chain(auto);
        for (erosion, fov_degrees) in erosions.zip([1.0, 60.0, 170.0].into_iter().cycle()) {
            let camera = Camera {
                up: DVec3::Y,
                ..Camera::looking(eye, target, fov_degrees, (64, 60))
            };
            let view = view_of(&camera, (low, high)).unwrap();
            let mut raster = plain(4);
            raster.light = light_of(&view, Shading::Lambert);
            let options = ViewOptions { erosion, raster };
            let (picture, counts) = draw(file, &view, &options).unwrap();
            bytes.extend(bytes_of(&picture));
            bytes.extend(format!("{view:?} {counts:?}").bytes());
        }
    }
    bytes
}

#[test]
fn files_and_pictures_have_their_hashes_on_any_number_of_threads() {
    let meshes = [balls(), generate(Kind::Village, 3)];
    for (number, (grids, texels, element, expected)) in ROWS.into_iter().enumerate() {
        let options = options(grids, texels, element);
        let found = meshes.each_ref().map(|mesh| {
            on_threads(1 + 2 * (number % 2), || {
                let bytes = encode(&build(mesh, &options, &Silent).unwrap()).unwrap();
                let file = TexturedFile::from_bytes(&bytes).unwrap();
                file.verify().unwrap();
                [hash(&bytes), hash(&pictures(&file))]
            })
        });
        assert_eq!(found, expected, "{grids:?}: {found:#x?}");
    }
}
