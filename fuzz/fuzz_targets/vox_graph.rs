//! A `.vox` whose scene graph shares nodes, composed from bytes, is read or rejected within the limit of voxels.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shiftvox::graph::Silent;
use shiftvox::scene::{ReadOptions, read_voxels_from};

const MOST: u64 = 1 << 16;
const NODES: usize = 64;

/// Bytes, then zeros.
struct Choices<'d>(std::slice::Iter<'d, u8>);

impl Choices<'_> {
    fn byte(&mut self) -> u8 {
        self.0.next().copied().unwrap_or(0)
    }

    fn below(&mut self, end: usize) -> u32 {
        u32::from(self.byte()) % end as u32
    }
}

fn numbers(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

fn chunk(file: &mut Vec<u8>, id: &[u8; 4], content: &[u8]) {
    file.extend(id);
    file.extend(numbers(&[content.len() as u32, 0]));
    file.extend(content);
}

fn text(text: &str) -> Vec<u8> {
    let mut bytes = numbers(&[text.len() as u32]);
    bytes.extend(text.as_bytes());
    bytes
}

/// A node; children have higher numbers, unless a byte says that they need not.
fn node(file: &mut Vec<u8>, number: usize, nodes: usize, models: usize, choices: &mut Choices<'_>) {
    let mut content = numbers(&[number as u32, 0]);
    let child = |choices: &mut Choices<'_>| match choices.byte() {
        255 => choices.below(nodes + 1),
        step => (number + 1 + usize::from(step) % 3).min(nodes - 1) as u32,
    };
    match choices.below(3) {
        _ if number + 1 == nodes => {
            content.extend(numbers(&[1, choices.below(models), 0]));
            chunk(file, b"nSHP", &content);
        }
        0 => {
            let to = child(choices);
            content.extend(numbers(&[to, u32::MAX, u32::MAX, 1, 2]));
            let by = [0; 3].map(|_| (i32::from(choices.byte() as i8) >> 2).to_string());
            for word in ["_t", &by.join(" "), "_r", &choices.below(128).to_string()] {
                content.extend(text(word));
            }
            chunk(file, b"nTRN", &content);
        }
        1 => {
            let children: Vec<u32> = (0..choices.below(5)).map(|_| child(choices)).collect();
            content.extend(numbers(&[children.len() as u32]));
            content.extend(numbers(&children));
            chunk(file, b"nGRP", &content);
        }
        _ => {
            let shown = choices.below(4);
            content.extend(numbers(&[shown]));
            for _ in 0..shown {
                content.extend(numbers(&[choices.below(models + 1), 0]));
            }
            chunk(file, b"nSHP", &content);
        }
    }
}

fuzz_target!(|data: &[u8]| {
    let mut choices = Choices(data.iter());
    let (nodes, models) = (
        1 + choices.below(NODES) as usize,
        1 + choices.below(3) as usize,
    );
    let mut file = Vec::new();
    for _ in 0..models {
        let voxels = choices.below(6);
        chunk(&mut file, b"SIZE", &numbers(&[2 + choices.below(3), 2, 2]));
        let mut content = numbers(&[voxels]);
        for _ in 0..voxels {
            content.extend([
                choices.byte() % 4,
                choices.byte() % 3,
                choices.byte() % 2,
                choices.byte(),
            ]);
        }
        chunk(&mut file, b"XYZI", &content);
    }
    for number in 0..nodes {
        node(&mut file, number, nodes, models, &mut choices);
    }
    let mut bytes = b"VOX \x96\0\0\0MAIN\0\0\0\0".to_vec();
    bytes.extend(numbers(&[file.len() as u32]));
    bytes.extend(file);
    let options = ReadOptions {
        most_voxels: MOST,
        ..ReadOptions::default()
    };
    let mut count = 0u64;
    let result = read_voxels_from(&bytes, "fuzz", &options, &mut |_| count += 1, &Silent);
    assert!(count <= MOST);
    if let Ok(info) = result {
        assert_eq!(info.voxels, count);
    }
});
