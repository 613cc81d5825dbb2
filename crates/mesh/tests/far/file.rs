//! Files of far voxels, with and without decimated surfaces: round trips, and refused damage.

use shiftvox::graph::Silent;
use shiftvox::scene::{FileKind, detect};
use shiftvox_mesh::far::record::{NODE_BYTES, Node, RECORD_BYTES};
use shiftvox_mesh::far::store::{FarError, encode};
use shiftvox_mesh::far::{BuildOptions, FarFile, build};
use shiftvox_mesh::generate::{Kind, generate};
use xxhash_rust::xxh3::xxh3_64;

use super::city::{city, far, options};
use super::hybrid::hybrid;

fn small() -> Vec<u8> {
    let options = BuildOptions {
        rays: Some(3000),
        leaf_triangles: 1500,
        grid: 8,
        ..options()
    };
    encode(&build(&city(), &options, &Silent).unwrap()).unwrap()
}

/// Whether the program finds damage when it opens a file or reads all of it.
fn is_refused(bytes: &[u8]) -> bool {
    match FarFile::from_bytes(bytes).and_then(|file| file.verify()) {
        Ok(()) => false,
        Err(FarError::Malformed { .. }) => true,
        Err(other) => panic!("{other}"),
    }
}

/// A file with some bits of one byte flipped.
fn flipped(bytes: &[u8], place: usize, flip: u8) -> Vec<u8> {
    let mut damaged = bytes.to_vec();
    damaged[place] ^= flip;
    damaged
}

#[test]
fn files_hold_the_data_that_was_built() {
    let data = far();
    let bytes = encode(&data).unwrap();
    assert_eq!(detect(&bytes, bytes.len() as u64), Some(FileKind::Far));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("city.far");
    std::fs::write(&path, &bytes).unwrap();
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
    let bytes = small();
    assert!(!is_refused(&bytes));
    for length in (0..300).chain((300..bytes.len()).step_by(997)) {
        assert!(is_refused(&bytes[..length]), "{length} of {}", bytes.len());
    }
    assert!(is_refused(&[&bytes[..], &[0]].concat()));
    let hybrid = encode(&hybrid(&generate(Kind::Village, 3), 500)).unwrap();
    assert!(!is_refused(&hybrid));
    // All of header and nodes, some of the rest.
    let first = (128 + NODE_BYTES * 16).min(bytes.len());
    let places = (0..first).chain((first..bytes.len()).step_by(61));
    let of_hybrid = (0..hybrid.len()).step_by(997);
    let places = places.map(|place| (&bytes, place));
    for (bytes, place) in places.chain(of_hybrid.map(|place| (&hybrid, place))) {
        let damaged = flipped(bytes, place, 1 << (place % 8));
        assert!(is_refused(&damaged), "byte {place}");
    }
    // The fields of a node's surface, with right checksums.
    for place in 128..144 {
        for flip in [0x01, 0x40] {
            let damaged = with_checksums(flipped(&hybrid, 128 + place, flip));
            assert!(is_refused(&damaged), "byte {place} of the root");
        }
    }
}

/// Gives header and hierarchy right checksums.
fn with_checksums(mut bytes: Vec<u8>) -> Vec<u8> {
    let nodes = u64::from_le_bytes(bytes[24..32].try_into().unwrap()) as usize;
    if let Some(nodes) = bytes.get(128..nodes.saturating_mul(NODE_BYTES).saturating_add(128)) {
        let checksum = xxh3_64(nodes).to_le_bytes();
        bytes[96..104].copy_from_slice(&checksum);
    }
    let checksum = xxh3_64(&bytes[..120]).to_le_bytes();
    bytes[120..128].copy_from_slice(&checksum);
    bytes
}

#[test]
fn fields_are_checked_behind_their_checksums() {
    let bytes = small();
    assert!(!is_refused(&with_checksums(bytes.clone())));
    let mut version = bytes.clone();
    version[8] = 4;
    let error = FarFile::from_bytes(&with_checksums(version)).unwrap_err();
    assert!(error.to_string().contains("version 6, not 4"), "{error}");
    // Some bytes may have any value: the centre (48..72), the distance (72..80), the settings (80, 84), the bevels
    // (104..112), and of the root its box, origin and voxel, its counts and the fit's error.
    let header = (8..48).chain(86..96).chain(112..120);
    for place in header.chain(128 + 43..128 + 64) {
        let damaged = with_checksums(flipped(&bytes, place, 0x40));
        assert!(is_refused(&damaged), "byte {place}");
    }
}

/// Faulty hierarchies with right checksums.
#[test]
fn inconsistent_hierarchies_are_refused() {
    type Harm = fn(&mut Vec<Node>);
    let harms: [(&str, Harm); 5] = [
        ("a child on the level of its parent", |n| {
            n[1].level = n[0].level
        }),
        ("a first child that is not the next node", |n| {
            n[0].children[0] += 1
        }),
        ("a second child outside", |n| n[0].children[1] = u32::MAX),
        ("a triangle too many", |n| n[1].triangles += 1),
        ("data before that of the node before", |n| {
            n.last_mut().unwrap().data_at = 0
        }),
    ];
    for (name, harm) in harms {
        let mut data = far();
        harm(&mut data.nodes);
        assert!(is_refused(&encode(&data).unwrap()), "{name}");
    }
}
