//! Every operation of the datapath against 128-bit integers: result, overflow, trap and events, for all widths, both
//! types of number and all policies.

use std::fmt::Debug;

use crate::common::*;
use hwmodel::{
    Datapath, Format, FormatError, Memory, NoProbe, Number, OpClass, Overflow, Probe, Stage,
    StageLevel, Trap, TrapOp, WideWord, Word,
};
use proptest::prelude::*;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Event {
    Op(OpClass, u32, StageLevel, u32),
    Read(Memory, u64, StageLevel),
    Write(Memory, u64, StageLevel),
    Record(u64, u32),
}

/// Keeps every event. If it is not `ON`, it must not receive any.
#[derive(Default)]
struct Log<const ON: bool>(Vec<Event>);

impl<const ON: bool> Probe for Log<ON> {
    const ENABLED: bool = ON;
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        self.0.push(Event::Op(class, bits, place, times));
    }
    fn read(&mut self, memory: Memory, address: u64, place: StageLevel) {
        self.0.push(Event::Read(memory, address, place));
    }
    fn write(&mut self, memory: Memory, address: u64, place: StageLevel) {
        self.0.push(Event::Write(memory, address, place));
    }
    fn record(&mut self, index: u64, level: u32) {
        self.0.push(Event::Record(index, level));
    }
}

trait Host: Number {
    fn of(value: i64) -> Self;
    fn value(self) -> i64;
    /// From the rule itself and not from `Format`.
    fn bits(word: u32) -> u32 {
        if Self::IS_WIDE {
            64.min(2 * word)
        } else {
            word
        }
    }
    const IS_WIDE: bool;
}

impl Host for Word {
    fn of(value: i64) -> Self {
        Self::from_host(value)
    }
    fn value(self) -> i64 {
        self.to_host()
    }
    const IS_WIDE: bool = false;
}

impl Host for WideWord {
    fn of(value: i64) -> Self {
        Self::from_host(value)
    }
    fn value(self) -> i64 {
        self.to_host()
    }
    const IS_WIDE: bool = true;
}

/// Operands: two numbers, and places of a shift or a bit.
type Given = (i64, i64, u32);

