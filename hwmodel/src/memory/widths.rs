//! Bits of accesses to the memories.

use serde::{Deserialize, Serialize};

use crate::Memory;

/// Bits of a blended pixel's accumulator: nine of transmittance, 24 of each colour.
pub const ACCUMULATOR_BITS: u32 = 9 + 3 * 24;

/// Bits of a pixel: red, green and blue.
pub const PIXEL_BITS: u32 = 24;

/// Bits per access of each memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct Widths {
    /// Of a record.
    pub stack_bits: u32,
    pub node_bits: u32,
    /// Colour and normal of a node.
    pub attribute_bits: u32,
    /// One per quarter of a picture node.
    pub fill_vector_bits: u32,
    pub pixel_bits: u32,
}

impl Widths {
    /// Bits of an access of a memory.
    pub const fn of(&self, memory: Memory) -> u32 {
        match memory {
            Memory::Stack => self.stack_bits,
            Memory::Node => self.node_bits,
            Memory::Attribute => self.attribute_bits,
            Memory::FillVector => self.fill_vector_bits,
            Memory::Pixel => self.pixel_bits,
            Memory::Accumulator => ACCUMULATOR_BITS,
        }
    }
}
