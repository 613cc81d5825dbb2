//! NumPy arrays of points: N x 3, or N x 6 and N x 7 with colours.
//!
//! In Fortran order each column is contiguous, and a block is collected by seeking.

use std::io::{ErrorKind, Read, Seek, SeekFrom};

use super::cloud::Cloud;
use crate::picture::npy::{entry, lengths};
use crate::scene::DEFAULT_COLOR;
use crate::scene::emit::Emitter;
use crate::scene::fault::{Fault, Problem, printable};
use crate::scene::input::Input;
use crate::scene::numbers::{Number, Scalar};

const BLOCK_ROWS: u64 = 4096;
const MAX_HEADER: u64 = 1 << 16;

const SAVE_AGAIN: &str =
    "save it with numpy.save(file, indices), where indices is an N x 3 array of whole numbers";

struct Layout {
    scalar: Scalar,
    big_endian: bool,
    /// Whether columns follow each other instead of rows.
    fortran: bool,
    rows: u64,
    columns: u64,
    data: u64,
}

impl Layout {
    fn width(&self) -> u64 {
        self.scalar.size() as u64
    }

    fn slot(&self, rows: u64, row: u64, column: u64) -> u64 {
        match self.fortran {
            true => column * rows + row,
            false => row * self.columns + column,
        }
    }
}

pub(super) fn read(
    Input { reader, length }: &mut Input<'_>,
    emitter: &mut Emitter<'_>,
) -> Result<(), Problem> {
    let layout = read_header(reader, *length)?;
    let needed = u128::from(layout.rows) * u128::from(layout.columns * layout.width());
    let there = u128::from(length.saturating_sub(layout.data));
    if needed > there {
        let expected = format!("{needed} bytes of numbers, as the header says");
        let advice = "the file is cut short; save or copy it again";
        return Err(Fault::new("array", layout.data, expected, there.to_string(), advice).into());
    }
    if needed < there {
        let more = there - needed;
        emitter.info.warnings.push(format!(
            "{more} bytes after the end of the array were not read"
        ));
    }
    let (mut block, mut cloud) = (Vec::new(), Cloud::new(emitter.options));
    for first in (0..layout.rows).step_by(BLOCK_ROWS as usize) {
        let rows = BLOCK_ROWS.min(layout.rows - first);
        read_block(reader, &layout, first, rows, &mut block).map_err(Problem::Read)?;
        for row in 0..rows {
            pass_on(&layout, &block, (first, rows, row), &mut cloud, emitter)?;
        }
    }
    cloud.finish(&mut emitter.info)
}

fn read_block<R: Read + Seek>(
    reader: &mut R,
    layout: &Layout,
    first: u64,
    rows: u64,
    block: &mut Vec<u8>,
) -> std::io::Result<()> {
    block.resize((rows * layout.columns * layout.width()) as usize, 0);
    let runs = if layout.fortran { layout.columns } else { 1 };
    let length = block.len() / runs as usize;
    for (column, into) in (0..runs).zip(block.chunks_exact_mut(length)) {
        let slot = layout.slot(layout.rows, first, column);
        reader.seek(SeekFrom::Start(layout.data + slot * layout.width()))?;
        reader.read_exact(into)?;
    }
    Ok(())
}

fn pass_on(
    layout: &Layout,
    block: &[u8],
    (first, rows, row): (u64, u64, u64),
    cloud: &mut Cloud,
    emitter: &mut Emitter<'_>,
) -> Result<(), Problem> {
    let number = |column: u64| -> Number {
        let at = layout.slot(rows, row, column) * layout.width();
        layout
            .scalar
            .decode_one(layout.big_endian, &block[at as usize..])
    };
    let offset =
        |column| layout.data + layout.slot(layout.rows, first + row, column) * layout.width();
    let place = |column: Option<u64>| match column {
        Some(column) => (
            format!("row {}, column {column}", first + row),
            offset(column),
        ),
        None => (format!("row {}", first + row), offset(0)),
    };
    let mut color = DEFAULT_COLOR;
    if layout.columns > 3 {
        for (column, byte) in (3..).zip(&mut color) {
            let value = number(column).whole().and_then(|v| u8::try_from(v).ok());
            *byte = value.ok_or_else(|| {
                let (part, offset) = place(Some(column));
                let (expected, found) = ("a colour from 0 to 255", number(column).to_string());
                let advice = "columns 3, 4 and 5 hold red, green and blue as whole numbers";
                Fault::new(part, offset, expected, found, advice)
            })?;
        }
    }
    let place = |axis: Option<usize>| place(axis.map(|axis| axis as u64));
    cloud.point([0, 1, 2].map(number), color, None, place, emitter)
}

