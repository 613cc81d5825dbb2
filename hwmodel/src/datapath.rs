//! The datapath: each call does one operation on words, reports it to the probe, and applies the overflow policy.

use std::panic::Location;

use crate::probe::Memory;
use crate::{
    Format, Number, OpClass, Operand, Overflow, Probe, Stage, StageLevel, Trap, TrapOp, WideWord,
    Wires, Word,
};

/// A datapath of one word format and its wide format.
#[derive(Debug)]
pub struct Datapath<P: Probe> {
    policy: Overflow,
    /// 64 less the widths of words and wide words.
    spare: [u32; 2],
    place: StageLevel,
    record: u64,
    trap: Option<Trap>,
    overflows: u64,
    probe: P,
}

impl<P: Probe> Datapath<P> {
    /// A datapath for words of `format` and its wide words.
    pub fn new(format: Format, policy: Overflow, mut probe: P) -> Self {
        probe.begin(format);
        Self {
            policy,
            spare: [64 - format.bits(), 64 - format.wide().bits()],
            place: StageLevel {
                stage: Stage::default(),
                level: 0,
            },
            record: 0,
            trap: None,
            overflows: 0,
            probe,
        }
    }

    /// The first overflow so far, if the policy is to trap.
    #[inline]
    pub fn trap(&self) -> Option<Trap> {
        self.trap
    }

    /// Results that did not fit, under any policy.
    pub fn overflows(&self) -> u64 {
        self.overflows
    }

    /// Borrows the probe.
    #[inline]
    pub fn probe_mut(&mut self) -> &mut P {
        &mut self.probe
    }

    /// Returns the probe.
    pub fn into_probe(self) -> P {
        self.probe
    }

    /// Begins a record's turn.
    #[inline(always)]
    pub fn begin_record(&mut self, index: u64, level: u32) {
        self.record = index;
        self.place.level = level;
        if P::ENABLED {
            self.probe.record(index, level);
        }
    }

    /// Continues a record of this level.
    #[inline(always)]
    pub fn resume(&mut self, level: u32) {
        self.place.level = level;
    }

    /// Enters a stage.
    #[inline(always)]
    pub fn stage(&mut self, stage: impl Into<Stage>) {
        self.place.stage = stage.into();
        if P::ENABLED {
            self.probe.stage(self.place.stage);
        }
    }

    /// Begins a dependent step ([`Probe::next_step`]).
    #[inline(always)]
    pub fn next_step(&mut self, idle: u32) {
        if P::ENABLED {
            self.probe.next_step(idle, self.place);
        }
    }

    /// Does work of another stage ([`Probe::beside`]).
    #[inline(always)]
    pub fn beside<T>(&mut self, stage: impl Into<Stage>, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.place.stage;
        self.stage(stage);
        if P::ENABLED {
            self.probe.beside(true);
        }
        let done = work(self);
        if P::ENABLED {
            self.probe.beside(false);
        }
        self.place.stage = before;
        done
    }

    /// Reports a read.
    #[inline(always)]
    pub fn read(&mut self, memory: Memory, address: u64) {
        if P::ENABLED {
            self.probe.read(memory, address, self.place);
        }
    }

    /// Reports a write.
    #[inline(always)]
    pub fn write(&mut self, memory: Memory, address: u64) {
        if P::ENABLED {
            self.probe.write(memory, address, self.place);
        }
    }

    /// Shows a probe that taps the inputs and outputs of a block.
    #[inline(always)]
    pub fn tap(&mut self, block: impl Into<u32>, stimulus: &impl Wires, expected: &impl Wires) {
        if P::TAPS && self.probe.is_tapping() {
            let (mut into, mut out) = (Vec::new(), Vec::new());
            stimulus.show(&mut into);
            expected.show(&mut out);
            self.probe.tap(block.into(), &into, &out);
        }
    }

    #[inline(always)]
    fn width<T: Number>(&self) -> u32 {
        64 - self.spare[usize::from(T::WIDE)]
    }

    #[inline(always)]
    fn note<T: Number>(&mut self, class: OpClass) {
        if P::ENABLED {
            let operand = if T::WIDE {
                Operand::Wide
            } else {
                Operand::Word
            };
            let bits = self.width::<T>();
            self.probe.op_on(operand, class, bits, self.place);
        }
    }

    #[inline(always)]
    #[track_caller]
    fn note_shift<T: Number>(&mut self, places: u32) {
        if P::ENABLED {
            let bits = self.width::<T>();
            self.probe
                .shift(bits, places, self.place, Location::caller());
        }
    }

    /// Fits an exact result (`raw`, beyond 64 bits if `carried`) into the format.
    #[inline(always)]
    fn fit<T: Number>(&mut self, op: TrapOp, raw: i64, carried: bool) -> T {
        let spare = self.spare[usize::from(T::WIDE)];
        let wrapped = (raw << spare) >> spare;
        if carried | (wrapped != raw) {
            return self.overflowed(op, raw, carried, wrapped);
        }
        T::from_raw(raw)
    }

