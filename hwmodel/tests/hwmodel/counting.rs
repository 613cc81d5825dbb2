//! The counter against a list of its events.

use std::collections::BTreeMap;

use crate::common::*;
use hwmodel::count::{Accesses, Counter, LEVELS};
use hwmodel::{Datapath, Memory, OpClass, Overflow, Probe, Stage, StageLevel, WideWord, Word};
use proptest::prelude::*;

type Cells = BTreeMap<(u32, u32, Stage, OpClass), u64>;

#[derive(Debug, Default)]
struct Plain {
    ops: Cells,
    accesses: BTreeMap<(u32, Stage, Memory), Accesses>,
    records: BTreeMap<u32, u64>,
}

fn level(level: u32) -> u32 {
    level.min(LEVELS as u32 - 1)
}

impl Probe for Plain {
    fn op(&mut self, class: OpClass, bits: u32, place: StageLevel, times: u32) {
        let cell = (bits, level(place.level), place.stage, class);
        *self.ops.entry(cell).or_default() += u64::from(times);
    }
    fn read(&mut self, memory: Memory, _: u64, place: StageLevel) {
        let cell = (level(place.level), place.stage, memory);
        self.accesses.entry(cell).or_default().reads += 1;
    }
    fn write(&mut self, memory: Memory, _: u64, place: StageLevel) {
        let cell = (level(place.level), place.stage, memory);
        self.accesses.entry(cell).or_default().writes += 1;
    }
    fn record(&mut self, _: u64, at: u32) {
        *self.records.entry(level(at)).or_default() += 1;
    }
}

#[track_caller]
fn compare(counter: &Counter, plain: &Plain) {
    let cells = counter.cells();
    let cells = cells.map(|c| ((c.bits, c.level, c.stage, c.class), c.times));
    assert!(cells.eq(plain.ops.clone()));
    let accesses = counter.accesses();
    let accesses = accesses.map(|c| ((c.level, c.stage, c.memory), c.accesses));
    assert!(accesses.eq(plain.accesses.clone()));
    assert!(counter.records_by_level().eq(plain.records.clone()));
    assert_eq!(counter.records(), plain.records.values().sum::<u64>());
    assert_eq!(counter.ops(), plain.ops.values().sum::<u64>());
    let widest = plain.ops.keys().map(|key| key.0).max();
    assert_eq!(counter.widest(), widest.unwrap_or(0));
    let node = |of: fn(&Accesses) -> u64| {
        let cells = plain
            .accesses
            .iter()
            .filter(|(key, _)| key.2 == Memory::Node);
        cells.map(|(_, accesses)| of(accesses)).sum::<u64>()
    };
    assert_eq!(counter.reads(Memory::Node), node(|of| of.reads));
    assert_eq!(counter.writes(Memory::Node), node(|of| of.writes));
}

#[derive(Debug, Clone, Copy)]
enum Act {
    Record(u32),
    Stage(usize),
    Words(u8),
    Read(usize),
    Write(usize),
    Integer(u32),
    Format(u32),
}

fn act() -> impl Strategy<Value = Act> {
    prop_oneof![
        // Some of them 16 apart, where a counter has one set of counts for both; 70 is beyond the last.
        prop::sample::select(vec![0, 1, 2, 3, 16, 17, 34, 62, 70]).prop_map(Act::Record),
        (0..Stage::ALL.len()).prop_map(Act::Stage),
        (0u8..10).prop_map(Act::Words),
        (0..Memory::ALL.len()).prop_map(Act::Read),
        (0..Memory::ALL.len()).prop_map(Act::Write),
        (0u32..80).prop_map(Act::Integer),
        (16u32..=64).prop_map(Act::Format),
    ]
}

