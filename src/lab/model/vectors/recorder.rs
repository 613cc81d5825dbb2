//! A probe that writes what crosses the borders of blocks, row by row.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use hwmodel::{Format, Probe, Signal};

use super::VectorsError;
use super::blocks::{Description, absence, describe};
use super::folder::ROWS;
use super::ports::Ports;
use crate::machine::Block;
use crate::project::FrameSetup;
use crate::whole::WholeError;

/// A file of rows in the making.
#[derive(Debug)]
struct Rows {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Rows {
    fn create(path: PathBuf, format: Format, ports: &Ports) -> Result<Self, VectorsError> {
        let made = File::create(&path).and_then(|file| {
            let mut file = BufWriter::new(file);
            head(&mut file, format, ports)?;
            Ok(file)
        });
        match made {
            Ok(file) => Ok(Self { path, file }),
            Err(source) => Err(WholeError::Io { path, source }.into()),
        }
    }

    fn write(&mut self, text: &str) -> Result<(), VectorsError> {
        writeln!(self.file, "{text}").map_err(|source| self.failed(source))
    }

    fn failed(&self, source: io::Error) -> VectorsError {
        VectorsError::from(WholeError::Io {
            path: self.path.clone(),
            source,
        })
    }
}

/// What `$readmemh` skips and people read: the fields, from the highest bit down.
fn head(file: &mut impl Write, format: Format, ports: &Ports) -> io::Result<()> {
    let bits = ports.bits(format);
    writeln!(
        file,
        "// {bits} bits a row, from the most significant; bits, sign, name"
    )?;
    for (field, lowest) in ports.placed(format) {
        let width = field.kind.bits(format);
        let sign = if field.kind.is_signed() {
            "signed"
        } else {
            "unsigned"
        };
        let highest = lowest + width - 1;
        writeln!(file, "// [{highest}:{lowest}] {sign} {}", field.name)?;
    }
    Ok(())
}

/// A block's files and how many rows they have by now.
#[derive(Debug)]
pub(super) struct Recording {
    pub(super) description: Description,
    pub(super) rows: u64,
    /// Of them, those that the frame's records brought.
    pub(super) frame_rows: u64,
    /// Whether the frame's rules have the block.
    is_there: bool,
    files: Option<(Rows, Rows)>,
}

/// Writes the rows of a frame's first records.
#[derive(Debug)]
pub(super) struct Recorder {
    folder: PathBuf,
    format: Format,
    /// By the block's number.
    blocks: Vec<Recording>,
    records: u64,
    is_open: bool,
    is_directed: bool,
    error: Option<VectorsError>,
}

impl Recorder {
    /// Of the first `records` records of a frame, into a folder that is there.
    pub(super) fn new(folder: &Path, setup: &FrameSetup, records: u64) -> Self {
        let recording = |&block: &Block| Recording {
            description: describe(block, setup),
            rows: 0,
            frame_rows: 0,
            is_there: absence(block, setup).is_none(),
            files: None,
        };
        Self {
            folder: folder.to_owned(),
            format: setup.format,
            blocks: Block::ALL.iter().map(recording).collect(),
            records,
            is_open: true,
            is_directed: false,
            error: None,
        }
    }

    /// The frame is drawn; what follows are inputs made for the blocks.
    pub(super) fn begin_directed(&mut self) {
        for recording in &mut self.blocks {
            recording.frame_rows = recording.rows;
        }
        self.is_open = self.error.is_none();
        self.is_directed = true;
    }

    /// What was recorded, in the order of [`Block::ALL`], once all files are whole.
    pub(super) fn finish(mut self) -> Result<Vec<Recording>, VectorsError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        for recording in &mut self.blocks {
            if let Some((stimulus, expected)) = &mut recording.files {
                for rows in [stimulus, expected] {
                    let flushed = rows.file.flush();
                    flushed.map_err(|source| rows.failed(source))?;
                }
            }
        }
        Ok(self.blocks)
    }

