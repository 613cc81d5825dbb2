//! Voxel grids of the program binvox: a text header, then runs of empty and filled cells.
//!
//! Read as a stream. Nothing is allocated by the sizes in the header.

use std::io::{BufRead, ErrorKind, Read};

use crate::scene::emit::{Emitter, MAX_EXTENT};
use crate::scene::fault::{Fault, Problem, printable};
use crate::scene::input::Input;
use crate::scene::{DEFAULT_COLOR, ReadOptions, SceneInfo};

/// Longest line of the header, bytes.
const MAX_LINE: u64 = 256;

const AGAIN: &str = "the file is damaged or its exporter is at fault; export or copy it again";

/// Passes on the filled cells of a grid.
pub(super) fn read(
    input: &mut Input<'_>,
    _: &ReadOptions,
    emitter: &mut Emitter<'_>,
) -> Result<SceneInfo, Problem> {
    let mut offset = 0;
    let [x, z, y] = read_header(input, &mut offset)?;
    let mut info = SceneInfo {
        models: 1,
        instances: 1,
        ..SceneInfo::default()
    };
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
            info.stored_voxels += u64::from(count);
            for cell in cell..end {
                // Below 2^21 each.
                let index = [cell / y / z, cell % y, cell / y % z].map(|i| i as i64);
                emitter.voxel(index, DEFAULT_COLOR, None, || ("runs".to_owned(), offset))?;
            }
        }
        cell = end;
        offset += 2;
    }
    if offset < input.length {
        info.warnings.push(format!(
            "{} bytes after the last run were not read",
            input.length - offset
        ));
    }
    Ok(info)
}

/// Reads the header, with its line `data`: the cells along x, z and y.
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use crate::graph::Silent;
    use crate::scene::{FileKind, ReadOptions, SceneError, SceneInfo, detect, read_voxels_from};

    const SMALL: &[u8] =
        b"#binvox 1\ndim 2 3 4\ntranslate -0.5 1 2e-3\nscale 7.25\ndata\n\x00\x05\x01\x03\x00\x10";

    fn read(bytes: &[u8], most_voxels: u64) -> Result<(Vec<[i32; 3]>, SceneInfo), SceneError> {
        let options = ReadOptions {
            most_voxels,
            ..ReadOptions::default()
        };
        let mut voxels = Vec::new();
        let sink = &mut |voxel: crate::graph::Voxel| voxels.push(voxel.index);
        let info = read_voxels_from(bytes, "test", &options, sink, &Silent)?;
        assert_eq!(info.voxels, voxels.len() as u64);
        Ok((voxels, info))
    }

    fn message(bytes: &[u8]) -> String {
        read(bytes, 1 << 20).unwrap_err().to_string()
    }

    /// A file of these cells, in runs of at most `longest` cells.
    fn file(sizes: [usize; 3], cells: &[u8], longest: usize) -> Vec<u8> {
        let [x, z, y] = sizes;
        let mut bytes = format!("#binvox 2\ndim {x} {z} {y}\ndata\n").into_bytes();
        for run in cells.chunk_by(|a, b| a == b) {
            for part in run.chunks(longest) {
                bytes.extend([part[0], part.len() as u8]);
            }
        }
        bytes
    }

    #[test]
    fn y_runs_fastest_then_z_then_x() {
        assert_eq!(detect(SMALL, 0), Some(FileKind::Binvox));
        let (voxels, info) = read(SMALL, 3).unwrap();
        // Cells 5, 6 and 7 of 2 x 3 x 4 along x, z, y.
        assert_eq!(voxels, [[0, 1, 1], [0, 2, 1], [0, 3, 1]]);
        assert_eq!((info.stored_voxels, info.warnings.len()), (3, 0));
        let (_, info) = read(&[SMALL, b"more"].concat(), 3).unwrap();
        assert_eq!(info.warnings, ["4 bytes after the last run were not read"]);
        let few = read(SMALL, 2).unwrap_err();
        assert!(few.is_limit(), "{few}");
    }

    #[test]
    fn messages_say_where_and_what() {
        for (bytes, part) in [
            (
                &b"#binvox 3\n"[..],
                "expected \"#binvox 1\" or \"#binvox 2\", found \"#binvox 3\"",
            ),
            (
                b"#binvox 1\ndata\n",
                "header at byte 10: expected a line \"dim\"",
            ),
            (
                b"#binvox 1\ndim 0 1 1\n",
                "expected sizes from 1 to 2097151",
            ),
            (
                b"#binvox 1\ndim 1 1 2097152\n",
                "expected sizes from 1 to 2097151",
            ),
            (
                b"#binvox 1\ndim 1 1\n",
                "expected dim, translate, scale or data",
            ),
            (
                b"#binvox 1\ndim 1 1 1\n",
                "expected a line of at most 255 bytes",
            ),
            (
                b"#binvox 1\ndim 1 1 1\ndim 1 1 1\n",
                "expected dim, translate",
            ),
            (
                b"#binvox 1\ndim 1 1 4\ndata\n\x01\x05",
                "a run of at most 4 cells, found 5",
            ),
            (
                b"#binvox 1\ndim 2097151 2097151 2097151\ndata\n\x00\xff",
                "runs at byte 45: expected runs of 9223358842721533951 cells, found 255 cells",
            ),
        ] {
            let text = message(bytes);
            assert!(text.contains(part), "\n{text}\nlacks\n{part}");
        }
        let long = [b"#binvox 1\n".to_vec(), vec![b'x'; 5000]].concat();
        assert!(message(&long).contains("at most 255 bytes"));
        for length in 0..SMALL.len() {
            assert!(read(&SMALL[..length], 3).is_err(), "{length}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn runs_of_any_length_give_their_cells(
            (sizes, cells) in [1usize..7, 1usize..7, 1usize..7].prop_flat_map(|sizes| {
                let cells = sizes.iter().product::<usize>();
                (Just(sizes), prop::collection::vec(prop::sample::select(&[0u8, 0, 1, 255][..]), cells))
            }),
            longest in 1usize..256,
        ) {
            let [_, z, y] = sizes;
            let filled = (0..cells.len()).filter(|&cell| cells[cell] != 0);
            let expected: Vec<[i32; 3]> =
                filled.map(|cell| [cell / (z * y), cell % y, cell / y % z].map(|i| i as i32)).collect();
            prop_assert_eq!(read(&file(sizes, &cells, longest), 343).unwrap().0, expected);
        }

        #[test]
        fn damaged_files_are_read_or_refused(
            edits in prop::collection::vec((0..SMALL.len(), any::<u8>()), 1..5),
        ) {
            let mut bytes = SMALL.to_vec();
            for (at, byte) in edits {
                bytes[at] = byte;
            }
            if let Ok((voxels, _)) = read(&bytes, 100) {
                prop_assert!(voxels.len() <= 100);
            }
        }
    }
}
