//! The hybrid: decimated surfaces beside voxels in the hierarchy.

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::far::record::Node;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::{FarViewer, Opacity, ViewOptions};
use shiftvox_mesh::far::{BuildOptions, FarData, FarFile, build};
use shiftvox_mesh::generate::{Kind, generate};
use shiftvox_mesh::{Mesh, srgb_to_linear};

use super::city::file_of;
use super::file::{is_refused, with_checksums};
use super::shared::{around, difference, directions, on_threads, triangles};
use super::solid::{draw, nested_spheres};

fn hybrid(mesh: &Mesh, leaf_triangles: u32) -> FarData {
    let options = BuildOptions {
        hybrid: true,
        leaf_triangles,
        ..BuildOptions::default()
    };
    build(mesh, &options, &Silent).unwrap()
}

fn inner(data: &FarData) -> impl Iterator<Item = &Node> {
    data.nodes.iter().filter(|node| !node.is_leaf())
}

/// A solid has no voxels, and fewer triangles in coarser nodes, which stand above each other.
#[test]
fn a_solid_is_triangles_alone_and_fewer_from_level_to_level() {
    let data = hybrid(&generate(Kind::Scan, 3), 1000);
    assert!(data.nodes.iter().all(|node| node.voxels() == 0));
    let chain: Vec<&Node> = inner(&data).take(3).collect();
    let side = |node: &Node| *node.cells.iter().max().unwrap();
    assert_eq!(
        chain.iter().map(|node| side(node)).collect::<Vec<_>>(),
        [16, 32, 64]
    );
    assert_eq!([0, 1, 2].map(|n| chain[n].below().count()), [1, 1, 2]);
    let bytes = [0, 1, 2].map(|n| chain[n].drawn_bytes());
    assert!(bytes[0] < bytes[2] && bytes[1] * 2 < bytes[2], "{bytes:?}");
    assert!(chain[2].surface * 2 < data.nodes[0].triangles);
}

#[test]
fn leaves_become_voxels_and_the_house_does_not() {
    let data = hybrid(&generate(Kind::Garden, 3), 1000);
    let coarsest = &data.nodes[0];
    assert!(coarsest.voxels() > 100, "{coarsest:?}");
    assert!((10..2000).contains(&coarsest.surface), "{coarsest:?}");
    assert!(coarsest.drawn_bytes() * 10 < data.nodes.iter().map(Node::surface_bytes).sum());
}

#[test]
fn a_file_comes_back_on_any_threads() {
    let mesh = generate(Kind::Wheel, 3);
    let bytes = |threads| on_threads(threads, || encode(&hybrid(&mesh, 300)).unwrap());
    let (one, two) = (bytes(1), bytes(2));
    assert!(one == two);
    let file = FarFile::from_bytes(&one).unwrap();
    file.verify().unwrap();
    let mut surfaces = 0;
    for (number, node) in file.nodes().iter().enumerate() {
        let triangles = file.data(number).unwrap().triangles().len();
        assert_eq!(triangles, node.surface as usize);
        surfaces += usize::from(!node.is_leaf() && triangles > 0);
    }
    assert!(surfaces > 5, "{surfaces}");
}

#[test]
fn damaged_files_are_refused() {
    let bytes = encode(&hybrid(&generate(Kind::Village, 3), 500)).unwrap();
    assert!(!is_refused(&bytes));
    for place in (0..bytes.len()).step_by(997) {
        let mut damaged = bytes.clone();
        damaged[place] ^= 1 << (place % 8);
        assert!(is_refused(&damaged), "byte {place}");
    }
    // The fields of a node's surface, behind right checksums.
    for place in 128..144 {
        for flip in [0x01, 0x40] {
            let mut damaged = bytes.clone();
            damaged[128 + place] ^= flip;
            assert!(
                is_refused(&with_checksums(damaged)),
                "byte {place} of the root"
            );
        }
    }
}

/// Nodes of several levels join without a gap: through a white ball nothing shows of the red one in
/// it, nor of the red behind it, also where their surfaces are close together.
#[test]
#[ignore = "takes long"]
fn no_background_shows_between_nodes() {
    for inner in [8.0, 9.9] {
        nothing_shows_through(inner);
    }
}

