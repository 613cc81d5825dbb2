//! The counter against maps of its events.

use std::collections::BTreeMap;

use crate::common::*;
use hwmodel::count::Counter;
use hwmodel::{
    Datapath, Memory, NoProbe, OpClass, Overflow, Probe, Stage, StageLevel, WideWord, Word,
};
use proptest::prelude::*;

/// Operations, accesses (the flag: writes) and records.
#[derive(Debug, Default)]
struct Plain {
    ops: BTreeMap<(u32, u32, Stage, OpClass), u64>,
    accesses: BTreeMap<(u32, Stage, Memory, bool), u64>,
    records: BTreeMap<u32, u64>,
}

impl Probe for Plain {
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        let cell = (bits, place.level.min(63), place.stage, class);
        *self.ops.entry(cell).or_default() += u64::from(times);
    }
    fn read(&mut self, memory: Memory, _: u64, place: StageLevel) {
        let cell = (place.level.min(63), place.stage, memory, false);
        *self.accesses.entry(cell).or_default() += 1;
    }
    fn write(&mut self, memory: Memory, _: u64, place: StageLevel) {
        let cell = (place.level.min(63), place.stage, memory, true);
        *self.accesses.entry(cell).or_default() += 1;
    }
    fn record(&mut self, _: u64, level: u32) {
        *self.records.entry(level.min(63)).or_default() += 1;
    }
}

fn compare(counter: &Counter, plain: &Plain) {
    let cells = counter.cells();
    let cells = cells.map(|c| ((c.bits, c.level, c.stage, c.class), c.times));
    assert!(cells.eq(plain.ops.clone()));
    let accesses = counter.accesses().flat_map(|c| {
        let times = [(false, c.accesses.reads), (true, c.accesses.writes)];
        times.map(|(way, times)| ((c.level, c.stage, c.memory, way), times))
    });
    assert!(accesses.filter(|of| of.1 > 0).eq(plain.accesses.clone()));
    assert!(counter.records_by_level().eq(plain.records.clone()));
    assert_eq!(counter.records(), plain.records.values().sum::<u64>());
    assert_eq!(counter.ops(), plain.ops.values().sum::<u64>());
}

/// Levels, some of them 16 apart, where a counter has one set of counts for both; 70 is beyond the last.
const LEVELS: [u32; 9] = [0, 1, 2, 3, 16, 17, 34, 62, 70];

/// Kinds of act, and a number for it.
type Acts = Vec<(u8, usize)>;

fn play<P: Probe>(acts: &Acts, probe: &mut P) {
    let mut dp = Datapath::new(format(24), Overflow::Wrap, &mut *probe);
    dp.begin_record(0, 0);
    let (a, b) = (Word::from_host(3), Word::from_host(5));
    let (c, d) = (WideWord::from_host(3), WideWord::from_host(5));
    for &(kind, number) in acts {
        match kind {
            0 => dp.begin_record(0, LEVELS[number % LEVELS.len()]),
            1 => dp.stage(RecordStage::ALL[number % RecordStage::ALL.len()]),
            2 => dp.read(Memory::ALL[number % Memory::ALL.len()], 1),
            3 => dp.write(Memory::ALL[number % Memory::ALL.len()], 1),
            4 => _ = dp.add(a, b),
            5 => _ = dp.sub(c, d),
            6 => _ = dp.midpoint(a, b),
            7 => _ = dp.midpoint(c, d),
            8 => _ = dp.and_bits(number as u32 % 9, 1, 2),
            9 => _ = dp.divide_integer_step(a, b, number as u32),
            _ => {
                let format = format(16 + number as u32 % 49);
                dp = Datapath::new(format, Overflow::Wrap, dp.into_probe());
                dp.begin_record(0, LEVELS[number % LEVELS.len()]);
            }
        }
    }
}

fn acts() -> impl Strategy<Value = Acts> {
    prop::collection::vec((0..11u8, 0..80usize), 0..200)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn a_counter_is_a_map_alone_and_in_a_pair(acts in acts()) {
        let (mut pair, mut alone) = ((Counter::new(), (NoProbe, Plain::default())), Counter::new());
        play(&acts, &mut pair);
        play(&acts, &mut alone);
        let (counter, (_, plain)) = pair;
        compare(&counter, &plain);
        compare(&alone, &plain);
    }
}

#[test]
fn sums_by_any_key() {
    let mut counter = Counter::new();
    assert_eq!(counter.widest(), 0);
    counter.op(OpClass::Add, 24, at(RecordStage::Centre, 2), 3);
    counter.op(OpClass::Add, 200, at(RecordStage::Draw, 2), 4);
    counter.op(OpClass::Shift, 24, at(RecordStage::Draw, 64), 5);
    counter.op(OpClass::Shift, 24, at(RecordStage::Draw, 9), 0);
    assert_eq!(counter.sum_by(|cell| cell.level), [(2, 7), (63, 5)].into());
    assert_eq!((counter.ops_of(OpClass::Add), counter.widest()), (7, 200));
    assert_eq!(counter.ops_at(RecordStage::Draw, OpClass::Shift), 5);
    counter.record(0, 1);
    counter.read(Memory::Node, 7, at(RecordStage::OnePixel, 1));
    counter.record(1, 2);
    counter.write(Memory::Node, 7, at(RecordStage::OnePixel, 2));
    assert_eq!(
        (counter.reads(Memory::Node), counter.writes(Memory::Node)),
        (1, 1)
    );
    let sums = counter.accesses_by(|cell| cell.level);
    let reads = sums.into_iter().map(|(level, of)| (level, of.reads));
    assert!(reads.eq([(1, 1), (2, 0)]));
}