    #[cold]
    #[inline(never)]
    fn overflowed<T: Number>(&mut self, op: TrapOp, raw: i64, carried: bool, wrapped: i64) -> T {
        self.overflows += 1;
        if self.policy == Overflow::Trap && self.trap.is_none() {
            self.trap = Some(Trap {
                op,
                place: self.place,
                record: self.record,
                bits: self.width::<T>(),
            });
        }
        if self.policy == Overflow::Saturate {
            let spare = self.spare[usize::from(T::WIDE)];
            // A carry out of 64 bits flips the sign.
            let negative = (raw < 0) != carried;
            return T::from_raw(if negative {
                i64::MIN >> spare
            } else {
                i64::MAX >> spare
            });
        }
        T::from_raw(wrapped)
    }

    /// A constant of the frame.
    #[inline]
    pub fn load(&mut self, value: impl Into<i128>) -> Word {
        self.constant(value.into())
    }

    /// A wide constant of the frame.
    #[inline]
    pub fn load_wide(&mut self, value: impl Into<i128>) -> WideWord {
        self.constant(value.into())
    }

    fn constant<T: Number>(&mut self, value: i128) -> T {
        // Beyond 64 bits with a carry, whose sign is known.
        let value = value.clamp(-1 << 64, (1 << 64) - 1);
        let raw = value as i64;
        self.fit(TrapOp::Load, raw, i128::from(raw) != value)
    }

    /// `a + b`.
    #[inline(always)]
    pub fn add<T: Number>(&mut self, a: T, b: T) -> T {
        self.note::<T>(OpClass::Add);
        let (raw, carried) = a.raw().overflowing_add(b.raw());
        self.fit(TrapOp::Add, raw, carried)
    }

    /// `a - b`.
    #[inline(always)]
    pub fn sub<T: Number>(&mut self, a: T, b: T) -> T {
        self.note::<T>(OpClass::Sub);
        let (raw, carried) = a.raw().overflowing_sub(b.raw());
        self.fit(TrapOp::Sub, raw, carried)
    }

    /// `-a`.
    #[inline(always)]
    pub fn neg<T: Number>(&mut self, a: T) -> T {
        self.note::<T>(OpClass::Sub);
        let (raw, carried) = 0i64.overflowing_sub(a.raw());
        self.fit(TrapOp::Sub, raw, carried)
    }

    /// `(a + b) >> 1` without overflow: an add and a shift of one bit more than the word.
    #[inline(always)]
    pub fn midpoint<T: Number>(&mut self, a: T, b: T) -> T {
        if P::ENABLED {
            let operand = if T::WIDE {
                Operand::WideCarry
            } else {
                Operand::Carry
            };
            let bits = self.width::<T>() + 1;
            self.probe.op_on(operand, OpClass::Add, bits, self.place);
            self.probe.op_on(operand, OpClass::Shift, bits, self.place);
        }
        let (a, b) = (a.raw(), b.raw());
        T::from_raw((a & b) + ((a ^ b) >> 1))
    }

    /// `a >> places`, rounded down; `places` may exceed the width.
    #[inline(always)]
    #[track_caller]
    pub fn shr<T: Number>(&mut self, a: T, places: u32) -> T {
        self.note::<T>(OpClass::Shift);
        self.note_shift::<T>(places);
        T::from_raw(a.raw() >> places.min(63))
    }

    /// `a << places`; overflows where significant bits are lost.
    #[inline(always)]
    #[track_caller]
    pub fn shl<T: Number>(&mut self, a: T, places: u32) -> T {
        self.note::<T>(OpClass::Shift);
        self.note_shift::<T>(places);
        let raw = a.raw();
        let shifted = if places < 64 { raw << places } else { 0 };
        if places >= 64 && raw != 0 || places < 64 && shifted >> places != raw {
            // Bits are lost. `carried`: whether the sign changed.
            let spare = self.spare[usize::from(T::WIDE)];
            let carried = (shifted < 0) != (raw < 0);
            let wrapped = (shifted << spare) >> spare;
            return self.overflowed(TrapOp::ShiftLeft, shifted, carried, wrapped);
        }
        self.fit(TrapOp::ShiftLeft, shifted, false)
    }

    /// `a < b`.
    #[inline(always)]
    pub fn lt<T: Number>(&mut self, a: T, b: T) -> bool {
        self.note::<T>(OpClass::Compare);
        a.raw() < b.raw()
    }

    /// `a <= b`.
    #[inline(always)]
    pub fn le<T: Number>(&mut self, a: T, b: T) -> bool {
        self.note::<T>(OpClass::Compare);
        a.raw() <= b.raw()
    }

    /// `a < 0`: the sign bit.
    #[inline(always)]
    pub fn is_negative<T: Number>(&mut self, a: T) -> bool {
        self.note::<T>(OpClass::Compare);
        a.raw() < 0
    }

