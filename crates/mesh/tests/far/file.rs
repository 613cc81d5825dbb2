//! Files of far voxels: round trips, and refused damage.

use shiftvox::scene::{FileKind, detect};
use shiftvox_mesh::Surface;
use shiftvox_mesh::far::record::{NODE_BYTES, RECORD_BYTES};
use shiftvox_mesh::far::store::{FarError, encode};
use shiftvox_mesh::far::{BuildOptions, FarFile};
use xxhash_rust::xxh3::xxh3_64;

use super::city::{city, far, file_of, options};

fn small() -> Vec<u8> {
    let options = BuildOptions {
        rays: Some(3000),
        leaf_triangles: 1500,
        grid: 8,
        ..options()
    };
    encode(&far(&options)).unwrap()
}

/// Whether a file is found to be damaged when it is opened or when all of it is read.
pub(crate) fn is_refused(bytes: &[u8]) -> bool {
    match FarFile::from_bytes(bytes).and_then(|file| file.verify()) {
        Ok(()) => false,
        Err(FarError::Malformed { .. }) => true,
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn a_file_comes_back() {
    let data = far(&options());
    let bytes = encode(&data).unwrap();
    assert_eq!(detect(&bytes, bytes.len() as u64), Some(FileKind::Far));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("city.far");
    std::fs::write(&path, &bytes).unwrap();
    for file in [
        FarFile::open(&path).unwrap(),
        FarFile::from_bytes(&bytes).unwrap(),
    ] {
        file.verify().unwrap();
        assert_eq!(file.nodes(), &data.nodes[..]);
        assert_eq!(file.len(), bytes.len() as u64);
        let mut triangles = 0;
        for (number, node) in data.nodes.iter().enumerate() {
            let here = file.data(number).unwrap();
            triangles += here.triangles().len() as u64;
            let counts = here.lists().into_iter().zip(RECORD_BYTES);
            let counts: Vec<usize> = counts.map(|(list, bytes)| list.len() / bytes).collect();
            assert!(
                counts
                    .iter()
                    .zip(node.counts)
                    .all(|(&a, b)| a == b as usize)
            );
        }
        assert_eq!(triangles, data.triangles());
    }
}

/// A leaf has the triangles of the mesh, to the last bit of single precision.
#[test]
fn leaves_have_all_triangles() {
    let file = file_of(&far(&options()));
    let bits = |corners: [[f32; 3]; 3]| corners.map(|corner| corner.map(f32::to_bits));
    let mut stored: Vec<_> = (0..file.nodes().len())
        .flat_map(|number| {
            let data = file.data(number).unwrap();
            let corners = data.triangles().iter().map(|t| bits(t.corners));
            corners.collect::<Vec<_>>()
        })
        .collect();
    let mesh = city();
    let mut expected: Vec<_> = (0..Surface::len(&mesh))
        .map(|number| {
            let corners = Surface::corners(&mesh, number);
            bits(corners.map(|p| (p - file.settings.centre).as_vec3().to_array()))
        })
        .collect();
    stored.sort_unstable();
    expected.sort_unstable();
    assert_eq!(stored, expected);
}

#[test]
fn truncated_files_are_refused() {
    let bytes = small();
    assert!(!is_refused(&bytes));
    for length in (0..300).chain((300..bytes.len()).step_by(997)) {
        assert!(is_refused(&bytes[..length]), "{length} of {}", bytes.len());
    }
    let longer = [&bytes[..], &[0]].concat();
    assert!(is_refused(&longer));
}

#[test]
fn every_flipped_bit_is_found() {
    let bytes = small();
    let header_and_nodes = 128 + NODE_BYTES * 16;
    let places = (0..header_and_nodes).chain((header_and_nodes..bytes.len()).step_by(61));
    for place in places.filter(|&place| place < bytes.len()) {
        let mut damaged = bytes.clone();
        damaged[place] ^= 1 << (place % 8);
        assert!(is_refused(&damaged), "byte {place}");
    }
}

/// Gives header and hierarchy the checksums that they should have.
pub(crate) fn with_checksums(mut bytes: Vec<u8>) -> Vec<u8> {
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
    // Every byte of the header and of the root, but for those that may have any
    // value: the centre (48..72), the distance (72..80), the settings (80, 84),
    // the bevels (104..112), and of the root its box, origin and
    // voxel, what was counted and the fit's error.
    let header = (8..48).chain(86..91).chain(91..96).chain(112..120);
    let root = (41..64).filter(|byte| !(41..43).contains(byte));
    for place in header.chain(root.map(|byte| 128 + byte)) {
        let mut damaged = bytes.clone();
        damaged[place] ^= 0x40;
        assert!(is_refused(&with_checksums(damaged)), "byte {place}");
    }
    // Any damage at all must not panic.
    for place in 8..128 + NODE_BYTES * 8 {
        for flip in [0x01, 0x80, 0xff] {
            let mut damaged = bytes.clone();
            damaged[place] ^= flip;
            let _ = is_refused(&with_checksums(damaged));
        }
    }
}
