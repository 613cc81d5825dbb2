//! A node's data as it is stored: deflated.
//!
//! Records of voxels are laid out byte by byte first: the first bytes of all records of a list,
//! then the second ones, and so on. Neighbours are alike in each. Triangles stay as they are:
//! those that share a corner repeat its bytes.

use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::decompress_to_vec_with_limit;

use crate::far::record::{LeafTriangle, RECORD_BYTES, triangle_bytes};

/// How hard it is tried to make data small, 0 to 10: what other programs do if not told otherwise.
const EFFORT: u8 = 6;

/// Packs the records of voxels, list by list.
pub(in crate::far) fn pack_voxels(lists: &[Vec<u8>; 6]) -> Vec<u8> {
    let mut columns = Vec::with_capacity(lists.iter().map(Vec::len).sum());
    for (list, bytes) in lists.iter().zip(RECORD_BYTES) {
        for column in 0..bytes {
            columns.extend(list.iter().skip(column).step_by(bytes));
        }
    }
    compress_to_vec(&columns, EFFORT)
}

/// Unpacks records of so many voxels in each list; `None` where it is not they that were packed.
pub(super) fn unpack_voxels(packed: &[u8], counts: &[u32; 6]) -> Option<Vec<u8>> {
    let lengths = [0, 1, 2, 3, 4, 5].map(|list| counts[list] as usize * RECORD_BYTES[list]);
    let columns = unpack(packed, lengths.iter().sum())?;
    let mut records = vec![0; columns.len()];
    let mut begin = 0;
    for (length, bytes) in lengths.into_iter().zip(RECORD_BYTES) {
        let count = length / bytes;
        for column in 0..bytes {
            let from = &columns[begin + column * count..][..count];
            let to = records[begin..begin + length].iter_mut();
            for (to, &byte) in to.skip(column).step_by(bytes).zip(from) {
                *to = byte;
            }
        }
        begin += length;
    }
    Some(records)
}

/// Packs the triangles of a leaf.
pub(in crate::far) fn pack_triangles(triangles: &[LeafTriangle]) -> Vec<u8> {
    compress_to_vec(triangle_bytes(triangles), EFFORT)
}

/// Unpacks so many triangles; `None` where it is not they that were packed.
pub(super) fn unpack_triangles(packed: &[u8], count: u32) -> Option<Vec<LeafTriangle>> {
    let bytes = unpack(packed, count as usize * size_of::<LeafTriangle>())?;
    Some(bytemuck::pod_collect_to_vec(&bytes))
}

fn unpack(packed: &[u8], length: usize) -> Option<Vec<u8>> {
    // It grows with what is there: a wrong length takes no memory.
    let bytes = decompress_to_vec_with_limit(packed, length).ok()?;
    (bytes.len() == length).then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_comes_back_and_wrong_lengths_do_not() {
        let lists: [Vec<u8>; 6] = std::array::from_fn(|list| {
            let bytes = RECORD_BYTES[list] * 7 * list;
            (0..bytes).map(|at| (at * at / 5) as u8).collect()
        });
        let counts = [0, 7, 14, 21, 28, 35];
        let packed = pack_voxels(&lists);
        assert_eq!(unpack_voxels(&packed, &counts), Some(lists.concat()));
        assert_eq!(unpack_voxels(&packed, &[1, 7, 14, 21, 28, 35]), None);
        assert_eq!(unpack_voxels(&packed, &[0, 7, 14, 21, 28, 34]), None);
        assert_eq!(unpack_voxels(&packed[1..], &counts), None);
        let packed = pack_voxels(&Default::default());
        assert_eq!(unpack_voxels(&packed, &[0; 6]), Some(Vec::new()));
    }
}
