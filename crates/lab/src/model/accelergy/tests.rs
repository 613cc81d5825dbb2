use hwmodel::cost::{Breakdown, CostTable};

use super::*;

/// 100 adders of 32 bits, 7 shifts by wires, 5 reads and 3 writes of 64 bits of 8 KB, and 2 words of outer memory.
fn frame() -> FrameCost {
    let table = CostTable::load_shipped().unwrap();
    let mut cost = FrameCost::default();
    for (name, operation, width, times) in [
        ("add", "add", 32, 100),
        ("shift_wires", "shift_wires", 33, 7),
        ("stack, voxel", "sram_read", 64, 5),
        ("stack, voxel", "sram_write", 64, 3),
        ("lines of nodes", "dram_read", 64, 2),
    ] {
        let bytes = operation.starts_with("sram").then_some(8192);
        let (sum, each) = match bytes {
            Some(bytes) => (
                &mut cost.on_chip,
                table.memory_energy(operation, bytes, width),
            ),
            None if width == 64 => (&mut cost.outer, table.energy(operation, width)),
            None => (&mut cost.operations, table.energy(operation, width)),
        };
        sum.push(name, operation, width, times, each.unwrap());
        sum.of_bytes(bytes);
    }
    cost
}

/// Written by hand as in Accelergy's examples.
const COUNTS: &str = include_str!("counts.yaml");
/// As Accelergy writes it: with copies, other actions, and accesses that change nothing.
const TABLE: &str = include_str!("table.yaml");

#[test]
fn components_and_counts_by_hand() {
    let text = counts(&[("light", &frame())], Technology::default());
    assert_eq!(text, COUNTS);
    yaml::document(&text).unwrap();
}

fn totals(cost: &FrameCost, by: &dyn Estimator) -> Result<[f64; 3], CostError> {
    let price = |part: &Breakdown| Ok(part.priced_by("light", by)?.total);
    let FrameCost {
        operations,
        on_chip,
        outer,
        ..
    } = cost;
    Ok([price(operations)?, price(on_chip)?, price(outer)?])
}

#[test]
fn prices_of_a_table_by_hand() {
    let table = EnergyTable::parse("mine.yaml", TABLE).unwrap();
    let found = totals(&frame(), &table).unwrap();
    assert_eq!(found, [100.0 * 0.25, 5.0 * 8.0 + 3.0 * 9.0, 2000.0]);
}

#[test]
fn our_own_prices_come_back_unchanged() {
    let cost = frame();
    let expected = [&cost.operations, &cost.on_chip, &cost.outer].map(|part| part.total);
    let text = energies(&[("light", &cost)]);
    let table = EnergyTable::parse("own.yaml", &text).unwrap();
    assert_eq!(totals(&cost, &table).unwrap(), expected);
    // The shipped tables are an estimator, too.
    let shipped = CostTable::load_shipped().unwrap();
    assert_eq!(totals(&cost, &shipped).unwrap(), expected);
}

#[test]
fn wrong_tables_are_refused_with_file_and_key() {
    let deep = format!("energy: {}{}", "[".repeat(99), "]".repeat(99));
    for (from, to, expected) in [
        ("ERT:", "ART:", "mine.yaml is no Accelergy ERT"),
        ("energy: 8", "energy: dear", "mine.yaml is no Accelergy ERT"),
        (
            "energy: 8",
            "energy: -8",
            "`read` of `shiftvox.light.stack_voxel_64`: energy is -8; it must be at least 0",
        ),
        (
            "light.add_32",
            "light.add_33",
            "mine.yaml: ERT.tables has no `shiftvox.light.add_32`",
        ),
        (
            "name: write",
            "name: fill",
            "mine.yaml: ERT.tables has no action `write` of `light.stack_voxel_64`",
        ),
        (
            "energy: 8",
            "energy: &a 8\n      more: *a",
            "it has aliases",
        ),
        (
            "energy: 8",
            "energy: 8\n      energy: 1",
            "the key energy comes twice",
        ),
        (
            "energy: 1000",
            "energy: 1000\n---\nERT:",
            "several documents",
        ),
        (
            "energy: 1000",
            "energy: 1000\n...\nmore: [",
            "no Accelergy ERT",
        ),
        ("energy: 8", "energy: [", "mine.yaml is no Accelergy ERT"),
        ("energy: 8", &*deep, "nested too deeply"),
    ] {
        let text = TABLE.replacen(from, to, 1);
        let table = EnergyTable::parse("mine.yaml", &text);
        let error = table
            .and_then(|table| totals(&frame(), &table))
            .unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
}