    /// `a > 0`.
    #[inline(always)]
    pub fn is_positive<T: Number>(&mut self, a: T) -> bool {
        self.note::<T>(OpClass::Compare);
        a.raw() > 0
    }

    /// `a == 0`.
    #[inline(always)]
    pub fn is_zero<T: Number>(&mut self, a: T) -> bool {
        self.note::<T>(OpClass::Compare);
        a.raw() == 0
    }

    /// The smaller of two words.
    #[inline(always)]
    pub fn min<T: Number>(&mut self, a: T, b: T) -> T {
        self.note::<T>(OpClass::MinMax);
        if a.raw() <= b.raw() { a } else { b }
    }

    /// The larger of two words.
    #[inline(always)]
    pub fn max<T: Number>(&mut self, a: T, b: T) -> T {
        self.note::<T>(OpClass::MinMax);
        if a.raw() >= b.raw() { a } else { b }
    }

    /// `a` where the bit is set, else `b`.
    #[inline(always)]
    pub fn select<T: Number>(&mut self, bit: bool, a: T, b: T) -> T {
        self.note::<T>(OpClass::Select);
        if bit { a } else { b }
    }

    /// Bit `place` of a word, from the right: a wire.
    #[inline(always)]
    pub fn bit<T: Number>(&self, a: T, place: u32) -> bool {
        (a.raw() >> place.min(63)) & 1 != 0
    }

    /// A word with bit `place` zero: a wire to ground.
    #[inline(always)]
    pub fn without_bit(&self, a: Word, place: u32) -> Word {
        Word(a.0 & !(1 << place.min(63)))
    }

    /// And of `bits` bits.
    #[inline(always)]
    pub fn and_bits(&mut self, bits: u32, a: u8, b: u8) -> u8 {
        self.note_short(OpClass::Logic, bits);
        a & b
    }

    /// Or of `bits` bits.
    #[inline(always)]
    pub fn or_bits(&mut self, bits: u32, a: u8, b: u8) -> u8 {
        self.note_short(OpClass::Logic, bits);
        a | b
    }

    /// Exclusive or of `bits` bits.
    #[inline(always)]
    pub fn xor_bits(&mut self, bits: u32, a: u8, b: u8) -> u8 {
        self.note_short(OpClass::Logic, bits);
        a ^ b
    }

    #[inline(always)]
    pub(crate) fn note_short(&mut self, class: OpClass, bits: u32) {
        if P::ENABLED {
            self.probe.op_on(Operand::Short, class, bits, self.place);
        }
    }

    /// Counts an operation of `bits` bits on counters of control logic, such as a level: gates of their own, for which no
    /// unit's issue waits.
    #[inline(always)]
    pub fn control(&mut self, class: OpClass, bits: u32) {
        if P::ENABLED {
            self.probe.op_on(Operand::Control, class, bits, self.place);
        }
    }

    /// `2 a + bit`, as in a quotient register: wires.
    #[inline(always)]
    pub fn shift_in(&mut self, a: Word, bit: bool) -> Word {
        let raw = a.0;
        let carried = (raw << 1) >> 1 != raw;
        self.fit(TrapOp::ShiftLeft, raw << 1 | i64::from(bit), carried)
    }

    /// One step of a restoring divide: the divisor is subtracted from `2 remainder + bit` if it fits. Returns the new
    /// remainder and the quotient's next bit.
    ///
    /// `0 <= remainder < divisor` must hold before and holds after.
    #[inline(always)]
    pub fn divide_step(&mut self, remainder: Word, divisor: Word, bit: bool) -> (Word, bool) {
        if P::ENABLED {
            let bits = self.width::<Word>() + 1;
            self.probe
                .op_on(Operand::Carry, OpClass::DivideStep, bits, self.place);
        }
        // 0 <= remainder < 2^63, so the doubled one fits 64 bits without sign.
        let doubled = ((remainder.0 as u64) << 1) | u64::from(bit);
        let divisor = divisor.0 as u64;
        if doubled >= divisor {
            (Word((doubled - divisor) as i64), true)
        } else {
            (Word(doubled as i64), false)
        }
    }

    /// As [`divide_step`](Self::divide_step), for a quotient bit of weight `2^place`: `divisor << place` is subtracted if
    /// it fits. `0 <= remainder` and `0 < divisor` must hold. A shift by 63 or more exceeds any remainder.
    #[inline(always)]
    pub fn divide_integer_step(
        &mut self,
        remainder: Word,
        divisor: Word,
        place: u32,
    ) -> (Word, bool) {
        if P::ENABLED {
            let bits = self.width::<Word>().saturating_add(place);
            self.probe
                .op_on(Operand::Other, OpClass::DivideStep, bits, self.place);
        }
        let shifted = i128::from(divisor.0) << place.min(63);
        let left = i128::from(remainder.0) - shifted;
        if left >= 0 {
            (Word(left as i64), true)
        } else {
            (remainder, false)
        }
    }
}
