//! `.vxg` files return what was stored, and damage is found or harmless. `crates/mesh/tests/sealed` has damage under
//! checksums that fit.

use std::fs;

use shiftvox::graph::vxg::{self, VxgError};
use shiftvox::graph::{Graph, LinkedGraph, MeshBox, Opacity, Store};
use shiftvox::scene::{FileKind, detect};
use shiftvox::whole::WholeError;

use crate::{at, build, bytes_of, parts, seal};

/// A tree, a cyclic graph, a voxel, and the tree with opacities and of a mesh.
fn small_graphs() -> [Graph; 5] {
    let voxels = [[0; 3], [1, 0, 0], [1, 1, 0], [-5, 3, 2], [6; 3], [7, 6, 6]];
    let tree = build(&voxels.map(at));
    let mut cyclic = LinkedGraph::new(9);
    for own in [Some(0), Some(2)] {
        let (zero, one, two) = (Some(0), Some(1), Some(2));
        cyclic.add_node([1, 2, 3], [own, None, None, one, None, zero, two, None]);
    }
    cyclic.add_node([9, 9, 9], [None; 8]);
    let mut airy = tree.clone();
    let opacity = (0..tree.len() as u8).map(|i| Opacity([i, 3 * i, 0xff - i]));
    airy.opacity = opacity.collect();
    let mut of_mesh = tree.clone();
    let span = ([-1.0, 0.5, 1e6], [2.0, 0.75, 1e6 + 1.0]);
    of_mesh.placement.mesh = Some(MeshBox::new(span, [0, 1, 2, 3, 4, 5, 6, 255], true));
    let one = build(&[at([-3, 4, 5])]);
    [tree, cyclic.build().unwrap(), one, airy, of_mesh]
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
    for node in [0, 1, graph.root, u32::MAX] {
        sum += u64::from(graph.place_of(node).is_some());
        for octant in 0..8 {
            sum += u64::from(graph.view().child(node, octant).unwrap_or(0));
        }
    }
    std::hint::black_box(sum);
}

#[test]
fn files_return_what_was_stored() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("new/a.vxg");
    for graph in small_graphs() {
        vxg::write(&graph, &path, true).unwrap();
        let bytes = bytes_of(&graph);
        assert_eq!(fs::read(&path).unwrap(), bytes);
        let opened = vxg::open(&path).unwrap();
        assert!(matches!(opened.color, Store::Mapped(..)) || cfg!(target_endian = "big"));
        // Over the file that is mapped: the map keeps the old one.
        vxg::write(&opened, &path, true).unwrap();
        let verified = vxg::verify(&path).unwrap();
        for read in [opened, verified, vxg::from_bytes(&bytes).unwrap()] {
            read.validate().unwrap();
            assert_eq!(parts(&read), parts(&graph));
            exercise(&read);
        }
        assert_eq!(detect(&bytes, 0), Some(FileKind::Vxg));
    }
    assert_eq!(fs::read_dir(folder.path().join("new")).unwrap().count(), 1);
}

#[test]
fn nothing_is_overwritten_unasked_or_left_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vxg");
    fs::write(&path, b"precious").unwrap();
    let [mut graph, ..] = small_graphs();
    let refused = vxg::write(&graph, &path, false).unwrap_err();
    assert!(
        matches!(refused, VxgError::Write(WholeError::Exists(_))),
        "{refused}"
    );
    // A folder is not made where a file stands.
    let refused = vxg::write(&graph, &path.join("folder.vxg"), false).unwrap_err();
    assert!(
        matches!(refused, VxgError::Write(WholeError::Io { .. })),
        "{refused}"
    );
    // A broken graph is refused before anything is touched.
    graph.voxels += 1;
    let refused = vxg::write(&graph, &path, true).unwrap_err();
    assert!(matches!(refused, VxgError::Graph(_)), "{refused}");
    assert_eq!(fs::read(&path).unwrap(), b"precious");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    let missing = vxg::open(&folder.path().join("none.vxg")).unwrap_err();
    assert!(matches!(missing, VxgError::Io { .. }));
    assert!(vxg::open(folder.path()).is_err());
}

#[test]
fn every_truncation_and_damaged_byte_is_found_and_harmless() {
    let folder = tempfile::tempdir().unwrap();
    for (g, graph) in small_graphs().iter().enumerate() {
        let whole = bytes_of(graph);
        assert!(vxg::from_bytes(&[&whole[..], &[0]].concat()).is_err());
        // A name each: another's map must not change.
        let path = |name: String| folder.path().join(format!("{g}-{name}.vxg"));
        for place in 0..whole.len() {
            let cut = path(place.to_string());
            fs::write(&cut, &whole[..place]).unwrap();
            assert!(vxg::open(&cut).is_err(), "{place}");
            assert!(vxg::from_bytes(&whole[..place]).is_err(), "{place}");
            fs::remove_file(&cut).unwrap();
            for flip in [0x01, 0x80, 0xff] {
                let mut bytes = whole.clone();
                bytes[place] ^= flip;
                let path = path(format!("{place}-{flip}"));
                fs::write(&path, &bytes).unwrap();
                let message = vxg::verify(&path).unwrap_err().to_string();
                assert!(vxg::from_bytes(&bytes).is_err());
                let opened = vxg::open(&path);
                // Where numbers are turned, all of a file is checked when it is opened.
                if place < 512 || cfg!(target_endian = "big") {
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

#[test]
fn messages_say_where_what_and_what_to_do() {
    let [tree, .., airy, _] = small_graphs().map(|graph| bytes_of(&graph));
    let refused = |bytes: Vec<u8>, parts: &[&str]| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.vxg");
        fs::write(&path, bytes).unwrap();
        let message = vxg::verify(&path).unwrap_err().to_string();
        let is_told = parts.iter().all(|part| message.contains(part));
        assert!(
            is_told && message.contains("scene.vxg: section "),
            "{message}"
        );
    };
    refused(
        b"VOX \x96\0\0\0".to_vec(),
        &["header, byte 0: expected the signature"],
    );
    // The root's child list, in the second section, leaves the nodes, under checksums that fit.
    let edited = |bytes: &[u8], at: usize, new: &[u8]| {
        let mut bytes = bytes.to_vec();
        bytes[at..at + new.len()].copy_from_slice(new);
        seal::vxg(bytes, false).unwrap()
    };
    let advice = "copy it again";
    let lost = edited(&tree, 576, &1000u32.to_le_bytes());
    refused(lost, &["FRST, byte 576: expected children", advice]);
    // Another version, otherwise sound.
    refused(
        edited(&tree, 8, &[3]),
        &["header, byte 8: expected version 1 or 2, not 3"],
    );
    // Version 2 is for opacities, which may not be missing.
    assert_eq!((tree[8], airy[8]), (1, 2));
    let start = u64::from_le_bytes(airy[424..432].try_into().unwrap()) as usize;
    let without = edited(&airy[..start], 432, &[0; 8]);
    refused(
        without,
        &["header, byte 432: expected opacities, not none", advice],
    );
}
