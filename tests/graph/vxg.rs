//! `.vxg` files return what was stored, and damage is found or harmless.

use std::fs;

use proptest::prelude::*;
use shiftvox::graph::vxg::{self, VxgError};
use shiftvox::graph::{
    BuildOptions, Builder, Graph, LinkedGraph, MergeBy, MeshBox, Opacity, Silent, Store, Voxel,
    merge,
};
use shiftvox::scene::{FileKind, detect};

use crate::parts;

fn build(indices: &[[i32; 3]]) -> Graph {
    let mut builder = Builder::new(BuildOptions::default());
    builder.extend(indices.iter().map(|&index| Voxel {
        index,
        color: index.map(|c| (c * 37) as u8),
        normal: None,
    }));
    builder.finish(([0.5, -2.0, 1e6], 0.25), &Silent).unwrap()
}

fn small_graphs() -> Vec<Graph> {
    let tree = build(&[
        [0, 0, 0],
        [1, 0, 0],
        [1, 1, 0],
        [-5, 3, 2],
        [6, 6, 6],
        [7, 6, 6],
    ]);
    let (dag, _) = merge(&tree, MergeBy::Shape, &Silent);
    let mut cyclic = LinkedGraph::new(9);
    cyclic.add_node(
        [1, 2, 3],
        [Some(0), None, None, Some(1), None, Some(0), Some(2), None],
    );
    cyclic.add_node(
        [1, 2, 3],
        [Some(2), None, None, Some(1), None, Some(0), Some(2), None],
    );
    cyclic.add_node([9, 9, 9], [None; 8]);
    let mut airy = tree.clone();
    airy.opacity = (0..tree.len() as u8)
        .map(|i| Opacity([i, 3 * i, 0xff - i]))
        .collect::<Vec<_>>()
        .into();
    let cyclic = cyclic.build().unwrap();
    let mut of_mesh = tree.clone();
    let span = ([-1.0, 0.5, 1e6], [2.0, 0.75, 1e6 + 1.0]);
    of_mesh.placement.mesh = Some(MeshBox::new(span, [0, 1, 2, 3, 4, 5, 6, 255], true));
    vec![tree, dag, cyclic, build(&[[-3, 4, 5]]), airy, of_mesh]
}

fn bytes_of(graph: &Graph) -> Vec<u8> {
    let mut bytes = Vec::new();
    vxg::write_to(graph, &mut bytes).unwrap();
    bytes
}

/// Uses a graph of which nothing is sure in every way that the program does.
fn exercise(graph: &Graph) {
    let mut sum = 0u64;
    for cell in graph.voxels().take(3000) {
        sum += u64::from(graph.color_of(cell.node)[0]);
        sum += graph.normal_of(cell.node).decode().map_or(0, |_| 1);
        sum += graph.file_index(&cell)[0].unsigned_abs();
    }
    let _ = graph.validate();
    sum += graph.count_voxels() + graph.nodes_per_level().len() as u64;
    for by in [MergeBy::Shape, MergeBy::ShapeAndAttributes] {
        let (merged, _) = merge(graph, by, &Silent);
        sum += merged.len() as u64;
    }
    let view = graph.view();
    for node in [0, 1, graph.root, u32::MAX] {
        for octant in 0..8 {
            sum += u64::from(view.child(node, octant).unwrap_or(0));
        }
    }
    std::hint::black_box(sum);
}

#[test]
fn files_return_what_was_stored() {
    let folder = tempfile::tempdir().unwrap();
    for (i, graph) in small_graphs().iter().enumerate() {
        let path = folder.path().join(format!("{i}.vxg"));
        vxg::write(graph, &path, false).unwrap();
        assert_eq!(fs::read(&path).unwrap(), bytes_of(graph));
        let opened = vxg::open(&path).unwrap();
        opened.validate().unwrap();
        assert!(matches!(opened.color, Store::Mapped(..)) || cfg!(target_endian = "big"));
        assert_eq!(parts(&opened), parts(graph));
        assert_eq!(parts(&vxg::verify(&path).unwrap()), parts(graph));
        assert_eq!(
            parts(&vxg::from_bytes(&bytes_of(graph)).unwrap()),
            parts(graph)
        );
        assert_eq!(detect(&bytes_of(graph), 0), Some(FileKind::Vxg));
        exercise(&opened);
        // Over the file that is mapped: the map keeps the old one.
        vxg::write(&opened, &path, true).unwrap();
        assert_eq!(parts(&vxg::verify(&path).unwrap()), parts(graph));
    }
    assert_eq!(
        fs::read_dir(folder.path()).unwrap().count(),
        small_graphs().len()
    );
}

