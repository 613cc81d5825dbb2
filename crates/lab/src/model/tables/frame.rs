//! What was counted of one frame.

use std::collections::BTreeMap;

use hwmodel::cycles::{Cause, CycleReport};
use hwmodel::memory::{RecordKind, Widths};
use hwmodel::{Memory, OpClass, Stage};

use super::{number, percent};
use crate::model::frame::Counted;
use crate::model::record::{FieldPresence, NumberWidths, RecordField};
use crate::report::{Cell, Table};

/// Operations and cycles by stage.
#[must_use]
pub fn stages(counted: &Counted, cycles: &CycleReport) -> Table {
    let mut table = Table::of(
        "By stage: operations by class, and cycles of its blocks",
        "stage visits add subtract compare min_max select shift logic divide_step busy held \
         used_percent stall stalls_most_for",
    );
    let counts = counted.counter.sum_by(|cell| (cell.stage, cell.class));
    // A stage of another drawing rule has no figures.
    for stage in cycles.stages.iter().filter(|stage| stage.visits > 0) {
        let mut row = vec![Cell::from(stage.stage.name()), Cell::from(stage.visits)];
        row.extend(
            OpClass::ALL
                .iter()
                .map(|&class| Cell::from(counts.get(&(stage.stage, class)).copied())),
        );
        let worst = Cause::ALL
            .into_iter()
            .rev()
            .max_by_key(|&c| stage.stalls.of(c));
        let worst = worst.filter(|&cause| stage.stalls.of(cause) > 0);
        row.extend([
            Cell::from(stage.busy),
            Cell::from(stage.held),
            percent(stage.utilisation),
            Cell::from(stage.stalls.total()),
            worst.map_or(Cell::None, |cause| Cell::from(cause.name())),
        ]);
        table.rows.push(row);
    }
    table
}

/// Operations by class and width.
#[must_use]
pub fn classes(counted: &Counted) -> Table {
    let mut table = Table::new(
        "Operations by class and width",
        &["class", "bits", "operations", "a_record"],
    );
    let records = counted.counter.records().max(1) as f64;
    for ((class, bits), times) in counted.counter.sum_by(|cell| (cell.class, cell.bits)) {
        table.rows.push(vec![
            Cell::from(class.name()),
            Cell::from(u64::from(bits)),
            Cell::from(times),
            number(times as f64 / records, 2),
        ]);
    }
    table
}

/// Records and operations by octree level.
#[must_use]
pub fn levels(counted: &Counted) -> Table {
    let mut table = Table::of(
        "By octree level",
        "level records operations node_reads fill_vector_reads pixels",
    );
    let counter = &counted.counter;
    let operations = counter.sum_by(|cell| cell.level);
    let accesses = counter.accesses_by(|cell| (cell.level, cell.memory));
    for (level, records) in counter.records_by_level() {
        let of = |memory: Memory| accesses.get(&(level, memory)).copied().unwrap_or_default();
        table.rows.push(vec![
            Cell::from(u64::from(level)),
            Cell::from(records),
            Cell::from(operations.get(&level).copied().unwrap_or(0)),
            Cell::from(of(Memory::Node).reads),
            Cell::from(of(Memory::FillVector).reads),
            Cell::from(of(Memory::Pixel).writes),
        ]);
    }
    table
}

/// The fields of a record.
#[must_use]
pub fn record(fields: &[RecordField]) -> Table {
    let mut table = Table::new("A record on the stack", &["field", "bits", "held"]);
    for field in fields.iter().filter(|field| field.bits > 0) {
        let held = match field.held {
            FieldPresence::Always => "always",
            FieldPresence::InClipSpace => "in clip space",
            FieldPresence::InScreenSpace => "in screen space",
            FieldPresence::AsFinestVoxel => "as a finest voxel, instead of what is in clip space",
        };
        table.rows.push(vec![
            Cell::from(field.name),
            Cell::from(u64::from(field.bits)),
            Cell::from(held),
        ]);
    }
    table
}

/// Bits of a record's numbers: seen in this frame, proven by its set-up, and had by the hardware.
#[must_use]
pub fn numbers(numbers: &[NumberWidths]) -> Table {
    let mut table = Table::new(
        "Numbers of a record, and the bits of each",
        &["number", "of_them", "seen", "proven", "used"],
    );
    for of in numbers {
        table.rows.push(vec![
            Cell::from(of.name),
            Cell::from(u64::from(of.count)),
            Cell::from(u64::from(of.seen)),
            Cell::from(u64::from(of.proven)),
            Cell::from(u64::from(of.used)),
        ]);
    }
    table
}

