//! A second writer of `.vxg` files, from `spec/graph.md`. It stores any arrays, sound or not, with correct lengths and
//! checksums.

use shiftvox::graph::{Graph, PackedNormal, Placement};
use xxhash_rust::xxh3::xxh3_64;

const HEADER_BYTES: usize = 512;
const SECTION_TABLE: usize = 128;
const ENTRY_BYTES: usize = 32;
const LEVEL_START: usize = 288;
/// End of the level table; the rest is reserved.
const LEVEL_END: usize = LEVEL_START + 4 * 32;
const CHECKSUM: usize = 504;
const TAGS: [(&[u8; 4], u32); 5] = [
    (b"MASK", 1),
    (b"FRST", 4),
    (b"LINK", 4),
    (b"COLR", 3),
    (b"NRML", 2),
];

/// Corrects the file's length and checksums.
pub fn seal(bytes: &mut [u8]) {
    if bytes.len() < HEADER_BYTES {
        return;
    }
    let length = (bytes.len() as u64).to_le_bytes();
    bytes[16..24].copy_from_slice(&length);
    for section in 0..TAGS.len() {
        let entry = SECTION_TABLE + section * ENTRY_BYTES;
        let offset = u64_at(bytes, entry + 8);
        let end = offset.saturating_add(u64_at(bytes, entry + 16));
        if let Some(contents) = bytes.get(offset..end) {
            let sum = xxh3_64(contents).to_le_bytes();
            bytes[entry + 24..entry + 32].copy_from_slice(&sum);
        }
    }
    let sum = xxh3_64(&bytes[..CHECKSUM]).to_le_bytes();
    bytes[CHECKSUM..HEADER_BYTES].copy_from_slice(&sum);
}

fn u64_at(bytes: &[u8], at: usize) -> usize {
    let mut eight = [0; 8];
    eight.copy_from_slice(&bytes[at..at + 8]);
    u64::from_le_bytes(eight) as usize
}

/// The file of a graph, sound or not.
pub fn file_of(graph: &Graph) -> Vec<u8> {
    let numbers = |of: &[u32]| of.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>();
    let contents = [
        graph.mask.to_vec(),
        numbers(&graph.first),
        numbers(&graph.links),
        graph.color.iter().flatten().copied().collect(),
        graph
            .normal
            .iter()
            .flat_map(|n| n.0.to_le_bytes())
            .collect(),
    ];
    let mut bytes = vec![0; HEADER_BYTES];
    let mut place = |at: usize, part: &[u8]| bytes[at..at + part.len()].copy_from_slice(part);
    place(0, b"\x89VXG\r\n\x1a\n");
    place(8, &1u32.to_le_bytes());
    place(12, &(HEADER_BYTES as u32).to_le_bytes());
    place(24, &graph.depth.to_le_bytes());
    place(28, &graph.root.to_le_bytes());
    place(32, &graph.voxels.to_le_bytes());
    for axis in 0..3 {
        let placement = &graph.placement;
        place(40 + 8 * axis, &placement.origin_index[axis].to_le_bytes());
        place(64 + 8 * axis, &placement.world_origin[axis].to_le_bytes());
    }
    place(88, &graph.placement.voxel_size.to_le_bytes());
    place(96, &(graph.level_start.len() as u32).to_le_bytes());
    place(100, &(TAGS.len() as u32).to_le_bytes());
    for (at, start) in (LEVEL_START..LEVEL_END).step_by(4).zip(&graph.level_start) {
        place(at, &start.to_le_bytes());
    }
    for (section, (tag, item_bytes)) in TAGS.into_iter().enumerate() {
        bytes.resize(bytes.len().next_multiple_of(64), 0);
        let offset = (bytes.len() as u64).to_le_bytes();
        let length = (contents[section].len() as u64).to_le_bytes();
        let entry = SECTION_TABLE + section * ENTRY_BYTES;
        bytes[entry..entry + 4].copy_from_slice(tag);
        bytes[entry + 4..entry + 8].copy_from_slice(&item_bytes.to_le_bytes());
        bytes[entry + 8..entry + 16].copy_from_slice(&offset);
        bytes[entry + 16..entry + 24].copy_from_slice(&length);
        bytes.extend(&contents[section]);
    }
    seal(&mut bytes);
    bytes
}

/// A small graph from a few bytes, mostly unsound. Missing bytes are zeros.
///
/// Six bytes are depth, root, and the numbers of level entries, masks, links and nodes. The arrays follow, one byte per
/// entry.
pub fn graph_of(bytes: &[u8]) -> Graph {
    let mut bytes = bytes.iter().copied();
    let mut next = || bytes.next().unwrap_or(0);
    // The highest few mean numbers near the largest.
    let number = |byte: u8| match byte {
        0..250 => u32::from(byte),
        _ => u32::MAX - u32::from(255 - byte),
    };
    let [depth, root, levels, masks, links, nodes] = std::array::from_fn(|_| next());
    // Small graphs suffice and are faster.
    let (masks, links, nodes) = (masks % 64, links % 128, nodes % 64);
    let mut numbers = |count: u8| (0..count).map(|_| number(next())).collect::<Vec<_>>();
    let level_start = numbers(levels);
    let mask = numbers(masks).iter().map(|&n| n as u8).collect::<Vec<_>>();
    let first = numbers(masks);
    let links = numbers(links);
    let attributes = numbers(nodes);
    let color = attributes.iter().map(|&n| [n as u8, (n >> 4) as u8, 3]);
    let normal = attributes
        .iter()
        .map(|&n| PackedNormal((n as u16).wrapping_mul(257)));
    let mut graph = Graph {
        depth: u32::from(depth),
        root: number(root),
        mask: mask.into(),
        first: first.into(),
        links: links.into(),
        color: color.collect::<Vec<_>>().into(),
        normal: normal.collect::<Vec<_>>().into(),
        opacity: Vec::new().into(),
        level_start,
        voxels: 0,
        placement: Placement::default(),
    };
    // No fuzzer guesses the count that a file must state. It is checked last, when level entries bound the counting.
    if graph
        .validate()
        .is_err_and(|invalid| invalid.array == "voxels")
    {
        graph.voxels = graph.count_voxels();
    }
    graph
}
