//! `.npy` files, format 1.0, of NumPy's `save` and `load`: little-endian `u1`, `i4` and `f4`, C order, up to three
//! dimensions.

#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    U8(Vec<u8>),
    I32(Vec<i32>),
    F32(Vec<f32>),
}

/// An array and its shape, slowest dimension first.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Rows, columns, and entries per pixel if there are several.
    pub shape: Vec<usize>,
    pub values: Values,
}

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NpyError(String);

const MAGIC: &[u8; 6] = b"\x93NUMPY";
const PREFIX: usize = 10;

pub fn is_npy(beginning: &[u8]) -> bool {
    beginning.starts_with(MAGIC)
}

pub fn encode(array: &Array) -> Vec<u8> {
    let mut bytes = header(&array.shape, &array.values);
    bytes.extend_from_slice(&array.values.bytes());
    bytes
}

/// The header of an array's file, of numbers of the same type as `like`.
pub fn header(shape: &[usize], like: &Values) -> Vec<u8> {
    let kind = match like {
        Values::U8(_) => "|u1",
        Values::I32(_) => "<i4",
        Values::F32(_) => "<f4",
    };
    let lengths: Vec<String> = shape.iter().map(ToString::to_string).collect();
    let comma = if lengths.len() == 1 { "," } else { "" };
    let mut header = format!(
        "{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}{comma}), }}",
        lengths.join(", ")
    );
    // The numbers begin at a multiple of 64.
    while !(PREFIX + header.len() + 1).is_multiple_of(64) {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0]);
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes
}

/// Reads a `.npy` file's bytes. Errors: see [`NpyError`]. Allocates no more than the bytes justify.
pub fn decode(bytes: &[u8]) -> Result<Array, NpyError> {
    let wrong = |offset, expected, found: &[u8]| {
        let found = found.escape_ascii();
        NpyError(format!("byte {offset}: expected {expected}, found {found}"))
    };
    let wrong_type = |kind: &[u8], order: &str| {
        let (kind, expected) = (kind.escape_ascii(), "'|u1', '<i4' or '<f4' in C order");
        NpyError(format!(
            "the array's type is `{kind}{order}`; expected {expected}"
        ))
    };
    if !is_npy(bytes) {
        let found = &bytes[..bytes.len().min(6)];
        return Err(wrong(0, "the magic \\x93NUMPY", found));
    }
    let (header_start, header_length) = match bytes.get(6..12) {
        Some(&[1, _, a, b, ..]) => (PREFIX, usize::from(u16::from_le_bytes([a, b]))),
        Some(&[2 | 3, _, a, b, c, d]) => (12, u32::from_le_bytes([a, b, c, d]) as usize),
        Some(found) => return Err(wrong(6, "version 1, 2 or 3", &found[..2])),
        None => return Err(wrong(6, "a header", &[])),
    };
    let data_start = header_start.saturating_add(header_length);
    let header = bytes
        .get(header_start..data_start)
        .ok_or_else(|| wrong(header_start, "a header in text, within the file", &[]))?;
    let kind = entry(header, "descr").and_then(|kind| kind.split(|byte| *byte == b'\'').nth(1));
    let kind = kind.unwrap_or_default();
    if !entry(header, "fortran_order").is_some_and(|order| order.starts_with(b"False")) {
        return Err(wrong_type(kind, ", not in C order"));
    }
    let shape = entry(header, "shape")
        .and_then(lengths)
        .ok_or_else(|| wrong(header_start, "a shape of numbers", header))?;
    let data = &bytes[data_start..];
    let size = if kind == b"|u1" { 1 } else { 4 };
    let expected = shape
        .iter()
        .try_fold(size, |product: usize, &n| product.checked_mul(n))
        .unwrap_or(usize::MAX);
    if expected != data.len() {
        let found = data.len();
        return Err(NpyError(format!(
            "the header promises {expected} bytes of numbers, the file has {found}"
        )));
    }
    let (words, _) = data.as_chunks::<4>();
    let values = match kind {
        b"|u1" => Values::U8(data.to_vec()),
        b"<i4" => Values::I32(words.iter().map(|&w| i32::from_le_bytes(w)).collect()),
        b"<f4" => Values::F32(words.iter().map(|&w| f32::from_le_bytes(w)).collect()),
        other => return Err(wrong_type(other, "")),
    };
    Ok(Array { shape, values })
}

/// The text after a key and its colon in a header, which is a Python dictionary.
pub(crate) fn entry<'t>(header: &'t [u8], key: &str) -> Option<&'t [u8]> {
    let key = format!("'{key}'");
    let mut windows = header.windows(key.len());
    let at = windows.position(|window| window == key.as_bytes())?;
    let rest = header[at + key.len()..].trim_ascii_start();
    Some(rest.strip_prefix(b":")?.trim_ascii_start())
}

/// The lengths of an array along its dimensions, from the entry `shape`.
pub(crate) fn lengths(shape: &[u8]) -> Option<Vec<usize>> {
    let inside = shape.strip_prefix(b"(")?;
    let end = inside.iter().position(|byte| *byte == b')')?;
    let lengths = std::str::from_utf8(&inside[..end]).ok()?.split(',');
    let lengths = lengths.map(str::trim).filter(|length| !length.is_empty());
    lengths.map(|length| length.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_come_back() {
        for values in [
            Values::U8(vec![1, 2, 3, 4, 5, 6]),
            Values::I32(vec![-1, 2, i32::MIN, 4, 5, 6]),
            Values::F32(vec![0.5, f32::INFINITY, -1.0, 4.0, 5.0, 6.0]),
        ] {
            let shape = vec![1, 2, 3];
            let array = Array { shape, values };
            let bytes = encode(&array);
            assert_eq!(bytes.iter().position(|&b| b == b'\n'), Some(127));
            assert_eq!(decode(&bytes), Ok(array));
        }
    }

    #[test]
    fn damage_is_an_error() {
        let array = Array {
            shape: vec![2],
            values: Values::I32(vec![1, 2]),
        };
        let bytes = encode(&array);
        for length in 0..bytes.len() {
            assert!(decode(&bytes[..length]).is_err(), "{length}");
        }
        let mut huge = bytes.clone();
        let at = huge.windows(4).position(|w| w == b"(2,)").unwrap();
        huge.splice(at..at + 4, *b"(99999999999999999999,)");
        assert!(decode(&huge).is_err());
    }
}
