//! Files of rows: one a line, in hexadecimal digits.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use hwmodel::{Format, Signal};

use super::VectorsError;
use super::folder::ROWS;
use super::ports::Ports;
use shiftvox::whole::WholeError;

/// A file of rows in the making.
#[derive(Debug)]
pub(super) struct Rows {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Rows {
    pub(super) fn create(
        path: PathBuf,
        format: Format,
        ports: &Ports,
    ) -> Result<Self, VectorsError> {
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

    /// Writes a row.
    pub(super) fn write(&mut self, text: &str) -> Result<(), VectorsError> {
        writeln!(self.file, "{text}").map_err(|source| self.failed(source))
    }

    /// All of it is in the file.
    pub(super) fn finish(&mut self) -> Result<(), VectorsError> {
        self.file.flush().map_err(|source| self.failed(source))
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
pub(super) fn packed(signals: &[Signal], ports: &Ports, format: Format) -> Option<String> {
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

#[cfg(test)]
mod tests {
    use hwmodel::SignalKind;

    use super::*;
    use crate::model::vectors::ports::{BIT, WORD};
    use shiftvox::project::CageKind;

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
