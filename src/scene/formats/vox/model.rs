//! One model: its size, its voxels, and the rule for voxels outside its size.

use super::chunk::{Chunk, Fields};
use crate::scene::OutOfBounds;
use crate::scene::fault::Fault;

/// A model as the file stores it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Model<'a> {
    /// `SIZE`, voxels.
    pub size: [u32; 3],
    /// x, y, z, colour index of each voxel.
    pub voxels: &'a [[u8; 4]],
    /// Where the first voxel lies in the file.
    pub offset: u64,
}

/// The size that a chunk `SIZE` says.
pub(super) fn read_size(chunk: &Chunk<'_>) -> Result<[u32; 3], Box<Fault>> {
    let mut fields = Fields::new(chunk);
    Ok([
        fields.u32("the size along x")?,
        fields.u32("the size along y")?,
        fields.u32("the size along z")?,
    ])
}

/// The model that a chunk `XYZI` completes.
pub(super) fn read_voxels<'a>(chunk: &Chunk<'a>, size: [u32; 3]) -> Result<Model<'a>, Box<Fault>> {
    let mut fields = Fields::new(chunk);
    let count = fields.count("voxels", 4)? as usize;
    let (voxels, _) = fields.rest().as_chunks::<4>();
    Ok(Model {
        size,
        voxels: &voxels[..count],
        offset: fields.offset(),
    })
}

/// Whether a coordinate triple lies inside `SIZE`.
#[inline]
pub(super) fn is_inside(position: [u8; 3], size: [u32; 3]) -> bool {
    (0..3).all(|axis| u32::from(position[axis]) < size[axis])
}

/// The coordinate that a stored byte means.
///
/// Inside `SIZE` it is the coordinate. Outside, it is the number congruent to
/// it modulo 256 that is nearest to the middle of `SIZE`: one of the 256 numbers
/// from `floor(SIZE / 2) - 128` on. Numbers inside `SIZE` are all among these
/// (`SIZE` is below 256 where a byte can be outside it), so the rule has no seam.
#[inline]
pub(super) fn unwrap(byte: u8, size: u32) -> i64 {
    let byte = u32::from(byte);
    let wrapped = byte >= size && byte >= size / 2 + 128;
    i64::from(byte) - if wrapped { 256 } else { 0 }
}

/// The coordinates of a voxel, or `None` where it is to be left out.
#[inline]
pub(super) fn position(stored: [u8; 3], size: [u32; 3], rule: OutOfBounds) -> Option<[i64; 3]> {
    let [x, y, z] = stored;
    if is_inside(stored, size) {
        return Some([i64::from(x), i64::from(y), i64::from(z)]);
    }
    match rule {
        OutOfBounds::Wrap => Some([unwrap(x, size[0]), unwrap(y, size[1]), unwrap(z, size[2])]),
        OutOfBounds::Keep => Some([i64::from(x), i64::from(y), i64::from(z)]),
        OutOfBounds::Drop | OutOfBounds::Error => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unwrapping_takes_the_nearest_number_to_the_middle() {
        for size in 0..=300u32 {
            for byte in 0..=255u8 {
                let meant = unwrap(byte, size);
                assert_eq!(meant.rem_euclid(256), i64::from(byte));
                if u32::from(byte) < size {
                    assert_eq!(meant, i64::from(byte), "inside stays");
                } else {
                    let middle = i64::from(size / 2);
                    assert!((middle - 128..middle + 128).contains(&meant));
                }
            }
        }
        // VoxelShop's dragon in a box of 20: 183 means -73, and 72 means 72.
        assert_eq!(unwrap(203, 20), -53);
        assert_eq!(unwrap(72, 20), 72);
    }
}
