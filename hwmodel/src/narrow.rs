//! Narrow numbers: weights and colours, which need fewer bits than a word and
//! whose number of bits is written down at each operation.

use crate::{Datapath, OpClass, Operand, Probe, Word};

/// A number of few bits, 0 or more. Like a [`Word`] it has no operators: what
/// is done with it is a call on a [`Datapath`] that names the bits.
///
/// ```compile_fail,E0369
/// let a = hwmodel::Narrow::from_host(6);
/// let _ = a * a; // a narrow number cannot be multiplied
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[repr(transparent)]
pub struct Narrow(u32);

impl Narrow {
    /// Zero.
    pub const ZERO: Self = Self(0);

    /// A number that the host prepared, or that comes from a memory.
    #[must_use]
    pub const fn from_host(value: u32) -> Self {
        Self(value)
    }

    /// The number's value for the host, or for a memory.
    #[must_use]
    pub const fn to_host(self) -> u32 {
        self.0
    }
}

impl<P: Probe> Datapath<P> {
    #[inline(always)]
    fn note_narrow(&mut self, class: OpClass, bits: u32) {
        if P::ENABLED {
            let place = self.place();
            self.probe_mut().op_on(Operand::Short, class, bits, place);
        }
    }

    /// The lowest bits of a word that is not negative: wires.
    #[inline(always)]
    #[must_use]
    pub fn narrowed(&self, a: Word, bits: u32) -> Narrow {
        Narrow(a.0 as u32 & ((1 << bits) - 1))
    }

    /// A narrow number as a word: wires.
    #[inline(always)]
    #[must_use]
    pub fn widened(&self, a: Narrow) -> Word {
        Word(i64::from(a.0))
    }

    /// `a + b`, which must fit `bits` bits.
    #[inline(always)]
    pub fn add_narrow(&mut self, bits: u32, a: Narrow, b: Narrow) -> Narrow {
        self.note_narrow(OpClass::Add, bits);
        let sum = a.0 + b.0;
        debug_assert!(u64::from(sum) < 1 << bits, "{sum} in {bits} bits");
        Narrow(sum)
    }

    /// `a - b`, where `b` is no larger than `a`.
    #[inline(always)]
    pub fn sub_narrow(&mut self, bits: u32, a: Narrow, b: Narrow) -> Narrow {
        self.note_narrow(OpClass::Sub, bits);
        Narrow(a.0.wrapping_sub(b.0))
    }

    /// `a <= b`.
    #[inline(always)]
    pub fn le_narrow(&mut self, bits: u32, a: Narrow, b: Narrow) -> bool {
        self.note_narrow(OpClass::Compare, bits);
        a.0 <= b.0
    }

    /// `a` where the bit is set, else `b`.
    #[inline(always)]
    pub fn select_narrow(&mut self, bits: u32, bit: bool, a: Narrow, b: Narrow) -> Narrow {
        self.note_narrow(OpClass::Select, bits);
        if bit { a } else { b }
    }

    /// `a << places`: wires, counted as a shift.
    #[inline(always)]
    pub fn shl_narrow(&mut self, bits: u32, a: Narrow, places: u32) -> Narrow {
        self.note_narrow(OpClass::Shift, bits);
        Narrow(a.0 << places)
    }

    /// `a >> places`, rounded down: wires, counted as a shift.
    #[inline(always)]
    pub fn shr_narrow(&mut self, bits: u32, a: Narrow, places: u32) -> Narrow {
        self.note_narrow(OpClass::Shift, bits);
        Narrow(a.0 >> places)
    }

    /// Bit `place`, from the right: a wire.
    #[inline(always)]
    #[must_use]
    pub fn bit_narrow(&self, a: Narrow, place: u32) -> bool {
        a.0 >> place & 1 != 0
    }
}
