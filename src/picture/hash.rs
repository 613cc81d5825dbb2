//! The identity of a picture: 32 hexadecimal digits.

use xxhash_rust::xxh3::Xxh3;

use super::Picture;
use super::npy::Values;
use super::rows::{Buffer, Rows};

/// Beginning of every stream; changes with the stream's format.
const STREAM: &[u8] = b"shiftvox picture 1\n";

const BUFFERS: [Buffer; 5] = [
    Buffer::Color,
    Buffer::Depth,
    Buffer::Node,
    Buffer::Normal,
    Buffer::Voxel,
];

/// The picture's hash: XXH3 with 128 bits and seed 0, as 32 lower-case hexadecimal digits, most significant first.
///
/// The stream, all numbers little-endian: the 19 bytes `shiftvox picture 1\n`; width and height (u32); then buffer by
/// buffer, each row by row, colour (4 bytes per pixel: red, green, blue, alpha), depth (bits of the f32), node (i32),
/// normal (bits of 3 f32), voxel (4 i32). Negative zeros are replaced by zeros, and there is no NaN. Records are left out.
pub fn hash(picture: &Picture) -> String {
    let Ok(hash) = hash_rows(picture);
    hash
}

/// [`hash`] of a picture that is made in groups of rows. Fails when rows cannot be made.
pub fn hash_rows<R: Rows>(picture: &R) -> Result<String, R::Error> {
    let mut state = Xxh3::new();
    state.update(STREAM);
    let (width, height) = picture.size();
    state.update(&width.to_le_bytes());
    state.update(&height.to_le_bytes());
    for buffer in BUFFERS {
        for rows in picture.steps() {
            let mut values = picture.rows(buffer, rows)?;
            if let Values::F32(values) = &mut values {
                // Adding zero turns -0 into 0.
                values.iter_mut().for_each(|value| *value += 0.0);
            }
            state.update(&values.bytes());
        }
    }
    Ok(format!("{:032x}", state.digest128()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stream_is_as_written_without_records_and_negative_zeros() {
        let picture = Picture {
            width: 1,
            height: 1,
            rgba: vec![[1, 2, 3, 255]],
            depth: vec![2.5],
            normal: vec![[-0.0, 0.0, 1.0]],
            voxel: vec![[-4, 5, 6, 3]],
            node: vec![7],
            records: Some(vec![3.0]),
        };
        let mut stream = b"shiftvox picture 1\n\x01\0\0\0\x01\0\0\0\x01\x02\x03\xff".to_vec();
        stream.extend(2.5f32.to_bits().to_le_bytes());
        stream.extend(7i32.to_le_bytes());
        stream.extend([0.0f32, 0.0, 1.0].map(f32::to_le_bytes).concat());
        stream.extend([-4i32, 5, 6, 3].map(i32::to_le_bytes).concat());
        let expected = format!("{:032x}", xxhash_rust::xxh3::xxh3_128(&stream));
        assert_eq!(hash(&picture), expected);
    }
}
