//! Helpers of the input tests: reading into a list, finding data, and a writer of small `.vox` files.

#![allow(
    dead_code,
    unreachable_pub,
    clippy::unwrap_used,
    reason = "test helpers; each test file uses a part"
)]

use std::path::PathBuf;

use shiftvox::graph::{Silent, Voxel};
use shiftvox::scene::{ReadOptions, SceneError, SceneInfo, read_voxels_from};

/// Index and colour.
pub type Plain = ([i32; 3], [u8; 3]);

/// Reads bytes into a list.
pub fn read(bytes: &[u8], options: &ReadOptions) -> Result<(Vec<Voxel>, SceneInfo), SceneError> {
    let mut voxels = Vec::new();
    let info = read_voxels_from(bytes, "test", options, &mut |v| voxels.push(v), &Silent)?;
    assert_eq!(info.voxels, voxels.len() as u64);
    Ok((voxels, info))
}

/// Reads bytes by default options into a list of index and colour, in the file's order.
pub fn read_plain(bytes: &[u8]) -> Vec<Plain> {
    let (voxels, _) = read(bytes, &ReadOptions::default()).unwrap();
    voxels.into_iter().map(|v| (v.index, v.color)).collect()
}

/// The text of an error.
pub fn message(bytes: &[u8]) -> String {
    read(bytes, &ReadOptions::default())
        .unwrap_err()
        .to_string()
}

/// A file that ships with the tests.
pub fn shipped(name: &str) -> Vec<u8> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(name);
    std::fs::read(path).unwrap()
}

/// A file of the folder `SHIFTVOX_DATA`, for tests that are ignored without it.
pub fn shared(name: &str) -> Vec<u8> {
    let folder = std::env::var_os("SHIFTVOX_DATA").expect("SHIFTVOX_DATA names a folder");
    std::fs::read(PathBuf::from(folder).join(name)).unwrap()
}

/// Attributes of a node.
pub type Attributes<'a> = &'a [(&'a str, &'a str)];

/// A `.vox` file in the making: chunks are appended as they are called for, right or wrong.
#[derive(Default)]
pub struct VoxFile {
    children: Vec<u8>,
}

impl VoxFile {
    pub fn new() -> Self {
        Self::default()
    }

    pub fn chunk(mut self, id: &[u8; 4], content: &[u8]) -> Self {
        self.children.extend(id);
        self.children.extend((content.len() as u32).to_le_bytes());
        self.children.extend(0u32.to_le_bytes());
        self.children.extend(content);
        self
    }

    pub fn model(self, size: [u32; 3], voxels: &[[u8; 4]]) -> Self {
        let mut content = (voxels.len() as u32).to_le_bytes().to_vec();
        content.extend(voxels.as_flattened());
        self.chunk(b"SIZE", &numbers(&size))
            .chunk(b"XYZI", &content)
    }

    pub fn palette(self, entries: &[[u8; 4]]) -> Self {
        self.chunk(b"RGBA", entries.as_flattened())
    }

    pub fn transform(
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

    pub fn group(self, id: u32, children: &[u32]) -> Self {
        let mut content = numbers(&[id]);
        content.extend(dict(&[]));
        content.extend(numbers(&[children.len() as u32]));
        content.extend(numbers(children));
        self.chunk(b"nGRP", &content)
    }

    pub fn shape(self, id: u32, models: &[(u32, Attributes<'_>)]) -> Self {
        let mut content = numbers(&[id]);
        content.extend(dict(&[]));
        content.extend(numbers(&[models.len() as u32]));
        for (model, attributes) in models {
            content.extend(numbers(&[*model]));
            content.extend(dict(attributes));
        }
        self.chunk(b"nSHP", &content)
    }

    pub fn layer(self, id: u32, attributes: Attributes<'_>) -> Self {
        let mut content = numbers(&[id]);
        content.extend(dict(attributes));
        content.extend(numbers(&[u32::MAX]));
        self.chunk(b"LAYR", &content)
    }

    pub fn bytes(&self) -> Vec<u8> {
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

/// Reads bytes with so many different damages: whatever comes of that, it does not panic.
pub fn read_damaged(bytes: &[u8], rounds: u64) {
    for seed in 0..rounds {
        let mut damaged = bytes.to_vec();
        damage(&mut damaged, seed);
        let options = ReadOptions::default();
        let _ = read_voxels_from(&damaged, "damaged", &options, &mut |_| (), &Silent);
    }
}

/// Damages bytes in a way that depends on `seed` alone.
pub fn damage(bytes: &mut [u8], seed: u64) {
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
