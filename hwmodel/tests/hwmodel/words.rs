//! Every operation of the datapath against 128-bit integers: result, overflow, trap and events, for all widths, both
//! types of number and all policies.

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

/// A type of number, as the host sees it.
trait Host: Number {
    fn of(value: i64) -> Self;
    fn value(self) -> i64;
    /// Width, from the rule itself (wide words have twice the bits, 64 at most) and not from `Format`.
    fn bits(word: u32) -> u32;
}

impl Host for Word {
    fn of(value: i64) -> Self {
        Self::from_host(value)
    }
    fn value(self) -> i64 {
        self.to_host()
    }
    fn bits(word: u32) -> u32 {
        word
    }
}

impl Host for WideWord {
    fn of(value: i64) -> Self {
        Self::from_host(value)
    }
    fn value(self) -> i64 {
        self.to_host()
    }
    fn bits(word: u32) -> u32 {
        (2 * word).min(64)
    }
}

/// Operands: two numbers, and places of a shift or a bit.
#[derive(Debug, Clone, Copy)]
struct Given {
    a: i64,
    b: i64,
    places: u32,
}

impl Given {
    fn exact(self) -> (i128, i128) {
        (i128::from(self.a), i128::from(self.b))
    }

    /// `a / 2^places`, rounded down.
    fn halved(self) -> i128 {
        i128::from(self.a).div_euclid(1 << self.places.min(64))
    }
}

/// A call, its exact result (a bit is 0 or 1), its events as class and bits beyond the number's, and the operation that
/// a trap names.
type Row<P> = (
    fn(&mut Datapath<P>, Given) -> i64,
    fn(Given) -> i128,
    &'static [(OpClass, u32)],
    TrapOp,
);

fn rows<P: Probe, T: Host>() -> Vec<Row<P>> {
    use OpClass::{Add, Compare, MinMax, Select, Shift, Sub};
    use TrapOp::{Load, ShiftLeft};
    let none = Load;
    vec![
        (
            |dp, g| dp.add(T::of(g.a), T::of(g.b)).value(),
            |g| g.exact().0 + g.exact().1,
            &[(Add, 0)],
            TrapOp::Add,
        ),
        (
            |dp, g| dp.sub(T::of(g.a), T::of(g.b)).value(),
            |g| g.exact().0 - g.exact().1,
            &[(Sub, 0)],
            TrapOp::Sub,
        ),
        (
            |dp, g| dp.neg(T::of(g.a)).value(),
            |g| -g.exact().0,
            &[(Sub, 0)],
            TrapOp::Sub,
        ),
        (
            |dp, g| dp.midpoint(T::of(g.a), T::of(g.b)).value(),
            |g| (g.exact().0 + g.exact().1).div_euclid(2),
            &[(Add, 1), (Shift, 1)],
            none,
        ),
        (
            |dp, g| dp.shr(T::of(g.a), g.places).value(),
            Given::halved,
            &[(Shift, 0)],
            none,
        ),
        (
            |dp, g| dp.shl(T::of(g.a), g.places).value(),
            |g| g.exact().0 << g.places.min(64),
            &[(Shift, 0)],
            ShiftLeft,
        ),
        (
            |dp, g| dp.min(T::of(g.a), T::of(g.b)).value(),
            |g| g.a.min(g.b).into(),
            &[(MinMax, 0)],
            none,
        ),
        (
            |dp, g| dp.max(T::of(g.a), T::of(g.b)).value(),
            |g| g.a.max(g.b).into(),
            &[(MinMax, 0)],
            none,
        ),
        (
            |dp, g| dp.select(true, T::of(g.a), T::of(g.b)).value(),
            |g| g.a.into(),
            &[(Select, 0)],
            none,
        ),
        (
            |dp, g| dp.select(false, T::of(g.a), T::of(g.b)).value(),
            |g| g.b.into(),
            &[(Select, 0)],
            none,
        ),
        (
            |dp, g| dp.lt(T::of(g.a), T::of(g.b)).into(),
            |g| (g.a < g.b).into(),
            &[(Compare, 0)],
            none,
        ),
        (
            |dp, g| dp.le(T::of(g.a), T::of(g.b)).into(),
            |g| (g.a <= g.b).into(),
            &[(Compare, 0)],
            none,
        ),
        (
            |dp, g| dp.equal(T::of(g.a), T::of(g.b)).into(),
            |g| (g.a == g.b).into(),
            &[(Compare, 0)],
            none,
        ),
        (
            |dp, g| dp.is_negative(T::of(g.a)).into(),
            |g| (g.a < 0).into(),
            &[(Compare, 0)],
            none,
        ),
        (
            |dp, g| dp.is_positive(T::of(g.a)).into(),
            |g| (g.a > 0).into(),
            &[(Compare, 0)],
            none,
        ),
        (
            |dp, g| dp.is_zero(T::of(g.a)).into(),
            |g| (g.a == 0).into(),
            &[(Compare, 0)],
            none,
        ),
        (
            |dp, g| dp.bit(T::of(g.a), g.places).into(),
            |g| g.halved().rem_euclid(2),
            &[],
            none,
        ),
    ]
}