/// Of a red ball of a radius in a white one of 10.
fn nothing_shows_through(inner: f64) {
    let mesh = nested_spheres(96, inner);
    let data = hybrid(&mesh, 300);
    let file = file_of(&data);
    let mut mixed = 0;
    let mut told = String::new();
    for size in [12, 40, 120, 400] {
        for (number, towards) in directions(12).enumerate() {
            let view = around(&mesh, towards, 0.6 + 0.3 * number as f64, size);
            let picture = draw(&file, &view, Opacity::Six);
            let is_red = |p: &&[u8; 4]| p[0].abs_diff(p[1]) > 2;
            let reds = picture.rgba.iter().filter(is_red).count();
            // The outline of the ball is convex: what is between two pixels of a row is covered.
            let rows = picture.coverage.chunks_exact(size as usize);
            let gaps: usize = rows
                .map(|row| {
                    let is_seen = |&cover: &f32| cover > 0.0;
                    let first = row.iter().position(is_seen);
                    let last = row.iter().rposition(is_seen);
                    let (Some(first), Some(last)) = (first, last) else {
                        return 0;
                    };
                    row[first..=last]
                        .iter()
                        .filter(|&&cover| cover < 1.0)
                        .count()
                })
                .sum();
            if reds + gaps > 0 {
                told += &format!("{inner}: {reds} red, {gaps} gaps: {size}, {towards}\n");
            }
            let level = |&node: &i32| usize::try_from(node).ok().map(|n| file.nodes()[n].level);
            let mut levels: Vec<u32> = picture.node.iter().filter_map(level).collect();
            levels.sort_unstable();
            levels.dedup();
            mixed += usize::from(levels.len() > 2);
        }
    }
    assert!(told.is_empty(), "{told}");
    assert!(mixed >= 3, "{mixed} pictures of three levels or more");
    assert!(data.nodes.iter().all(|node| node.voxels() == 0));
}

/// Decibel of a picture in linear light.
fn psnr(rgba: &[[u8; 4]], truth: &[[u8; 4]]) -> f64 {
    -20.0 * difference(rgba, truth, |byte| f64::from(srgb_to_linear(byte))).log10()
}

/// With 16 samples a picture is near the triangles', in a share of their bytes; far voxels are not nearer
/// in as few.
#[test]
#[ignore = "takes long"]
fn pictures_are_near_in_few_bytes() {
    let kinds = [
        (Kind::Scan, [(120, 36.0, 0.6), (50, 36.0, 0.12)]),
        (Kind::Garden, [(120, 34.0, 0.95), (50, 32.0, 0.5)]),
    ];
    for (kind, sizes) in kinds {
        let mesh = generate(kind, 3);
        let files = [
            hybrid(&mesh, 1000),
            build(&mesh, &BuildOptions::default(), &Silent).unwrap(),
        ];
        let whole: u64 = files[0]
            .nodes
            .iter()
            .filter(|n| n.is_leaf())
            .map(Node::surface_bytes)
            .sum();
        let files = files.map(|data| file_of(&data));
        for (size, least, share) in sizes {
            let view = around(&mesh, DVec3::new(1.0, 0.6, 0.8), 2.0, size);
            let background = Some([90, 120, 200]);
            let truth = triangles(&mesh, &view, 256, None, background);
            let [near, far] = files.each_ref().map(|file| {
                let options = ViewOptions {
                    samples_across: 4,
                    background,
                    ..ViewOptions::default()
                };
                let (picture, counts) = FarViewer::new(file).draw(&view, &options).unwrap();
                (psnr(&picture.rgba, &truth.rgba), counts.bytes)
            });
            let told = format!("{kind:?}, {size} pixels: {near:.1?}, far {far:.1?}, whole {whole}");
            assert!(near.0 > least, "{told}");
            assert!((near.1 as f64) < share * whole as f64, "{told}");
            assert!(near.0 > far.0 || near.1 < far.1, "{told}");
        }
    }
}
