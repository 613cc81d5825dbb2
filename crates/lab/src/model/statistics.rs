//! The model's results as a list of statistics, for `stats.txt` and CSV.

use hwmodel::cycles::Cause;
use hwmodel::statistics::Statistics;
use hwmodel::{Memory, OpClass};

use super::area::DesignArea;
use super::cost::FrameCost;
use super::frame::Counted;
use super::ray_caster::RayCasterReport;
use super::record::record_bits;
use crate::float_rays::FloatStep;
use shiftvox::machine::{COUNTERS, Simulated};

/// A name as one word of a dotted name.
fn word(name: &str) -> String {
    let keep = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let mapped: String = name.chars().map(keep).collect();
    mapped.trim_matches('_').to_owned()
}

/// Everything that was counted of a frame.
#[must_use]
pub fn of(
    counted: &Counted,
    simulated: &Simulated,
    cost: &FrameCost,
    area: &DesignArea,
    ray_caster: Option<&RayCasterReport>,
) -> Statistics {
    let mut list = Statistics::new();
    let counter = &counted.counter;
    for &(name, count) in &counted.stats {
        let info = COUNTERS.iter().find(|counter| counter.name == name);
        let meaning = info.map(|counter| format!("{} [{}]", counter.meaning, counter.unit));
        let meaning = meaning.unwrap_or_default();
        list.add(&format!("machine.{name}"), count, "Count", &meaning);
    }
    for (level, records) in counter.records_by_level() {
        let name = format!("machine.level{level:02}.records");
        list.add(&name, records, "Count", "records of this octree level");
    }
    let cells = counter.sum_by(|cell| (cell.class, cell.bits, cell.stage));
    for ((class, bits, stage), times) in cells {
        let name = format!(
            "machine.ops.{}.w{bits}.{}",
            word(class.name()),
            word(stage.name())
        );
        let what = format!("{} on {bits} bits in stage {}", class.name(), stage.name());
        list.add(&name, times, "Count", &what);
    }
    for class in OpClass::ALL {
        let name = format!("machine.ops.{}.total", word(class.name()));
        list.add(
            &name,
            counter.ops_of(class),
            "Count",
            "operations of this class",
        );
    }
    list.add(
        "machine.ops.total",
        counter.ops(),
        "Count",
        "all operations, shifts included",
    );
    list.add(
        "machine.ops.multiply",
        0u64,
        "Count",
        "there is no such operation",
    );
    list.add(
        "machine.ops.widest",
        u64::from(counter.widest()),
        "Bit",
        "widest operation",
    );
    list.add(
        "machine.record.bits",
        u64::from(record_bits(&counted.fields)),
        "Bit",
        "a record on the stack",
    );
    for memory in Memory::ALL {
        let name = word(memory.name());
        let probe = &counted.memory;
        let (read_bits, written_bits) = match memory {
            // Records differ in what they hold.
            Memory::Stack => (counted.records.read_bits(), counted.records.written_bits()),
            _ => (probe.read_bits(memory), probe.written_bits(memory)),
        };
        list.add(
            &format!("memory.{name}.reads"),
            probe.reads(memory),
            "Count",
            "reads",
        );
        list.add(
            &format!("memory.{name}.writes"),
            probe.writes(memory),
            "Count",
            "writes",
        );
        list.add(
            &format!("memory.{name}.read_bits"),
            read_bits,
            "Bit",
            "bits read",
        );
        list.add(
            &format!("memory.{name}.written_bits"),
            written_bits,
            "Bit",
            "bits written",
        );
        list.add(
            &format!("memory.{name}.distinct"),
            probe.distinct(memory),
            "Count",
            "different addresses",
        );
    }
    cycles(&mut list, simulated);
    for (name, part) in [
        ("operations", &cost.operations),
        ("on_chip", &cost.on_chip),
        ("outer", &cost.outer),
    ] {
        let what = format!("energy of {}", name.replace('_', " "));
        list.add(&format!("energy.{name}"), part.total, "pJ", &what);
    }
    let (total, low, high) = cost.total();
    list.add(
        "energy.total",
        total,
        "pJ",
        "energy of the frame, middle of its range",
    );
    list.add("energy.low", low, "pJ", "low end");
    list.add("energy.high", high, "pJ", "high end");
    list.add(
        "area.total",
        area.total,
        "NAND2",
        "area of what the frame uses, middle of its range",
    );
    for (part, of) in area.parts() {
        let name = format!("area.{part}");
        list.add(&name, of.total, "NAND2", "middle of its range");
    }
    if let Some(ray_caster) = ray_caster {
        for step in FloatStep::ALL {
            let name = format!("ray_caster.{}", word(step.name()));
            list.add(
                &name,
                ray_caster.counts.of(step),
                "Count",
                "steps of the ray caster",
            );
        }
        list.add(
            "ray_caster.rays",
            ray_caster.counts.rays,
            "Count",
            "rays cast",
        );
        list.add(
            "ray_caster.cells",
            ray_caster.counts.cells,
            "Count",
            "cells that rays looked at",
        );
        list.add(
            "ray_caster.cycles",
            ray_caster.cycles.cycles,
            "Cycle",
            "cycles of its frame, no fewer than",
        );
        list.add(
            "ray_caster.energy.total",
            ray_caster.cost.total().0,
            "pJ",
            "energy of its frame",
        );
    }
    list
}

