//! Refused files of far voxels, with and without decimated surfaces.

use std::ops::Range;

use shiftvox_mesh::far::record::Node;
use shiftvox_mesh::far::store::{FarError, encode};
use shiftvox_mesh::far::{FarData, FarFile};
use shiftvox_mesh::generate::{Kind, generate};
use xxhash_rust::xxh3::xxh3_64;

use super::city::far;
use super::solid::hybrid;

fn is_refused(bytes: &[u8]) -> bool {
    match FarFile::from_bytes(bytes).and_then(|file| file.verify()) {
        Ok(()) => false,
        Err(FarError::Malformed { .. }) => true,
        Err(other) => panic!("{other}"),
    }
}

/// With right checksums. Centre, distance, settings and bevels may have any value. So may the root's box, grid, counts
/// and error.
#[test]
fn fields_are_checked_behind_their_checksums() {
    let (city, hybrid) = (far(false), hybrid(&generate(Kind::Village, 3), 500));
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
    let harms: [Harm; 6] = [
        // A child on its parent's level, a first child that is not the next node, a second child outside.
        |n| n[1].level = n[0].level,
        |n| n[0].children[0] += 1,
        |n| n[0].children[1] = u32::MAX,
        |n| n[0].across = 5,
        // A triangle too many, data before that of the node before.
        |n| n[1].triangles += 1,
        |n| n.last_mut().unwrap().data_at = 0,
    ];
    for (number, harm) in harms.into_iter().enumerate() {
        let mut data = city.clone();
        harm(&mut data.nodes);
        assert!(is_refused(&encode(&data).unwrap()), "{number}");
    }
}
