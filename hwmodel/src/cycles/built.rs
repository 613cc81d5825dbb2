//! Units and registers that are built, where a description lists them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::Format;

/// Parts of hardware beside memories and control, for its area. Where steps share no units, as in a state machine,
/// the units of the cycle model are too few or too many.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Built {
    /// Units of a lane, by stage ([`Stage::key`](crate::Stage::key)) and operation of the cost table.
    pub units: BTreeMap<String, BTreeMap<String, Sizes>>,
    /// Registers of all lanes together.
    pub shared: Sizes,
    /// Registers of a lane.
    pub lane: Sizes,
    /// Registers of a context.
    pub context: Sizes,
    /// Registers that save a context while others of its lane run, so none if it is the only one.
    pub saved: Sizes,
}

/// Numbers of units or registers of each size.
pub type Sizes = BTreeMap<Size, u32>;

/// A number of bits that may depend on the frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Size {
    /// One.
    Bit,
    /// Of a word.
    Word,
    /// One more than of a word.
    Carry,
    /// Of a wide word.
    Wide,
    /// One for each level of the picture, with the whole picture.
    Level,
}

impl Size {
    /// The number, for a picture of so many levels below the whole.
    pub fn bits(self, format: Format, levels: u32) -> u32 {
        match self {
            Self::Bit => 1,
            Self::Word => format.bits(),
            Self::Carry => format.bits() + 1,
            Self::Wide => format.wide().bits(),
            Self::Level => levels + 1,
        }
    }
}

impl Built {
    /// Bits of the registers of lanes with so many contexts each.
    pub fn register_bits(&self, lanes: u32, contexts: u32, format: Format, levels: u32) -> u64 {
        let bits = |sizes: &Sizes| -> u64 {
            let of = |(size, &count): (&Size, &u32)| (size.bits(format, levels), count);
            let of = sizes.iter().map(of);
            of.map(|(bits, count)| u64::from(bits) * u64::from(count))
                .sum()
        };
        let saved = if contexts > 1 { bits(&self.saved) } else { 0 };
        let lane = bits(&self.lane) + u64::from(contexts) * (bits(&self.context) + saved);
        bits(&self.shared) + u64::from(lanes) * lane
    }
}