fn rows_of_words<P: Probe>() -> Vec<Row<P>> {
    use TrapOp::ShiftLeft;
    vec![
        (
            |dp, g| dp.shift_in(Word::of(g.a), false).value(),
            |g| 2 * g.exact().0,
            &[],
            ShiftLeft,
        ),
        (
            |dp, g| dp.shift_in(Word::of(g.a), true).value(),
            |g| 2 * g.exact().0 + 1,
            &[],
            ShiftLeft,
        ),
    ]
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

/// A datapath at [`PLACE`], in record 41.
fn datapath<P: Probe>(bits: u32, policy: Overflow, probe: P) -> Datapath<P> {
    let mut dp = Datapath::new(format(bits), policy, probe);
    dp.begin_record(41, PLACE.level);
    dp.stage(PLACE.stage);
    dp
}

fn check<T: Host>(word: u32, given: Given, row: &Row<Log<true>>, silent: &Row<Log<false>>) {
    let (run, exact, events, op) = row;
    let bits = T::bits(word);
    for policy in [Overflow::Trap, Overflow::Wrap, Overflow::Saturate] {
        let mut dp = datapath(word, policy, Log::<true>::default());
        let found = run(&mut dp, given);
        let (expected, overflowed) = fit(exact(given), bits, policy);
        let context = format!("{given:?}, {word}-bit words, {policy:?}, {op:?} {events:?}");
        assert_eq!(
            (found, dp.overflows()),
            (expected, overflowed.into()),
            "{context}"
        );
        let is_trap = overflowed && policy == Overflow::Trap;
        let trap = is_trap.then_some(Trap {
            op: *op,
            place: PLACE,
            record: 41,
            bits,
        });
        assert_eq!(dp.trap(), trap, "{context}");
        let event = |&(class, more)| Event::Op(class, bits + more, PLACE, 1);
        let expected: Vec<Event> = events.iter().map(event).collect();
        assert_eq!(dp.into_probe().0[1..], expected, "{context}");
        let mut dp = datapath(word, policy, Log::<false>::default());
        assert_eq!(silent.0(&mut dp, given), found, "{context}");
        assert!(dp.into_probe().0.is_empty());
    }
}

fn check_all(word: u32, given: Given, is_wide: bool) {
    if is_wide {
        let both = rows::<_, WideWord>().into_iter().zip(rows::<_, WideWord>());
        both.for_each(|(row, silent)| check::<WideWord>(word, given, &row, &silent));
    } else {
        let both = rows::<_, Word>().into_iter().zip(rows::<_, Word>());
        let both = both.chain(rows_of_words().into_iter().zip(rows_of_words()));
        both.for_each(|(row, silent)| check::<Word>(word, given, &row, &silent));
    }
}

const PLACES: [u32; 17] = [
    0,
    1,
    2,
    7,
    14,
    15,
    16,
    17,
    31,
    32,
    33,
    47,
    62,
    63,
    64,
    65,
    u32::MAX,
];

#[test]
fn edge_cases_of_all_operations() {
    for word in widths() {
        for is_wide in [false, true] {
            let values = edge_cases(if is_wide { WideWord::bits(word) } else { word });
            assert_eq!(values.len(), PLACES.len(), "each number meets all places");
            for (i, &a) in values.iter().enumerate() {
                for (j, &b) in values.iter().enumerate() {
                    let places = PLACES[(i + j) % PLACES.len()];
                    check_all(word, Given { a, b, places }, is_wide);
                }
            }
        }
    }
}

/// A width, whether words are wide, and two numbers of that width.
fn any_pair() -> impl Strategy<Value = (u32, bool, i64, i64)> {
    (widths(), any::<bool>()).prop_flat_map(|(word, is_wide)| {
        let bits = if is_wide { WideWord::bits(word) } else { word };
        (Just(word), Just(is_wide), any_value(bits), any_value(bits))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn all_operations((word, is_wide, a, b) in any_pair(), places in 0..70u32) {
        check_all(word, Given { a, b, places }, is_wide);
    }

    /// The host may load any 64-bit number. One that does not fit overflows.
    #[test]
    fn loads(word in widths(), value: i64, less in 0..64u32, end in 0..5i128, is_low: bool) {
        for bits in [word, WideWord::bits(word)] {
            let end = if is_low { least(bits) } else { greatest(bits) } + end - 2;
            let values = [value >> less, i64::try_from(end).unwrap_or(0)];
            for a in values {
                let given = Given { a, b: 0, places: 0 };
                let exact = |g: Given| g.exact().0;
                let load = (exact as fn(Given) -> i128, &[] as &[_], TrapOp::Load);
                let (exact, events, op) = load;
                check::<Word>(
                    word,
                    given,
                    &(|dp, g| dp.load(g.a).value(), exact, events, op),
                    &(|dp, g| dp.load(g.a).value(), exact, events, op),
                );
                check::<WideWord>(
                    word,
                    given,
                    &(|dp, g| dp.load_wide(g.a).value(), exact, events, op),
                    &(|dp, g| dp.load_wide(g.a).value(), exact, events, op),
                );
            }
        }
    }

    /// `2 a + bit` by `b`, and `a` by `b << place`.
    #[test]
    fn steps_of_divides(
        (word, _, a, b) in any_pair(), bit: bool, place in prop_oneof![0..70u32, Just(u32::MAX - 64)],
    ) {
        let greatest = i64::try_from(greatest(word)).unwrap();
        let divisor = (b & greatest).max(1);
        let step = |remainder: i64, run: &dyn Fn(&mut Datapath<Log<true>>, Word, Word) -> (Word, bool)| {
            let mut dp = datapath(word, Overflow::Trap, Log::<true>::default());
            let (rest, bit) = run(&mut dp, Word::of(remainder), Word::of(divisor));
            (rest.value().into(), bit, dp.into_probe().0[1..].to_vec())
        };
        let event = |more| vec![Event::Op(OpClass::DivideStep, word + more, PLACE, 1)];
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
        prop_assert_eq!(&dp.into_probe().0[1..], &[Event::Op(OpClass::Logic, width, PLACE, 1); 3]);
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
