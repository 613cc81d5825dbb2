//! Events of a probe: one per operation, of its class and width (two for a midpoint), none for wires and constants.

use crate::common::*;
use hwmodel::count::Counter;
use hwmodel::{
    Datapath, Memory, NoProbe, Number, OpClass, Overflow, Probe, Stage, StageLevel, WideWord, Word,
};

const PLACE: StageLevel = StageLevel {
    stage: Stage::QuadtreeFit,
    level: 7,
};

/// The operations that `run` reports: class, width, how many.
fn ops(bits: u32, run: impl Fn(&mut Datapath<Log>)) -> Vec<(OpClass, u32, u32)> {
    let mut dp = Datapath::new(format(bits), Overflow::Wrap, Log::default());
    dp.begin_record(3, PLACE.level);
    dp.stage(PLACE.stage);
    run(&mut dp);
    let log = dp.into_probe().0;
    assert_eq!(log[0], Event::Record(3, PLACE.level));
    log[1..]
        .iter()
        .map(|event| match *event {
            Event::Op(class, bits, place, times) => {
                assert_eq!(place, PLACE);
                (class, bits, times)
            }
            other => panic!("{other:?} is no operation"),
        })
        .collect()
}

/// The operations that both types of number have, in `bits`-bit words.
fn common_operations<T: Host + Number>(format_bits: u32) {
    let bits = T::bits(format(format_bits));
    // Numbers whose sum and double overflow: overflows are counted once, too.
    let greatest = i64::try_from(greatest(bits)).expect("64 bits at most");
    for (a, b) in [(5, 3), (greatest, greatest - 1)] {
        let (a, b) = (T::of(a), T::of(b));
        let of = |run: &dyn Fn(&mut Datapath<Log>)| ops(format_bits, run);
        type Run<'r> = &'r dyn Fn(&mut Datapath<Log>);
        let runs: [(OpClass, &[Run<'_>]); 6] = [
            (OpClass::Add, &[&|dp| _ = dp.add(a, b)]),
            (OpClass::Sub, &[&|dp| _ = dp.sub(a, b), &|dp| _ = dp.neg(a)]),
            (
                OpClass::Shift,
                &[
                    &|dp| _ = dp.shr(a, 3),
                    &|dp| _ = dp.shr(a, 99),
                    &|dp| _ = dp.shl(a, 3),
                    &|dp| _ = dp.shl(a, 99),
                ],
            ),
            (
                OpClass::Compare,
                &[
                    &|dp| _ = dp.lt(a, b),
                    &|dp| _ = dp.le(a, b),
                    &|dp| _ = dp.equal(a, b),
                    &|dp| _ = dp.is_negative(a),
                    &|dp| _ = dp.is_positive(a),
                    &|dp| _ = dp.is_zero(a),
                ],
            ),
            (
                OpClass::MinMax,
                &[&|dp| _ = dp.min(a, b), &|dp| _ = dp.max(a, b)],
            ),
            (
                OpClass::Select,
                &[&|dp| _ = dp.select(true, a, b), &|dp| {
                    _ = dp.select(false, a, b)
                }],
            ),
        ];
        for (class, runs) in runs {
            assert!(
                runs.iter().all(|run| of(run) == [(class, bits, 1)]),
                "{class:?}"
            );
        }
        assert_eq!(
            of(&|dp| _ = dp.midpoint(a, b)),
            [(OpClass::Add, bits + 1, 1), (OpClass::Shift, bits + 1, 1)]
        );
        assert_eq!(of(&|dp| _ = dp.bit(a, 2)), []);
    }
}

#[test]
fn each_operation_is_one_event() {
    for bits in widths() {
        common_operations::<Word>(bits);
        common_operations::<WideWord>(bits);
    }
}

#[test]
fn operations_of_words_alone() {
    for bits in widths() {
        let (a, b) = (Word::of(5), Word::of(7));
        let step = ops(bits, |dp| _ = dp.divide_step(a, b, true));
        assert_eq!(step, [(OpClass::DivideStep, bits + 1, 1)]);
        for place in [0, 3, 64] {
            let step = ops(bits, |dp| _ = dp.divide_integer_step(a, b, place));
            assert_eq!(step, [(OpClass::DivideStep, bits + place, 1)]);
        }
        for width in [3, 4, 8] {
            let one = [(OpClass::Logic, width, 1)];
            assert_eq!(ops(bits, |dp| _ = dp.and_bits(width, 6, 3)), one);
            assert_eq!(ops(bits, |dp| _ = dp.or_bits(width, 6, 3)), one);
            assert_eq!(ops(bits, |dp| _ = dp.xor_bits(width, 6, 3)), one);
        }
        // Wires, and constants of the host.
        assert_eq!(ops(bits, |dp| _ = dp.shift_in(a, true)), []);
        assert_eq!(ops(bits, |dp| _ = dp.load(1 << 20)), []);
        assert_eq!(ops(bits, |dp| _ = dp.load_wide(1 << 20)), []);
    }
}

#[test]
fn memories_and_records_are_passed_on() {
    let mut dp = Datapath::new(format(32), Overflow::Trap, Log::default());
    let before = StageLevel {
        stage: Stage::Pop,
        level: 0,
    };
    dp.read(Memory::Stack, 9);
    dp.begin_record(12, PLACE.level);
    dp.stage(PLACE.stage);
    dp.write(Memory::Pixel, 1 << 40);
    assert_eq!(
        dp.into_probe().0,
        [
            Event::Read(Memory::Stack, 9, before),
            Event::Record(12, PLACE.level),
            Event::Write(Memory::Pixel, 1 << 40, PLACE),
        ]
    );
}

/// Every operation there is, once.
fn everything<P: Probe>(dp: &mut Datapath<P>) -> Vec<i64> {
    dp.begin_record(0, 2);
    dp.stage(Stage::Draw);
    dp.read(Memory::Node, 1);
    dp.write(Memory::Pixel, 2);
    let (a, b) = (dp.load(1000), dp.load(-77));
    let words = [
        dp.add(a, b),
        dp.sub(a, b),
        dp.neg(a),
        dp.midpoint(a, b),
        dp.shr(b, 3),
        dp.shl(b, 3),
        dp.min(a, b),
        dp.max(a, b),
        dp.select(true, a, b),
        dp.shift_in(a, true),
        dp.divide_step(b, a, true).0,
        dp.divide_integer_step(a, b, 2).0,
    ];
    let bits = [
        dp.lt(a, b),
        dp.le(a, b),
        dp.equal(a, b),
        dp.is_negative(a),
        dp.is_positive(a),
        dp.is_zero(a),
    ];
    let short = [
        dp.and_bits(4, 5, 6),
        dp.or_bits(4, 5, 6),
        dp.xor_bits(4, 5, 6),
    ];
    let numbers = words.map(Word::to_host);
    numbers
        .into_iter()
        .chain(bits.map(i64::from))
        .chain(short.map(i64::from))
        .collect()
}

/// Is disabled, and panics at every event.
struct Deaf;

impl Probe for Deaf {
    const ENABLED: bool = false;
    fn op(&mut self, _: OpClass, _: u32, _: StageLevel, _: u32) {
        panic!("nobody listens");
    }
    fn read(&mut self, _: Memory, _: u64, _: StageLevel) {
        panic!("nobody listens");
    }
    fn write(&mut self, _: Memory, _: u64, _: StageLevel) {
        panic!("nobody listens");
    }
    fn record(&mut self, _: u64, _: u32) {
        panic!("nobody listens");
    }
}

#[test]
fn a_disabled_probe_is_told_nothing() {
    const { assert!(!NoProbe::ENABLED) };
    const { assert!(!<&mut NoProbe as Probe>::ENABLED) };
    const { assert!(<&mut Counter as Probe>::ENABLED) };
    let mut deaf = Datapath::new(format(32), Overflow::Trap, Deaf);
    let mut none = Datapath::new(format(32), Overflow::Trap, NoProbe);
    let mut counted = Datapath::new(format(32), Overflow::Trap, Counter::new());
    let results = everything(&mut counted);
    let counter = counted.into_probe();
    // Twelve calls give words (a shift-in counts nothing, a midpoint twice), six bits, three short vectors; the widest is
    // the integer step at place 2.
    assert_eq!((counter.ops(), counter.widest()), (12 - 1 + 1 + 6 + 3, 34));
    assert!(
        OpClass::ALL
            .iter()
            .all(|&class| counter.ops_at(Stage::Draw, class) > 0)
    );
    assert_eq!(everything(&mut deaf), results);
    assert_eq!(everything(&mut none), results);
}

#[test]
fn a_counter_heeds_how_many_times() {
    let mut counter = Counter::new();
    counter.op(OpClass::Add, 40, PLACE, 5);
    counter.op(OpClass::Add, 20, PLACE, 0);
    assert_eq!((counter.ops(), counter.widest()), (5, 40));
}

/// `ALL` lists every variant at its discriminant, which counters index by.
#[test]
fn lists_are_in_order() {
    assert!(
        (0..)
            .zip(OpClass::ALL)
            .all(|(i, class)| class as usize == i)
    );
    assert!((0..).zip(Stage::ALL).all(|(i, stage)| stage as usize == i));
    assert!(
        (0..)
            .zip(Memory::ALL)
            .all(|(i, memory)| memory as usize == i)
    );
}

/// The machine has adders and shifters. A class added to this list has to be
/// one that a light hardware can afford.
#[test]
fn no_class_multiplies_or_divides() {
    let names = OpClass::ALL.map(OpClass::name).join(", ");
    let expected = "add, subtract, compare, min/max, select, shift, logic, divide step";
    assert_eq!(names, expected);
}
