//! Cost tables: shipped figures, interpolation, a user's own rows, and errors.

use crate::costs_common::{near, shipped};
use hwmodel::cost::{CostError, CostTable, Fit, Goal, Quantity};

#[test]
fn figures_of_the_shipped_rows() {
    let table = shipped();
    let areas = "add 8 area 50.5, add 32 delay 330.8, midpoint 48 area 352.9, less 64 area 356.3, \
                 multiply 32 area 10184.7, register 24 delay 96";
    for row in areas
        .split(", ")
        .map(|row| row.split(' ').collect::<Vec<_>>())
    {
        let goal = if row[2] == "area" {
            Goal::Area
        } else {
            Goal::Delay
        };
        let cost = table.area(row[0], row[1].parse().unwrap(), goal).unwrap();
        near(cost.value, row[3].parse().unwrap());
        assert_eq!(
            (cost.fit, cost.derived, cost.is_range()),
            (Fit::Row, false, false)
        );
        assert!(cost.source.contains("Yosys"), "{}", cost.source);
    }
    let energies = "add 8 0.03, add 32 0.1, multiply 8 0.2, multiply 32 3.1, float_add 16 0.4, float_add 32 0.9, \
                    float_multiply 16 1.1, float_multiply 32 3.7";
    for row in energies
        .split(", ")
        .map(|row| row.split(' ').collect::<Vec<_>>())
    {
        let cost = table.energy(row[0], row[1].parse().unwrap()).unwrap();
        near(cost.value, row[2].parse().unwrap());
        assert!(cost.source.contains("ISSCC 2014") && !cost.derived);
    }
    for (bytes, picojoules) in [(8 << 10, 10.0), (32 << 10, 20.0), (1 << 20, 100.0)] {
        let cost = table.memory_energy("sram_read", bytes, 64).unwrap();
        near(cost.value, picojoules);
        assert_eq!(cost.fit, Fit::Row);
    }
    let dram = table.energy("dram_read", 64).unwrap();
    assert_eq!((dram.low, dram.value, dram.high), (1300.0, 1950.0, 2600.0));
    assert!(dram.is_range());
    let um2 = |operation, width| {
        table
            .cost(Quantity::Um2At45Nm, operation, width, None)
            .unwrap()
            .value
    };
    assert_eq!([um2("add", 8), um2("add", 32)], [36.0, 137.0]);
    assert_eq!([um2("multiply", 8), um2("multiply", 32)], [282.0, 3495.0]);
    assert_eq!(
        [um2("float_add", 32), um2("float_multiply", 32)],
        [4184.0, 7700.0]
    );
    near(table.delay("add", 32, Goal::Delay).unwrap().value, 1301.61);
}

/// The synthesis figures are all there.
#[test]
#[ignore = "needs the folder SHIFTVOX_DATA"]
fn the_synthesis_is_shipped_whole() {
    let data = std::env::var("SHIFTVOX_DATA").expect("SHIFTVOX_DATA names a folder with hw/");
    let text = std::fs::read_to_string(format!("{data}/hw/synthesis.csv")).unwrap();
    let table = shipped();
    let mut rows = 0;
    for line in text.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let [operation, width, goal, _, um2, nand2, delay] = fields[..] else {
            panic!("{line}");
        };
        let width = width.parse().unwrap();
        let goal = if goal == "area" {
            Goal::Area
        } else {
            Goal::Delay
        };
        near(
            table.area(operation, width, goal).unwrap().value,
            nand2.parse().unwrap(),
        );
        let cost = table
            .cost(Quantity::Um2, operation, width, Some(goal))
            .unwrap();
        near(cost.value, um2.parse().unwrap());
        if !delay.is_empty() {
            near(
                table.delay(operation, width, goal).unwrap().value,
                delay.parse().unwrap(),
            );
        }
        rows += 1;
    }
    assert_eq!(rows, 152);
}

/// Rows that follow from others follow from them.
#[test]
fn derived_rows_are_what_they_say() {
    let table = shipped();
    let nand2 = |operation, width| table.area(operation, width, Goal::Area).unwrap();
    let energy = |operation, width| table.energy(operation, width).unwrap();
    let operations = "sub midpoint less min minmax select xor and shift_var divide_step";
    for operation in operations.split(' ') {
        for width in [8, 32] {
            let ratio = nand2(operation, width).value / nand2("add", width).value;
            let cost = energy(operation, width);
            let expected = ratio * energy("add", width).value;
            assert!((cost.value - expected).abs() < 6e-5, "{operation} {width}");
            assert!(cost.derived && cost.source.contains("adder's"));
        }
    }
    let divide = energy("float_divide", 32);
    assert!((divide.low - 26.0 * energy("divide_step", 25).value).abs() < 0.01);
    assert!((divide.high - 7.1 * 3.7).abs() < 0.05);
    let compare = energy("float_compare", 32);
    assert_eq!((compare.low, compare.high), (energy("less", 32).value, 0.9));
    let registers = 2.0 * nand2("register", 25).value + nand2("divide_step", 25).value;
    let (add, divide) = (nand2("float_add", 32), nand2("float_divide", 32));
    assert!((divide.low - add.low - registers).abs() < 0.1);
    assert!((divide.high - add.high - registers).abs() < 0.1);
    assert!((add.low - 4184.0 / 0.798).abs() < 0.1);
    assert!((add.high - 4184.0 * 232.9 / 137.0).abs() < 0.1);
}

