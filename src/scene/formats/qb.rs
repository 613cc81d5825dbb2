//! Qubicle Binary: a header of six numbers, then matrices of colours, as runs if they are compressed.

use std::io::BufRead;

use crate::scene::emit::{Emitter, MAX_EXTENT};
use crate::scene::fault::{Fault, Problem};
use crate::scene::input::Input;
use crate::scene::numbers::Scalar;
use crate::scene::ply::Source;

const RUN: u32 = 2;
const NEXT_SLICE: u32 = 6;

pub(super) fn read(input: &mut Input<'_>, emitter: &mut Emitter<'_>) -> Result<(), Problem> {
    let mut reader = Reader {
        source: Source::new(&mut input.reader),
        emitter,
        is_bgra: false,
        is_right_handed: false,
    };
    reader.number("header")?;
    reader.is_bgra = reader.setting()?;
    reader.is_right_handed = reader.setting()?;
    let is_compressed = reader.setting()?;
    // With it, the fourth byte of a colour has a bit per visible side. It is 0 where there is no voxel, as without.
    reader.setting()?;
    let matrices = reader.number("header")?;
    for number in 0..matrices {
        reader.matrix(number, is_compressed)?;
    }
    let more = input.length.saturating_sub(reader.source.offset);
    if more > 0 {
        let warning = format!("{more} bytes after the last matrix were not read");
        emitter.info.warnings.push(warning);
    }
    Ok(())
}

struct Matrix {
    part: String,
    /// Right, up and depth.
    size: [i64; 3],
    position: [i64; 3],
}

struct Reader<'s, 'e, R> {
    source: Source<'s, R>,
    emitter: &'s mut Emitter<'e>,
    is_bgra: bool,
    is_right_handed: bool,
}

impl<R: BufRead> Reader<'_, '_, R> {
    fn fault(&self, part: &str, expected: &str, found: impl ToString) -> Problem {
        let advice = "the file is damaged or cut short; export or copy it again";
        let (at, found) = (self.source.offset, found.to_string());
        Fault::new(part, at, expected, found, advice).into()
    }

    fn number(&mut self, part: &str) -> Result<u32, Problem> {
        let number = self.source.number(Scalar::U32, false)?;
        let number = number.and_then(|number| number.whole());
        number
            .map(|number| number as u32)
            .ok_or_else(|| self.fault(part, "a number of 4 bytes", "the end of the file"))
    }

    fn setting(&mut self) -> Result<bool, Problem> {
        match self.number("header")? {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(self.fault("header", "a setting of 0 or 1", other)),
        }
    }

    fn matrix(&mut self, number: u32, is_compressed: bool) -> Result<(), Problem> {
        let part = format!("matrix {number}");
        let name = self.source.number(Scalar::U8, false)?;
        let name = name.and_then(|length| length.whole()).unwrap_or(0);
        self.source.skip(name as u64)?;
        let mut size = [0; 3];
        for side in &mut size {
            *side = i64::from(self.number(&part)?);
            if *side >= MAX_EXTENT {
                return Err(self.fault(&part, "sizes up to 2097151", *side));
            }
        }
        let mut position = [0; 3];
        for place in &mut position {
            *place = i64::from(self.number(&part)? as i32);
        }
        if size.contains(&0) {
            // Slices without voxels; compressed, each has its end.
            let ends = if is_compressed { size[2] } else { 0 };
            self.source.skip(4 * ends as u64)?;
            return Ok(());
        }
        let matrix = Matrix {
            part,
            size,
            position,
        };
        let slice = size[0] * size[1];
        for depth in 0..size[2] {
            let mut at = 0;
            while is_compressed || at < slice {
                let (mut color, mut count) = (self.number(&matrix.part)?, 1);
                if is_compressed && color == NEXT_SLICE {
                    break;
                }
                if is_compressed && color == RUN {
                    count = i64::from(self.number(&matrix.part)?);
                    color = self.number(&matrix.part)?;
                }
                if count > slice - at {
                    let expected = format!("{} more voxels in a slice at most", slice - at);
                    return Err(self.fault(&matrix.part, &expected, count));
                }
                self.run(&matrix, depth, at..at + count, color)?;
                at += count;
            }
        }
        Ok(())
    }

    fn run(
        &mut self,
        matrix: &Matrix,
        depth: i64,
        run: std::ops::Range<i64>,
        color: u32,
    ) -> Result<(), Problem> {
        let [a, g, b, visible] = color.to_le_bytes();
        if visible == 0 {
            return Ok(());
        }
        self.emitter.expect((run.end - run.start) as u64)?;
        let color = if self.is_bgra { [b, g, a] } else { [a, g, b] };
        let begin = self.source.offset;
        for at in run {
            let right = matrix.position[0] + at % matrix.size[0];
            let up = matrix.position[1] + at / matrix.size[0];
            let depth = matrix.position[2] + depth;
            // Depth points away from the viewer, or towards.
            let index = [
                right,
                if self.is_right_handed {
                    -1 - depth
                } else {
                    depth
                },
                up,
            ];
            self.emitter
                .voxel(index, color, None, || (matrix.part.clone(), begin))?;
        }
        Ok(())
    }
}