    fn record_row(
        &mut self,
        block: u32,
        stimulus: &[Signal],
        expected: &[Signal],
    ) -> Result<(), VectorsError> {
        let Some(recording) = self.blocks.get_mut(block as usize) else {
            return Err(VectorsError::Unknown(block));
        };
        if self.is_directed && !recording.is_there {
            return Ok(());
        }
        let description = &recording.description;
        let into = packed(stimulus, &description.stimulus, self.format);
        let out = packed(expected, &description.expected, self.format);
        let (Some(into), Some(out)) = (into, out) else {
            return Err(VectorsError::Misfit(description.name));
        };
        let (to_stimulus, to_expected) = match &mut recording.files {
            Some(files) => files,
            files @ None => {
                let create = |end: &str, ports| {
                    let name = file_name(description.name, end);
                    Rows::create(self.folder.join(name), self.format, ports)
                };
                files.insert((
                    create(STIMULUS, &description.stimulus)?,
                    create(EXPECTED, &description.expected)?,
                ))
            }
        };
        to_stimulus.write(&into)?;
        to_expected.write(&out)?;
        recording.rows += 1;
        Ok(())
    }
}

/// What files of inputs have in their names.
pub(super) const STIMULUS: &str = "in";
/// What files of outputs have.
pub(super) const EXPECTED: &str = "out";

/// The name of a file of rows.
pub(super) fn file_name(block: &str, end: &str) -> String {
    format!("{block}.{end}.{ROWS}")
}

/// Signals as hexadecimal digits, the first the most significant; `None` where
/// they are not the ports', or do not fit their wires.
fn packed(signals: &[Signal], ports: &Ports, format: Format) -> Option<String> {
    if signals.len() != ports.fields().len() {
        return None;
    }
    let mut digits = String::with_capacity(ports.digits(format) as usize);
    // Fewer than four bits wait; with a word of 64 they fit 128.
    let mut waiting = 0u128;
    let mut held = ports.digits(format) * 4 - ports.bits(format);
    for (signal, field) in signals.iter().zip(ports.fields()) {
        let bits = signal.kind.bits(format);
        if signal.kind != field.kind || !fits(signal.value, bits, signal.kind.is_signed()) {
            return None;
        }
        let mask = u64::MAX >> (64 - bits);
        waiting = waiting << bits | u128::from(signal.value as u64 & mask);
        held += bits;
        while held >= 4 {
            held -= 4;
            let digit = (waiting >> held) as u32 & 0xf;
            digits.push(char::from_digit(digit, 16)?);
        }
        waiting &= (1 << held) - 1;
    }
    Some(digits)
}

fn fits(value: i64, bits: u32, is_signed: bool) -> bool {
    let spare = 64 - bits;
    if is_signed {
        (value << spare) >> spare == value
    } else {
        value >= 0 && (value as u64) << spare >> spare == value as u64
    }
}

impl Probe for Recorder {
    const TAPS: bool = true;

    fn record(&mut self, index: u64, _level: u32) {
        self.is_open = index < self.records && self.error.is_none();
    }

    fn is_tapping(&self) -> bool {
        self.is_open
    }

    fn tap(&mut self, block: u32, stimulus: &[Signal], expected: &[Signal]) {
        if let Err(error) = self.record_row(block, stimulus, expected) {
            self.error = Some(error);
            self.is_open = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use hwmodel::SignalKind;

    use super::super::ports::{BIT, WORD};
    use super::*;
    use crate::project::CageKind;

    #[test]
    fn fields_are_packed_from_the_top() {
        let format = Format::new(18, 4).unwrap();
        let ports = Ports::new(CageKind::Frame)
            .one("bit", BIT, "")
            .one("word", WORD, "")
            .one("short", SignalKind::Signed(3), "");
        let row = |values: [i64; 3]| {
            let kinds = [BIT, WORD, SignalKind::Signed(3)];
            let signals: Vec<Signal> = kinds
                .into_iter()
                .zip(values)
                .map(|(kind, value)| Signal { kind, value })
                .collect();
            packed(&signals, &ports, format)
        };
        // 22 bits: two of padding, 1, 18 ones less the last, 101.
        assert_eq!(row([1, -2, -3]).as_deref(), Some("3ffff5"));
        assert_eq!(row([0, 1, 3]).as_deref(), Some("00000b"));
        assert_eq!(row([2, 1, 3]), None);
        assert_eq!(row([1, 1 << 17, 3]), None);
        assert_eq!(row([1, 0, 4]), None);
        assert_eq!(packed(&[], &ports, format), None);
    }
}
