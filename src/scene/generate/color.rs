//! Colours of generated scenes (sRGB).

/// A few colours that go together.
const PALETTE: [[u8; 3]; 8] = [
    [214, 96, 77],
    [244, 165, 96],
    [230, 205, 120],
    [134, 184, 106],
    [78, 154, 148],
    [67, 120, 178],
    [126, 97, 168],
    [190, 110, 150],
];

/// A colour of the palette, repeating.
pub(super) fn palette(which: u32) -> [u8; 3] {
    PALETTE[which as usize % PALETTE.len()]
}

/// A light colour that grows with the position in a cube of `side` voxels.
pub(super) fn gradient(index: [i32; 3], side: i32) -> [u8; 3] {
    // 70 + 170 at most: fits a byte.
    index.map(|i| (70 + i64::from(i) * 170 / i64::from(side)) as u8)
}
