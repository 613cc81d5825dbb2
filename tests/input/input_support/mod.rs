//! Helpers of the input tests: reading into a list, the drivers of wrong files, and a writer of small `.vox` files.

use std::path::Path;

use shiftvox::graph::{Silent, Voxel};
use shiftvox::scene::{ReadOptions, SceneError, SceneInfo, read_voxels_from};
use xxhash_rust::xxh3::Xxh3;

/// Index and colour.
pub(crate) type Plain = ([i32; 3], [u8; 3]);

pub(crate) fn read(
    bytes: &[u8],
    options: &ReadOptions,
) -> Result<(Vec<Voxel>, SceneInfo), SceneError> {
    let mut voxels = Vec::new();
    let info = read_voxels_from(bytes, "test", options, &mut |v| voxels.push(v), &Silent)?;
    assert_eq!(info.voxels, voxels.len() as u64);
    Ok((voxels, info))
}

/// Reads bytes by default options into a list of index and colour, in the file's order.
pub(crate) fn read_plain(bytes: &[u8]) -> Vec<Plain> {
    let (voxels, _) = read(bytes, &ReadOptions::default()).unwrap();
    voxels.into_iter().map(|v| (v.index, v.color)).collect()
}

pub(crate) fn digest(voxels: &[Plain]) -> u64 {
    let mut hash = Xxh3::new();
    for (index, color) in voxels {
        index.iter().for_each(|c| hash.update(&c.to_le_bytes()));
        hash.update(color);
    }
    hash.digest()
}

/// Each file is refused with a message that has the text beside it.
pub(crate) fn refused<'t>(cases: impl IntoIterator<Item = (Vec<u8>, &'t str)>) {
    for (bytes, part) in cases {
        let text = read(&bytes, &ReadOptions::default())
            .unwrap_err()
            .to_string();
        assert!(text.contains(part), "\n{text}\nlacks\n{part}");
    }
}

/// No beginning shorter than `whole` is accepted, and no damage panics.
pub(crate) fn cut_and_damaged(bytes: &[u8], whole: usize, rounds: u64) {
    for length in 0..whole {
        let cut = read(&bytes[..length], &ReadOptions::default());
        assert!(cut.is_err(), "{length}");
    }
    for seed in 0..rounds {
        let mut damaged = bytes.to_vec();
        damage(&mut damaged, seed);
        let _ = read(&damaged, &ReadOptions::default());
    }
}

/// A file below the repository.
pub(crate) fn shipped(path: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

/// A file of the folder `SHIFTVOX_DATA`, for tests that are ignored without it.
pub(crate) fn shared(path: &str) -> Vec<u8> {
    let folder = std::env::var_os("SHIFTVOX_DATA").expect("SHIFTVOX_DATA names a folder");
    std::fs::read(Path::new(&folder).join(path)).unwrap()
}

/// Attributes of a node.
pub(crate) type Attributes<'a> = &'a [(&'a str, &'a str)];

/// A `.vox` file in the making: chunks are appended as they are called for, right or wrong.
#[derive(Default)]
pub(crate) struct VoxFile {
    children: Vec<u8>,
}

impl VoxFile {
    pub(crate) fn new() -> Self {
        Self::default()
    }

    pub(crate) fn chunk(mut self, id: &[u8; 4], content: &[u8]) -> Self {
        self.children.extend(id);
        self.children.extend((content.len() as u32).to_le_bytes());
        self.children.extend(0u32.to_le_bytes());
        self.children.extend(content);
        self
    }

    pub(crate) fn model(self, size: [u32; 3], voxels: &[[u8; 4]]) -> Self {
        let mut content = (voxels.len() as u32).to_le_bytes().to_vec();
        content.extend(voxels.as_flattened());
        self.chunk(b"SIZE", &numbers(&size))
            .chunk(b"XYZI", &content)
    }

    pub(crate) fn palette(self, entries: &[[u8; 4]]) -> Self {
        self.chunk(b"RGBA", entries.as_flattened())
    }

    pub(crate) fn transform(
        self,
        id: u32,
        attributes: Attributes<'_>,
        child: u32,
        layer: i32,
        frames: &[Attributes<'_>],
    ) -> Self {
        let mut content = numbers(&[id]);
        content.extend(dict(attributes));
        content.extend(numbers(&[
            child,
            u32::MAX,
            layer as u32,
            frames.len() as u32,
        ]));
        for frame in frames {
            content.extend(dict(frame));
        }
        self.chunk(b"nTRN", &content)
    }

    pub(crate) fn group(self, id: u32, children: &[u32]) -> Self {
        let mut content = numbers(&[id]);
        content.extend(dict(&[]));
        content.extend(numbers(&[children.len() as u32]));
        content.extend(numbers(children));
        self.chunk(b"nGRP", &content)
    }

    pub(crate) fn shape(self, id: u32, models: &[(u32, Attributes<'_>)]) -> Self {
        let mut content = numbers(&[id]);
        content.extend(dict(&[]));
        content.extend(numbers(&[models.len() as u32]));
        for (model, attributes) in models {
            content.extend(numbers(&[*model]));
            content.extend(dict(attributes));
        }
        self.chunk(b"nSHP", &content)
    }

    pub(crate) fn layer(self, id: u32, attributes: Attributes<'_>) -> Self {
        let mut content = numbers(&[id]);
        content.extend(dict(attributes));
        content.extend(numbers(&[u32::MAX]));
        self.chunk(b"LAYR", &content)
    }

    /// Appends chunks that are bytes already.
    pub(crate) fn chunks(mut self, chunks: &[u8]) -> Self {
        self.children.extend(chunks);
        self
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut bytes = b"VOX \x96\0\0\0MAIN\0\0\0\0".to_vec();
        bytes.extend((self.children.len() as u32).to_le_bytes());
        bytes.extend(&self.children);
        bytes
    }
}

fn numbers(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

fn dict(attributes: Attributes<'_>) -> Vec<u8> {
    let mut bytes = numbers(&[attributes.len() as u32]);
    for (key, value) in attributes {
        for text in [key, value] {
            bytes.extend(numbers(&[text.len() as u32]));
            bytes.extend(text.as_bytes());
        }
    }
    bytes
}

/// Damages bytes in a way that depends on `seed` alone.
fn damage(bytes: &mut [u8], seed: u64) {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    for _ in 0..=next() % 4 {
        let at = next() as usize % bytes.len();
        bytes[at] = match next() % 4 {
            0 => 0,
            1 => 255,
            2 => bytes[at] ^ (1 << (next() % 8)),
            _ => next() as u8,
        };
    }
}
