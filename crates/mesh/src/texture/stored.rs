//! Textures in a file (`spec/far.md`, File): one after another, deflated, without their coarser copies.

use std::sync::Arc;

use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::decompress_to_vec_with_limit;
use xxhash_rust::xxh3::xxh3_64;

use super::{AlphaMode, Texture, Wrap};

const EFFORT: u8 = 6;
const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

/// Deflated bytes, after a checksum and the number of bytes; nothing of none.
pub(crate) fn sealed(bytes: &[u8]) -> Vec<u8> {
    if bytes.is_empty() {
        return Vec::new();
    }
    let length = (bytes.len() as u64).to_le_bytes();
    let rest = [&length[..], &compress_to_vec(bytes, EFFORT)].concat();
    [&xxh3_64(&rest).to_le_bytes()[..], &rest].concat()
}

/// `None` for bytes that [`sealed`] does not make.
pub(crate) fn opened(bytes: &[u8]) -> Option<Vec<u8>> {
    if bytes.is_empty() {
        return Some(Vec::new());
    }
    let (checksum, rest) = bytes.split_first_chunk()?;
    let (length, deflated) = rest.split_first_chunk()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    if xxh3_64(rest) != u64::from_le_bytes(*checksum) {
        return None;
    }
    let all = decompress_to_vec_with_limit(deflated, length).ok()?;
    (all.len() == length && length > 0).then_some(all)
}

pub(crate) fn to_bytes(textures: &[Arc<Texture>]) -> Vec<u8> {
    let mut all = Vec::new();
    for texture in textures {
        let finest = &texture.levels[0];
        for side in finest.size {
            all.extend((side as u32).to_le_bytes());
        }
        let [across, down] = texture.wrap.map(|wrap| wrap as u8);
        all.extend([across, down, u8::from(texture.is_mask), 0]);
        for channel in 0..4 {
            // Differences between neighbours take fewer bits.
            let mut before = 0;
            all.extend(finest.texels.iter().map(|texel| {
                let step = texel[channel].wrapping_sub(before);
                before = texel[channel];
                step
            }));
        }
    }
    sealed(&all)
}

/// `None` for bytes that [`to_bytes`] does not write.
pub(crate) fn from_bytes(bytes: &[u8]) -> Option<Vec<Arc<Texture>>> {
    let all = opened(bytes)?;
    let mut left = &all[..];
    let mut textures = Vec::new();
    while !left.is_empty() {
        textures.push(Arc::new(next(&mut left)?));
    }
    Some(textures)
}

fn next(left: &mut &[u8]) -> Option<Texture> {
    let (head, rest) = left.split_first_chunk::<12>()?;
    let side = |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
    let [width, height] = [side(0), side(4)].map(|side| side as usize);
    let count = width.checked_mul(height).filter(|&count| count > 0)?;
    let (channels, rest) = rest.split_at_checked(count.checked_mul(4)?)?;
    *left = rest;
    let mut texels = vec![[0; 4]; count];
    for (channel, steps) in channels.chunks_exact(count).enumerate() {
        let mut value = 0u8;
        for (texel, step) in texels.iter_mut().zip(steps) {
            value = value.wrapping_add(*step);
            texel[channel] = value;
        }
    }
    let wrap = |at: usize| WRAPS.get(usize::from(head[at])).copied();
    let mode = match head[10] {
        0 => AlphaMode::Blend,
        1 => AlphaMode::Mask(0.5),
        _ => return None,
    };
    Some(Texture::new(
        [width, height],
        texels,
        mode,
        [wrap(8)?, wrap(9)?],
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textures_come_back_and_damage_is_seen() {
        let texels = |count: u8| (0..count).map(|n| [n, n * 3, 255 - n, n * 40]).collect();
        let mask = AlphaMode::Mask(0.3);
        let textures = [
            Texture::new(
                [3, 2],
                texels(6),
                AlphaMode::Blend,
                [Wrap::Mirror, Wrap::Clamp],
            ),
            Texture::new([1, 5], texels(5), mask, [Wrap::Repeat; 2]),
            Texture::new([2, 2], texels(4), AlphaMode::Opaque, [Wrap::Clamp; 2]),
        ];
        let textures = textures.map(Arc::new);
        let bytes = to_bytes(&textures);
        assert_eq!(from_bytes(&bytes).as_deref(), Some(&textures[..]));
        assert_eq!(from_bytes(&to_bytes(&[])), Some(Vec::new()));
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1;
            assert_eq!(from_bytes(&damaged), None, "byte {at}");
            assert!(at == 0 || from_bytes(&bytes[..at]).is_none(), "{at} bytes");
        }
    }
}
