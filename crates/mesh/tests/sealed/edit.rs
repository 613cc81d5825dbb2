//! Edits of a file's fields, each as 64 bits say: of a random number, or of a fuzzer.

/// Values that fields of numbers rarely expect, as `f64` and as `f32`.
const ODD: [f64; 8] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    1e308,
    -1e30,
    1e-38,
    0.0,
    -1.0,
];

/// Does one edit. Two of three are among the first `fields` bytes, of header and tables.
pub(crate) fn edit(bytes: &mut [u8], fields: usize, choice: u64) {
    let taken = |from: u32, bits: u32| choice >> from & ((1 << bits) - 1);
    let width = 1usize << taken(0, 2);
    let range = match taken(2, 2) {
        0 => bytes.len(),
        _ => fields.min(bytes.len()),
    };
    let place = |number: u64| number as usize % (range / width).max(1) * width;
    let at = place(taken(8, 24));
    let Some(field) = bytes.get(at..at + width) else {
        return;
    };
    let mut old = [0; 8];
    old[..width].copy_from_slice(field);
    let old = u64::from_le_bytes(old);
    let value = taken(32, 32);
    let new = match taken(4, 4) {
        0 => 0,
        1 => u64::MAX,
        2 | 3 => old.wrapping_add(1),
        4 | 5 => old.wrapping_sub(1),
        6 => old << 1,
        7..10 => old ^ 1 << (value % (8 * width as u64)),
        10 => value,
        11 => u64::from(value as u8),
        12 => {
            // Another field's.
            let other = place(value);
            let mut copy = [0; 8];
            copy[..width].copy_from_slice(&bytes[other..other + width]);
            u64::from_le_bytes(copy)
        }
        _ => {
            let odd = ODD[value as usize % ODD.len()];
            match width {
                8 => odd.to_bits(),
                _ => u64::from((odd as f32).to_bits()),
            }
        }
    };
    bytes[at..at + width].copy_from_slice(&new.to_le_bytes()[..width]);
}
