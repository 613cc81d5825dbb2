//! The identity of a picture: 32 hexadecimal digits.

use xxhash_rust::xxh3::Xxh3;

use super::Picture;

/// What every stream begins with; a change of the stream changes it too.
const STREAM: &[u8] = b"shiftvox picture 1\n";

/// The picture's hash: XXH3 with 128 bits and seed 0, as 32 lower-case
/// hexadecimal digits, most significant first.
///
/// The stream, all numbers little-endian: the 19 bytes `shiftvox picture 1\n`;
/// width and height (u32); then buffer by buffer, each row by row, colour (4
/// bytes a pixel: red, green, blue, alpha), depth (bits of the f32), node
/// (i32), normal (bits of 3 f32), voxel (4 i32). Negative zeros count as
/// zeros, and there is no NaN. Records are not part of it: they say how the
/// picture was found, not what it shows.
#[must_use]
pub fn hash(picture: &Picture) -> String {
    let mut state = Xxh3::new();
    state.update(STREAM);
    state.update(&picture.width.to_le_bytes());
    state.update(&picture.height.to_le_bytes());
    let mut row = Vec::new();
    let mut feed = |bytes: &mut dyn Iterator<Item = [u8; 4]>| {
        row.clear();
        row.extend(bytes.flatten());
        state.update(&row);
    };
    // Adding zero turns -0 into 0.
    let float = |value: f32| (value + 0.0).to_le_bytes();
    feed(&mut picture.rgba.iter().copied());
    feed(&mut picture.depth.iter().map(|&depth| float(depth)));
    feed(&mut picture.node.iter().map(|node| node.to_le_bytes()));
    feed(&mut picture.normal.iter().flatten().map(|&n| float(n)));
    feed(&mut picture.voxel.iter().flatten().map(|v| v.to_le_bytes()));
    format!("{:032x}", state.digest128())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tiny() -> Picture {
        Picture {
            width: 1,
            height: 1,
            rgba: vec![[1, 2, 3, 255]],
            depth: vec![2.5],
            normal: vec![[0.0, 0.0, 1.0]],
            voxel: vec![[-4, 5, 6, 3]],
            node: vec![7],
            records: None,
        }
    }

    #[test]
    fn the_stream_is_as_written() {
        let mut stream = b"shiftvox picture 1\n\x01\0\0\0\x01\0\0\0\x01\x02\x03\xff".to_vec();
        stream.extend(2.5f32.to_bits().to_le_bytes());
        stream.extend(7i32.to_le_bytes());
        for n in [0.0f32, 0.0, 1.0] {
            stream.extend(n.to_bits().to_le_bytes());
        }
        for v in [-4i32, 5, 6, 3] {
            stream.extend(v.to_le_bytes());
        }
        let expected = format!("{:032x}", xxhash_rust::xxh3::xxh3_128(&stream));
        assert_eq!(hash(&tiny()), expected);
        assert_eq!(expected.len(), 32);
    }

    #[test]
    fn every_buffer_counts_and_records_do_not() {
        let base = hash(&tiny());
        let changes: [fn(&mut Picture); 5] = [
            |p| p.rgba[0][3] = 254,
            |p| p.depth[0] = 2.500_000_2,
            |p| p.normal[0][1] = 1e-20,
            |p| p.voxel[0][3] = 2,
            |p| p.node[0] = 8,
        ];
        for change in changes {
            let mut other = tiny();
            change(&mut other);
            assert_ne!(hash(&other), base);
        }
        let mut other = tiny();
        other.records = Some(vec![3.0]);
        other.normal[0][0] = -0.0;
        assert_eq!(hash(&other), base);
    }
}
