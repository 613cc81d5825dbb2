//! Cost tables: shipped figures, interpolation, a user's own rows, errors, and sums.

use crate::common::*;
use hwmodel::cost::{
    Cost, CostError, CostTable, Fit, Goal, MemoryShape, Store, energy_of, memory_energy_of,
};
use hwmodel::count::Counter;
use hwmodel::memory::Widths;
use hwmodel::{Memory, OpClass, Probe};

fn shipped() -> CostTable {
    CostTable::load_shipped().expect("well-formed tables")
}

#[track_caller]
fn near(found: f64, expected: f64) {
    let within = 1e-9 * expected.abs().max(1.0);
    assert!(
        (found - expected).abs() <= within,
        "{found} is not {expected}"
    );
}

fn cost(table: &CostTable, quantity: &str, operation: &str, size: u32) -> Result<Cost, CostError> {
    match quantity {
        "area" => table.area(operation, size, Goal::Area),
        "fast" => table.area(operation, size, Goal::Delay),
        "delay" => table.delay(operation, size, Goal::Area),
        "energy" => table.energy(operation, size),
        _ => table.memory_energy(operation, u64::from(size), 64),
    }
}

/// Rows of quantity, operation, width or size, figure, fit, and a part of the rows in words; of an error, if the figure
/// is the key of the row to add.
fn check(table: &CostTable, rows: &str) {
    for row in rows.lines().map(str::trim) {
        let mut parts = row.splitn(6, ' ');
        let [quantity, operation, size, expected, fit, words] =
            [(); 6].map(|()| parts.next().unwrap());
        match (
            cost(table, quantity, operation, size.parse().unwrap()),
            expected.parse(),
        ) {
            (Ok(found), Ok(expected)) => {
                near(found.value, expected);
                assert_eq!(format!("{:?}", found.fit), fit, "{row}");
                assert!(found.rows.contains(words), "{}", found.rows);
                assert!(found.low <= found.value && found.value <= found.high);
            }
            (Err(error), Err(_)) => {
                let error = error.to_string();
                let add = format!(
                    "add a row with `{expected}` to a cost table of your own, or to hwmodel/tables/"
                );
                assert!(error.contains(words) && error.contains(&add), "{error}");
            }
            (found, _) => panic!("{row}: {found:?}"),
        }
    }
}

#[test]
fn figures_at_between_and_beyond_the_rows() {
    // Between rows linear in the width, its square (multiply) or the root of the size; below the first row to zero.
    let rows = "area add 32 232.9 Row `add` of 32 bits, for small area (hwmodel/tables/area.toml)
        fast add 32 330.8 Row , for short delay
        delay add 32 4680.73 Row 32 bits
        energy add 32 0.1 Row (hwmodel/tables/energy.toml)
        energy shift_wires 77 0 Row `shift_wires` of any width
        energy dram_read 64 1950 Row 64 bits
        sram sram_read 32768 20 Row 32768 bytes
        area add 40 293.9 Interpolated 32 and 48 bits
        area multiply 20 3984.5150000000003 Interpolated 16 and 24
        sram sram_read 65536 27.115765968724425 Interpolated 32768 and 1048576 bytes
        area add 4 25.25 Extrapolated 8 bits
        area multiply 4 155.375 Extrapolated 8 bits
        area add 65 514.9125 Extrapolated 48 and 64
        area add 256 2312.7 Extrapolated 48 and 64
        energy add 64 0.19333333333333336 Extrapolated 8 and 32
        sram sram_read 2048 5 Extrapolated 8192 bytes
        sram sram_read 16777216 391.53693612510233 Extrapolated 32768 and 1048576 bytes
        fast cube_root 24 nand2 - area in NAND2 equivalents of `cube_root` at 24 bits (for short delay)
        energy cube_root 24 energy_pj - energy of `cube_root` at 24 bits
        sram add 8192 energy_pj - energy of `add` at 64 bits
        area add 257 nand2 - near 257 bits (for small area): the largest row has 64, and nothing is extrapolated beyond 4
        sram sram_read 16777217 energy_pj - near 16777217 bytes: the largest row has 1048576, and nothing is extrapolated beyond 16";
    check(&shipped(), rows);
    let scaled = shipped().memory_energy("sram_read", 8192, 4).unwrap();
    assert_eq!(
        (scaled.value, scaled.fit),
        (10.0 * 4.0 / 64.0, Fit::Interpolated)
    );
    let dram = shipped().energy("dram_read", 64).unwrap();
    assert_eq!((dram.low, dram.high), (1300.0, 2600.0));
}