/// Lines of the machine that shift, and by how many places.
#[must_use]
pub fn shifts(counted: &Counted) -> Table {
    let mut table = Table::new(
        "Shifts by the lines that do them: wires, or a shifter",
        &["line", "stage", "bits", "times", "least", "most", "places"],
    );
    for site in counted.shifts.sites() {
        table.rows.push(vec![
            Cell::Text(site.site.clone()),
            Cell::from(site.stage.name()),
            Cell::from(u64::from(site.bits)),
            Cell::from(site.times),
            Cell::from(u64::from(site.least)),
            Cell::from(u64::from(site.most)),
            Cell::from(site.kind.name()),
        ]);
    }
    table
}

/// What the records on the stack held.
#[must_use]
pub fn records_by_kind(counted: &Counted) -> Table {
    let mut table = Table::new(
        "Records on the stack by what they hold",
        &["kind", "bits", "popped", "pushed", "percent_of_the_popped"],
    );
    let all: u64 = RecordKind::ALL
        .iter()
        .map(|&kind| counted.records.of(kind).reads)
        .sum();
    for kind in RecordKind::ALL {
        let accesses = counted.records.of(kind);
        if accesses.writes > 0 {
            table.rows.push(vec![
                Cell::from(kind.name()),
                Cell::from(u64::from(counted.records.bits().of(kind))),
                Cell::from(accesses.reads),
                Cell::from(accesses.writes),
                percent(accesses.reads as f64 / all.max(1) as f64),
            ]);
        }
    }
    table
}

/// Traffic by memory.
#[must_use]
pub fn memories(counted: &Counted, widths: &Widths, cycles: &CycleReport) -> Table {
    let mut table = Table::of(
        "Memories",
        "memory reads writes bits_an_access kilobytes different_addresses \
         cache_hits_percent outer_kilobytes",
    );
    let probe = &counted.memory;
    let kilobytes = |bits: u64| number(bits as f64 / 8192.0, 1);
    let used = |memory: &Memory| probe.reads(*memory) + probe.writes(*memory) > 0;
    for memory in Memory::ALL.into_iter().filter(used) {
        let cache = match memory {
            Memory::Node => Some(&cycles.node_cache),
            Memory::Attribute => Some(&cycles.attribute_cache),
            _ => None,
        };
        let accesses = probe.reads(memory) + probe.writes(memory);
        let bits = match memory {
            Memory::Stack => counted.records.read_bits() + counted.records.written_bits(),
            _ => accesses * u64::from(widths.of(memory)),
        };
        table.rows.push(vec![
            Cell::from(memory.name()),
            Cell::from(probe.reads(memory)),
            Cell::from(probe.writes(memory)),
            // Of the stack on average: records differ.
            Cell::from(bits / accesses.max(1)),
            kilobytes(bits),
            Cell::from(probe.distinct(memory)),
            cache.map_or(Cell::None, |cache| percent(cache.hit_rate)),
            cache.map_or(Cell::None, |cache| kilobytes(8 * cache.bytes_in)),
        ]);
    }
    table
}

/// The miss curve of nodes, at powers of two.
#[must_use]
pub fn miss_curve(counted: &Counted) -> Table {
    let mut table = Table::new(
        "Misses of node caches of every size (fully associative, one pass)",
        &["bytes", "lines", "misses", "miss_percent"],
    );
    for (_, curve) in counted.memory.curves() {
        let line = u64::from(curve.line_bytes());
        let accesses = curve.accesses().max(1) as f64;
        let mut lines = 1;
        loop {
            let misses = curve.misses(lines);
            table.rows.push(vec![
                Cell::from(lines * line),
                Cell::from(lines),
                Cell::from(misses),
                percent(misses as f64 / accesses),
            ]);
            if lines >= curve.distinct_lines() {
                break;
            }
            lines *= 2;
        }
    }
    table
}

/// What no frame on this hardware goes below, and what the contexts did.
#[must_use]
pub fn bounds(cycles: &CycleReport) -> Table {
    let mut table = Table::new(
        "What limits: cycles below which each resource does not go",
        &["resource", "cycles", "percent_of_the_frame"],
    );
    for bound in cycles.bounds.iter().filter(|bound| bound.cycles > 0) {
        table.rows.push(vec![
            Cell::Text(bound.resource.clone()),
            Cell::from(bound.cycles),
            percent(bound.share),
        ]);
    }
    table
}

/// Operations by stage, a value for each class, in the order of [`OpClass::ALL`].
#[must_use]
pub fn operations_by_stage(counted: &Counted) -> BTreeMap<Stage, [u64; OpClass::ALL.len()]> {
    let mut stages = BTreeMap::new();
    for ((stage, class), times) in counted.counter.sum_by(|cell| (cell.stage, cell.class)) {
        stages.entry(stage).or_insert([0; OpClass::ALL.len()])[class as usize] = times;
    }
    stages
}
