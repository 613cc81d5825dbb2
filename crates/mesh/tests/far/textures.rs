//! Textures and opacities of triangles in files.

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::Mesh;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::ViewOptions;
use shiftvox_mesh::far::{BuildOptions, FarData, FarFile, build};

use super::city::{draw, file_of};
use super::shared::{area, card, disc, looking, triangles};

/// A disc in 200 or more triangles, in half of their colour, with that opacity around it.
fn picture(around: u8, cells: u32) -> Mesh {
    let mtl = "Kd 0.5 0.5 0.5\nmap_Kd a.png\nmap_d -imfchan m a.png";
    card(&disc(around), cells, 0.0, mtl)
}

fn far(mesh: &Mesh, leaf_triangles: u32, hybrid: bool) -> FarData {
    let options = BuildOptions {
        leaf_triangles,
        hybrid,
        ..BuildOptions::default()
    };
    build(mesh, &options, &Silent).unwrap()
}

#[test]
fn triangles_of_files_have_textures_holes_and_opacities() {
    for around in [0, 100, 255] {
        let mesh = picture(around, 10);
        let middle = DVec3::new(0.5, 0.5, 0.0);
        let view = looking(middle + DVec3::Z * 2.0, middle, [250; 2], 400.0);
        let options = ViewOptions {
            samples_across: 4,
            ..ViewOptions::default()
        };
        let (picture, counts) = draw(&file_of(&far(&mesh, 1000, false)), &view, &options);
        assert_eq!(counts.opaque_voxels + counts.transparent_voxels, 0);
        let expected = triangles(&mesh, &view, 16, None);
        let [seen, all] = [&picture.coverage, &expected.coverage].map(|covers| area(covers));
        assert!(
            (seen / all - 1.0).abs() < 0.002,
            "{around}: {seen} of {all}"
        );
        // Where any of the 16 samples is stopped, it has the right colour.
        let pairs = picture.rgba.iter().zip(&expected.rgba);
        let mut pairs = pairs.filter(|(seen, _)| seen[3] > 0);
        let off = |(a, b): &(&[u8; 4], &[u8; 4])| (0..3).any(|k| a[k].abs_diff(b[k]) > 2);
        assert_eq!(pairs.find(off), None, "{around}");
    }
}

#[test]
fn decimated_surfaces_do_not_take_the_place_of_textures() {
    let file = file_of(&far(&picture(0, 20), 100, true));
    let inner = file.nodes().iter().filter(|node| !node.is_leaf());
    assert!(inner.clone().count() > 2);
    for node in inner {
        assert!(node.voxels() > 100 && node.surface == 0, "{node:?}");
    }
}

#[test]
fn damaged_textures_are_refused() {
    let mut data = far(&picture(100, 10), 50, false);
    let whole = encode(&data).unwrap();
    let file = FarFile::from_bytes(&whole).unwrap();
    file.verify().unwrap();
    let begin = (128 + 144 * file.nodes().len()).next_multiple_of(64);
    for at in [begin, begin + 8, begin + 100] {
        let mut bytes = whole.clone();
        bytes[at] ^= 1;
        let error = FarFile::from_bytes(&bytes).unwrap().verify().unwrap_err();
        assert!(error.to_string().contains("textures"), "{at}: {error}");
    }
    data.textures.clear();
    let error = file_of(&data).verify().unwrap_err();
    assert!(error.to_string().contains("at most 0 textures"), "{error}");
}
