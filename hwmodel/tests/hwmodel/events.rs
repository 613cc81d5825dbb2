//! What a probe is told: each operation is exactly one event of its class and
//! width (a midpoint is two), wires and constants are none.

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
        let one = |class| vec![(class, bits, 1)];
        let of = |run: &dyn Fn(&mut Datapath<Log>)| ops(format_bits, run);
        assert_eq!(of(&|dp| _ = dp.add(a, b)), one(OpClass::Add));
        assert_eq!(of(&|dp| _ = dp.sub(a, b)), one(OpClass::Sub));
        assert_eq!(of(&|dp| _ = dp.neg(a)), one(OpClass::Sub));
        assert_eq!(
            of(&|dp| _ = dp.midpoint(a, b)),
            [(OpClass::Add, bits + 1, 1), (OpClass::Shift, bits + 1, 1)]
        );
        assert_eq!(of(&|dp| _ = dp.shr(a, 3)), one(OpClass::Shift));
        assert_eq!(of(&|dp| _ = dp.shr(a, 99)), one(OpClass::Shift));
        assert_eq!(of(&|dp| _ = dp.shl(a, 3)), one(OpClass::Shift));
        assert_eq!(of(&|dp| _ = dp.shl(a, 99)), one(OpClass::Shift));
        assert_eq!(of(&|dp| _ = dp.lt(a, b)), one(OpClass::Compare));
        assert_eq!(of(&|dp| _ = dp.le(a, b)), one(OpClass::Compare));
        assert_eq!(of(&|dp| _ = dp.equal(a, b)), one(OpClass::Compare));
        assert_eq!(of(&|dp| _ = dp.is_negative(a)), one(OpClass::Compare));
        assert_eq!(of(&|dp| _ = dp.is_positive(a)), one(OpClass::Compare));
        assert_eq!(of(&|dp| _ = dp.is_zero(a)), one(OpClass::Compare));
        assert_eq!(of(&|dp| _ = dp.min(a, b)), one(OpClass::MinMax));
        assert_eq!(of(&|dp| _ = dp.max(a, b)), one(OpClass::MinMax));
        assert_eq!(of(&|dp| _ = dp.select(true, a, b)), one(OpClass::Select));
        assert_eq!(of(&|dp| _ = dp.select(false, a, b)), one(OpClass::Select));
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
        // Wires, and constants that the host hands over.
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

/// Panics as soon as it is told anything, but says that nobody listens.
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
    assert_eq!(everything(&mut deaf), results);
    assert_eq!(everything(&mut none), results);
}

#[test]
fn a_counter_adds_up_what_a_log_holds() {
    let mut log = Log::default();
    let mut dp = Datapath::new(format(24), Overflow::Trap, &mut log);
    everything(&mut dp);
    everything(&mut dp);
    let mut counter = Counter::new();
    let mut dp = Datapath::new(format(24), Overflow::Trap, &mut counter);
    everything(&mut dp);
    everything(&mut dp);

    let count = |wanted: &dyn Fn(&Event) -> u64| log.0.iter().map(wanted).sum::<u64>();
    for class in OpClass::ALL {
        for stage in Stage::ALL {
            let expected = count(&|event| match event {
                Event::Op(c, _, at, times) if (*c, at.stage) == (class, stage) => u64::from(*times),
                _ => 0,
            });
            assert_eq!(counter.ops_at(stage, class), expected);
        }
        assert_eq!(counter.ops_of(class), counter.ops_at(Stage::Draw, class));
        assert_ne!(counter.ops_of(class), 0, "{}", class.name());
    }
    for memory in Memory::ALL {
        let reads = count(&|e| u64::from(matches!(e, Event::Read(m, ..) if *m == memory)));
        let writes = count(&|e| u64::from(matches!(e, Event::Write(m, ..) if *m == memory)));
        assert_eq!(counter.reads(memory), reads);
        assert_eq!(counter.writes(memory), writes);
    }
    assert_eq!(counter.reads(Memory::Node), 2);
    assert_eq!(counter.writes(Memory::Pixel), 2);
    // By hand: each round has 12 calls that give words (a shift-in counts
    // nothing, a midpoint twice), 6 compares and 3 logic.
    assert_eq!(counter.ops(), 2 * (12 - 1 + 1 + 6 + 3));
    assert_eq!(counter.records(), 2);
    assert_eq!(counter.widest(), 26, "the integer step at place 2");
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
    for (i, class) in OpClass::ALL.into_iter().enumerate() {
        assert_eq!(class as usize, i);
    }
    for (i, stage) in Stage::ALL.into_iter().enumerate() {
        assert_eq!(stage as usize, i);
    }
    for (i, memory) in Memory::ALL.into_iter().enumerate() {
        assert_eq!(memory as usize, i);
    }
}

/// The machine has adders and shifters. A class added to this list has to be
/// one that a light hardware can afford.
#[test]
fn no_class_multiplies_or_divides() {
    let names = OpClass::ALL.map(OpClass::name);
    assert_eq!(
        names,
        [
            "add",
            "subtract",
            "compare",
            "min/max",
            "select",
            "shift",
            "logic",
            "divide step"
        ]
    );
}