#[test]
fn between_and_beyond_the_rows() {
    let table = shipped();
    let area = |operation, width| table.area(operation, width, Goal::Area).unwrap();
    let between = area("add", 40);
    near(between.value, (232.9 + 354.9) / 2.0);
    assert_eq!(between.fit, Fit::Interpolated);
    assert_eq!(
        between.rows,
        "`add` of 32 and 48 bits, for small area (hwmodel/tables/area.toml)"
    );
    // The square of 20 is 400, 9/20 of the way from 16 to 24 squared.
    let multiplier = area("multiply", 20);
    near(
        multiplier.value,
        2572.1 + (5710.8 - 2572.1) * (400.0 - 256.0) / (576.0 - 256.0),
    );
    assert_eq!(multiplier.fit, Fit::Interpolated);
    // Below the narrowest row to zero, above the widest as before it.
    let narrow = area("add", 4);
    near(narrow.value, 50.5 / 2.0);
    assert_eq!(narrow.fit, Fit::Extrapolated);
    near(area("multiply", 4).value, 621.5 / 4.0);
    let wide = area("add", 65);
    near(wide.value, 505.5 + (505.5 - 354.9) / 16.0);
    assert_eq!(wide.fit, Fit::Extrapolated);
    near(
        table.energy("add", 64).unwrap().value,
        0.1 + (0.1 - 0.03) * 32.0 / 24.0,
    );
    assert!(table.area("add", 256, Goal::Area).is_ok());
    let error = table.area("add", 257, Goal::Area).unwrap_err();
    assert!(matches!(
        error,
        CostError::TooWide {
            widest: 64,
            width: 257,
            ..
        }
    ));
    let told = error.to_string();
    assert!(
        told.contains("near 257 bits") && told.contains("beyond 4 times"),
        "{told}"
    );
    assert!(told.contains("area.toml"), "{told}");
    // Wires cost nothing at any width, and a row says so.
    let wires = table.energy("shift_wires", 77).unwrap();
    assert_eq!((wires.value, wires.fit), (0.0, Fit::Row));
    assert_eq!(
        wires.rows,
        "`shift_wires` of any width (hwmodel/tables/energy.toml)"
    );
}

#[test]
fn memories_of_any_size() {
    let table = shipped();
    let sram = |bytes, bits| table.memory_energy("sram_read", bytes, bits).unwrap();
    let (root, low, high) = (65536f64.sqrt(), 32768f64.sqrt(), 1024.0);
    let between = sram(65536, 64);
    near(between.value, 20.0 + 80.0 * (root - low) / (high - low));
    assert_eq!(between.fit, Fit::Interpolated);
    assert!(
        between.rows.contains("32768 and 1048576 bytes"),
        "{}",
        between.rows
    );
    near(sram(2048, 64).value, 5.0);
    assert_eq!(sram(2048, 64).fit, Fit::Extrapolated);
    near(sram(8192, 4).value, 10.0 * 4.0 / 64.0);
    assert_eq!(
        sram(8192, 4).fit,
        Fit::Interpolated,
        "scaled, and marked so"
    );
    let error = table.memory_energy("sram_read", 1 << 40, 64).unwrap_err();
    let told = error.to_string();
    assert!(
        told.contains("near 1099511627776 bytes") && told.contains("beyond 16 times"),
        "{told}"
    );
    assert!(matches!(
        table.memory_energy("add", 8192, 64),
        Err(CostError::Missing { .. })
    ));
}

#[test]
fn what_is_missing_is_named() {
    let error = shipped().area("cube_root", 24, Goal::Area).unwrap_err();
    assert_eq!(
        error.to_string(),
        "no area in NAND2 equivalents of `cube_root`, asked for at 24 bits (for small area): \
         add a row with `nand2` to a cost table of your own, or to hwmodel/tables/area.toml"
    );
    let error = shipped().energy("cube_root", 24).unwrap_err();
    assert_eq!(
        error.to_string(),
        "no energy of `cube_root`, asked for at 24 bits: \
         add a row with `energy_pj` to a cost table of your own, or to hwmodel/tables/energy.toml"
    );
    assert!(CostTable::empty().energy("add", 32).is_err());
}