/// Reads the header: magic, version, and a Python dictionary in text.
fn read_header<R: Read>(reader: &mut R, length: u64) -> Result<Layout, Problem> {
    let mut head = [0u8; 12];
    exact(reader, &mut head[..10], 0)?;
    let (start, size) = match head[6] {
        1 => (10, u64::from(u16::from_le_bytes([head[8], head[9]]))),
        2 | 3 => {
            exact(reader, &mut head[10..], 10)?;
            let size = u32::from_le_bytes([head[8], head[9], head[10], head[11]]);
            (12, u64::from(size))
        }
        version => return Err(fault(6, "format version 1, 2 or 3", version.to_string()).into()),
    };
    if size > MAX_HEADER || start + size > length {
        let most = MAX_HEADER.min(length - start);
        let expected = format!("a header of at most {most} bytes");
        return Err(fault(8, expected, format!("one of {size} bytes")).into());
    }
    let mut text = vec![0; size as usize];
    exact(reader, &mut text, start)?;
    Ok(parse_header(&text, start)?)
}

fn exact<R: Read>(reader: &mut R, into: &mut [u8], offset: u64) -> Result<(), Problem> {
    reader.read_exact(into).map_err(|error| {
        if error.kind() != ErrorKind::UnexpectedEof {
            return Problem::Read(error);
        }
        let expected = format!("{} bytes of header", into.len());
        fault(offset, expected, "the end of the file").into()
    })
}

fn fault(offset: u64, expected: impl Into<String>, found: impl Into<String>) -> Box<Fault> {
    Fault::new("header", offset, expected, found, SAVE_AGAIN)
}

fn parse_header(text: &[u8], start: u64) -> Result<Layout, Box<Fault>> {
    let value = |key: &str| {
        let missing = || fault(start, format!("an entry '{key}'"), printable(text));
        entry(text, key).ok_or_else(missing)
    };
    let descr = value("descr")?;
    let (scalar, big_endian) = element_type(descr).ok_or_else(|| {
        let expected = "integers of 1 to 8 bytes or floats of 4 or 8, such as '<i4'";
        fault(start, expected, printable(descr))
    })?;
    let order = value("fortran_order")?;
    let fortran = order.starts_with(b"True");
    if !fortran && !order.starts_with(b"False") {
        return Err(fault(
            start,
            "fortran_order True or False",
            printable(order),
        ));
    }
    let shape = value("shape")?;
    let sizes = lengths(shape);
    let Some(&[rows, columns @ (3 | 6 | 7)]) = sizes.as_deref() else {
        let expected = "a shape (N, 3), (N, 6) or (N, 7)";
        let advice = "indices make one row a voxel; for a dense grid, save numpy.argwhere(grid)";
        return Err(Fault::new(
            "header",
            start,
            expected,
            printable(shape),
            advice,
        ));
    };
    Ok(Layout {
        scalar,
        big_endian,
        fortran,
        rows: rows as u64,
        columns: columns as u64,
        data: start + text.len() as u64,
    })
}

fn element_type(descr: &[u8]) -> Option<(Scalar, bool)> {
    let [
        b'\'',
        order @ (b'<' | b'|' | b'=' | b'>'),
        kind,
        width,
        b'\'',
        ..,
    ] = descr
    else {
        return None;
    };
    Some((Scalar::of(*kind, *width)?, *order == b'>'))
}
