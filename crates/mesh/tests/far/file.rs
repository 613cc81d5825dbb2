//! Files of far voxels, with and without decimated surfaces: round trips, and refused damage.

use std::fs;
use std::ops::Range;

use shiftvox::graph::Silent;
use shiftvox::scene::{FileKind, detect};
use shiftvox_mesh::far::record::{NODE_BYTES, Node, RECORD_BYTES};
use shiftvox_mesh::far::store::{FarError, encode};
use shiftvox_mesh::far::{BuildOptions, FarData, FarFile, build};
use shiftvox_mesh::generate::{Kind, generate};
use xxhash_rust::xxh3::xxh3_64;

use super::city::{city, far, options};
use super::solid::hybrid;

/// The city with few voxels, and a village with decimated surfaces.
fn small() -> [FarData; 2] {
    let options = BuildOptions {
        rays: Some(3000),
        leaf_triangles: 1500,
        grid: 8,
        ..options()
    };
    let city = build(&city(), &options, &Silent).unwrap();
    [city, hybrid(&generate(Kind::Village, 3), 500)]
}

/// Whether damage is found when a file is opened or all of it is read.
fn is_refused(bytes: &[u8]) -> bool {
    match FarFile::from_bytes(bytes).and_then(|file| file.verify()) {
        Ok(()) => false,
        Err(FarError::Malformed { .. }) => true,
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn files_hold_the_data_that_was_built() {
    let data = far(false);
    let bytes = encode(&data).unwrap();
    assert_eq!(detect(&bytes, bytes.len() as u64), Some(FileKind::Far));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("city.far");
    fs::write(&path, &bytes).unwrap();
    for file in [FarFile::open(&path), FarFile::from_bytes(&bytes)] {
        let file = file.unwrap();
        file.verify().unwrap();
        assert_eq!(file.nodes(), &data.nodes[..]);
        assert_eq!(file.len(), bytes.len() as u64);
        for (number, node) in data.nodes.iter().enumerate() {
            let here = file.data(number).unwrap();
            let lists = here.lists().into_iter().zip(RECORD_BYTES);
            let counts = lists.map(|(list, bytes)| (list.len() / bytes) as u32);
            assert!(counts.eq(node.counts));
        }
    }
}

#[test]
fn truncated_and_damaged_files_are_refused() {
    let [city, hybrid] = small().map(|data| encode(&data).unwrap());
    assert!(!is_refused(&city) && !is_refused(&hybrid));
    for length in (0..300).chain((300..city.len()).step_by(997)) {
        assert!(is_refused(&city[..length]), "{length} of {}", city.len());
    }
    assert!(is_refused(&[&city[..], &[0]].concat()));
    // All of header and nodes, some of the rest.
    let first = (128 + NODE_BYTES * 16).min(city.len());
    let places = (0..first).chain((first..city.len()).step_by(61));
    let places = places.map(|place| (&city, place));
    let of_hybrid = (0..hybrid.len()).step_by(997);
    for (bytes, place) in places.chain(of_hybrid.map(|place| (&hybrid, place))) {
        let mut damaged = bytes.clone();
        damaged[place] ^= 1 << (place % 8);
        assert!(is_refused(&damaged), "byte {place}");
    }
}

/// With right checksums. Some bytes may have any value: the centre (48..72), the distance (72..80), the settings (80,
/// 84), the bevels (104..112), and of the root its box, origin and voxel, its counts and the fit's error.
#[test]
fn fields_are_checked_behind_their_checksums() {
    let [city, hybrid] = small();
    for place in (8..48).chain(86..96).chain(112..120) {
        let mut bytes = encode(&city).unwrap();
        bytes[place] ^= 0x40;
        let checksum = xxh3_64(&bytes[..120]).to_le_bytes();
        bytes[120..128].copy_from_slice(&checksum);
        assert!(is_refused(&bytes), "byte {place} of the header");
    }
    let of_root: [(&FarData, Range<usize>, u8); 3] = [
        (&city, 43..64, 0x40),
        (&hybrid, 128..144, 0x01),
        (&hybrid, 128..144, 0x40),
    ];
    for (data, places, flip) in of_root {
        for place in places {
            let mut data = data.clone();
            bytemuck::bytes_of_mut(&mut data.nodes[0])[place] ^= flip;
            assert!(is_refused(&encode(&data).unwrap()), "byte {place}");
        }
    }
    type Harm = fn(&mut Vec<Node>);
    let harms: [Harm; 5] = [
        // A child on the level of its parent, a first child that is not the next node, a second child outside.
        |n| n[1].level = n[0].level,
        |n| n[0].children[0] += 1,
        |n| n[0].children[1] = u32::MAX,
        // A triangle too many, data before that of the node before.
        |n| n[1].triangles += 1,
        |n| n.last_mut().unwrap().data_at = 0,
    ];
    let data = far(false);
    for (number, harm) in harms.into_iter().enumerate() {
        let mut data = data.clone();
        harm(&mut data.nodes);
        assert!(is_refused(&encode(&data).unwrap()), "{number}");
    }
}
