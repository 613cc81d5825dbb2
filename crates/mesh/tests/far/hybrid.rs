//! The hybrid: decimated surfaces beside voxels in the hierarchy.

use std::collections::BTreeSet;

use glam::DVec3;
use shiftvox::graph::Silent;
use shiftvox_mesh::Mesh;
use shiftvox_mesh::far::record::Node;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::{Opacity, ViewOptions};
use shiftvox_mesh::far::{BuildOptions, FarData, FarFile, build};
use shiftvox_mesh::generate::{Kind, generate};

use super::city::{draw, file_of};
use super::samples::linear;
use super::shared::{around, difference, on_any_threads, triangles};
use super::solid::{check_hidden, nested_spheres};

pub(crate) fn hybrid(mesh: &Mesh, leaf_triangles: u32) -> FarData {
    let options = BuildOptions {
        hybrid: true,
        leaf_triangles,
        ..BuildOptions::default()
    };
    build(mesh, &options, &Silent).unwrap()
}

#[test]
fn a_solid_has_only_triangles_and_fewer_in_coarser_nodes() {
    let data = hybrid(&generate(Kind::Scan, 3), 1000);
    assert!(data.nodes.iter().all(|node| node.voxels() == 0));
    // The first nodes stand above each other.
    let inner = data.nodes.iter().filter(|node| !node.is_leaf());
    let chain: Vec<&Node> = inner.take(3).collect();
    let sides = chain.iter().map(|node| *node.cells.iter().max().unwrap());
    assert!(sides.eq([16, 32, 64]));
    assert!(chain.iter().map(|node| node.below().count()).eq([1, 1, 2]));
    let bytes = [0, 1, 2].map(|n| chain[n].drawn_bytes());
    assert!(bytes[0] < bytes[2] && bytes[1] * 2 < bytes[2], "{bytes:?}");
    assert!(chain[2].surface * 2 < data.nodes[0].triangles);
}

#[test]
fn leaves_of_trees_become_voxels_and_a_house_stays_a_surface() {
    let data = hybrid(&generate(Kind::Garden, 3), 1000);
    let coarsest = &data.nodes[0];
    assert!(coarsest.voxels() > 100, "{coarsest:?}");
    assert!((10..2000).contains(&coarsest.surface), "{coarsest:?}");
    let whole: u64 = data.nodes.iter().map(Node::surface_bytes).sum();
    assert!(coarsest.drawn_bytes() * 10 < whole);
}

#[test]
fn files_hold_the_surfaces_on_any_number_of_threads() {
    let mesh = generate(Kind::Wheel, 3);
    let bytes = on_any_threads(|| encode(&hybrid(&mesh, 300)).unwrap());
    let file = FarFile::from_bytes(&bytes).unwrap();
    file.verify().unwrap();
    let mut surfaces = 0;
    for (number, node) in file.nodes().iter().enumerate() {
        let triangles = file.data(number).unwrap().triangles().len();
        assert_eq!(triangles, node.surface as usize);
        surfaces += usize::from(!node.is_leaf() && triangles > 0);
    }
    assert!(surfaces > 5, "{surfaces}");
}

/// Nodes of several levels join without a gap: a white ball hides the red one inside and the background, also where
/// their surfaces are close together.
#[test]
#[ignore = "takes long"]
fn no_background_shows_between_nodes() {
    for inner in [8.0, 9.9] {
        let mesh = nested_spheres(96, inner);
        let data = hybrid(&mesh, 300);
        assert!(data.nodes.iter().all(|node| node.voxels() == 0));
        let file = file_of(&data);
        let mut mixed = 0;
        check_hidden(
            (&mesh, &file),
            |n| 0.6 + 0.3 * n,
            Opacity::Six,
            |picture, size| {
                // The outline of the ball is convex: the pixels between two pixels of a row are covered.
                for row in picture.coverage.chunks_exact(size as usize) {
                    let mut covered = row.iter().enumerate().filter(|(_, cover)| **cover > 0.0);
                    if let (Some((first, _)), Some((last, _))) =
                        (covered.next(), covered.next_back())
                    {
                        let has_gap = row[first..=last].iter().any(|&cover| cover < 1.0);
                        assert!(!has_gap, "{inner}, {size} pixels: {row:?}");
                    }
                }
                let nodes = picture.node.iter().filter_map(|&n| usize::try_from(n).ok());
                let levels: BTreeSet<u32> = nodes.map(|n| file.nodes()[n].level).collect();
                mixed += usize::from(levels.len() > 2);
            },
        );
        assert!(mixed >= 3, "{mixed} pictures of three levels or more");
    }
}

/// With 16 samples a picture is close to that of the triangles, for a share of their bytes. Far voxels are not closer
/// for as few.
#[test]
#[ignore = "takes long"]
fn hybrid_pictures_are_good_for_their_bytes() {
    let kinds = [
        (Kind::Scan, [(120, 36.0, 0.6), (50, 36.0, 0.12)]),
        (Kind::Garden, [(120, 34.0, 0.95), (50, 32.0, 0.5)]),
    ];
    for (kind, sizes) in kinds {
        let mesh = generate(kind, 3);
        let data = hybrid(&mesh, 1000);
        let leaves = data.nodes.iter().filter(|n| n.is_leaf());
        let whole: u64 = leaves.map(Node::surface_bytes).sum();
        let far = build(&mesh, &BuildOptions::default(), &Silent).unwrap();
        let files = [data, far].map(|data| file_of(&data));
        for (size, least, share) in sizes {
            let view = around(&mesh, DVec3::new(1.0, 0.6, 0.8), 2.0, size);
            let background = Some([90, 120, 200]);
            let truth = triangles(&mesh, &view, 256, None, background);
            // Decibel in linear light, and bytes.
            let [near, far] = files.each_ref().map(|file| {
                let options = ViewOptions {
                    samples_across: 4,
                    background,
                    ..ViewOptions::default()
                };
                let (picture, counts) = draw(file, &view, &options);
                let error = difference(&picture.rgba, &truth.rgba, linear);
                (-20.0 * error.log10(), counts.bytes)
            });
            let is_good = near.0 > least
                && (near.1 as f64) < share * whole as f64
                && (near.0 > far.0 || near.1 < far.1);
            assert!(
                is_good,
                "{kind:?}, {size}: {near:.1?}, far {far:.1?}, whole {whole}"
            );
        }
    }
}
