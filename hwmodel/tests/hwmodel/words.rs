//! Every operation of the datapath against 128-bit integers: result, overflow, trap and events, for all widths, both
//! types of number and all policies.

use crate::common::*;
use hwmodel::count::Counter;
use hwmodel::{
    Datapath, Format, FormatError, Memory, Narrow, NoProbe, Number, OpClass, Overflow, Probe,
    Short, Signal, SignalKind, Stage, StageLevel, Trap, TrapOp, WideWord, Wires, Word,
};
use proptest::prelude::*;

fn least(bits: u32) -> i128 {
    -(1i128 << (bits - 1))
}

fn greatest(bits: u32) -> i128 {
    (1i128 << (bits - 1)) - 1
}

/// Numbers of `bits` bits at which carries, signs and rounding change.
fn edge_cases(bits: u32) -> Vec<i64> {
    let (low, high, half) = (least(bits), greatest(bits), 1i128 << (bits - 2));
    let ends = [low, low + 1, high - 1, high];
    let halves = [-half, half].map(|half| [half - 1, half, half + 1]);
    let all = ends.into_iter().chain(halves.concat()).chain(-3..=3);
    all.map(|value| i64::try_from(value).unwrap()).collect()
}

/// Any number of `bits` bits, small or large.
fn any_value(bits: u32) -> impl Strategy<Value = i64> {
    let spare = 64 - bits;
    prop_oneof![
        2 => (any::<i64>(), 0..bits).prop_map(move |(v, less)| v >> (spare + less)),
        1 => proptest::sample::select(edge_cases(bits)),
    ]
}

#[derive(Default)]
struct Log(Vec<(OpClass, u32, StageLevel, u32)>);

impl Probe for Log {
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        self.0.push((class, bits, place, times));
    }
}

const PLACE: StageLevel = StageLevel {
    stage: Stage::new(6, "vertex pool"),
    level: 5,
};

fn datapath<P: Probe>(word: u32, policy: Overflow, probe: P) -> Datapath<P> {
    let mut dp = Datapath::new(format(word), policy, probe);
    dp.begin_record(41, PLACE.level);
    dp.stage(PLACE.stage);
    dp
}

/// Events of an operation, as class and bits beyond the number's, and the operation that a trap names.
type Kind<'k> = (&'k [(OpClass, u32)], TrapOp);

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

/// Checks a call for a number of `bits` bits on a fresh datapath; a result that is a bit is 0 or 1.
fn check(
    (word, bits): (u32, u32),
    (events, op): Kind,
    exact: i128,
    call: &dyn Fn(&mut Datapath<Log>) -> i64,
) {
    for policy in [Overflow::Trap, Overflow::Wrap, Overflow::Saturate] {
        let mut dp = datapath(word, policy, Log::default());
        let found = call(&mut dp);
        let overflowed = exact < least(bits) || exact > greatest(bits);
        let expected = match policy {
            Overflow::Saturate => exact.clamp(least(bits), greatest(bits)),
            // After a trap, too.
            _ => exact << (128 - bits) >> (128 - bits),
        };
        let trap = Trap {
            op,
            place: PLACE,
            record: 41,
            bits,
        };
        let trap = (overflowed && policy == Overflow::Trap).then_some(trap);
        let expected = (expected, u64::from(overflowed), trap);
        let found = (found.into(), dp.overflows(), dp.trap());
        assert_eq!(
            found, expected,
            "{exact} {policy:?} {word} {op:?} {events:?}"
        );
        let events = events.iter();
        let events = events.map(|&(class, more)| (class, bits + more, PLACE, 1));
        assert!(events.eq(dp.into_probe().0), "{word} {op:?}");
    }
}