#[test]
fn nothing_is_overwritten_unasked_or_left_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vxg");
    fs::write(&path, b"precious").unwrap();
    let mut graph = small_graphs().remove(0);
    let refused = vxg::write(&graph, &path, false).unwrap_err();
    assert!(matches!(refused, VxgError::Exists(_)), "{refused}");
    assert_eq!(fs::read(&path).unwrap(), b"precious");
    // A broken graph is refused before anything is touched.
    graph.voxels += 1;
    let refused = vxg::write(&graph, &path, true).unwrap_err();
    assert!(matches!(refused, VxgError::Graph(_)), "{refused}");
    assert_eq!(fs::read(&path).unwrap(), b"precious");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    // Its folder is made, but not where a file stands.
    let nowhere = path.join("folder.vxg");
    let refused = vxg::write(&small_graphs()[0], &nowhere, false).unwrap_err();
    assert!(matches!(refused, VxgError::Io { .. }), "{refused}");
}

#[test]
fn every_truncation_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.vxg");
    for graph in small_graphs() {
        let whole = bytes_of(&graph);
        for length in 0..whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            assert!(vxg::open(&path).is_err(), "{length}");
            assert!(vxg::from_bytes(&whole[..length]).is_err(), "{length}");
        }
        let mut longer = whole.clone();
        longer.push(0);
        assert!(vxg::from_bytes(&longer).is_err());
    }
}

#[test]
fn every_damaged_byte_is_found_and_harmless() {
    let folder = tempfile::tempdir().unwrap();
    for (g, graph) in small_graphs().iter().enumerate() {
        let whole = bytes_of(graph);
        for place in 0..whole.len() {
            for flip in [0x01, 0x80, 0xff] {
                let mut bytes = whole.clone();
                bytes[place] ^= flip;
                // A name each: another's map must not change.
                let path = folder.path().join(format!("{g}-{place}-{flip}.vxg"));
                fs::write(&path, &bytes).unwrap();
                let message = vxg::verify(&path).unwrap_err().to_string();
                assert!(vxg::from_bytes(&bytes).is_err());
                let opened = vxg::open(&path);
                if place < 512 {
                    assert!(opened.is_err(), "header byte {place}");
                } else {
                    exercise(&opened.unwrap());
                    assert!(message.contains("byte "), "{message}");
                }
                fs::remove_file(&path).unwrap();
            }
        }
    }
}

/// No file gets so far, because opening compares the lengths; a graph made by hand does.
#[test]
fn child_lists_that_are_missing_read_as_no_children() {
    for graph in small_graphs() {
        for length in 0..graph.first.len() {
            let mut broken = graph.clone();
            broken.first = graph.first[..length].to_vec().into();
            assert_eq!(broken.validate().unwrap_err().array, "first");
            assert_eq!(broken.view().child(length as u32, 0), None);
            exercise(&broken);
        }
    }
}

/// Only a node that nothing leads to is on the finest level of this file, so
/// merging empties that level. Found by the fuzz target `vxg`.
#[test]
fn merging_away_a_whole_level_leaves_a_sound_graph() {
    let file = include_bytes!("../data/regressions/merge_unreachable_level.vxg");
    let graph = vxg::from_bytes(file).unwrap();
    assert!(graph.is_level_ordered());
    for by in [MergeBy::Shape, MergeBy::ShapeAndAttributes] {
        let (merged, _) = merge(&graph, by, &Silent);
        merged.validate().unwrap();
        let cells = |graph: &Graph| {
            let cells = graph.voxels();
            cells.map(|c| (c.corner, c.level)).collect::<Vec<_>>()
        };
        assert_eq!(cells(&merged), cells(&graph));
        assert_eq!(
            parts(&vxg::from_bytes(&bytes_of(&merged)).unwrap()),
            parts(&merged)
        );
    }
}