#[test]
fn a_table_of_one_s_own() {
    let mine = r#"
        quadratic = ["square_root"]
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
    let add = table.area("add", 32, Goal::Area).unwrap();
    assert_eq!((add.low, add.value, add.high), (200.0, 210.0, 220.0));
    assert_eq!(add.source, "our own 7 nm library");
    assert_eq!(add.rows, "`add` of 32 bits, for small area (mine.toml)");
    // Never mixed with shipped rows of the same kind; what is not there stays.
    let wider = table.area("add", 64, Goal::Area).unwrap();
    assert_eq!((wider.value, wider.fit), (420.0, Fit::Extrapolated));
    near(table.area("add", 32, Goal::Delay).unwrap().value, 330.8);
    near(table.energy("add", 32).unwrap().value, 0.1);
    near(table.delay("add", 32, Goal::Area).unwrap().value, 4680.73);
    // Without goal for both.
    for goal in [Goal::Area, Goal::Delay] {
        let less = table.area("less", 32, goal).unwrap();
        assert_eq!((less.value, less.source.as_str()), (1.0, "both"));
    }
    // With a goal before what has none, which stays for the other.
    assert_eq!(
        table.area("float_add", 32, Goal::Area).unwrap().value,
        6000.0
    );
    assert!(table.area("float_add", 32, Goal::Delay).unwrap().is_range());
    near(
        table.area("square_root", 20, Goal::Area).unwrap().value,
        400.0,
    );
    assert!(table.operations().contains(&"square_root"));
    // A name that only `quadratic` has is listed too.
    let listed = CostTable::empty().with_overrides("mine.toml", "quadratic = [\"ad\"]");
    assert_eq!(listed.unwrap().operations(), ["ad"]);
}

/// Fields of rows, and a part of the complaint.
const NO_ROWS: &str = r#"operation = "add", width = 8, nand2 = 1 -> missing field `source`
operation = "add", width = 8, nand2 = 1, source = " " -> mine.toml, row `add` of 8 bits: the source is empty
operation = "", nand2 = 1, source = "s" -> no name
operation = "add", width = 8, source = "s" -> there is no figure
operation = "add", width = 0, nand2 = 1, source = "s" -> at least 1 bit
operation = "add", width = -1, nand2 = 1, source = "s" -> invalid value
operation = "add", nand2 = -1, source = "s" -> from 0 to 1e12
operation = "add", nand2 = nan, source = "s" -> from 0 to 1e12
operation = "add", nand2 = inf, source = "s" -> from 0 to 1e12
operation = "add", nand2 = [2, 1], source = "s" -> range [low, high]
operation = "add", nand2 = "1", source = "s" -> did not match
operation = "add", nand = 1, source = "s" -> unknown field `nand`
operation = "add", goal = "speed", nand2 = 1, source = "s" -> speed
operation = "m", bytes = 0, width = 1, energy_pj = 1, source = "s" -> at least 1 byte
operation = "m", bytes = 8, energy_pj = 1, source = "s" -> and a width
operation = "add", width = 8, nand2 = 1, source = "s" }, { operation = "add", width = 8, nand2 = 2, source = "s" -> two such rows
operation = "add", width = 8, nand2 = 1e300, source = "s" -> from 0 to 1e12
operation = "add", width = 4294967295, nand2 = 1, source = "s" -> a width is at most 65536 bits
operation = "m", bytes = 9223372036854775807, width = 1, energy_pj = 1, source = "s" -> at most 2^50 bytes
operation = "add", nand2 = 1, source = "s" }, { operation = "add", width = 8, nand2 = 2, source = "s" -> row `add` of 8 bits: one row is for any width"#;

#[test]
fn what_is_no_table() {
    let rows = NO_ROWS.lines().map(|line| line.split_once(" -> ").unwrap());
    let rows = rows.map(|(fields, says)| (format!("row = [{{ {fields} }}]"), says));
    let others = [
        ("row = [", "mine.toml is no cost table: TOML parse error"),
        ("rows = []", "unknown field `rows`"),
    ];
    for (text, says) in rows.chain(others.map(|(text, says)| (text.to_owned(), says))) {
        let error = shipped()
            .with_overrides("mine.toml", &text)
            .unwrap_err()
            .to_string();
        assert!(error.contains(says), "{text}: {error}");
        assert!(error.contains("mine.toml"), "{error}");
    }
}