fn check_all<T: Number>(sizes: (u32, u32), (a, b, places): (i64, i64, u32)) {
    let run = |kind, exact, call: &dyn Fn(&mut Datapath<Log>) -> i64| {
        check(sizes, kind, exact, call);
    };
    let (x, y) = (T::from_raw(a), T::from_raw(b));
    let (w, a, b) = (Word::from_host(a), i128::from(a), i128::from(b));
    let half = a.div_euclid(1 << places.min(64));
    run(ADD, a + b, &|dp| dp.add(x, y).raw());
    run(SUB, a - b, &|dp| dp.sub(x, y).raw());
    run(SUB, -a, &|dp| dp.neg(x).raw());
    run(MIDPOINT, (a + b).div_euclid(2), &|dp| {
        dp.midpoint(x, y).raw()
    });
    run(SHIFT, half, &|dp| dp.shr(x, places).raw());
    run(SHIFT, a << places.min(64), &|dp| dp.shl(x, places).raw());
    run(MIN_MAX, a.min(b), &|dp| dp.min(x, y).raw());
    run(MIN_MAX, a.max(b), &|dp| dp.max(x, y).raw());
    run(SELECT, a, &|dp| dp.select(true, x, y).raw());
    run(SELECT, b, &|dp| dp.select(false, x, y).raw());
    run(COMPARE, (a < b).into(), &|dp| dp.lt(x, y).into());
    run(COMPARE, (a <= b).into(), &|dp| dp.le(x, y).into());
    run(COMPARE, (a < 0).into(), &|dp| dp.is_negative(x).into());
    run(COMPARE, (a > 0).into(), &|dp| dp.is_positive(x).into());
    run(COMPARE, (a == 0).into(), &|dp| dp.is_zero(x).into());
    run(WIRE, half & 1, &|dp| dp.bit(x, places).into());
    if sizes.0 == sizes.1 {
        run(WIRE, 2 * a, &|dp| dp.shift_in(w, false).to_host());
        run(WIRE, 2 * a + 1, &|dp| dp.shift_in(w, true).to_host());
    }
}

fn any_numbers() -> impl Strategy<Value = (u32, bool, i64, i64)> {
    (16..=64u32, any::<bool>()).prop_flat_map(|(word, is_wide)| {
        let bits = if is_wide { 64.min(2 * word) } else { word };
        (Just(word), Just(is_wide), any_value(bits), any_value(bits))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6000))]

    #[test]
    fn numbers((word, is_wide, a, b) in any_numbers(), places in 0..70u32) {
        match is_wide {
            false => check_all::<Word>((word, word), (a, b, places)),
            true => check_all::<WideWord>((word, 64.min(2 * word)), (a, b, places)),
        }
    }

    /// The host may load any number. One that does not fit overflows.
    #[test]
    fn loads(word in 16..=64u32, value: i64, less in 0..64u32, from_end in -2..=2i128) {
        let wide = 64.min(2 * word);
        let ends = [word, wide].map(|bits| [least(bits) + from_end, greatest(bits) + from_end]);
        for exact in ends.concat().into_iter().chain([(value >> less).into()]) {
            check((word, word), LOAD, exact, &|dp| dp.load(exact).to_host());
            check((word, wide), LOAD, exact, &|dp| dp.load_wide(exact).to_host());
        }
    }

    /// `2 a + bit` by `b`, and `a` by `b << place`.
    #[test]
    fn steps_of_divides(
        word in 16..=64u32, a: i64, b: i64, less in 0..64u32, bit: bool,
        place in prop_oneof![0..70u32, Just(u32::MAX - 64)],
    ) {
        let [a, b] = [a, b].map(|value| i128::from(value >> less) & greatest(word));
        let b = b.max(1);
        let host = |value| Word::from_host(i64::try_from(value).unwrap());
        let step = |more, remainder: i128, less: i128, call: &dyn Fn(&mut Datapath<Log>) -> (Word, bool)| {
            let (rest, bit) = if remainder >= less { (remainder - less, 1) } else { (remainder, 0) };
            let kind: Kind = (&[(OpClass::DivideStep, more)], TrapOp::Load);
            check((word, word), kind, rest, &|dp| call(dp).0.to_host());
            check((word, word), kind, bit, &|dp| call(dp).1.into());
        };
        step(1, 2 * (a % b) + i128::from(bit), b, &|dp| dp.divide_step(host(a % b), host(b), bit));
        step(place, a, b << place.min(63), &|dp| dp.divide_integer_step(host(a), host(b), place));
    }

    #[test]
    fn short_vectors(a: u8, b: u8, width in 1..=8u32) {
        let mut dp = datapath(32, Overflow::Trap, Log::default());
        let found = [dp.and_bits(width, a, b), dp.or_bits(width, a, b), dp.xor_bits(width, a, b)];
        prop_assert_eq!(found, [a & b, a | b, a ^ b]);
        prop_assert_eq!(dp.into_probe().0, [(OpClass::Logic, width, PLACE, 1); 3]);
    }
}

