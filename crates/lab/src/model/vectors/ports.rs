//! The ports of a block, and rows of their values as hexadecimal digits.

use hwmodel::{Format, Signal, SignalKind};
use serde_json::{Value, json};

use shiftvox::machine::{NumberSpan, ProvenWidths, RecordNumber};
use shiftvox::project::CageKind;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Port {
    pub(super) name: String,
    pub(super) kind: SignalKind,
    pub(super) count: usize,
}

/// Ports side by side, the most significant first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Ports(pub(super) Vec<Port>);

/// Inputs that are constants of a frame: registers that set-up writes, not wires from another block. In rows made for a
/// block they change nevertheless.
const OF_FRAME: [&str; 9] = [
    "eye_floor",
    "eye_ceil",
    "positive",
    "axis_x",
    "axis_y",
    "axis_z",
    "wider",
    "closed",
    "limit",
];

impl Ports {
    /// Reads `name:kind` with blanks between them. A kind is `w` for a word or `v` for a wide word. `u4` and `s4` are numbers
    /// of four bits without and with sign. `c` is one coordinate of a cage: eight vertices, or a corner and three edges. A
    /// number before a kind is a count.
    ///
    /// # Panics
    /// When the text is not like that.
    pub(super) fn new(text: &str, cage: CageKind) -> Self {
        let port = |text: &str| {
            let (name, kind) = text.split_once(':')?;
            let letter = kind.find(|c: char| c.is_ascii_alphabetic())?;
            let (count, kind) = kind.split_at(letter);
            let count = if count.is_empty() {
                1
            } else {
                count.parse().ok()?
            };
            let bits = || kind[1..].parse().ok();
            let (kind, count) = match &kind[..1] {
                "w" => (SignalKind::Word, count),
                "v" => (SignalKind::Wide, count),
                "u" => (SignalKind::Unsigned(bits()?), count),
                "s" => (SignalKind::Signed(bits()?), count),
                "c" if cage == CageKind::Corners => (SignalKind::Word, 8),
                "c" => (SignalKind::Word, 4),
                _ => return None,
            };
            let name = name.to_owned();
            Some(Port { name, kind, count })
        };
        let ports = text.split_whitespace().map(|text| match port(text) {
            Some(port) => port,
            None => unreachable!("no port: {text}"),
        });
        Self(ports.collect())
    }

    pub(super) fn bits(&self, format: Format) -> u32 {
        self.numbers().map(|(port, _)| port.kind.bits(format)).sum()
    }

    /// Each number with its port and its place in that.
    fn numbers(&self) -> impl Iterator<Item = (&Port, usize)> {
        let ports = self.0.iter();
        ports.flat_map(|port| (0..port.count).map(move |at| (port, at)))
    }

    /// Values as hexadecimal digits, the first the most significant; `None` if they do not fit the ports.
    pub(super) fn packed(&self, signals: &[Signal], format: Format) -> Option<String> {
        let digits = self.bits(format).div_ceil(4);
        let mut text = String::with_capacity(digits as usize);
        // Fewer than four bits wait for more; with a word of 64 they fit 128.
        let (mut waiting, mut held) = (0u128, digits * 4 - self.bits(format));
        if signals.len() != self.numbers().count() {
            return None;
        }
        for (signal, (port, _)) in signals.iter().zip(self.numbers()) {
            let bits = port.kind.bits(format);
            if signal.kind != port.kind || !fits(signal.value, bits, port.kind.is_signed()) {
                return None;
            }
            let mask = u64::MAX >> (64 - bits);
            waiting = waiting << bits | u128::from(signal.value as u64 & mask);
            held += bits;
            while held >= 4 {
                held -= 4;
                text.push(char::from_digit((waiting >> held) as u32 & 0xf, 16)?);
            }
            waiting &= (1 << held) - 1;
        }
        Some(text)
    }

    /// The ports in the manifest. `seen` has the range of each number in the rows of the frame, and `proven` the sufficient
    /// widths, if they are known.
    pub(super) fn describe(
        &self,
        format: Format,
        meaning: impl Fn(&str) -> String,
        seen: &[NumberSpan],
        proven: Option<&ProvenWidths>,
    ) -> Value {
        let (mut lowest, mut first) = (self.bits(format), 0);
        let ports = self.0.iter().map(|port| {
            let bits = port.kind.bits(format);
            let place = first;
            first += port.count;
            lowest -= bits * port.count as u32;
            // Values of wires fit 64 bits.
            let range = |span: &NumberSpan| [span.least as i64, span.greatest as i64];
            let seen = seen.get(place..first).unwrap_or_default();
            let proven_bits = |at: usize| match (port.kind, proven?) {
                (SignalKind::Wide, proven) => Some(proven.wide_bits),
                (_, proven) => Some(proven.numbers.get(&port.number(at)?)?.bits()),
            };
            json!({
                "name": port.name,
                "count": port.count,
                "bits": bits,
                "signed": port.kind.is_signed(),
                "lowest_bit": lowest,
                "meaning": meaning(&port.name),
                "changes": if OF_FRAME.contains(&port.name.as_str()) { "frame" } else { "row" },
                "seen": seen.iter().map(range).collect::<Vec<_>>(),
                "proven_bits": (0..port.count).map(proven_bits).collect::<Vec<_>>(),
            })
        });
        let ports: Vec<Value> = ports.collect();
        json!({ "bits": self.bits(format), "ports": ports })
    }
}

impl Port {
    /// The number of a record that an input is, if set-up can prove its width.
    fn number(&self, at: usize) -> Option<RecordNumber> {
        let is_edge = self.count == 4 && at > 0;
        match (self.name.as_str(), is_edge) {
            ("w_min", _) => Some(RecordNumber::LeastW),
            ("w", false) => Some(RecordNumber::ClipW),
            ("w", true) | ("edge_w", _) => Some(RecordNumber::EdgeW),
            ("x", false) if self.count > 1 => Some(RecordNumber::ClipXy),
            ("x", true) | ("edge_x", _) => Some(RecordNumber::EdgeXy),
            ("min", _) => Some(RecordNumber::Lowest),
            ("max", _) => Some(RecordNumber::Highest),
            _ => None,
        }
    }
}

fn fits(value: i64, bits: u32, is_signed: bool) -> bool {
    let spare = 64 - bits;
    match is_signed {
        true => (value << spare) >> spare == value,
        false => value >= 0 && (value as u64) << spare >> spare == value as u64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_packed_from_the_top() {
        let format = Format::new(18, 4).unwrap();
        let ports = Ports::new("bit:u1 word:w short:s3", CageKind::Frame);
        // 22 bits: two of padding, 1, 18 ones less the last, 101.
        for (values, text) in [
            (&[1, -2, -3][..], Some("3ffff5")),
            (&[0, 1, 3], Some("00000b")),
            (&[2, 1, 3], None),
            (&[1, 1 << 17, 3], None),
            (&[1, 0, 4], None),
            (&[], None),
        ] {
            let kinds = ports.0.iter().map(|port| port.kind).zip(values);
            let signals = kinds.map(|(kind, &value)| Signal { kind, value });
            let packed = ports.packed(&signals.collect::<Vec<_>>(), format);
            assert_eq!(packed.as_deref(), text, "{values:?}");
        }
    }
}