/// Events of an operation, as class and bits beyond the number's, and the operation that a trap names.
type Kind = (&'static [(OpClass, u32)], TrapOp);

const ADD: Kind = (&[(OpClass::Add, 0)], TrapOp::Add);
const SUB: Kind = (&[(OpClass::Sub, 0)], TrapOp::Sub);
const SHIFT: Kind = (&[(OpClass::Shift, 0)], TrapOp::ShiftLeft);
const WIRE: Kind = (&[], TrapOp::ShiftLeft);
const LOAD: Kind = (&[], TrapOp::Load);
// These never trap.
const MIDPOINT: Kind = (&[(OpClass::Add, 1), (OpClass::Shift, 1)], TrapOp::Load);
const MIN_MAX: Kind = (&[(OpClass::MinMax, 0)], TrapOp::Load);
const SELECT: Kind = (&[(OpClass::Select, 0)], TrapOp::Load);
const COMPARE: Kind = (&[(OpClass::Compare, 0)], TrapOp::Load);

/// A call on a fresh datapath; a result that is a bit is 0 or 1.
struct Ran<P: Probe> {
    kind: Kind,
    exact: i128,
    found: i64,
    dp: Datapath<P>,
}

fn run_all<P: Probe + Default, T: Host>(
    word: u32,
    policy: Overflow,
    (a, b, places): Given,
    mut see: impl FnMut(Ran<P>),
) {
    let mut run = |kind: Kind, exact, call: &dyn Fn(&mut Datapath<P>) -> i64| {
        let mut dp = datapath(word, policy, P::default());
        let found = call(&mut dp);
        see(Ran {
            kind,
            exact,
            found,
            dp,
        });
    };
    let (x, y) = (T::of(a), T::of(b));
    let (w, a, b) = (Word::of(a), i128::from(a), i128::from(b));
    let half = a.div_euclid(1 << places.min(64));
    let double = a << places.min(64);
    let mean = (a + b).div_euclid(2);
    run(ADD, a + b, &|dp| dp.add(x, y).value());
    run(SUB, a - b, &|dp| dp.sub(x, y).value());
    run(SUB, -a, &|dp| dp.neg(x).value());
    run(MIDPOINT, mean, &|dp| dp.midpoint(x, y).value());
    run(SHIFT, half, &|dp| dp.shr(x, places).value());
    run(SHIFT, double, &|dp| dp.shl(x, places).value());
    run(MIN_MAX, a.min(b), &|dp| dp.min(x, y).value());
    run(MIN_MAX, a.max(b), &|dp| dp.max(x, y).value());
    run(SELECT, a, &|dp| dp.select(true, x, y).value());
    run(SELECT, b, &|dp| dp.select(false, x, y).value());
    run(COMPARE, (a < b).into(), &|dp| dp.lt(x, y).into());
    run(COMPARE, (a <= b).into(), &|dp| dp.le(x, y).into());
    run(COMPARE, (a == b).into(), &|dp| dp.equal(x, y).into());
    run(COMPARE, (a < 0).into(), &|dp| dp.is_negative(x).into());
    run(COMPARE, (a > 0).into(), &|dp| dp.is_positive(x).into());
    run(COMPARE, (a == 0).into(), &|dp| dp.is_zero(x).into());
    run(WIRE, half & 1, &|dp| dp.bit(x, places).into());
    if !T::IS_WIDE {
        run(WIRE, 2 * a, &|dp| dp.shift_in(w, false).value());
        run(WIRE, 2 * a + 1, &|dp| dp.shift_in(w, true).value());
    }
}

/// An exact result in a word of `bits` bits, and whether it overflowed. After a trap the word is the wrapped one.
fn fit(exact: i128, bits: u32, policy: Overflow) -> (i64, bool) {
    let overflowed = exact < least(bits) || exact > greatest(bits);
    let kept = match policy {
        Overflow::Saturate => exact.clamp(least(bits), greatest(bits)),
        _ if overflowed => {
            let residue = exact.rem_euclid(1i128 << bits);
            residue - i128::from(residue > greatest(bits)) * (1i128 << bits)
        }
        _ => exact,
    };
    (i64::try_from(kept).expect("64 bits at most"), overflowed)
}

const PLACE: StageLevel = at(Stage::VertexPool, 5);

fn op_event(class: OpClass, bits: u32) -> Event {
    Event::Op(class, bits, PLACE, 1)
}

fn datapath<P: Probe>(bits: u32, policy: Overflow, probe: P) -> Datapath<P> {
    let mut dp = Datapath::new(format(bits), policy, probe);
    dp.begin_record(41, PLACE.level);
    dp.stage(PLACE.stage);
    dp
}

fn check<T: Host>(word: u32, policy: Overflow, context: impl Debug, ran: Ran<Log<true>>) {
    let (bits, dp) = (T::bits(word), ran.dp);
    let (events, op) = ran.kind;
    let (expected, overflowed) = fit(ran.exact, bits, policy);
    let context = format!("{context:?}, {word}-bit words, {policy:?}, {op:?} {events:?}");
    let found = (ran.found, dp.overflows());
    assert_eq!(found, (expected, overflowed.into()), "{context}");
    let trap = Trap {
        op,
        place: PLACE,
        record: 41,
        bits,
    };
    let is_trap = overflowed && policy == Overflow::Trap;
    assert_eq!(dp.trap(), is_trap.then_some(trap), "{context}");
    let events = events.iter();
    let events = events.map(|&(class, more)| op_event(class, bits + more));
    assert!(
        events.eq(dp.into_probe().0.into_iter().skip(1)),
        "{context}"
    );
}

const POLICIES: [Overflow; 3] = [Overflow::Trap, Overflow::Wrap, Overflow::Saturate];

fn check_all<T: Host>(word: u32, given: Given) {
    for policy in POLICIES {
        run_all::<_, T>(word, policy, given, |ran| {
            check::<T>(word, policy, given, ran)
        });
    }
    run_all::<Log<false>, T>(word, Overflow::Wrap, given, |ran| {
        let expected = fit(ran.exact, T::bits(word), Overflow::Wrap).0;
        assert_eq!(ran.found, expected);
        assert!(ran.dp.into_probe().0.is_empty());
    });
}

const PLACES: [u32; 17] = [
    0, 1, 2, 7, 14, 15, 16, 17, 31, 32, 33, 47, 62, 63, 64, 65, 1000,
];

fn edge_cases_of<T: Host>() {
    for word in widths() {
        let values = edge_cases(T::bits(word));
        assert_eq!(values.len(), PLACES.len(), "each number meets all places");
        for (i, &a) in values.iter().enumerate() {
            for (j, &b) in values.iter().enumerate() {
                check_all::<T>(word, (a, b, PLACES[(i + j) % PLACES.len()]));
            }
        }
    }
}

#[test]
fn edge_cases_of_all_operations() {
    edge_cases_of::<Word>();
    edge_cases_of::<WideWord>();
}

fn any_pair<T: Host>() -> impl Strategy<Value = (u32, i64, i64)> {
    widths().prop_flat_map(|word| {
        let bits = T::bits(word);
        (Just(word), any_value(bits), any_value(bits))
    })
}

type Logged = Datapath<Log<true>>;

fn check_load<T: Host>(word: u32, value: i64, load: fn(&mut Logged, i64) -> T) {
    for policy in POLICIES {
        let mut dp = datapath(word, policy, Log::default());
        let ran = Ran {
            kind: LOAD,
            exact: value.into(),
            found: load(&mut dp, value).value(),
            dp,
        };
        check::<T>(word, policy, value, ran);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn words((word, a, b) in any_pair::<Word>(), places in 0..70u32) {
        check_all::<Word>(word, (a, b, places));
    }

    #[test]
    fn wide_words((word, a, b) in any_pair::<WideWord>(), places in 0..70u32) {
        check_all::<WideWord>(word, (a, b, places));
    }

    /// The host may load any 64-bit number. One that does not fit overflows.
    #[test]
    fn loads(word in widths(), value: i64, less in 0..64u32, from_end in -2..=2i128) {
        let ends = [word, 64.min(2 * word)].map(|bits| [least(bits), greatest(bits)]);
        let ends = ends.concat().into_iter().filter_map(|end| i64::try_from(end + from_end).ok());
        for value in ends.chain([value >> less]) {
            check_load(word, value, |dp, value| dp.load(value));
            check_load(word, value, |dp, value| dp.load_wide(value));
        }
    }

    /// `2 a + bit` by `b`, and `a` by `b << place`.
    #[test]
    fn steps_of_divides(
        (word, a, b) in any_pair::<Word>(), bit: bool, place in prop_oneof![0..70u32, Just(u32::MAX - 64)],
    ) {
        let greatest = i64::try_from(greatest(word)).unwrap();
        let divisor = (b & greatest).max(1);
        let step = |remainder: i64, run: &dyn Fn(&mut Logged, Word, Word) -> (Word, bool)| {
            let mut dp = datapath(word, Overflow::Trap, Log::<true>::default());
            let (rest, bit) = run(&mut dp, Word::of(remainder), Word::of(divisor));
            (rest.value().into(), bit, dp.into_probe().0[1..].to_vec())
        };
        let event = |more| vec![op_event(OpClass::DivideStep, word + more)];
        let remainder = (a & greatest) % divisor;
        let doubled = 2 * i128::from(remainder) + i128::from(bit);
        let (over, divisor) = (doubled - i128::from(divisor), i128::from(divisor));
        let expected = if over >= 0 { (over, true, event(1)) } else { (doubled, false, event(1)) };
        prop_assert_eq!(step(remainder, &|dp, r, d| dp.divide_step(r, d, bit)), expected);

        let remainder = a & greatest;
        let over = i128::from(remainder) - (divisor << place.min(63));
        let expected = if over >= 0 {
            (over, true, event(place))
        } else {
            (i128::from(remainder), false, event(place))
        };
        prop_assert_eq!(step(remainder, &|dp, r, d| dp.divide_integer_step(r, d, place)), expected);
    }

    #[test]
    fn short_vectors(a: u8, b: u8, width in 1..=8u32) {
        let mut dp = datapath(32, Overflow::Trap, Log::<true>::default());
        let found = [dp.and_bits(width, a, b), dp.or_bits(width, a, b), dp.xor_bits(width, a, b)];
        prop_assert_eq!(found, [a & b, a | b, a ^ b]);
        prop_assert_eq!(&dp.into_probe().0[1..], &[op_event(OpClass::Logic, width); 3]);
    }
}

#[test]
fn accesses_have_the_place_of_their_time() {
    let mut dp = Datapath::new(format(32), Overflow::Trap, Log::<true>::default());
    dp.read(Memory::Stack, 9);
    dp.begin_record(12, 7);
    dp.stage(Stage::QuadtreeFit);
    dp.write(Memory::Pixel, 1 << 40);
    let expected = [
        Event::Read(Memory::Stack, 9, at(Stage::Pop, 0)),
        Event::Record(12, 7),
        Event::Write(Memory::Pixel, 1 << 40, at(Stage::QuadtreeFit, 7)),
    ];
    assert_eq!(dp.into_probe().0, expected);
}

#[test]
fn the_first_trap_stays() {
    let mut dp = datapath(16, Overflow::Trap, NoProbe);
    let max = Word::of(i64::from(i16::MAX));
    dp.begin_record(2, 3);
    dp.add(max, max);
    let first = dp.trap();
    dp.begin_record(3, 4);
    dp.shl(max, 5);
    assert_eq!((dp.trap(), dp.overflows()), (first, 2));
    assert_eq!(
        first.map(|trap| (trap.record, trap.place.level)),
        Some((2, 3))
    );
}

#[test]
fn formats_have_16_to_64_bits_with_a_bit_beside_sign_and_fraction() {
    for bits in (0..70).chain([u32::MAX]) {
        for frac in (0..70).chain([u32::MAX]) {
            let found = Format::new(bits, frac);
            let read =
                serde_json::from_value::<Format>(serde_json::json!({"bits": bits, "frac": frac}));
            if !(16..=64).contains(&bits) {
                assert_eq!(found, Err(FormatError::Bits(bits)));
            } else if frac > bits - 2 {
                assert_eq!(found, Err(FormatError::Frac { bits, frac }));
            }
            assert_eq!(read.ok(), found.ok());
            let Ok(format) = found else { continue };
            assert_eq!((format.bits(), format.frac()), (bits, frac));
            let wide = format.wide();
            assert_eq!((wide.bits(), wide.frac()), (WideWord::bits(bits), frac));
            assert_eq!(i128::from(format.min()), least(bits));
            assert_eq!(i128::from(format.max()), greatest(bits));
            for end in [least(bits), greatest(bits)] {
                for value in (end - 1..=end + 1).filter_map(|value| i64::try_from(value).ok()) {
                    let expected = (format.min()..=format.max()).contains(&value);
                    assert_eq!(format.holds(value), expected, "{value} in {bits} bits");
                }
            }
        }
    }
}