#[test]
fn derived_rows_are_what_they_say() {
    let table = shipped();
    let nand2 = |operation, width| table.area(operation, width, Goal::Area).unwrap();
    let energy = |operation, width| table.energy(operation, width).unwrap();
    let operations = "sub midpoint less min minmax select xor and shift_var divide_step";
    for (operation, width) in operations.split(' ').flat_map(|of| [(of, 8), (of, 32)]) {
        let ratio = nand2(operation, width).value / nand2("add", width).value;
        let cost = energy(operation, width);
        let expected = ratio * energy("add", width).value;
        assert!((cost.value - expected).abs() < 6e-5, "{operation} {width}");
        assert!(cost.derived && cost.source.contains("adder's"));
    }
}

/// Areas of the published macros, as far as the rectangle's widths are off, and of smaller memories by hand.
#[test]
fn memories_by_shape() {
    let table = shipped();
    let area = |words: u64, width, ports| {
        let shape = MemoryShape {
            words,
            width,
            ports,
        };
        let (operation, each) = table.memory_area(shape, Goal::Area).unwrap();
        assert!(each.derived && each.source.contains("-port macros") || operation == "register");
        (operation, each.value * words as f64 * f64::from(width))
    };
    for (words, width, ports, square_micrometres, within) in [
        (64, 64, 1, 64.36 * 784.48, 0.006),
        (1024, 16, 1, 336.46 * 236.80, 0.006),
        (2048, 64, 1, 626.70 * 784.48, 0.006),
        // Not in the fit; has several words in a row.
        (4096, 8, 1, 618.30 * 236.80, 0.045),
        (64, 32, 2, 74.87 * 702.83, 0.014),
        (1024, 16, 2, 385.37 * 402.61, 0.014),
    ] {
        let (operation, found) = area(words, width, ports);
        let ratio = found * 7.2576 / square_micrometres;
        let is_near = operation == "sram" && (ratio - 1.0).abs() < within;
        assert!(is_near, "{words} words of {width} bits: {ratio}");
    }
    // Four ports are two copies of two. A register bit is 4 NAND2, and each of its selectors 3.
    let [two, three, four] = [2, 3, 4].map(|ports| area(1024, 32, ports).1);
    near(four, 2.0 * two);
    near(three, four);
    assert_eq!(area(4, 8, 1).0, "register");
    near(area(4, 8, 1).1, 32.0 * (4.0 + 2.0 * 3.0));
}

#[test]
fn a_table_of_one_s_own() {
    let mine = r#"
        quadratic = ["square_root", "cube_root"]
        row = [
            { operation = "add", width = 32, goal = "area", nand2 = [200, 220], source = "lab" },
            { operation = "less", width = 32, nand2 = 1, source = "both" },
            { operation = "square_root", width = 10, nand2 = 100, source = "lab" },
            { operation = "float_add", width = 32, goal = "area", nand2 = 6000, source = "lab" },
        ]
        [sources]
        lab = "our own 7 nm library"
    "#;
    let table = shipped().with_overrides("mine.toml", mine).unwrap();
    let shipped_add = cost(&shipped(), "fast", "float_add", 32).unwrap().value;
    // Never mixed with shipped rows of the same kind; others stay. Without goal for both goals; with a goal before rows
    // without, which stay for the other.
    let rows = format!(
        "area add 32 210 Row `add` of 32 bits, for small area (mine.toml)
        area add 64 420 Extrapolated (mine.toml)
        fast add 32 330.8 Row (hwmodel/tables/area.toml)
        delay add 32 4680.73 Row (hwmodel/tables/area.toml)
        energy add 32 0.1 Row (hwmodel/tables/energy.toml)
        area less 32 1 Row (mine.toml)
        fast less 32 1 Row (mine.toml)
        area float_add 32 6000 Row (mine.toml)
        area square_root 20 400 Extrapolated (mine.toml)
        fast float_add 32 {shipped_add} Row (hwmodel/tables/area.toml)"
    );
    check(&table, &rows);
    let add = cost(&table, "area", "add", 32).unwrap();
    assert_eq!((add.low, add.high), (200.0, 220.0));
    assert_eq!(add.source, "our own 7 nm library");
    assert_eq!(cost(&table, "area", "less", 32).unwrap().source, "both");
    let listed = table.operations();
    assert!(listed.contains(&"square_root") && listed.contains(&"cube_root"));
}

