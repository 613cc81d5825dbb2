//! Files of sections behind checksums, `.vxg`, `.far` and `.tvx`, put right after any damage: length, zeros between
//! sections, checksums. Faults are then in the fields alone. Follows `spec/graph.md`, `spec/far.md` and
//! `spec/textured.md`, and shares no code with the program. The fuzz targets have it too.

use std::ops::Range;

use xxhash_rust::xxh3::xxh3_64;

/// Bytes of the headers of `.far` and `.tvx`.
const RECORD: usize = 128;
/// Bytes of a node of a `.far` file.
const NODE: usize = 144;
/// Bytes of the header of `.vxg`.
const VXG_HEADER: usize = 512;
/// Bytes of a grid's entry in a `.tvx` file.
const GRID: usize = 80;
/// Longer files are not made.
const LONGEST: u64 = 1 << 16;

fn number(bytes: &[u8], at: usize, width: usize) -> u64 {
    let bytes = &bytes[at..at + width];
    bytes.iter().rev().fold(0, |n, &b| n << 8 | u64::from(b))
}

fn put(bytes: &mut [u8], at: usize, number: u64) {
    bytes[at..at + 8].copy_from_slice(&number.to_le_bytes());
}

/// The next section: so many items of so many bytes, from the next multiple of 64 on.
fn section(end: &mut u64, count: u64, item: u64) -> Range<u64> {
    let begin = end.saturating_add(63) & !63;
    *end = begin.saturating_add(count.saturating_mul(item));
    begin..*end
}

/// Gives the file the length that its sections have and zeros between them; nothing of a file that would be too long.
fn lay_out(bytes: &mut Vec<u8>, header: usize, sections: &[Range<u64>]) -> Option<()> {
    let end = sections.last()?.end;
    if end > LONGEST {
        return None;
    }
    bytes.resize(end as usize, 0);
    let mut before = header;
    for section in sections {
        bytes[before..section.start as usize].fill(0);
        before = section.end as usize;
    }
    put(bytes, 16, end);
    Some(())
}

fn slot(section: &Range<u64>) -> Range<usize> {
    section.start as usize..section.end as usize
}

/// Writes the checksum of a section. Sections beyond the file, or that end before they begin, have none.
fn seal(bytes: &mut [u8], section: &Range<u64>, at: usize) {
    if let Some(content) = bytes.get(slot(section)) {
        let sum = xxh3_64(content);
        put(bytes, at, sum);
    }
}

fn sealed(mut bytes: Vec<u8>, header: usize) -> Option<Vec<u8>> {
    let end = header - 8;
    seal(&mut bytes, &(0..end as u64), end);
    Some(bytes)
}

/// A `.vxg` file put right; nothing where its header says too much. With `place` sections follow each other.
pub(crate) fn vxg(mut bytes: Vec<u8>, place: bool) -> Option<Vec<u8>> {
    if bytes.len() < VXG_HEADER {
        return None;
    }
    let count = if number(&bytes, 8, 4) == 2 { 6 } else { 5 };
    let entries = [128, 160, 192, 224, 256, 416];
    let entries = &entries[..count];
    if place {
        let mut end = VXG_HEADER as u64;
        let lengths = entries.iter().map(|&entry| number(&bytes, entry + 16, 8));
        let sections: Vec<_> = lengths.map(|length| section(&mut end, length, 1)).collect();
        lay_out(&mut bytes, VXG_HEADER, &sections)?;
        for (&entry, section) in entries.iter().zip(&sections) {
            put(&mut bytes, entry + 8, section.start);
        }
    }
    let length = bytes.len() as u64;
    put(&mut bytes, 16, length);
    for &entry in entries {
        let [begin, length] = [8, 16].map(|at| number(&bytes, entry + at, 8));
        let own = begin..begin.saturating_add(length);
        seal(&mut bytes, &own, entry + 24);
    }
    sealed(bytes, VXG_HEADER)
}

/// A `.far` file put right; nothing where its header says too much. With `place` no node's data begins before that of
/// the one before it.
pub(crate) fn far(mut bytes: Vec<u8>, place: bool) -> Option<Vec<u8>> {
    if bytes.len() < RECORD + NODE {
        return None;
    }
    let [nodes, data] = [24, 32].map(|at| number(&bytes, at, 8));
    let mut end = RECORD as u64;
    let nodes = section(&mut end, nodes, NODE as u64);
    let data = section(&mut end, data, 1);
    lay_out(&mut bytes, RECORD, &[nodes.clone(), data.clone()])?;
    let length = data.end - data.start;
    let mut before = 0;
    for node in slot(&nodes).step_by(NODE) {
        if place {
            before = number(&bytes, node + 64, 8).clamp(before, length);
            put(&mut bytes, node + 64, before);
        }
    }
    let mut last = length;
    for node in slot(&nodes).step_by(NODE).rev() {
        let begin = number(&bytes, node + 64, 8);
        let [from, to] = [begin, last].map(|at| data.start + at.min(length));
        last = begin;
        seal(&mut bytes, &(from..to), node + 120);
    }
    seal(&mut bytes, &nodes, 96);
    sealed(bytes, RECORD)
}

/// A `.tvx` file put right; nothing where its header says too much. With `fit` its box is the one around its primitives.
pub(crate) fn tvx(mut bytes: Vec<u8>, fit: bool) -> Option<Vec<u8>> {
    if bytes.len() < RECORD {
        return None;
    }
    let grids = number(&bytes, 80, 4).clamp(1, 16) as usize;
    bytes[80..84].copy_from_slice(&(grids as u32).to_le_bytes());
    if bytes.len() < RECORD + grids * GRID {
        return None;
    }
    let mut end = RECORD as u64;
    let entries = section(&mut end, grids as u64, GRID as u64);
    let primitives = section(&mut end, number(&bytes, 24, 8), 52);
    let mut sections = vec![entries.clone(), primitives.clone()];
    for entry in slot(&entries).step_by(GRID) {
        let texels = number(&bytes, entry + 4, 4);
        let face = texels.saturating_mul(texels).saturating_mul(6);
        for (at, item) in [(16, 24), (24, 4), (32, face)] {
            sections.push(section(&mut end, number(&bytes, entry + at, 8), item));
        }
    }
    lay_out(&mut bytes, RECORD, &sections)?;
    for (grid, entry) in slot(&entries).step_by(GRID).enumerate() {
        for part in 0..3 {
            let own = &sections[2 + 3 * grid + part];
            seal(&mut bytes, own, entry + 56 + 8 * part);
        }
    }
    if fit {
        for k in 0..3 {
            let of_corner = |at: usize| f64::from(f32::from_bits(number(&bytes, at, 4) as u32));
            let corners = slot(&primitives).step_by(52);
            let values =
                corners.flat_map(|p| [0, 12, 24].map(|corner| of_corner(p + corner + 4 * k)));
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
                (l.min(v), h.max(v))
            });
            put(&mut bytes, 32 + 8 * k, low.to_bits());
            put(&mut bytes, 56 + 8 * k, high.to_bits());
        }
    }
    seal(&mut bytes, &primitives, 104);
    seal(&mut bytes, &entries, 112);
    sealed(bytes, RECORD)
}
