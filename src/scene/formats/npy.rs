//! Numpy arrays of voxel indices: N x 3, or N x 6 and N x 7 with colours.
//!
//! Arrays are read block by block, so memory does not depend on the file. In Fortran order each column is contiguous,
//! and a block is collected by seeking.

use std::io::{Read, Seek, SeekFrom};

use crate::scene::emit::Emitter;
use crate::scene::fault::{Fault, Problem, printable};
use crate::scene::input::Input;
use crate::scene::{ReadOptions, SceneInfo};

/// Rows that are read at a time.
const BLOCK_ROWS: u64 = 4096;
/// Longest header, bytes; numpy's own is below 200.
const MAX_HEADER: u64 = 1 << 16;

const SAVE_AGAIN: &str =
    "save it with numpy.save(file, indices), where indices is an N x 3 array of whole numbers";

/// The kinds of numbers an array can have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Signed,
    Unsigned,
    Float,
}

/// An array's description.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Layout {
    kind: Kind,
    /// Bytes of a number.
    width: usize,
    big_endian: bool,
    /// Columns one after another instead of rows.
    fortran: bool,
    rows: u64,
    columns: usize,
    /// Where the numbers begin.
    data: u64,
}

/// Passes on the voxels of an array.
pub(super) fn read(
    Input { reader, length }: &mut Input<'_>,
    options: &ReadOptions,
    emitter: &mut Emitter<'_>,
) -> Result<SceneInfo, Problem> {
    let length = *length;
    let layout = read_header(reader, length)?;
    let needed = u128::from(layout.rows) * (layout.columns * layout.width) as u128;
    let there = u128::from(length.saturating_sub(layout.data));
    if needed > there {
        return Err(Fault::new(
            "array",
            layout.data,
            format!("{needed} bytes of numbers, as the header says"),
            format!("{there}"),
            "the file is cut short; save or copy it again",
        )
        .into());
    }
    let mut info = SceneInfo {
        models: 1,
        instances: 1,
        stored_voxels: layout.rows,
        has_colors: layout.columns > 3,
        ..SceneInfo::default()
    };
    if needed < there {
        info.warnings.push(format!(
            "{} bytes after the end of the array were not read",
            there - needed
        ));
    }
    let mut block = Vec::new();
    let mut first = 0;
    while first < layout.rows {
        let rows = BLOCK_ROWS.min(layout.rows - first);
        read_block(reader, &layout, first, rows, &mut block)?;
        for row in 0..rows {
            hand_on(&layout, &block, (first, rows, row), options, emitter)?;
        }
        first += rows;
    }
    Ok(info)
}

/// Reads the numbers of some rows into `block`, in the file's order.
fn read_block<R: Read + Seek>(
    reader: &mut R,
    layout: &Layout,
    first: u64,
    rows: u64,
    block: &mut Vec<u8>,
) -> Result<(), Problem> {
    let width = layout.width as u64;
    let columns = layout.columns as u64;
    // At most BLOCK_ROWS x 7 x 8 bytes.
    block.resize((rows * columns * width) as usize, 0);
    let mut run = |at: u64, into: &mut [u8]| {
        reader
            .seek(SeekFrom::Start(layout.data + at))
            .map_err(Problem::Read)?;
        reader.read_exact(into).map_err(Problem::Read)
    };
    if !layout.fortran {
        return run(first * columns * width, block);
    }
    for (column, into) in block.chunks_exact_mut((rows * width) as usize).enumerate() {
        run((column as u64 * layout.rows + first) * width, into)?;
    }
    Ok(())
}

/// Turns one row of a block into a voxel.
fn hand_on(
    layout: &Layout,
    block: &[u8],
    (first, rows, row): (u64, u64, u64),
    options: &ReadOptions,
    emitter: &mut Emitter<'_>,
) -> Result<(), Problem> {
    let width = layout.width;
    let number_of_row = first + row;
    let offset = |column: usize| {
        let slot = if layout.fortran {
            column as u64 * layout.rows + number_of_row
        } else {
            number_of_row * layout.columns as u64 + column as u64
        };
        layout.data + slot * width as u64
    };
    let number = |column: usize| {
        let slot = if layout.fortran {
            column * rows as usize + row as usize
        } else {
            row as usize * layout.columns + column
        };
        whole(layout, &block[slot * width..][..width])
    };
    let part = |column: usize| format!("row {number_of_row}, column {column}");
    let mut index = [0; 3];
    for (column, i) in index.iter_mut().enumerate() {
        *i = number(column).map_err(|found| {
            Fault::new(
                part(column),
                offset(column),
                "a whole number of 64 bits, the voxel's index",
                found,
                "divide the positions by the voxel's size and round them down first: numpy.floor(p / size).astype(int)",
            )
        })?;
    }
    let mut color = options.default_color;
    if layout.columns > 3 {
        for (channel, byte) in color.iter_mut().enumerate() {
            let column = 3 + channel;
            let value = number(column);
            *byte = value
                .clone()
                .ok()
                .and_then(|v| u8::try_from(v).ok())
                .ok_or_else(|| {
                    Fault::new(
                        part(column),
                        offset(column),
                        "a colour from 0 to 255",
                        value.map_or_else(|found| found, |value| value.to_string()),
                        "columns 3, 4 and 5 hold red, green and blue as whole numbers",
                    )
                })?;
        }
    }
    emitter.voxel(index, color, None, || {
        (format!("row {number_of_row}"), offset(0))
    })
}

