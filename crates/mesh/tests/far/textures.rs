//! Textures and opacities of triangles in files.

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::far::record::Node;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::ViewOptions;
use shiftvox_mesh::far::{BuildOptions, FarData, FarFile, build};
use shiftvox_mesh::{Material, Mesh};

use super::city::{draw, file_of};
use super::shared::{card, disc, looking, quad, shape, sheet, triangles};

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
        let pairs = picture.rgba.iter().zip(&expected.rgba);
        let off = pairs.flat_map(|(a, b)| (0..4).map(|k| a[k].abs_diff(b[k])));
        // Steps of bytes, twice.
        assert!(off.max().unwrap() < 4, "{around}");
    }
}

#[test]
fn hybrids_keep_textures_and_glass() {
    let file = file_of(&far(&picture(0, 20), 100, true));
    let nodes = file.nodes().iter().filter(|node| node.has_grid());
    let nodes: Vec<&Node> = nodes.collect();
    let keeps = |node: &&Node| node.surface == 0 || node.is_painted == 1;
    assert!(nodes[0].surface > 0 && nodes.iter().all(keeps));
    // A pane before a wall of many quads.
    let mesh = shape(|builder| {
        let mut glass = Material::of_srgb("glass", [0, 0, 255]);
        glass.alpha = 0.5;
        let glass = builder.material(glass);
        let at = |i: u32, j: u32| DVec3::new(f64::from(i), f64::from(j), 0.0);
        sheet(builder, [30, 30], 0, at);
        let corners = [[5.0, 5.0], [25.0, 5.0], [25.0, 25.0], [5.0, 25.0]];
        quad(builder, corners.map(|[x, y]| [x, y, 2.0]), glass);
    });
    let file = file_of(&far(&mesh, 100, true));
    let coarsest = &file.nodes()[0];
    assert!(coarsest.surface > 0 && coarsest.is_painted == 1);
    let middle = DVec3::new(15.0, 15.0, 0.0);
    let view = looking(middle + DVec3::Z * 300.0, middle, [32; 2], 300.0);
    let (picture, _) = draw(&file, &view, &ViewOptions::default());
    let expected = triangles(&mesh, &view, 16, None);
    let [seen, all] = [&picture.rgba, &expected.rgba].map(|rgba| rgba[16 * 32 + 16]);
    assert!(
        (0..3).all(|k| seen[k].abs_diff(all[k]) < 30),
        "{seen:?} {all:?}"
    );
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
