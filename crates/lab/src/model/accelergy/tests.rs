use hwmodel::cost::{Breakdown, CostTable};

use super::*;

/// 100 adders of 32 bits, 7 shifts by wires, 5 reads and 3 writes of 64 bits of 8 KB, and 2 words of outer memory.
fn frame() -> FrameCost {
    let table = CostTable::load_shipped().unwrap();
    let mut cost = FrameCost::default();
    let push = |sum: &mut Breakdown, name: &str, operation: &str, width, bytes, times| {
        let each = match bytes {
            Some(bytes) => table.memory_energy(operation, bytes, width),
            None => table.energy(operation, width),
        };
        sum.push(name, operation, width, times, each.unwrap());
        sum.of_bytes(bytes);
    };
    push(&mut cost.operations, "add", "add", 32, None, 100);
    push(
        &mut cost.operations,
        "shift_wires",
        "shift_wires",
        33,
        None,
        7,
    );
    let bytes = Some(8192);
    push(&mut cost.on_chip, "stack, voxel", "sram_read", 64, bytes, 5);
    push(
        &mut cost.on_chip,
        "stack, voxel",
        "sram_write",
        64,
        bytes,
        3,
    );
    push(&mut cost.outer, "lines of nodes", "dram_read", 64, None, 2);
    cost
}

/// As Accelergy's examples have them.
const COUNTS: &str = "architecture:
  version: 0.3
  subtree:
  - name: shiftvox
    attributes:
      technology: 45nm
      voltage: 0.9
    subtree:
    - name: light
      local:
      - name: add_32
        class: intadder
        attributes:
          datawidth: 32
      - name: dram_64
        class: DRAM
        attributes:
          width: 64
      - name: stack_voxel_64
        class: SRAM
        attributes:
          width: 64
          depth: 1024
action_counts:
  version: 0.3
  local:
  - name: shiftvox.light.add_32
    action_counts:
    - name: add
      counts: 100
  - name: shiftvox.light.dram_64
    action_counts:
    - name: read
      counts: 2
  - name: shiftvox.light.stack_voxel_64
    action_counts:
    - name: read
      arguments:
        data_delta: 1
        address_delta: 1
      counts: 5
    - name: write
      arguments:
        data_delta: 1
        address_delta: 1
      counts: 3
";

#[test]
fn components_and_counts_by_hand() {
    let text = counts(&[("light", &frame())], Technology::default());
    assert_eq!(text, COUNTS);
    serde_saphyr::from_str::<Value>(&text).unwrap();
}

/// A table as Accelergy writes it: with copies, other actions, and accesses that change nothing.
const TABLE: &str = "
ERT:
  version: 0.3
  tables:
  - name: shiftvox.ray_caster.add_32
    actions:
    - name: add
      arguments: null
      energy: 99
  - name: shiftvox.light.add_32[0..3]
    actions:
    - name: idle
      arguments: null
      energy: 0
    - name: add
      arguments: null
      energy: 0.25
  - name: shiftvox.light.stack_voxel_64
    actions:
    - name: read
      arguments:
        address_delta: 0
        data_delta: 0
      energy: 4
    - name: read
      arguments:
        address_delta: 1
        data_delta: 1
      energy: 8
    - name: write
      arguments:
        address_delta: 1
        data_delta: 1
      energy: 9
  - name: shiftvox.light.dram_64
    actions:
    - name: read
      energy: 1000
";

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
    ] {
        let text = TABLE.replacen(from, to, 1);
        let table = EnergyTable::parse("mine.yaml", &text);
        let error = table
            .and_then(|table| totals(&frame(), &table))
            .unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
}
