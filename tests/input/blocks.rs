//! Grids of Qubicle and of Minecraft.

use std::io::Write;

use flate2::{Compression, write::GzEncoder};
use shiftvox::scene::ReadOptions;

use crate::wrong::{cut_and_damaged, refused};
use crate::{Plain, read, read_plain, read_with};

fn words(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

/// A scene of Qubicle with the given settings: colour order, depth axis and compression.
fn qb([order, axis, packed]: [u32; 3], matrices: &[([u32; 6], &[u32])]) -> Vec<u8> {
    let mut bytes = words(&[0x101, order, axis, packed, 0, matrices.len() as u32]);
    for (place, data) in matrices {
        bytes.extend(b"\x03abc");
        bytes.extend(words(place));
        bytes.extend(words(data));
    }
    bytes
}

const RED: u32 = 0xff00_00c8;
const DARK: u32 = 0x0103_0201;

#[test]
fn matrices_of_qubicle_are_placed_turned_and_unpacked() {
    let place = [2, 1, 2, 5, 6, -7i32 as u32];
    let plain: &[u32] = &[RED, 0, DARK, RED];
    let packed: &[u32] = &[RED, 0, 6, DARK, RED, 6];
    let runs: &[u32] = &[RED, 2, 1, 0, 6, 2, 1, DARK, RED, 6];
    let red = [200, 0, 0];
    let expected: [Plain; 3] = [
        ([5, -7, 6], red),
        ([5, -6, 6], [1, 2, 3]),
        ([6, -6, 6], red),
    ];
    for (settings, data) in [([0; 3], plain), ([0, 0, 1], packed), ([0, 0, 1], runs)] {
        let bytes = qb(
            settings,
            &[
                ([0, 9, 9, 0, 0, 0], &[6; 9][..9 * settings[2] as usize]),
                (place, data),
            ],
        );
        assert_eq!(read_plain(&bytes), expected, "{data:?}");
        cut_and_damaged(&bytes, bytes.len(), 2_000);
    }
    // Blue first, and depth towards the viewer.
    let turned = expected.map(|([x, y, z], [r, g, b])| ([x, -1 - y, z], [b, g, r]));
    assert_eq!(read_plain(&qb([1, 1, 0], &[(place, plain)])), turned);
    let (_, info) = read(&[&qb([0; 3], &[(place, plain)]), &b"more"[..]].concat()).unwrap();
    assert_eq!(
        info.warnings,
        ["4 bytes after the last matrix were not read"]
    );
    for (bytes, part) in [
        (
            qb([0, 2, 0], &[]),
            "header at byte 12: expected a setting of 0 or 1, found 2",
        ),
        (
            qb([0; 3], &[([1 << 21, 1, 1, 0, 0, 0], &[])]),
            "matrix 0 at byte 32: expected sizes up to 2097151",
        ),
        (
            qb([0, 0, 1], &[(place, &[2, 3, RED])]),
            "expected 2 more voxels in a slice at most, found 3",
        ),
    ] {
        refused(&bytes, part);
    }
    // A run of 2^40 voxels.
    let huge = qb(
        [0, 0, 1],
        &[([1 << 20, 1 << 20, 1, 0, 0, 0], &[2, u32::MAX, RED, 6])],
    );
    let options = ReadOptions {
        most_voxels: 1000,
        ..ReadOptions::default()
    };
    assert!(read_with(&huge, &options).unwrap_err().is_limit());
}

/// A named value of NBT.
fn tag(kind: u8, name: &str, content: &[u8]) -> Vec<u8> {
    let length = (name.len() as u16).to_be_bytes();
    [&[kind][..], &length, name.as_bytes(), content].concat()
}

fn compound(name: &str, entries: &[Vec<u8>]) -> Vec<u8> {
    tag(10, name, &[&entries.concat()[..], &[0]].concat())
}

fn short(name: &str, value: u16) -> Vec<u8> {
    tag(2, name, &value.to_be_bytes())
}

fn int(name: &str, value: i32) -> Vec<u8> {
    tag(3, name, &value.to_be_bytes())
}

fn text(name: &str, value: &str) -> Vec<u8> {
    tag(
        8,
        name,
        &[&(value.len() as u16).to_be_bytes()[..], value.as_bytes()].concat(),
    )
}

fn array(kind: u8, name: &str, count: usize, bytes: &[u8]) -> Vec<u8> {
    tag(
        kind,
        name,
        &[&(count as u32).to_be_bytes()[..], bytes].concat(),
    )
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut file = GzEncoder::new(Vec::new(), Compression::default());
    file.write_all(bytes).unwrap();
    file.finish().unwrap()
}

/// Two blocks east, one up, two south, of versions 2 and 3. The number 300 takes two bytes.
fn schem(version: i32) -> Vec<u8> {
    let states = [
        int("minecraft:air", 0),
        int("minecraft:oak_stairs[facing=east]", 300),
        int("mod:widget", 2),
    ];
    let states = compound("Palette", &states);
    let data = [0, 0xac, 2, 2, 0xac, 2];
    let size = [short("Width", 2), short("Height", 1), short("Length", 2)].concat();
    // Values of all other kinds, which are skipped.
    let more = [
        tag(5, "real", &[0; 4]),
        array(11, "Offset", 1, &[9; 4]),
        tag(1, "b", &[1]),
    ]
    .concat();
    let list = tag(9, "lists", &[9, 0, 0, 0, 1, 3, 0, 0, 0, 1, 0, 0, 0, 7]);
    let begin = [int("Version", version), more, list, size];
    let begin = begin.concat();
    if version == 2 {
        return compound(
            "Schematic",
            &[begin, states, array(7, "BlockData", 6, &data)],
        );
    }
    let blocks = compound("Blocks", &[states, array(7, "Data", 6, &data)]);
    compound("", &[compound("Schematic", &[begin, blocks])])
}

const OAK: [u8; 3] = [0xa2, 0x83, 0x4f];
const GRAY: [u8; 3] = [200; 3];

#[test]
fn schematics_of_sponge() {
    let expected = [([1, -1, 0], OAK), ([0, -2, 0], GRAY), ([1, -2, 0], OAK)];
    for version in [2, 3] {
        let bytes = schem(version);
        for bytes in [&packed(&bytes), &bytes] {
            assert_eq!(read_plain(bytes), expected, "{version}");
            let (_, info) = read(bytes).unwrap();
            let part = "kinds of blocks without a colour of their own, which got the default one: 1, such as \"mod:widget\"";
            assert_eq!(info.warnings, [part]);
        }
        cut_and_damaged(&bytes, bytes.len(), 10_000);
        cut_and_damaged(&packed(&bytes), 40, 2_000);
    }
    for (from, to, part) in [
        (
            &b"Width"[..],
            &b"Widht"[..],
            "expected an entry \"Width\" of its type, found none",
        ),
        (
            b"\x00\x06Height\x00\x01",
            b"\x00\x06Height\x00\x02",
            "expected 8 blocks, found 4",
        ),
        (
            b"\xac\x02\x02",
            b"\xad\x02\x02",
            "expected numbers of the palette, found 301",
        ),
        (
            b"\x09\x00\x05lists",
            b"\x0d\x00\x05lists",
            "kinds of values from 1 to 12, found 13",
        ),
    ] {
        let bytes = schem(3);
        let at = bytes.windows(from.len()).position(|w| w == from).unwrap();
        refused(
            &[&bytes[..at], to, &bytes[at + from.len()..]].concat(),
            part,
        );
    }
    let old = compound("Schematic", &[array(7, "Blocks", 1, &[1])]);
    refused(&packed(&old), "WorldEdit: //schem save NAME sponge.3");
    // Lists in lists exhaust no stack.
    let deep = [0u8, 0, 0, 1, 9].repeat(100_000);
    refused(
        &compound("", &[tag(9, "a", &[&[9], &deep[..]].concat())]),
        "at most 512 levels",
    );
}

/// A region of Litematica from `(1, 2, 3)`, with blocks of two kinds among `states`.
fn litematic(states: usize, blocks: &[u64], size: [i32; 3]) -> Vec<u8> {
    let vector =
        |name, [x, y, z]: [i32; 3]| compound(name, &[int("x", x), int("y", y), int("z", z)]);
    let state = |n| {
        let name = text(
            "Name",
            if n + 1 == states {
                "minecraft:oak_planks"
            } else {
                "minecraft:air"
            },
        );
        [&name[..], &[0]].concat()
    };
    let states: Vec<Vec<u8>> = (0..states).map(state).collect();
    let head = [
        &[10][..],
        &(states.len() as u32).to_be_bytes(),
        &states.concat(),
    ]
    .concat();
    let words: Vec<u8> = blocks.iter().flat_map(|word| word.to_be_bytes()).collect();
    let region = [
        vector("Position", [1, 2, 3]),
        vector("Size", size),
        tag(9, "BlockStatePalette", &head),
        array(12, "BlockStates", blocks.len(), &words),
    ];
    let regions = [compound("one", &region)];
    compound("", &[int("Version", 6), compound("Regions", &regions)])
}

#[test]
fn schematics_of_litematica() {
    // 17 states have 5 bits, so block 12 is in two words.
    let last = 16u128;
    let bits = last | last << (5 * 12);
    let words = [bits as u64, (bits >> 64) as u64];
    let bytes = litematic(17, &words, [2, 7, 1]);
    let expected = [([1, -4, 2], OAK), ([1, -4, 8], OAK)];
    assert_eq!(read_plain(&packed(&bytes)), expected);
    cut_and_damaged(&bytes, bytes.len(), 10_000);
    // Two bits at least. A negative size begins at the other corner.
    let bytes = litematic(2, &[1], [-2, 1, -2]);
    assert_eq!(read_plain(&bytes), [([0, -3, 2], OAK)]);
    refused(
        &litematic(2, &[1], [-2, 1, 40]),
        "expected 80 blocks, found 32",
    );
    refused(
        &litematic(1, &[1], [1, 1, 1]),
        "expected numbers of the palette, found 1",
    );
    refused(&litematic(2, &[1], [i32::MIN; 3]), "fewer blocks");
}
