//! What the host does before the first record.

use crate::lab::model::host::{HostWork, operation};
use crate::project::host::{HostCell, Part};
use crate::report::{Cell, Table};

/// The host's steps, by what was done and to what.
#[must_use]
pub fn host(work: &HostWork) -> Table {
    let mut table = Table::new(
        "The host's set-up, before the first record: not among the machine's operations",
        &["step", "numbers", "bits", "times", "row_of_energy"],
    );
    for ((step, kind), times) in work.by_step() {
        table.rows.push(vec![
            Cell::from(step.name()),
            Cell::from(kind.name()),
            Cell::from(u64::from(kind.bits())),
            Cell::from(times),
            operation(step, kind).map_or(Cell::None, Cell::from),
        ]);
    }
    table
}

/// The host's steps by what they are for.
#[must_use]
pub fn host_parts(work: &HostWork) -> Table {
    let mut columns = vec!["step", "numbers", "bits"];
    columns.extend(Part::ALL.map(Part::name));
    let mut table = Table::new("The host's set-up, by what it is for", &columns);
    for (step, kind) in work.by_step().into_keys() {
        let times = Part::ALL.map(|part| {
            let is_it = |cell: &&HostCell| (cell.part, cell.step, cell.kind) == (part, step, kind);
            let cell = work.cells.iter().find(is_it);
            cell.map_or(Cell::from(0), |cell| Cell::from(cell.times))
        });
        let mut row = vec![
            Cell::from(step.name()),
            Cell::from(kind.name()),
            Cell::from(u64::from(kind.bits())),
        ];
        row.extend(times);
        table.rows.push(row);
    }
    table
}
