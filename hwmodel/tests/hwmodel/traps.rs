//! The first overflow under [`Overflow::Trap`]: what it names, and that later
//! ones do not replace it.

use crate::common::*;
use hwmodel::{Datapath, NoProbe, Overflow, Stage, StageLevel, Trap, TrapOp, WideWord, Word};

/// The trap of one operation, run in a place of its own.
fn trap_of(bits: u32, run: impl Fn(&mut Datapath<NoProbe>)) -> Option<Trap> {
    let mut dp = datapath(bits, Overflow::Trap);
    dp.begin_record(41, 5);
    dp.stage(Stage::VertexPool);
    run(&mut dp);
    dp.trap()
}

#[test]
fn a_trap_names_operation_place_record_and_width() {
    for bits in widths() {
        let wide_bits = (2 * bits).min(64);
        let number = |end: i128| i64::try_from(end).expect("64 bits at most");
        let (max, min) = (
            Word::of(number(greatest(bits))),
            Word::of(number(least(bits))),
        );
        let (one, wide) = (Word::of(1), WideWord::of(number(greatest(wide_bits))));
        type Run<'r> = &'r dyn Fn(&mut Datapath<NoProbe>);
        let runs: [(TrapOp, u32, Run<'_>); 9] = [
            (TrapOp::Add, bits, &|dp| _ = dp.add(max, one)),
            (TrapOp::Sub, bits, &|dp| _ = dp.sub(min, one)),
            (TrapOp::Sub, bits, &|dp| _ = dp.neg(min)),
            (TrapOp::ShiftLeft, bits, &|dp| _ = dp.shl(max, 1)),
            (TrapOp::ShiftLeft, bits, &|dp| _ = dp.shl(one, u32::MAX)),
            (TrapOp::ShiftLeft, bits, &|dp| _ = dp.shift_in(min, true)),
            (TrapOp::Add, wide_bits, &|dp| _ = dp.add(wide, wide)),
            (TrapOp::Load, bits, &|dp| _ = dp.load(i64::MIN)),
            (TrapOp::Load, wide_bits, &|dp| _ = dp.load_wide(i64::MAX)),
        ];
        // 64 bits hold whatever is loaded.
        let is_possible =
            |(op, bits, _): &(TrapOp, u32, Run<'_>)| *op != TrapOp::Load || *bits < 64;
        for (op, bits_of_op, run) in runs.into_iter().filter(is_possible) {
            let place = StageLevel {
                stage: Stage::VertexPool,
                level: 5,
            };
            let expected = Trap {
                op,
                place,
                record: 41,
                bits: bits_of_op,
            };
            assert_eq!(trap_of(bits, run), Some(expected));
        }
    }
}

#[test]
fn what_cannot_overflow_does_not_trap() {
    for bits in widths() {
        for a in edge_cases(bits) {
            for b in edge_cases(bits) {
                let (x, y) = (Word::of(a), Word::of(b));
                let trap = trap_of(bits, |dp| {
                    dp.midpoint(x, y);
                    dp.shr(x, 3);
                    dp.shl(Word::ZERO, u32::MAX);
                    dp.min(x, y);
                    dp.max(x, y);
                    dp.select(a < b, x, y);
                    dp.lt(x, y);
                });
                assert_eq!(trap, None);
            }
        }
    }
}

#[test]
fn the_first_trap_stays() {
    let mut dp = datapath(16, Overflow::Trap);
    let max = Word::of(i64::from(i16::MAX));
    dp.begin_record(1, 0);
    dp.stage(Stage::Centre);
    dp.add(max, Word::of(-1));
    assert_eq!(dp.trap(), None);
    dp.begin_record(2, 3);
    dp.stage(Stage::Order);
    dp.add(max, max);
    let first = dp.trap().expect("a trap");
    dp.begin_record(3, 4);
    dp.stage(Stage::Draw);
    dp.shl(max, 5);
    assert_eq!(dp.trap(), Some(first));
    assert_eq!(dp.overflows(), 2, "later ones are counted all the same");
    assert_eq!((first.record, first.place.level), (2, 3));
    assert_eq!(first.place.stage, Stage::Order);
}

#[test]
fn other_policies_count_but_do_not_trap() {
    for policy in [Overflow::Wrap, Overflow::Saturate] {
        let mut dp = datapath(16, policy);
        let max = Word::of(i64::from(i16::MAX));
        for _ in 0..3 {
            dp.add(max, max);
        }
        assert_eq!((dp.trap(), dp.overflows()), (None, 3));
    }
}

#[test]
fn a_trap_says_all_in_words() {
    let trap = trap_of(24, |dp| _ = dp.load(i64::MAX)).expect("a trap");
    assert_eq!(
        trap.to_string(),
        "a word of 24 bits overflowed in load of a frame constant \
         (stage vertex pool, octree level 5, record 41)"
    );
    let names = [TrapOp::Add, TrapOp::Sub, TrapOp::ShiftLeft, TrapOp::Load].map(TrapOp::name);
    assert_eq!(
        names,
        ["add", "subtract", "shift left", "load of a frame constant"]
    );
}
