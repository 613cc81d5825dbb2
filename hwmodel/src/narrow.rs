//! Operations on narrow numbers, of given numbers of bits.

use crate::word::Narrow;
use crate::{Datapath, OpClass, Probe, Word};

impl<P: Probe> Datapath<P> {
    /// The lowest bits of a word that is not negative: wires.
    #[inline(always)]
    pub fn narrowed(&self, a: Word, bits: u32) -> Narrow {
        Narrow(a.0 as u32 & ((1 << bits) - 1))
    }

    /// A narrow number as a word: wires.
    #[inline(always)]
    pub fn widened(&self, a: Narrow) -> Word {
        Word(i64::from(a.0))
    }

    /// `a + b`, which must fit `bits` bits.
    #[inline(always)]
    pub fn add_narrow(&mut self, bits: u32, a: Narrow, b: Narrow) -> Narrow {
        self.note_short(OpClass::Add, bits);
        let sum = a.0 + b.0;
        debug_assert!(u64::from(sum) < 1 << bits, "{sum} in {bits} bits");
        Narrow(sum)
    }

    /// `a - b`, where `b` is no larger than `a`.
    #[inline(always)]
    pub fn sub_narrow(&mut self, bits: u32, a: Narrow, b: Narrow) -> Narrow {
        self.note_short(OpClass::Sub, bits);
        Narrow(a.0.wrapping_sub(b.0))
    }

    /// `a <= b`.
    #[inline(always)]
    pub fn le_narrow(&mut self, bits: u32, a: Narrow, b: Narrow) -> bool {
        self.note_short(OpClass::Compare, bits);
        a.0 <= b.0
    }

    /// `a` where the bit is set, else `b`.
    #[inline(always)]
    pub fn select_narrow(&mut self, bits: u32, bit: bool, a: Narrow, b: Narrow) -> Narrow {
        self.note_short(OpClass::Select, bits);
        if bit { a } else { b }
    }

    /// `a << places`: wires, counted as a shift.
    #[inline(always)]
    pub fn shl_narrow(&mut self, bits: u32, a: Narrow, places: u32) -> Narrow {
        self.note_short(OpClass::Shift, bits);
        Narrow(a.0 << places)
    }

    /// `a >> places`, rounded down: wires, counted as a shift.
    #[inline(always)]
    pub fn shr_narrow(&mut self, bits: u32, a: Narrow, places: u32) -> Narrow {
        self.note_short(OpClass::Shift, bits);
        Narrow(a.0 >> places)
    }

    /// Bit `place`, from the right: a wire.
    #[inline(always)]
    pub fn bit_narrow(&self, a: Narrow, place: u32) -> bool {
        a.0 >> place & 1 != 0
    }
}
