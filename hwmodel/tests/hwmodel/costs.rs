//! Energy and area by the shipped tables: operations line by line, accesses, bills.

use crate::costs_common::{near, shipped};
use hwmodel::cost::{
    Costing, Goal, Line, MinMaxUnits, ShiftUnits, Store, Stores, Tally, Unit, area_of, energy_of,
    energy_of_tallies, memory_energy_of, operation_of,
};
use hwmodel::count::Counter;
use hwmodel::memory::Widths;
use hwmodel::{Memory, OpClass, Probe, Stage, StageLevel};

const PLACE: StageLevel = StageLevel {
    stage: Stage::ChildBox,
    level: 3,
};

#[test]
fn energy_line_by_line() {
    let mut counter = Counter::new();
    counter.op(OpClass::Add, 32, PLACE, 1000);
    counter.op(OpClass::Shift, 33, PLACE, 500);
    counter.op(OpClass::Logic, 4, PLACE, 10);
    counter.op(OpClass::Compare, 32, PLACE, 7);
    let table = shipped();
    let sum = energy_of(&counter, &table, Costing::default()).unwrap();
    let line = |line: &Line| format!("{} {} {}", line.operation, line.width, line.times);
    let lines: Vec<String> = sum.lines.iter().map(line).collect();
    assert_eq!(
        lines,
        ["add 32 1000", "less 32 7", "shift_wires 33 500", "xor 4 10"]
    );
    near(sum.lines[0].total, 100.0);
    near(sum.total, 100.0 + 7.0 * 0.0795 + 10.0 * 0.0111 / 2.0);
    assert!(sum.is_estimated(), "the logic of 4 bits is");
    assert_eq!(sum.sources().len(), 3);
    let costing = Costing {
        shifts: ShiftUnits::Variable,
        ..Costing::default()
    };
    let dearer = energy_of(&counter, &table, costing).unwrap();
    assert!(dearer.total > sum.total + 60.0);
    // Every class has a row at the widths of the machine, in both tables.
    for class in OpClass::ALL {
        for shifts in [ShiftUnits::Wires, ShiftUnits::Variable] {
            let operation = operation_of(class, shifts);
            for width in [3, 4, 7, 16, 24, 33, 48, 64, 65, 96, 128] {
                let is_there = |goal| {
                    table.area(operation, width, goal).is_ok()
                        && table.delay(operation, width, goal).is_ok()
                };
                let all = is_there(Goal::Area) && is_there(Goal::Delay);
                assert!(
                    all && table.energy(operation, width).is_ok(),
                    "{operation} {width}"
                );
            }
        }
    }
}

#[test]
fn spans_in_pairs() {
    let mut counter = Counter::new();
    counter.op(OpClass::MinMax, 32, PLACE, 3 * 14);
    counter.op(OpClass::Select, 32, PLACE, 1);
    let to_screen = StageLevel {
        stage: Stage::ToScreen,
        ..PLACE
    };
    counter.op(OpClass::MinMax, 7, to_screen, 5);
    let pairs = Costing {
        min_max: MinMaxUnits::Pairs,
        ..Costing::default()
    };
    let tally = |operation: &str, width, times| Tally {
        operation: operation.to_owned(),
        width,
        times,
    };
    assert_eq!(
        hwmodel::cost::tallies(&counter, pairs).unwrap(),
        [
            tally("less", 32, 30),
            tally("min", 7, 5),
            tally("select", 32, 3 * 14 + 1)
        ]
    );
    counter.op(OpClass::MinMax, 32, PLACE, 6);
    let error = hwmodel::cost::tallies(&counter, pairs)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("48 min/max operations of 32 bits in stage child box"),
        "{error}"
    );
    assert!(hwmodel::cost::tallies(&counter, Costing::default()).is_ok());
}

#[test]
fn energy_of_accesses_and_of_a_rival() {
    let table = shipped();
    let mut counter = Counter::new();
    for _ in 0..3 {
        counter.read(Memory::Node, 0, PLACE);
    }
    counter.write(Memory::FillVector, 0, PLACE);
    let widths = Widths {
        stack_bits: 640,
        node_bits: 64,
        attribute_bits: 56,
        fill_vector_bits: 4,
        pixel_bits: 24,
    };
    let sram = Store::Sram { bytes: 8192 };
    let stores = Stores {
        stack: sram,
        node: Store::Dram,
        attribute: Store::Dram,
        fill_vector: sram,
        pixel: Store::Dram,
        accumulator: sram,
    };
    let accesses = counter.accesses_by(|cell| cell.memory);
    let sum = memory_energy_of(&accesses, &widths, &stores, &table).unwrap();
    let lines: Vec<_> = sum
        .lines
        .iter()
        .map(|l| (l.name.as_str(), l.operation.as_str()))
        .collect();
    assert_eq!(
        lines,
        [("node", "dram_read"), ("fill vector", "sram_write")]
    );
    near(sum.low, 3.0 * 1300.0 + 10.0 / 16.0);
    near(sum.high, 3.0 * 2600.0 + 10.0 / 16.0);
    near(sum.total, 3.0 * 1950.0 + 10.0 / 16.0);
    let rival = [
        "float_add",
        "float_multiply",
        "float_divide",
        "float_compare",
        "multiply",
    ];
    let rival = rival.map(|operation| Tally {
        operation: operation.to_owned(),
        width: 32,
        times: 1,
    });
    let sum = energy_of_tallies(&rival, &table).unwrap();
    assert_eq!(sum.lines.len(), 5);
    assert!(sum.low < sum.total && sum.total < sum.high);
}

#[test]
fn area_of_a_bill() {
    let unit = |name: &str, operation: &str, width, count| Unit {
        name: name.to_owned(),
        operation: operation.to_owned(),
        width,
        count,
    };
    let bill = [
        unit("centre", "midpoint", 24, 3),
        unit("vertex pool", "midpoint", 24, 57),
        unit("records", "register", 24, 30),
    ];
    let sum = area_of(&bill, &shipped(), Goal::Area).unwrap();
    near(sum.total, 60.0 * 172.7 + 30.0 * 96.0);
    assert_eq!(sum.lines[1].name, "vertex pool");
    let error = area_of(&[unit("x", "tan", 8, 1)], &shipped(), Goal::Delay).unwrap_err();
    assert!(error.to_string().contains("`tan`"));
}