/// Fields of rows, and a part of the complaint.
const NO_ROWS: &str = r#"operation = "add", width = 8, nand2 = 1 -> missing field `source`
operation = "add", width = 8, nand2 = 1, source = " " -> mine.toml, row `add` of 8 bits: the source is empty
operation = "", nand2 = 1, source = "s" -> no name
operation = "add", width = 8, source = "s" -> there is no figure
operation = "add", width = 0, nand2 = 1, source = "s" -> at least 1 bit
operation = "add", nand2 = -1, source = "s" -> from 0 to 1e12
operation = "add", nand2 = nan, source = "s" -> from 0 to 1e12
operation = "add", nand2 = 1e300, source = "s" -> from 0 to 1e12
operation = "add", nand2 = [2, 1], source = "s" -> range [low, high]
operation = "add", nand = 1, source = "s" -> unknown field `nand`
operation = "m", bytes = 0, width = 1, energy_pj = 1, source = "s" -> at least 1 byte
operation = "m", bytes = 8, energy_pj = 1, source = "s" -> and a width
operation = "add", width = 65537, nand2 = 1, source = "s" -> a width is at most 65536 bits
operation = "m", bytes = 9223372036854775807, width = 1, energy_pj = 1, source = "s" -> at most 2^50 bytes
operation = "add", width = 8, nand2 = 1, source = "s" }, { operation = "add", width = 8, nand2 = 2, source = "s" -> two such rows
operation = "add", nand2 = 1, source = "s" }, { operation = "add", width = 8, nand2 = 2, source = "s" -> row `add` of 8 bits: one row is for any width
 }, -> mine.toml is no cost table: TOML parse error"#;

#[test]
fn what_is_no_table() {
    for (fields, says) in NO_ROWS.lines().map(|line| line.split_once(" -> ").unwrap()) {
        let text = format!("row = [{{ {fields} }}]");
        let error = shipped().with_overrides("mine.toml", &text).unwrap_err();
        let error = error.to_string();
        assert!(
            error.contains(says) && error.contains("mine.toml"),
            "{text}: {error}"
        );
    }
}

#[test]
fn energy_line_by_line() {
    use OpClass::{Add, Compare, Logic, Shift};
    let table = shipped();
    let mut counter = Counter::new();
    let operations = [
        (Add, 32, 1000),
        (Shift, 33, 500),
        (Logic, 4, 17),
        (Compare, 32, 7),
    ];
    for (class, bits, times) in operations {
        counter.op(class, bits, at(RecordStage::Draw, 3), times);
    }
    let sum = energy_of(&counter, &table).unwrap();
    let lines = sum.lines.iter();
    let lines = lines.map(|line| format!("{} {} {}", line.operation, line.width, line.times));
    let expected = "add 32 1000, less 32 7, shift_wires 33 500, xor 4 17";
    assert_eq!(lines.collect::<Vec<_>>().join(", "), expected);
    for line in &sum.lines {
        let each = table.energy(&line.operation, line.width).unwrap().value;
        near(line.total, line.times as f64 * each);
    }
    near(sum.total, sum.lines.iter().map(|line| line.total).sum());
}

