//! The wires of a block's border, by name.

use hwmodel::{Format, SignalKind};

use shiftvox::machine::RecordNumber;
use shiftvox::project::CageKind;

/// A word.
pub(super) const WORD: SignalKind = SignalKind::Word;
/// A wide word.
pub(super) const WIDE: SignalKind = SignalKind::Wide;
/// One wire.
pub(super) const BIT: SignalKind = SignalKind::Unsigned(1);
/// A level of a tree, or a shift by levels.
pub(super) const LEVEL: SignalKind = SignalKind::Unsigned(6);

/// Inputs that are constants of a frame: a register that set-up writes, not wires from another block.
const OF_FRAME: [&str; 9] = [
    "eye_floor_",
    "eye_ceil_",
    "positive",
    "axis_x_",
    "axis_y_",
    "axis_z_",
    "wider",
    "closed",
    "limit",
];

/// Whether an input is a constant of the frame, by its name. In rows made for the blocks it changes all the same.
pub(super) fn is_of_frame(name: &str) -> bool {
    // `axis_x_c` to `axis_z_c` are relative to a record's place in the picture.
    OF_FRAME.iter().any(|of| name.starts_with(of))
        && !(name.starts_with("axis_") && name.ends_with("_c"))
}

/// The number of a record that an input is, by its name: the set-up may prove how many bits are enough for it.
pub(super) fn number_of(name: &str) -> Option<RecordNumber> {
    let (stem, rest) = name.split_once('_').unwrap_or((name, ""));
    let is_edge = rest.starts_with("edge");
    match stem {
        "w" if rest == "min" => Some(RecordNumber::LeastW),
        "w" => Some(match is_edge {
            true => RecordNumber::EdgeW,
            false => RecordNumber::ClipW,
        }),
        "x" if is_edge => Some(RecordNumber::EdgeXy),
        "x" if rest != "c" && !rest.is_empty() => Some(RecordNumber::ClipXy),
        "edge" if rest.starts_with("x_") => Some(RecordNumber::EdgeXy),
        "edge" if rest.starts_with("w_") => Some(RecordNumber::EdgeW),
        "min" => Some(RecordNumber::Lowest),
        "max" => Some(RecordNumber::Highest),
        _ => None,
    }
}

/// A field of a row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Its name, fit for Verilog.
    pub name: String,
    /// Its width and sign.
    pub kind: SignalKind,
    /// What it is.
    pub meaning: &'static str,
}

/// The fields of a row, the most significant first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ports {
    cage: CageKind,
    fields: Vec<Field>,
}

impl Ports {
    /// No fields; `cage`: how a frame's records hold their vertices.
    pub(super) fn new(cage: CageKind) -> Self {
        Self {
            cage,
            fields: Vec::new(),
        }
    }

    /// All fields.
    #[must_use]
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// Bits of a row.
    #[must_use]
    pub fn bits(&self, format: Format) -> u32 {
        self.fields.iter().map(|f| f.kind.bits(format)).sum()
    }

    /// Hexadecimal digits of a row.
    #[must_use]
    pub fn digits(&self, format: Format) -> u32 {
        self.bits(format).div_ceil(4)
    }

    /// Each field with the place of its lowest bit in the row.
    pub fn placed(&self, format: Format) -> impl Iterator<Item = (&Field, u32)> {
        let mut left = self.bits(format);
        self.fields.iter().map(move |field| {
            left -= field.kind.bits(format);
            (field, left)
        })
    }

    /// With one more field.
    pub(super) fn one(mut self, name: &str, kind: SignalKind, meaning: &'static str) -> Self {
        self.fields.push(Field {
            name: name.to_owned(),
            kind,
            meaning,
        });
        self
    }

    /// With a field for each ending, in order.
    pub(super) fn each(
        self,
        name: &str,
        endings: &[&str],
        kind: SignalKind,
        meaning: &'static str,
    ) -> Self {
        endings.iter().fold(self, |ports, ending| {
            ports.one(&format!("{name}_{ending}"), kind, meaning)
        })
    }

    /// With a field for each axis.
    pub(super) fn axes(self, name: &str, kind: SignalKind, meaning: &'static str) -> Self {
        self.each(name, &["x", "y", "z"], kind, meaning)
    }

    /// With `count` numbered fields.
    pub(super) fn list(
        self,
        name: &str,
        count: usize,
        kind: SignalKind,
        meaning: &'static str,
    ) -> Self {
        (0..count).fold(self, |ports, i| {
            ports.one(&format!("{name}_{i}"), kind, meaning)
        })
    }

    /// With one coordinate of a cage: eight vertices in Morton order, or a
    /// corner and the edges from it along x, y, z.
    pub(super) fn cage(self, name: &str, meaning: &'static str) -> Self {
        match self.cage {
            CageKind::Corners => self.list(name, 8, WORD, meaning),
            CageKind::Frame => {
                let edge = format!("{name}_edge");
                self.one(&format!("{name}_corner"), WORD, meaning)
                    .axes(&edge, WORD, meaning)
            }
        }
    }
}