fn cycles(list: &mut Statistics, simulated: &Simulated) {
    let report = &simulated.cycles;
    list.add(
        "cycles.total",
        report.cycles,
        "Cycle",
        "cycles of the frame",
    );
    list.add(
        "cycles.a_record",
        report.cycles_per_record,
        "Cycle/Count",
        "cycles a record",
    );
    list.add(
        "cycles.a_pixel",
        report.cycles_per_pixel,
        "Cycle/Count",
        "cycles a pixel written",
    );
    list.add(
        "cycles.frames_per_second",
        report.frames_per_second,
        "Hz",
        "at the clock",
    );
    list.add(
        "cycles.work",
        report.work,
        "Cycle",
        "all turns, nothing waited for",
    );
    list.add(
        "cycles.span",
        report.span,
        "Cycle",
        "longest chain of turns",
    );
    list.add(
        "cycles.parallelism",
        report.parallelism,
        "Ratio",
        "work over span",
    );
    list.add(
        "cycles.serial",
        report.serial,
        "Cycle",
        "all turns one after the other",
    );
    list.add(
        "cycles.records",
        report.records,
        "Count",
        "records on this hardware",
    );
    for stage in &report.stages {
        let name = word(stage.stage.name());
        let add = |list: &mut Statistics, key: &str, value: u64, what: &str| {
            list.add(&format!("cycles.{name}.{key}"), value, "Cycle", what);
        };
        add(list, "busy", stage.busy, "cycles of issuing operations");
        add(
            list,
            "held",
            stage.held,
            "cycles of waiting to issue accesses",
        );
        for cause in Cause::ALL {
            let key = format!("stall.{}", word(cause.name()));
            add(
                list,
                &key,
                stage.stalls.of(cause),
                "cycles that records waited",
            );
        }
    }
    let cache = &report.node_cache;
    list.add(
        "node_cache.accesses",
        cache.accesses,
        "Count",
        "reads of nodes",
    );
    list.add(
        "node_cache.misses",
        cache.misses,
        "Count",
        "lines brought in",
    );
    list.add(
        "node_cache.hit_rate",
        cache.hit_rate,
        "Ratio",
        "hits over accesses",
    );
    list.add(
        "stack.deepest",
        report.stack.deepest,
        "Count",
        "most records on a stack",
    );
    list.add(
        "stack.most_live",
        report.stack.most_live,
        "Count",
        "most records at once",
    );
    list.add(
        "stack.spilled",
        report.stack.spilled,
        "Count",
        "records without an entry",
    );
    list.add(
        "stack.spilled_bits",
        report.stack.spilled_bits,
        "Bit",
        "their bits, written to outer memory and read back",
    );
    list.add(
        "outer_memory.busy",
        report.outer_busy,
        "Cycle",
        "cycles of its port: lines of caches and spilled records",
    );
}