#[test]
fn what_follows_and_how_uncertain_it_is() {
    let table = shipped();
    assert_eq!(table.follows("sub"), Some("add"));
    assert_eq!(table.follows("add"), None);
    assert!(table.spread().stated < table.spread().derived);
    // A user's row follows nothing, and a user's spread replaces the shipped one.
    let mine = "spread = { stated = 1.0, derived = 1.5, extrapolated = 2.0 }
                row = [{ operation = \"sub\", width = 32, energy_pj = 0.2, source = \"mine\" }]";
    let table = table.with_overrides("mine.toml", mine).unwrap();
    assert_eq!((table.follows("sub"), table.spread().derived), (None, 1.5));
    assert_eq!(table.follows("less"), Some("add"));
    let wrong = "spread = { stated = 0.5, derived = 1.5, extrapolated = 2.0 }";
    let error = table.with_overrides("mine.toml", wrong).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("mine.toml: factors of [spread] are 1 to 100")
    );
}

#[test]
fn energy_of_accesses() {
    let mut counter = Counter::new();
    for _ in 0..3 {
        counter.read(Memory::Node, 0, at(RecordStage::Draw, 0));
    }
    counter.write(Memory::FillVector, 0, at(RecordStage::Draw, 0));
    let widths = Widths {
        stack_bits: 640,
        node_bits: 64,
        attribute_bits: 56,
        fill_vector_bits: 4,
        pixel_bits: 24,
    };
    let store = |memory| match memory {
        Memory::Node => Store::Dram,
        _ => Store::Sram { bytes: 8192 },
    };
    let accesses = counter.accesses_by(|cell| cell.memory);
    let sum = memory_energy_of(&accesses, &widths, store, &shipped()).unwrap();
    assert_eq!(sum.lines.len(), 2);
    near(sum.total, 3.0 * 1950.0 + 10.0 / 16.0);
}

/// Parabolas of table 5 of Stillmaker and Baas.
/// - 45 nm, 0.9 V: 1.018 x 0.81 - 0.3107 x 0.9 + 0.1539 = 0.69885.
/// - 16 nm, 0.8 V: 0.2958 x 0.64 - 0.1241 x 0.8 + 0.03024 = 0.120272.
/// - 7 nm, 0.7 V: 0.1776 x 0.49 - 0.09097 x 0.7 + 0.02447 = 0.047815.
/// - 28 nm, 0.9 V: between 0.45714 (32 nm, as in the paper's corrigendum) and 0.20079 (20 nm). Of the way from 20 to 32
///   nm, ln 1.4 / ln 1.6 = 0.71589, so 0.20079 (0.45714 / 0.20079)^0.71589 = 0.36185.
#[test]
fn prices_in_another_technology_by_hand() {
    for (nm, volts, switching, leakage) in [
        (45, 0.9, 1.0, 1.0),
        (28, 0.9, 0.36185 / 0.69885, 28.0 / 45.0),
        (16, 0.8, 0.120272 / 0.69885, 16.0 * 0.8 / 40.5),
        (7, 0.7, 0.047815 / 0.69885, 7.0 * 0.7 / 40.5),
    ] {
        let text = format!("technology = {{ nm = {nm}, volts = {volts} }}");
        let table = shipped().with_overrides("mine.toml", &text).unwrap();
        for (operation, width, factor) in [
            ("add", 32, switching),
            ("clock", 1, switching),
            ("sram_leakage", 1, leakage),
            ("dram_read", 64, 1.0),
        ] {
            let found = table.energy(operation, width).unwrap();
            let shipped = shipped().energy(operation, width).unwrap();
            let ratio = found.value / shipped.value;
            assert!(
                (ratio - factor).abs() < 2e-5,
                "{operation} at {nm}: {ratio}"
            );
            assert_eq!(found.source != shipped.source, nm != 45 && factor != 1.0);
        }
        let sram = table.memory_energy("sram_read", 8192, 64).unwrap().value;
        assert!((sram - 10.0 * switching).abs() < 2e-4);
        let area = table.area("add", 32, Goal::Area).unwrap().value;
        near(area, 232.9);
        assert!(
            table
                .technology()
                .sentence()
                .starts_with(&format!("{nm} nm, {volts} V"))
        );
    }
    // A user's rows are of the user's technology, and another technology replaces the first.
    let mine = "technology = { nm = 7, volts = 0.7 }
                row = [{ operation = \"add\", width = 32, energy_pj = 0.01, source = \"mine\" }]";
    let table = shipped().with_overrides("mine.toml", mine).unwrap();
    near(table.energy("add", 32).unwrap().value, 0.01);
    let back = "technology = { nm = 45, volts = 0.9 }";
    let table = table.with_overrides("back.toml", back).unwrap();
    near(table.energy("less", 32).unwrap().value, 0.0795);
    for (technology, says) in [
        (
            "nm = 22, volts = 0.9",
            "mine.toml: technology.nm is 22; it must be 45, 28, 16 or 7",
        ),
        (
            "nm = 16, volts = 1.8",
            "mine.toml: technology.volts is 1.8; it must be 0.5 to 1.1",
        ),
        ("nm = 16", "missing field `volts`"),
    ] {
        let text = format!("technology = {{ {technology} }}");
        let error = shipped().with_overrides("mine.toml", &text).unwrap_err();
        assert!(error.to_string().contains(says), "{error}");
    }
}
