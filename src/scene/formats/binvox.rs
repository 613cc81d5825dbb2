//! Voxel grids of the program binvox: a text header, then runs of empty and filled cells.

use std::io::{BufRead, ErrorKind, Read};

use crate::scene::DEFAULT_COLOR;
use crate::scene::emit::{Emitter, MAX_EXTENT};
use crate::scene::fault::{Fault, Problem, printable};
use crate::scene::input::Input;

const MAX_LINE: u64 = 256;

const AGAIN: &str = "the file is damaged or its exporter is at fault; export or copy it again";

pub(super) fn read(input: &mut Input<'_>, emitter: &mut Emitter<'_>) -> Result<(), Problem> {
    let mut offset = 0;
    let [x, z, y] = read_header(input, &mut offset)?;
    let (mut cell, cells) = (0, x * z * y);
    while cell < cells {
        let mut run = [0; 2];
        input.reader.read_exact(&mut run).map_err(|error| {
            if error.kind() != ErrorKind::UnexpectedEof {
                return Problem::Read(error);
            }
            let expected = format!("runs of {cells} cells");
            Problem::from(fault("runs", offset, expected, format!("{cell} cells")))
        })?;
        let [value, count] = run;
        let end = cell + u64::from(count);
        if end > cells {
            let expected = format!("a run of at most {} cells", cells - cell);
            return Err(fault("runs", offset, expected, count.to_string()).into());
        }
        if value != 0 {
            for cell in cell..end {
                let index = [cell / y / z, cell % y, cell / y % z].map(|i| i as i64);
                emitter.voxel(index, DEFAULT_COLOR, None, || ("runs".to_owned(), offset))?;
            }
        }
        cell = end;
        offset += 2;
    }
    if offset < input.length {
        emitter.info.warnings.push(format!(
            "{} bytes after the last run were not read",
            input.length - offset
        ));
    }
    Ok(())
}

/// Reads the header up to `data`: the cells along x, z and y.
fn read_header(input: &mut Input<'_>, offset: &mut u64) -> Result<[u64; 3], Problem> {
    let mut sizes = None;
    loop {
        let mut line = Vec::new();
        let mut limited = (&mut input.reader).take(MAX_LINE);
        limited
            .read_until(b'\n', &mut line)
            .map_err(Problem::Read)?;
        let text = line.trim_ascii();
        let wrong = |expected: &str| fault("header", *offset, expected, printable(text));
        if !line.ends_with(b"\n") {
            return Err(wrong("a line of at most 255 bytes, and a line \"data\" after it").into());
        }
        let words: Vec<&[u8]> = text.split(u8::is_ascii_whitespace).collect();
        match words[..] {
            [b"#binvox", version] if *offset == 0 => {
                if ![&b"1"[..], b"2"].contains(&version) {
                    return Err(wrong("\"#binvox 1\" or \"#binvox 2\"").into());
                }
            }
            [b"dim", x, z, y] if sizes.is_none() => {
                let size = |word| size(word).ok_or_else(|| wrong("sizes from 1 to 2097151"));
                sizes = Some([size(x)?, size(z)?, size(y)?]);
            }
            // They place the grid in the space of the mesh that it was made of.
            [b"translate", ..] | [b"scale", ..] if *offset > 0 => {}
            [b"data"] => {
                let missing = || wrong("a line \"dim\" with three sizes before \"data\"");
                let sizes = sizes.ok_or_else(missing)?;
                *offset += line.len() as u64;
                return Ok(sizes);
            }
            _ => return Err(wrong("dim, translate, scale or data").into()),
        }
        *offset += line.len() as u64;
    }
}

fn size(word: &[u8]) -> Option<u64> {
    let size: i64 = std::str::from_utf8(word).ok()?.parse().ok()?;
    (1..MAX_EXTENT)
        .contains(&size)
        .then_some(size.unsigned_abs())
}

fn fault(part: &str, offset: u64, expected: impl Into<String>, found: String) -> Box<Fault> {
    Fault::new(part, offset, expected, found, AGAIN)
}