/// Puts right checksums on damaged contents: what an attacker would do.
fn seal(bytes: &mut [u8]) {
    let get = |bytes: &[u8], at: usize| {
        u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize
    };
    // The sixth section is that of opacities, of version 2.
    let entries = [128, 160, 192, 224, 256, 416];
    for &entry in &entries[..if bytes[8] == 2 { 6 } else { 5 }] {
        let (offset, length) = (get(bytes, entry + 8), get(bytes, entry + 16));
        if let Some(section) = offset
            .checked_add(length)
            .and_then(|end| bytes.get(offset..end))
        {
            let sum = xxhash_rust::xxh3::xxh3_64(section).to_le_bytes();
            bytes[entry + 24..entry + 32].copy_from_slice(&sum);
        }
    }
    let sum = xxhash_rust::xxh3::xxh3_64(&bytes[..504]).to_le_bytes();
    bytes[504..512].copy_from_slice(&sum);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// With checksums made to fit, only the checks of fields and indices are left.
    #[test]
    fn sealed_damage_is_refused_or_valid(
        which in 0..6usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        header in any::<bool>(),
    ) {
        let mut bytes = bytes_of(&small_graphs()[which]);
        for (place, value) in changes {
            let length = if header { 504 } else { bytes.len() };
            bytes[place.index(length)] = value;
        }
        seal(&mut bytes);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vxg");
        fs::write(&path, &bytes).unwrap();
        if let Ok(graph) = vxg::open(&path) {
            exercise(&graph);
        }
        match (vxg::verify(&path), vxg::from_bytes(&bytes)) {
            (Ok(mapped), Ok(owned)) => {
                mapped.validate().unwrap();
                prop_assert_eq!(parts(&mapped), parts(&owned));
            }
            (Err(_), Err(_)) => {}
            (a, b) => prop_assert!(false, "{a:?} but {b:?}"),
        }
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..700)) {
        let _ = vxg::from_bytes(&bytes);
    }
}

#[test]
fn messages_say_where_what_and_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.vxg");
    let graph = &small_graphs()[0];
    let mut bytes = bytes_of(graph);
    fs::write(&path, b"VOX \x96\0\0\0").unwrap();
    let message = vxg::open(&path).unwrap_err().to_string();
    assert!(
        message.contains("scene.vxg: section header, byte 0: expected the signature"),
        "{message}"
    );
    // The root's child list, in the second section, leaves the nodes, under checksums that fit.
    bytes[576..580].copy_from_slice(&1000u32.to_le_bytes());
    seal(&mut bytes);
    fs::write(&path, &bytes).unwrap();
    let message = vxg::verify(&path).unwrap_err().to_string();
    assert!(
        message.contains("section FRST, byte 576: expected children"),
        "{message}"
    );
    assert!(message.contains("copy it again"), "{message}");
    // Another version, otherwise sound.
    bytes[8] = 3;
    seal(&mut bytes);
    let message = vxg::from_bytes(&bytes).unwrap_err().to_string();
    assert!(message.contains("version 1 or 2, not 3"), "{message}");
    let missing = vxg::open(&folder.path().join("none.vxg")).unwrap_err();
    assert!(matches!(missing, VxgError::Io { .. }));
    assert!(vxg::open(folder.path()).is_err());
}

#[test]
fn opacities_make_another_version_and_others_stay_as_they_were() {
    let graphs = small_graphs();
    let version = |graph: &Graph| bytes_of(graph)[8..12].to_vec();
    assert_eq!(version(&graphs[0]), [1, 0, 0, 0]);
    let airy = &graphs[4];
    assert_eq!(version(airy), [2, 0, 0, 0]);
    // A file of version 2 whose opacities are none, sealed again.
    let mut bytes = bytes_of(airy);
    let start = u64::from_le_bytes(bytes[424..432].try_into().unwrap()) as usize;
    bytes.truncate(start);
    bytes[16..24].copy_from_slice(&(start as u64).to_le_bytes());
    bytes[432..440].copy_from_slice(&0u64.to_le_bytes());
    seal(&mut bytes);
    let error = vxg::from_bytes(&bytes).unwrap_err().to_string();
    assert!(error.contains("expected opacities, not none"), "{error}");
    // One opacity too few.
    let mut short = airy.clone();
    short.opacity = airy.opacity[1..].to_vec().into();
    assert!(short.validate().is_err());
    // Nodes that differ in opacity alone are not merged.
    let mut two = build(&[[0, 0, 0], [1, 1, 1]]);
    two.color = vec![[5; 3]; two.len()].into();
    two.normal = vec![Default::default(); two.len()].into();
    let merged = |graph: &Graph| merge(graph, MergeBy::ShapeAndAttributes, &Silent).0.len();
    assert_eq!(merged(&two), 2);
    two.opacity = vec![Opacity::OPAQUE, Opacity([1; 3]), Opacity([2; 3])].into();
    assert_eq!(merged(&two), 3);
}
