//! A node's data as it is stored (`spec/far.md`): columns of bytes, deflated.

use miniz_oxide::deflate::core::{
    CompressorOxide, TDEFLFlush, compress_to_output, create_comp_flags_from_zip_params,
};
use miniz_oxide::inflate::decompress_to_vec_with_limit;

use super::surface;
use crate::far::record::{LeafTriangle, Node, RECORD_BYTES};

const EFFORT: i32 = 6;
/// From there on, the end of a column ends a block: columns differ.
const LEAST_BLOCK: usize = 2048;

pub(in crate::far) fn pack(lists: &[Vec<u8>; 6], surface: &[u8]) -> Vec<u8> {
    let flags = create_comp_flags_from_zip_params(EFFORT, -15, 0);
    let mut compressor = Box::new(CompressorOxide::new(flags));
    let mut packed = Vec::new();
    let mut deflate = |bytes: &[u8], flush| {
        compress_to_output(&mut compressor, bytes, flush, |out| {
            packed.extend_from_slice(out);
            true
        });
    };
    let mut block = Vec::new();
    for (list, bytes) in lists.iter().zip(RECORD_BYTES) {
        for column in 0..bytes {
            block.extend(list.iter().skip(column).step_by(bytes));
            if block.len() >= LEAST_BLOCK {
                deflate(&block, TDEFLFlush::Sync);
                block.clear();
            }
        }
    }
    deflate(&block, TDEFLFlush::None);
    deflate(surface, TDEFLFlush::Finish);
    packed
}

pub(super) fn unpack(packed: &[u8], node: &Node) -> Option<(Vec<u8>, Vec<LeafTriangle>)> {
    let lists = [0, 1, 2, 3, 4, 5];
    let lengths = lists.map(|list| node.counts[list] as usize * RECORD_BYTES[list]);
    let voxels: usize = lengths.iter().sum();
    let columns = inflate(packed, voxels + usize::try_from(node.surface_bytes()).ok()?)?;
    let (columns, surface) = columns.split_at(voxels);
    let mut records = vec![0; voxels];
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
    Some((records, surface::read(node, surface)?))
}

fn inflate(packed: &[u8], length: usize) -> Option<Vec<u8>> {
    let bytes = decompress_to_vec_with_limit(packed, length).ok()?;
    (bytes.len() == length).then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::paint::Paint;

    #[test]
    fn surfaces_come_back() {
        for (count, colors, in_table, is_flat, is_painted) in [
            (1u32, 1u32, 1, false, true),
            (400, 7, 7, true, false),
            (40_000, 9000, 0, false, true),
        ] {
            let at = |i: u32| (f64::from(i) * 0.618_033).fract();
            let triangle = |i: u32| {
                let numbers = [i, i + 1, i + 2];
                let point = |i: u32| [4.0 * at(i) - 1.0, at(3 * i + 1), 0.0].map(|c| c as f32);
                let corners = numbers.map(point);
                let color = |i: u32| {
                    let [a, b, ..] = (i % colors).to_le_bytes();
                    [a, b, 9]
                };
                LeafTriangle {
                    corners,
                    normals: match is_flat {
                        true => [surface::flat_normal(&corners); 3],
                        false => numbers.map(|i| (i % 9000) as u16),
                    },
                    colors: numbers.map(color),
                    paint: match is_painted {
                        true => Paint {
                            texture: i as u16 % 9,
                            alpha: (i % 255) as u8 + 1,
                            places: numbers.map(|i| [at(i) as f32 * 4.0, i as f32]),
                        },
                        false => Paint::NONE,
                    },
                }
            };
            let triangles: Vec<LeafTriangle> = (0..count).map(triangle).collect();
            let is_shared = |p: [f32; 3]| p[0] > 0.5;
            let mut node = Node {
                low: [-1.0, 0.0, 0.0],
                high: [3.0, 1.0, 0.0],
                ..bytemuck::Zeroable::zeroed()
            };
            let bytes = surface::lay_out(&mut node, &triangles, is_shared);
            assert_eq!(bytes.len() as u64, node.surface_bytes());
            assert_eq!(node.colors, in_table);
            let packed = pack(&Default::default(), &bytes);
            let (_, back) = unpack(&packed, &node).unwrap();
            assert_eq!(back.len(), triangles.len());
            for (was, is) in triangles.iter().zip(&back) {
                for (p, q) in was.corners.into_iter().zip(is.corners) {
                    let off = (0..3).map(|k| (p[k] - q[k]).abs()).fold(0.0, f32::max);
                    let most = if is_shared(p) { 0.0 } else { 2.0001 / 65535.0 };
                    assert!(off <= most, "{p:?} {q:?}");
                }
                assert_eq!((was.colors, was.paint), (is.colors, is.paint));
                let normals = match is_flat {
                    true => [surface::flat_normal(&is.corners); 3],
                    false => was.normals,
                };
                assert_eq!(normals, is.normals);
            }
            node.surface += 1;
            assert_eq!(unpack(&packed, &node), None);
        }
    }
}