#[test]
fn accesses_have_the_place_of_their_time() {
    let mut dp = Datapath::new(format(32), Overflow::Trap, Counter::new());
    dp.read(Memory::Stack, 9);
    dp.begin_record(12, 7);
    dp.stage(RecordStage::QuadtreeFit);
    dp.write(Memory::Pixel, 1 << 40);
    let counter = dp.into_probe();
    let found = counter
        .accesses()
        .map(|of| (of.memory, of.stage, of.level, of.accesses.reads));
    let [start, fit] = [RecordStage::Pop, RecordStage::QuadtreeFit].map(Stage::from);
    assert!(found.eq([(Memory::Stack, start, 0, 1), (Memory::Pixel, fit, 7, 0)]));
}

#[test]
fn the_first_trap_stays() {
    let mut dp = datapath(16, Overflow::Trap, NoProbe);
    let max = Word::from_host(i64::from(i16::MAX));
    dp.add(max, max);
    let first = dp.trap();
    dp.begin_record(3, 4);
    dp.shl(max, 5);
    assert_eq!((dp.trap(), dp.overflows()), (first, 2));
    assert_eq!(first.unwrap().record, 41);
}

#[test]
fn values_on_the_wires_of_a_block() {
    let short = (Short::signed(-2, 5), Short::narrow(Narrow::from_host(3), 2));
    let words = (Word::from_host(-7), [WideWord::from_host(8); 2]);
    let mut found = Vec::new();
    (words, &short, true, false).show(&mut found);
    let expected = [
        (SignalKind::Word, -7, 24, true),
        (SignalKind::Wide, 8, 48, true),
        (SignalKind::Wide, 8, 48, true),
        (SignalKind::Signed(5), -2, 5, true),
        (SignalKind::Unsigned(2), 3, 2, false),
        (SignalKind::Unsigned(1), 1, 1, false),
        (SignalKind::Unsigned(1), 0, 1, false),
    ];
    let row = |of: Signal| {
        (
            of.kind,
            of.value,
            of.kind.bits(format(24)),
            of.kind.is_signed(),
        )
    };
    assert!(found.into_iter().map(row).eq(expected));
}

#[test]
fn formats_have_16_to_64_bits_with_a_bit_beside_sign_and_fraction() {
    let numbers = || (0..70).chain([u32::MAX]);
    for (bits, frac) in numbers().flat_map(|bits| numbers().map(move |frac| (bits, frac))) {
        let found = Format::new(bits, frac);
        if !(16..=64).contains(&bits) {
            assert_eq!(found, Err(FormatError::Bits(bits)));
        } else if frac > bits - 2 {
            assert_eq!(found, Err(FormatError::Frac { bits, frac }));
        }
        let Ok(format) = found else { continue };
        let wide = format.wide();
        let found = (format.bits(), format.frac(), wide.bits(), wide.frac());
        assert_eq!(found, (bits, frac, 64.min(2 * bits), frac));
        assert_eq!(i128::from(format.max()), greatest(bits));
    }
}
