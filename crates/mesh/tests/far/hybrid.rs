//! The hybrid: decimated surfaces beside voxels in the hierarchy.

use std::collections::BTreeSet;

use shiftvox::graph::Silent;
use shiftvox_mesh::Mesh;
use shiftvox_mesh::far::record::Node;
use shiftvox_mesh::far::view::Opacity;
use shiftvox_mesh::far::{BuildOptions, FarData, build};
use shiftvox_mesh::generate::{Kind, generate};

use super::city::file_of;
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
fn leaves_of_trees_become_voxels_and_a_house_stays_a_surface() {
    let data = hybrid(&generate(Kind::Garden, 3), 1000);
    let coarsest = &data.nodes[0];
    assert!(coarsest.voxels() > 100, "{coarsest:?}");
    assert!((10..2000).contains(&coarsest.surface), "{coarsest:?}");
    let whole: u64 = data.nodes.iter().map(Node::surface_bytes).sum();
    assert!(coarsest.drawn_bytes() * 10 < whole);
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
