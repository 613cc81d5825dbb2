//! Repairs length, zeros and checksums of damaged `.vxg`, `.far` and `.tvx` files, so that faults are in fields alone.
//! Shares no code with the program. `None` of files that would be too long. The fuzz targets use it too.

use std::ops::Range;

use xxhash_rust::xxh3::xxh3_64;

/// Bytes of the headers of `.far` and `.tvx`, a node of `.far`, a grid's entry in `.tvx`, and the header of `.vxg`.
const RECORD: usize = 128;
const NODE: usize = 144;
const GRID: usize = 80;
const VXG_HEADER: usize = 512;
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

/// Gives the file the length that its sections have, and zeros between them.
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
    Some(())
}

fn slot(section: &Range<u64>) -> Range<usize> {
    section.start as usize..section.end as usize
}

/// Writes the length and the checksums of sections, each with its place: last ones first, because tables hold them.
fn sealed(mut bytes: Vec<u8>, header: usize, sections: &[(Range<u64>, usize)]) -> Vec<u8> {
    let length = bytes.len() as u64;
    put(&mut bytes, 16, length);
    for (section, at) in sections.iter().rev() {
        if let Some(sum) = bytes.get(slot(section)).map(xxh3_64) {
            put(&mut bytes, *at, sum);
        }
    }
    let sum = xxh3_64(&bytes[..header - 8]);
    put(&mut bytes, header - 8, sum);
    bytes
}

/// With `place` sections follow each other.
pub(crate) fn vxg(mut bytes: Vec<u8>, place: bool) -> Option<Vec<u8>> {
    if bytes.len() < VXG_HEADER {
        return None;
    }
    let count = 5 + usize::from(number(&bytes, 8, 4) == 2);
    let entries = &[128, 160, 192, 224, 256, 416][..count];
    if place {
        let mut end = VXG_HEADER as u64;
        let lengths = entries.iter().map(|entry| number(&bytes, entry + 16, 8));
        let sections: Vec<_> = lengths.map(|length| section(&mut end, length, 1)).collect();
        lay_out(&mut bytes, VXG_HEADER, &sections)?;
        for (entry, section) in entries.iter().zip(&sections) {
            put(&mut bytes, entry + 8, section.start);
        }
    }
    let own = entries.iter().map(|entry| {
        let [begin, length] = [8, 16].map(|at| number(&bytes, entry + at, 8));
        (begin..begin.saturating_add(length), entry + 24)
    });
    let own: Vec<_> = own.collect();
    Some(sealed(bytes, VXG_HEADER, &own))
}

/// With `place` no node's data begins before that of the one before it.
pub(crate) fn far(mut bytes: Vec<u8>, place: bool) -> Option<Vec<u8>> {
    if bytes.len() < RECORD + NODE {
        return None;
    }
    let mut end = RECORD as u64;
    let nodes = section(&mut end, number(&bytes, 24, 8), NODE as u64);
    let data = section(&mut end, number(&bytes, 32, 8), 1);
    lay_out(&mut bytes, RECORD, &[nodes.clone(), data.clone()])?;
    let length = data.end - data.start;
    let mut own = vec![(nodes.clone(), 96)];
    let mut before = 0;
    for node in slot(&nodes).step_by(NODE) {
        if place {
            before = number(&bytes, node + 64, 8).clamp(before, length);
            put(&mut bytes, node + 64, before);
        }
        let begin = data.start + number(&bytes, node + 64, 8).min(length);
        // The data of a node ends where the next node's begins.
        if let [_, .., (last, _)] = &mut own[..] {
            last.end = begin;
        }
        own.push((begin..data.end, node + 120));
    }
    Some(sealed(bytes, RECORD, &own))
}

/// With `fit` the box is the one around the primitives.
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
    let mut own = vec![(entries.clone(), 112), (primitives.clone(), 104)];
    for entry in slot(&entries).step_by(GRID) {
        let texels = number(&bytes, entry + 4, 4);
        let face = texels.saturating_mul(texels).saturating_mul(6);
        for (at, item, sum) in [(16, 24, 56), (24, 4, 64), (32, face, 72)] {
            let count = number(&bytes, entry + at, 8);
            own.push((section(&mut end, count, item), entry + sum));
        }
    }
    let sections: Vec<_> = own.iter().map(|(section, _)| section.clone()).collect();
    lay_out(&mut bytes, RECORD, &sections)?;
    for k in 0..if fit { 3 } else { 0 } {
        let corners = slot(&primitives).step_by(52).map(|p| p + 4 * k);
        let corners = corners.flat_map(|p| [p, p + 12, p + 24]);
        let values = corners.map(|at| f32::from_bits(number(&bytes, at, 4) as u32));
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) = values
            .map(f64::from)
            .fold(start, |(l, h), v| (l.min(v), h.max(v)));
        put(&mut bytes, 32 + 8 * k, low.to_bits());
        put(&mut bytes, 56 + 8 * k, high.to_bits());
    }
    Some(sealed(bytes, RECORD, &own))
}