/// A number as an integer, or its text if it is not one.
fn whole(layout: &Layout, bytes: &[u8]) -> Result<i64, String> {
    let mut eight = [0u8; 8];
    eight[..bytes.len()].copy_from_slice(bytes);
    if layout.big_endian {
        eight[..bytes.len()].reverse();
    }
    let bits = u64::from_le_bytes(eight);
    let unused = 64 - 8 * bytes.len() as u32;
    match layout.kind {
        Kind::Unsigned => i64::try_from(bits).map_err(|_| bits.to_string()),
        // Up to the top and back down brings the sign along.
        Kind::Signed => Ok((bits << unused) as i64 >> unused),
        Kind::Float => {
            let real = if bytes.len() == 4 {
                f64::from(f32::from_bits(bits as u32))
            } else {
                f64::from_bits(bits)
            };
            // Below 2^53 the cast is exact.
            if real == real.trunc() && real.abs() < 9_007_199_254_740_992.0 {
                Ok(real as i64)
            } else {
                Err(real.to_string())
            }
        }
    }
}

/// Reads the header: magic, version, and a Python dictionary in text.
fn read_header<R: Read>(reader: &mut R, length: u64) -> Result<Layout, Problem> {
    let mut head = [0u8; 12];
    // Version 1 has a length of 2 bytes, versions 2 and 3 one of 4.
    exact(reader, &mut head[..10], 0)?;
    let (start, size) = match head[6] {
        1 => (10, u64::from(u16::from_le_bytes([head[8], head[9]]))),
        2 | 3 => {
            exact(reader, &mut head[10..], 10)?;
            let size = u32::from_le_bytes([head[8], head[9], head[10], head[11]]);
            (12, u64::from(size))
        }
        version => {
            return Err(fault(6, "format version 1, 2 or 3", version.to_string()).into());
        }
    };
    if size > MAX_HEADER || start + size > length {
        return Err(fault(
            8,
            format!(
                "a header of at most {} bytes",
                MAX_HEADER.min(length - start)
            ),
            format!("one of {size} bytes"),
        )
        .into());
    }
    let mut text = vec![0; size as usize];
    exact(reader, &mut text, start)?;
    understand(&text, start)
}

fn exact<R: Read>(reader: &mut R, into: &mut [u8], offset: u64) -> Result<(), Problem> {
    reader.read_exact(into).map_err(|error| {
        if error.kind() == std::io::ErrorKind::UnexpectedEof {
            let expected = format!("{} bytes of header", into.len());
            fault(offset, expected, "the end of the file".to_owned()).into()
        } else {
            Problem::Read(error)
        }
    })
}

fn fault(offset: u64, expected: impl Into<String>, found: impl Into<String>) -> Box<Fault> {
    Fault::new("header", offset, expected, found, SAVE_AGAIN)
}

/// Interprets the header's dictionary.
fn understand(text: &[u8], start: u64) -> Result<Layout, Problem> {
    let data = start + text.len() as u64;
    let missing = |key: &str| fault(start, format!("an entry '{key}'"), printable(text));
    let descr = value(text, b"'descr'").ok_or_else(|| missing("descr"))?;
    let (kind, width, big_endian) = element_type(descr).ok_or_else(|| {
        fault(
            start,
            "integers of 1 to 8 bytes or floats of 4 or 8, such as '<i4'",
            printable(descr),
        )
    })?;
    let order = value(text, b"'fortran_order'").ok_or_else(|| missing("fortran_order"))?;
    let fortran = match order {
        _ if order.starts_with(b"True") => true,
        _ if order.starts_with(b"False") => false,
        _ => return Err(fault(start, "fortran_order True or False", printable(order)).into()),
    };
    let shape = value(text, b"'shape'").ok_or_else(|| missing("shape"))?;
    let (rows, columns) = rows_and_columns(shape)
        .filter(|(_, columns)| [3, 6, 7].contains(columns))
        .ok_or_else(|| {
            Fault::new(
                "header",
                start,
                "a shape (N, 3), (N, 6) or (N, 7)",
                printable(shape),
                "indices make one row a voxel; for a dense grid, save numpy.argwhere(grid)",
            )
        })?;
    Ok(Layout {
        kind,
        width,
        big_endian,
        fortran,
        rows,
        columns,
        data,
    })
}

/// The text after a key and its colon in a Python dictionary.
fn value<'t>(text: &'t [u8], key: &[u8]) -> Option<&'t [u8]> {
    let at = text.windows(key.len()).position(|window| window == key)?;
    let rest = text[at + key.len()..].trim_ascii_start();
    Some(rest.strip_prefix(b":")?.trim_ascii_start())
}

/// The type that a description such as `'<i4'` names, if it is supported.
fn element_type(descr: &[u8]) -> Option<(Kind, usize, bool)> {
    let [b'\'', order, kind, width, b'\'', ..] = descr else {
        return None;
    };
    let big_endian = match order {
        b'<' | b'|' | b'=' => false,
        b'>' => true,
        _ => return None,
    };
    let (kind, widths): (_, &[u8]) = match kind {
        b'i' => (Kind::Signed, b"1248"),
        b'u' => (Kind::Unsigned, b"1248"),
        b'f' => (Kind::Float, b"48"),
        _ => return None,
    };
    (widths.contains(width)).then(|| (kind, usize::from(width - b'0'), big_endian))
}

/// The two numbers of a shape `(rows, columns)`.
fn rows_and_columns(shape: &[u8]) -> Option<(u64, usize)> {
    let inside = shape.strip_prefix(b"(")?;
    let end = inside.iter().position(|b| *b == b')')?;
    let text = std::str::from_utf8(&inside[..end]).ok()?;
    let (rows, columns) = text.split_once(',')?;
    let columns = columns.trim();
    let columns = columns.strip_suffix(',').unwrap_or(columns);
    Some((rows.trim().parse().ok()?, columns.trim().parse().ok()?))
}