fn words<P: Probe>(dp: &mut Datapath<P>, which: u8) {
    let (a, b) = (Word::from_host(3), Word::from_host(5));
    let (c, d) = (WideWord::from_host(3), WideWord::from_host(5));
    match which {
        0 => _ = dp.add(a, b),
        1 => _ = dp.sub(c, d),
        2 => _ = dp.midpoint(a, b),
        3 => _ = dp.midpoint(c, d),
        4 => _ = dp.and_bits(4, 1, 2),
        5 => _ = dp.xor_bits(3, 1, 2),
        6 => _ = dp.or_bits(8, 1, 2),
        7 => _ = dp.divide_step(a, b, true),
        8 => _ = dp.select(true, c, d),
        _ => _ = dp.min(a, b),
    }
}

fn play<P: Probe>(acts: &[Act], probe: &mut P) {
    let mut dp = Datapath::new(format(24), Overflow::Wrap, &mut *probe);
    let mut stage = Stage::Pop;
    let mut current = 0;
    for &act in acts {
        match act {
            Act::Record(level) => {
                current = level;
                dp.begin_record(0, level);
            }
            Act::Stage(to) => {
                stage = Stage::ALL[to];
                dp.stage(stage);
            }
            Act::Words(which) => words(&mut dp, which),
            Act::Read(memory) => dp.read(Memory::ALL[memory], 1),
            Act::Write(memory) => dp.write(Memory::ALL[memory], 1),
            Act::Integer(place) => {
                dp.divide_integer_step(Word::from_host(9), Word::from_host(2), place);
            }
            Act::Format(bits) => {
                let probe = dp.into_probe();
                dp = Datapath::new(format(bits), Overflow::Wrap, probe);
                dp.stage(stage);
                dp.begin_record(0, current);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_counter_is_a_map_alone_and_in_a_pair(acts in prop::collection::vec(act(), 0..300)) {
        let mut pair = (Counter::new(), (hwmodel::NoProbe, Plain::default()));
        play(&acts, &mut pair);
        let (counter, (_, plain)) = pair;
        compare(&counter, &plain);
        let mut alone = Plain::default();
        play(&acts, &mut alone);
        compare(&counter, &alone);
        let (stage, class) = (Stage::ALL[acts.len() % 13], OpClass::ALL[acts.len() % 8]);
        let wanted = plain.ops.iter().filter(|(key, _)| (key.2, key.3) == (stage, class));
        prop_assert_eq!(counter.ops_at(stage, class), wanted.map(|(_, n)| n).sum::<u64>());
    }

    #[test]
    fn halves_merge_into_the_whole(
        first in prop::collection::vec(act(), 0..150),
        second in prop::collection::vec(act(), 0..150),
    ) {
        let (mut a, mut b, mut plain) = (Counter::new(), Counter::new(), Plain::default());
        play(&first, &mut a);
        play(&second, &mut b);
        play(&first, &mut plain);
        play(&second, &mut plain);
        let mut other = b.clone();
        a.merge(&b);
        compare(&a, &plain);
        let mut one = Counter::new();
        play(&first, &mut one);
        other.merge(&one);
        prop_assert_eq!(&other, &a);
        prop_assert!(a.ops() == 0 || other != Counter::new());
    }

}

#[test]
fn sums_by_any_key() {
    let mut counter = Counter::new();
    counter.op(OpClass::Add, 24, at(Stage::Centre, 2), 3);
    counter.op(OpClass::Add, 200, at(Stage::Draw, 2), 4);
    counter.op(OpClass::Shift, 24, at(Stage::Draw, 64), 5);
    counter.op(OpClass::Shift, 24, at(Stage::Draw, 9), 0);
    assert_eq!(counter.sum_by(|cell| cell.level), [(2, 7), (63, 5)].into());
    assert_eq!(counter.sum_by(|cell| cell.bits), [(24, 8), (200, 4)].into());
    assert_eq!(counter.ops_of(OpClass::Add), 7);
    counter.record(0, 1);
    counter.read(Memory::Node, 7, at(Stage::OnePixel, 1));
    counter.record(1, 2);
    counter.write(Memory::Node, 7, at(Stage::OnePixel, 2));
    let sums = counter.accesses_by(|cell| cell.level);
    let sums: Vec<_> = sums.values().map(|of| (of.reads, of.writes)).collect();
    assert_eq!(sums, [(1, 0), (0, 1)]);
}
